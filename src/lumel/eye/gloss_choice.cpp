#include "lumel/eye/gloss_choice.h"

#include <tbb/parallel_for.h>

#include <map>

namespace lumel {

namespace {

constexpr uint32_t kTile = 8;   // pixels along the edge of a tile, in which noise is taken as even
constexpr double kShared = 2;   // weight of errors that pixels share, against noise
constexpr double kOfThree = 0.5;  // of the sum of the errors of three vertices, squared: they are independent (mean of the squared weights)
constexpr double kChance = 2;  // standard errors of b^2 that chance may explain
constexpr double kCost = 0.4;  // of a ray of the lobe, in eye samples without

/// lum of a variance, as if its channels were one.
double noise(Rgb variance) { return sqr(double{lum(square_root(variance))}); }

/// Errors of the gloss of one material over L^2 + e, summed over the pixels that see it.
struct Gloss {
    double pixels = 0;
    double told = 0;  // b^2 as the solution tells it,
    double common = 0, common2 = 0;  // and products of D in neighbouring pixels, and their squares
    double gathered = 0;  // variance of D
    double roots = 0;  // what it adds to those of Errors if every eye sample follows the lobe

    Gloss& operator+=(const Gloss& o) {
        pixels += o.pixels, told += o.told, common += o.common, common2 += o.common2, gathered += o.gathered, roots += o.roots;
        return *this;
    }
    double solution() const { return kShared * std::max(kOfThree * told, common - kChance * std::sqrt(common2)); }
};

/// Where samples go where they are needed, they leave the square of the sum over pixels of the roots of the variances of one sample, over
/// the number of samples.
struct Errors {
    double pixels = 0, samples = 0, roots = 0;
    std::vector<Gloss> gloss;

    Gloss& of(uint32_t material) {
        if (material >= gloss.size()) gloss.resize(size_t{material} + 1);
        return gloss[material];
    }
    Errors& operator+=(const Errors& o) {
        pixels += o.pixels, samples += o.samples, roots += o.roots;
        for (uint32_t material = 0; material < o.gloss.size(); ++material) of(material) += o.gloss[material];
        return *this;
    }
    GlossChoice choice(const Gloss& g) const {
        const double b2 = g.solution();
        if (!(b2 > 0) || !std::isfinite(b2 + g.gathered)) return {};
        // After as many samples again: with the solution alone, or with the best mixture, for which there is time for fewer samples.
        const double rest = sqr(roots) / (2 * samples), fewer = 1 + kCost * g.pixels / pixels,
                     variance = (sqr(roots + g.roots) - sqr(roots)) / (2 * samples) * fewer;
        return {static_cast<float>(b2 / (b2 + g.gathered)), rest * fewer + b2 * variance / (b2 + variance) < rest + b2};
    }
};

/// Adds up the tiles of a film that stand in a row.
class Tiles {
public:
    Tiles(const Film& film, double e, uint32_t row) : film_(film), e_(e) {
        for (uint32_t x = 0; x < film.width; x += kTile) add(x, row * kTile);
    }
    const Errors& errors() const { return errors_; }

private:
    void add(uint32_t x0, uint32_t y0) {
        double pixels = 0, rest = 0;
        std::map<uint32_t, double> lobes;  // variances of one ray, by material
        for (uint32_t y = y0; y < std::min(film_.height, y0 + kTile); ++y)
            for (uint32_t x = x0; x < std::min(film_.width, x0 + kTile); ++x) {
                const size_t pixel = size_t{film_.width} * y + x;
                const PassMoments& seen = film_.uncorrected[pixel];
                const double over = 1 / (sqr(double{lum(seen.mean())}) + e_);
                ++pixels, errors_.samples += double{seen.count()};
                rest += over * noise(seen.variance()) * double{seen.count()};
                if (is_known(pixel)) lobes[film_.material[pixel]] += add_gloss(pixel, x + 1 < film_.width, over);
            }
        errors_.pixels += pixels;
        errors_.roots += std::sqrt(pixels * rest);
        for (const auto& [material, variance] : lobes)
            errors_.of(material).roots += std::sqrt(pixels * (rest + variance)) - std::sqrt(pixels * rest);
    }
    /// Gives the variance of one ray of the lobe. `has_next`: there is a pixel to the right.
    double add_gloss(size_t pixel, bool has_next, double over) {
        const PassMoments& excess = film_.specular[pixel].excess;
        const uint32_t material = film_.material[pixel];
        Gloss& gloss = errors_.of(material);
        const double variance = over * noise(excess.variance());
        ++gloss.pixels;
        gloss.told += over * sqr(double{lum(film_.sum[pixel].specular_stderr) / film_.samples(pixel)});
        gloss.gathered += variance;
        if (has_next && is_known(pixel + 1) && film_.material[pixel + 1] == material) {
            const double product = over * double{lum(excess.mean())} * double{lum(film_.specular[pixel + 1].excess.mean())};
            gloss.common += product, gloss.common2 += sqr(product);
        }
        return variance * double{excess.count()};
    }
    bool is_known(size_t pixel) const {
        return film_.material[pixel] != PixelPass::kNoMaterial && film_.specular[pixel].excess.has_spread();
    }

    const Film& film_;
    double e_;
    Errors errors_;
};

}  // namespace

std::vector<GlossChoice> choose_gloss(const Film& film) {
    const double light = film.mean_light();
    if (!(light > 0)) return {};
    std::vector<Errors> rows((film.height + kTile - 1) / kTile);
    tbb::parallel_for(uint32_t{0}, static_cast<uint32_t>(rows.size()),
                      [&](uint32_t row) { rows[row] = Tiles(film, double{Film::kDark} * sqr(light), row).errors(); });
    Errors errors;
    for (const Errors& row : rows) errors += row;
    std::vector<GlossChoice> choices;
    choices.reserve(errors.gloss.size());
    for (const Gloss& gloss : errors.gloss) choices.push_back(errors.choice(gloss));
    return choices;
}

}  // namespace lumel
