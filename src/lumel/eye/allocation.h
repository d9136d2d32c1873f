// Where the samples of a pass go: to the pixels that gain most from them.
#pragma once

#include "lumel/eye/film.h"

namespace lumel {

/// Samples of the next pass for every pixel, `mean` for the mean pixel and at least one for each.
///
/// The sum over pixels of variance / (L^2 + e) is least, at so many samples in all, where they are in proportion to the square root of
/// the variance of one sample over L^2 + e (Neyman 1934): edges, penumbrae and noisy gloss get what flat walls do not need. Variances come
/// from the spread of the passes so far, as a mean over the pixels around; until there are two passes all pixels get the same.
std::vector<uint32_t> samples_of_pass(const Film& film, uint32_t mean);

}  // namespace lumel
