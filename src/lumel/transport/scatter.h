// What surfaces do with the light that arrived: it becomes the emitters of the next step.
#pragma once

#include "lumel/transfer/transfers.h"
#include "lumel/transport/emitters.h"

namespace lumel {

/// Sum the light of each side into `received` (W, shading cosine included; overwritten), and let `next` send it on: the Lambertian share
/// as diffuse flux, the specular share as records whose directions are drawn among the transfers by what the lobe makes of them. Where
/// there are few hits a single one would make a small patch far too bright: small patches, and all in their lobes, send what they and
/// their neighbours received, spread by area. The records of lamps in `next` are cleared.
void scatter(const Scene& scene, const Transfers& transfers, uint64_t stream, std::vector<Rgb>& received, Emitters& next);

/// Add the records of one more generation to those of all before it: of two candidates for a place one stays, drawn by power, and
/// takes over the power of both, so that the mean over streams is their sum.
void merge_records(const Scene& scene, const Emitters& generation, uint64_t stream, Emitters& total);

}  // namespace lumel
