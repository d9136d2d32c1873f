#include "lumel/eye/lobe_draw.h"

namespace lumel {

void LobeBlock::draw() {
    for (uint32_t i = 0; i < size; ++i) {
        const LobeDraw d(shading[i], wo[i], alpha[i], {u[i], v[i]});
        wi.set(i, d.wi);
        pdf_w[i] = d.pdf_w, masked[i] = d.masked, cos_h[i] = d.cos_h;
    }
}

}  // namespace lumel
