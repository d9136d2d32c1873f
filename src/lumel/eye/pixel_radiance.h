// Estimates of the specular light of all pixels of a camera, from samples measured in pixels.
#pragma once

#include "lumel/areas/pixels.h"
#include "lumel/eye/reconstruction.h"

namespace lumel {

struct PixelRadiance {
    std::vector<Reconstructed> pixels;  ///< row by row
    uint32_t borrowed = 0;              ///< glossy pixels without a sample that took those of their neighbours
    uint32_t unfilled = 0;              ///< glossy pixels that found none there either
    uint32_t measured = 0, flagged = 0; ///< pixels with samples, and those of them that are flagged (see Trust)
};

/// Estimate every pixel.
PixelRadiance estimate_pixels(const PixelAreas& areas, uint32_t camera, const Estimator& estimator);

}  // namespace lumel
