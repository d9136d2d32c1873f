#include "arrays.h"

NB_MODULE(_core, m) {
    m.doc() = "The core of lumel. Private: the package around it is the interface.";
    bind_scene(m);
    bind_accel(m);
    bind_raster(m);
    bind_session(m);
}
