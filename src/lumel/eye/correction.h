// How much of what was gathered goes into the picture: as much as its noise allows against the error that it mends.
#pragma once

#include "lumel/eye/film.h"

namespace lumel {

/// Set the correction of every pixel of a film from what its passes gathered.
///
/// Gathering has no bias to speak of but noise; the reconstruction has little noise but is off where patches are too coarse. Their
/// difference D, measured in every pixel, tells both. Of D the share b^2 / (b^2 + variance) is added, which makes the mean square error
/// least (James and Stein 1961). The spread of the passes tells the variance; the squared error b^2 of the reconstruction is what
/// different pixels that see a like surface have in common, since their noise is independent. It is done twice: for the mean of D over
/// the pixels around, where noise is small, and for what each pixel has beyond it. Only pixels whose gathering rays meet something near
/// are corrected: elsewhere patches are fine enough, and light from small bright spots, which rays seldom find, would be taken for
/// darkness. With `gloss`, the gloss of a material is corrected as `choose_gloss` says wherever it is seen.
void correct(Film& film, bool gloss);

}  // namespace lumel
