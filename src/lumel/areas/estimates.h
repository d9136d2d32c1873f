// Estimates of areas of interest, alone or pooled, with the help of those around them.
#pragma once

#include <span>
#include <vector>

#include "lumel/areas/neighbourhood.h"
#include "lumel/areas/pixels.h"
#include "lumel/estimators/trust.h"

namespace lumel {

/// What an estimator makes of the samples of some areas.
struct AreaEstimate {
    Samples samples;   ///< pooled; those of the neighbours where the areas had none themselves
    Estimate estimate;
    Trust trust;
    bool borrowed = false;  ///< no sample of its own, and those of the neighbours taken instead
    bool unfilled = false;  ///< no sample there either: the value is a stand-in
};

/// Estimate areas that are pooled (their sums are added before the estimator takes its ratio) towards an eye; their neighbours help.
AreaEstimate estimate_pooled(const PatchAreas& areas, const Neighbourhood& neighbourhood, uint32_t eye, std::span<const uint32_t> centre,
                             const Estimator& estimator);

/// Estimate one pixel. Its neighbours are glossy pixels of about the same albedo, in a square that grows until they have samples enough.
AreaEstimate estimate_pixel(const PixelAreas& areas, uint32_t camera, uint32_t pixel, const Estimator& estimator);

}  // namespace lumel
