// Pixels as areas of interest: the specular radiance that reaches a pixel, measured on the image plane.
#pragma once

#include <memory>

#include "lumel/accel/accel.h"
#include "lumel/areas/bundle_field.h"
#include "lumel/areas/tally.h"
#include "lumel/scene/camera.h"
#include "lumel/scene/surface.h"

namespace lumel {

class LobeLooks;

/// Measures the indirect specular radiance of the pixels of many cameras at once.
///
/// With s in the unit square of a pixel, |ds/dA| = cos(theta_eye) / (d^2 dw/ds), and for a transfer that lands on x in view,
///     f/p = L_in w_s |ds/dA| / p      g/p = lum(w_s) |ds/dA| / (a_bar p)
/// a_bar is the mean of lum(a_s) over the pixel, 0 for what is not gloss, so that g integrates to 1 over pixels half on gloss as well.
/// ([WIS] averages over the surface's area instead.) Gathered samples join as for patches; their points are drawn on the pixel.
/// What a bundle brings is interpolated between patches, and every pixel reflects it by its own lobe.
class PixelAreas {
public:
    PixelAreas(const Accel& accel, const Lattice& lattice, std::vector<Camera> cameras);

    uint32_t cameras() const { return static_cast<uint32_t>(cameras_.size()); }
    const Camera& camera(uint32_t index) const { return cameras_[index]; }
    /// Mean lum specular albedo of a pixel.
    double albedo(uint32_t camera, uint32_t pixel) const { return albedo_[at(camera, pixel)]; }
    void measure(const Step& step);
    /// End a replica: see Tally.
    void close_replica(double weight, double rays) { tally_.close_replica(weight, rays); }
    /// Go back to the start, without a sample.
    void forget() { tally_ = Tally(tally_.size()); }
    /// Sums not yet divided by albedo: samples of several pixels can be pooled by addition.
    Samples unscaled(uint32_t camera, uint32_t pixel) const { return tally_.samples(at(camera, pixel)); }
    /// Samples of one pixel as its estimator wants them.
    Samples samples(uint32_t camera, uint32_t pixel) const;

private:
    /// A sample on its way to the tally.
    struct Deposit {
        uint32_t area;
        bool plain;
        Rgb f;
        float g;
    };
    size_t at(uint32_t camera, uint32_t pixel) const { return first_[camera] + pixel; }
    void find_receivers();
    void find_albedo();
    void shoot_side(const Step& step, uint32_t side, std::vector<Deposit>& deposits) const;
    void measure_bundles(const Step& step);
    void measure_bundles(const Step& step, uint32_t camera);
    /// Gather, or with nothing to gather look now and then what the density covers.
    void look(const Step& step, uint32_t camera, uint32_t pixel, LobeLooks& looks) const;

    const Accel* accel_;
    const Scene* scene_;
    std::vector<Camera> cameras_;
    std::vector<uint32_t> receivers_;  // glossy sides that face any camera
    BundleField field_;                // on these
    std::vector<size_t> first_;   // per camera: its first area
    std::vector<double> albedo_;  // per area
    Tally tally_;
};

}  // namespace lumel
