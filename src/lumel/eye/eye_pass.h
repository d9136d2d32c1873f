// From the solution to pixels: emission, direct light, reconstructed indirect light; mirrors followed.
#pragma once

#include <atomic>

#include "lumel/accel/accel.h"
#include "lumel/eye/film.h"
#include "lumel/eye/pixel_radiance.h"
#include "lumel/eye/reconstruction.h"
#include "lumel/scene/camera.h"

namespace lumel {

struct EyePassConfig {
    uint32_t samples = 16;      ///< of this pass, for the mean pixel (see `samples_of_pass`), spread over the pixel (box filter)
    bool direct_light = true;   ///< false without the first shot: then the solution holds the direct light too
    bool gather = true;         ///< gather indirect light where the reconstruction is off; needs direct_light
    bool gloss = true;          ///< mix rays of the lobe into gloss where that is better (see choose_gloss)
    uint64_t stream = 0;        ///< key of the random numbers of the picture, whatever the pass
};

/// Add one pass over the whole picture to `film`. `eye` is the index of the camera among the eyes of the solver; the specular light of what
/// is seen directly comes from `pixels` if they were measured, else from the reconstruction. Stops early, leaving
/// `film` as it was, when `stop` becomes true. Returns whether the pass was added.
bool eye_pass(const Accel& accel, const Camera& camera, uint32_t eye, const Reconstruction& reconstruction, const PixelRadiance* pixels,
              const EyePassConfig& config, const std::atomic<bool>* stop, Film& film);

/// Glossy sides that any of the cameras sees directly, and their neighbours on the lattice, in ascending order. Sharp gloss is left to the
/// eye passes, as if it were seen in a mirror.
std::vector<uint32_t> visible_glossy_sides(const Accel& accel, const Lattice& lattice, std::span<const Camera> cameras);

}  // namespace lumel
