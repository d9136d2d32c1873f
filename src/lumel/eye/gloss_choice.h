// Material by material, how much of its gloss the picture takes from rays of the specular lobe instead of from patches.
#pragma once

#include <vector>

#include "lumel/eye/film.h"

namespace lumel {

/// What is best for the gloss of one material.
struct GlossChoice {
    float share = 0;      ///< of what was gathered, 0..1; the rest comes from the solution
    bool gather = false;  ///< are rays of the lobe worth their time in every eye sample?
};

/// One entry for each material whose gloss was measured and is in the picture, by its number.
///
/// Patches blur sharp gloss, and their noise is seen as blotches; rays of the lobe make noise that differs from pixel to pixel. The squared
/// error b^2 of the solution is what it tells itself, or the mean product of the differences D, of what was gathered from the solution, in
/// neighbouring pixels: the noise of rays is independent there, b is not. It counts twice, since it is left in the mean over
/// pixels as well. The share b^2 / (b^2 + variance) of D makes the mean square error least (James and Stein 1961), relative to the light of
/// the pixels. As the share is one number for a whole material, it makes nothing darker where rays have missed a small bright spot.
std::vector<GlossChoice> choose_gloss(const Film& film);

}  // namespace lumel
