// What a patch sends and receives in one sweep, in one cache line.
#pragma once

#include <cstdint>

#include "lumel/math/vec.h"
#include "lumel/raster/lanes.h"

namespace lumel {

/// Light along the direction of the window and against it.
struct alignas(64) PatchLight {
    /// Red, green, blue and a count: what is sent counts 1, so that what is received counts the pixels that it came over.
    using Flow = FloatLanes;

    Flow sent_along{}, sent_against{};          ///< by the side that faces along the direction, by the one that faces against it
    Flow received_along{}, received_against{};  ///< the same

    PatchLight() = default;
    PatchLight(Rgb along, Rgb against) : sent_along{along.x, along.y, along.z, 1}, sent_against{against.x, against.y, against.z, 1} {}
    /// Add the colour of a flow to a sum, two channels side by side.
    static void add(Rgb& sum, Flow flow) {
        using Pair = float __attribute__((vector_size(2 * sizeof(float))));
        const Pair pair = Pair{sum.x, sum.y} + Pair{flow[0], flow[1]};
        sum = {pair[0], pair[1], sum.z + flow[2]};
    }
    static Rgb colour(Flow flow) { return {flow[0], flow[1], flow[2]}; }
    static uint32_t count(Flow flow) { return static_cast<uint32_t>(static_cast<int32_t>(flow[3])); }
};

/// Two neighbours see each other over `pixels` pixels: `far` lies behind `near`.
inline void exchange(PatchLight& near, PatchLight& far, uint32_t pixels) {
    const auto times = static_cast<float>(static_cast<int32_t>(pixels));
    near.received_along += far.sent_against * times;
    far.received_against += near.sent_along * times;
}

}  // namespace lumel
