#include "lumel/eye/smooth.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <array>

#include "lumel/scene/surface.h"

namespace lumel {

namespace {

constexpr int kTerms = 7;          // of the fit: a constant, the normal, the position
constexpr size_t kMost = 24;       // sides of a fit
constexpr size_t kFewest = 6;
constexpr int kRings = 3;
constexpr float kSameSide = 0.8f;  // least cosine between normals of a fit
constexpr double kAlike = 9;       // squared differences that noise explains, in variances
constexpr double kRidge = 1e-3;    // keeps terms out of the fit that hardly vary

using Terms = std::array<double, kTerms>;

double product(const Terms& a, const Terms& b) {
    double sum = 0;
    for (int k = 0; k < kTerms; ++k) sum += a[k] * b[k];
    return sum;
}

/// A weighted least squares problem.
class Fit {
public:
    void add(double weight, const Terms& t, double value) {
        for (int a = 0; a < kTerms; ++a) {
            for (int b = 0; b <= a; ++b) matrix_[a][b] += weight * t[a] * t[b];
            right_[a] += weight * t[a] * value;
        }
    }
    double weight() const { return weight_; }
    /// Terms that the fit has to itself: those that vary.
    double used() const { return used_; }
    Terms coefficients() const { return solve(right_); }

    /// Replace the normal equations by their Cholesky factor.
    void factorise() {
        weight_ = matrix_[0][0];
        used_ = 1;
        for (int a = 1; a < kTerms; ++a) {
            used_ += matrix_[a][a] / (matrix_[a][a] + kRidge * weight_);
            matrix_[a][a] += kRidge * weight_;
        }
        for (int i = 0; i < kTerms; ++i)
            for (int j = 0; j <= i; ++j) {
                double sum = matrix_[i][j];
                for (int k = 0; k < j; ++k) sum -= matrix_[i][k] * matrix_[j][k];
                matrix_[i][j] = i == j ? std::sqrt(std::max(sum, 1e-30)) : sum / matrix_[j][j];
            }
    }
    Terms solve(Terms b) const {
        for (int i = 0; i < kTerms; ++i) {
            for (int k = 0; k < i; ++k) b[i] -= matrix_[i][k] * b[k];
            b[i] /= matrix_[i][i];
        }
        for (int i = kTerms - 1; i >= 0; --i) {
            for (int k = i + 1; k < kTerms; ++k) b[i] -= matrix_[k][i] * b[k];
            b[i] /= matrix_[i][i];
        }
        return b;
    }

private:
    std::array<Terms, kTerms> matrix_{};
    Terms right_{};
    double weight_ = 0, used_ = 0;
};

class Smoother {
public:
    Smoother(const Scene& scene, const Lattice& lattice, const SideField& field) : scene_(scene), lattice_(lattice), field_(field) {
        find_places();
        sides_.resize(scene.sides());
        for_each_side([&](uint32_t side) {
            const Surface x(scene_, scene_.centre_of_patch(scene_.patch_of_side(side)), scene_.is_back(side));
            sides_[side] = {x.x, x.shading, scene_.side_area(side), lum(field_.mean[side]), sqr(lum(square_root(field_.variance[side])))};
        });
        // Sides are compared by the means over all that touch: noise of single sides is skewed, and picking by it would darken.
        around_.resize(scene.sides());
        for_each_side([&](uint32_t side) {
            Around& a = around_[side];
            for_each_touching(side, [&](uint32_t other) {
                a.value += sides_[other].value * sides_[other].area;
                a.area += sides_[other].area;
            });
            a.value /= a.area;
        });
    }

    SideField result() const {
        SideField smooth = field_;
        for_each_side([&](uint32_t side) { replace(side, smooth); });
        return smooth;
    }

private:
    struct Side {
        Vec3 x, normal;
        double area = 0, value = 0, variance = 0;  // lum
    };
    struct Around {
        double value = 0, area = 0;
    };

    template <class Body>
    void for_each_side(const Body& body) const {
        tbb::parallel_for(tbb::blocked_range<uint32_t>(0, scene_.sides(), 256), [&](const auto& range) {
            for (uint32_t side = range.begin(); side < range.end(); ++side)
                if (scene_.scatters(side)) body(side);
        });
    }

    std::array<uint32_t, 3> places(uint32_t patch) const {
        auto ids = lattice_.corners(patch);
        for (uint32_t& id : ids) id = lattice_.place(id);
        return ids;
    }
    /// List the patches at every place.
    void find_places() {
        first_.assign(size_t{lattice_.places()} + 1, 0);
        for (uint32_t patch = 0; patch < scene_.patches(); ++patch)
            for (uint32_t place : places(patch)) ++first_[place + 1];
        for (uint32_t place = 0; place < lattice_.places(); ++place) first_[place + 1] += first_[place];
        patches_.resize(first_.back());
        std::vector<uint32_t> at(first_.begin(), first_.end() - 1);
        for (uint32_t patch = 0; patch < scene_.patches(); ++patch)
            for (uint32_t place : places(patch)) patches_[at[place]++] = patch;
    }
    /// Sides on the same face that share a place and face about the same way, this one among them, some more than once.
    template <class Body>
    void for_each_touching(uint32_t side, const Body& body) const {
        const uint32_t face = scene_.is_back(side) ? scene_.patches() : 0;
        for (uint32_t place : places(scene_.patch_of_side(side)))
            for (uint32_t i = first_[place]; i < first_[place + 1]; ++i) {
                const uint32_t other = patches_[i] + face;
                if (sides_[other].area > 0 && dot(sides_[other].normal, sides_[side].normal) > kSameSide) body(other);
            }
    }

    /// Sides around one, itself first, ring by ring.
    std::vector<uint32_t> rings(uint32_t side) const {
        std::vector<uint32_t> found{side};
        size_t first = 0;
        for (int ring = 0; ring < kRings; ++ring) {
            const size_t last = found.size();
            for (; first < last && found.size() < kMost; ++first)
                for_each_touching(found[first], [&](uint32_t other) {
                    if (found.size() < kMost && dot(sides_[other].normal, sides_[side].normal) > kSameSide &&
                        std::find(found.begin(), found.end(), other) == found.end())
                        found.push_back(other);
                });
        }
        return found;
    }

    void replace(uint32_t side, SideField& smooth) const {
        // Noise of a unit of area, and the sides that agree with this one within it.
        std::vector<uint32_t> found = rings(side);
        double unit = 0;
        for (uint32_t other : found) unit += sides_[other].variance * sides_[other].area / static_cast<double>(found.size());
        std::erase_if(found, [&](uint32_t other) {
            const Around &a = around_[side], &b = around_[other];
            return (a.value - b.value) * (a.value - b.value) > kAlike * unit * (1 / a.area + 1 / b.area);
        });
        if (!(unit > 0)) return;
        float reach = 0;
        for (uint32_t other : found) reach = std::max(reach, length(sides_[other].x - sides_[side].x));
        if (found.size() < kFewest || !(reach > 0)) return;

        // Fit.
        std::vector<Terms> terms;
        Fit fit;
        for (uint32_t other : found) {
            const Vec3 dn = sides_[other].normal - sides_[side].normal, dx = (sides_[other].x - sides_[side].x) / reach;
            terms.push_back({1, dn.x, dn.y, dn.z, dx.x, dx.y, dx.z});
            fit.add(sides_[other].area, terms.back(), sides_[other].value);
        }
        fit.factorise();
        const Terms here = fit.solve({1}), coefficients = fit.coefficients();

        // What the fit says, its noise, and what it leaves unexplained.
        Rgb64 said;
        double said_variance = 0, residuals = 0;
        for (size_t k = 0; k < found.size(); ++k) {
            const Side& other = sides_[found[k]];
            const double weight = other.area * product(terms[k], here), off = other.value - product(terms[k], coefficients);
            said += to_double(field_.mean[found[k]]) * weight;
            said_variance += weight * weight * unit / other.area;
            residuals += other.area * off * off;
        }
        const double variance = unit / sides_[side].area;
        const double unexplained = std::max(0.0, residuals - unit * (static_cast<double>(found.size()) - fit.used())) / fit.weight();
        const double share = unexplained / (unexplained + variance);
        const Rgb mixed = (said * (1 - share) + to_double(field_.mean[side]) * share).to_float();
        smooth.mean[side] = {std::max(0.0f, mixed.x), std::max(0.0f, mixed.y), std::max(0.0f, mixed.z)};

        // The errors of both are not independent: add them as if they were one. They have the colour of the light.
        const double left = (1 - share) * std::sqrt(said_variance) + share * std::sqrt(variance);
        const float light = lum(smooth.mean[side]);
        const Rgb error = light > 0 ? smooth.mean[side] * (static_cast<float>(left) / light) : Rgb{};
        smooth.variance[side] = error * error;
    }

    const Scene& scene_;
    const Lattice& lattice_;
    const SideField& field_;
    std::vector<uint32_t> first_, patches_;  // patches at every place
    std::vector<Side> sides_;
    std::vector<Around> around_;
};

}  // namespace

SideField smoothed(const Scene& scene, const Lattice& lattice, const SideField& field) { return Smoother(scene, lattice, field).result(); }

}  // namespace lumel
