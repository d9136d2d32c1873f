// Light that few rays find, and then much of it at once: single bright pixels.
#pragma once

#include <vector>

#include "lumel/eye/difference.h"
#include "lumel/eye/likeness.h"

namespace lumel {

/// Share what single rare bright rays found, one entry a pixel, among the pixels around that see the same gloss. A ray counts as rare
/// where the standard error of its pixel is far beyond the root mean square of those around and what differs is within it: what comes
/// again and again stays where it is. The sum over pixels stays the same but for rounding.
void share_rare(const Film& film, const Likeness& alike, std::vector<Difference>& differences);

}  // namespace lumel
