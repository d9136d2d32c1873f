// Take noise out of what is known of patches.
#pragma once

#include "lumel/areas/irradiance.h"
#include "lumel/scene/lattice.h"

namespace lumel {

/// The field with the value of every side replaced by what a linear fit over the sides around it says, as far as noise explains the rest.
///
/// The fit is in position and normal, so facets that bend away from each other keep their differences. Only sides count whose light
/// does not differ from that around this one by more than noise explains. Where the residuals of the fit exceed the noise, by r^2 a
/// side, its own value keeps the share r^2 / (r^2 + variance) (empirical Bayes). So nothing changes where there is no noise.
///
/// Sides are few that agree around small ones, so groups of them are smoothed first in the same way, and groups of groups: what they say
/// joins the fit with the share (variance of the fit) / (variance of the fit + their variance + b^2), b^2 what they are off beyond noise.
SideField smoothed(const Scene& scene, const Lattice& lattice, const SideField& field);

}  // namespace lumel
