// Looking back along a transfer: what light comes to a point, and how likely a transport was to send a transfer that way.
#pragma once

#include <span>

#include "lumel/math/vec.h"

namespace lumel {

/// A look from a point off its surface.
struct Look {
    Vec3 origin, direction;
};

/// What a look finds: the same L_in that a transfer along it would carry, and the density of such transfers.
struct Seen {
    Rgb radiance;       ///< W/(m2 sr)
    float density = 0;  ///< n p(x, wi) / cos(theta_x): expected transfers of one step per m2 and sr across the direction
    bool dark = false;  ///< no light can come to where the look ended, nor to where it began: a point under a box, say
};

/// One step of a transport, as seen by those who gather.
class Sight {
public:
    virtual ~Sight() = default;
    /// Answer all looks; `seen` has as many entries as `looks`. Safe from many threads.
    virtual void see(std::span<const Look> looks, std::span<Seen> seen) const = 0;
};

}  // namespace lumel
