#include "lumel/eye/rare_light.h"

#include <tbb/parallel_for.h>

#include "lumel/eye/around.h"

namespace lumel {

namespace {

constexpr int kTell = 2;            // pixels to each side that tell what is usual,
constexpr float kFewest = 8;        // as many of them at least,
constexpr float kRare = 3;          // of their standard errors that a pixel may have
constexpr int kShare = 4;           // pixels to each side that take what is beyond

/// What a pixel has less of after sharing.
struct Given {
    Rgb value, variance;
    float kept = 1;  // of how it differs from those around
};

class RareLight {
public:
    RareLight(const Film& film, const Likeness& alike, std::vector<Difference>& differences)
        : film_(film), alike_(alike), differences_(differences) {}

    /// What should be given; nothing if the pixel is like those around.
    Given of(int x, int y) const {
        const size_t pixel = pixel_at(film_, x, y);
        const Difference& own = differences_[pixel];
        if (!is_known(pixel) || !(own.stderr_ > 0)) return {};
        float squares = 0, count = 0;
        Rgb sum;
        for_each_around(film_, x, y, kTell, [&](size_t other, int, int) {
            if (other == pixel || !takes(pixel, other)) return;
            squares += sqr(differences_[other].stderr_), sum += differences_[other].mean, ++count;
        });
        if (count < kFewest) return {};
        const float usual = kRare * std::sqrt(squares / count);
        const Rgb differs = own.mean - sum / count;
        if (!(own.stderr_ > usual) || own.is_sure(std::abs(lum(differs)), own.stderr_)) return {};
        const float kept = usual / own.stderr_;
        return {differs * (1 - kept), own.variance * sqr(1 - kept), kept};
    }
    void give(int x, int y, const Given& given) {
        const size_t pixel = pixel_at(film_, x, y);
        Difference& own = differences_[pixel];
        own.mean += given.value * -1, own.set_variance(own.variance * sqr(given.kept));
        float count = 0;
        for_each_around(film_, x, y, kShare, [&](size_t other, int, int) { count += takes(pixel, other) ? 1.0f : 0.0f; });
        for_each_around(film_, x, y, kShare, [&](size_t other, int, int) {
            if (!takes(pixel, other)) return;
            Difference& d = differences_[other];
            d.mean += given.value / count, d.set_variance(d.variance + given.variance / sqr(count));
        });
    }

private:
    bool is_known(size_t pixel) const { return differences_[pixel].passes > 0; }
    /// Does the other pixel see the same gloss?
    bool takes(size_t pixel, size_t other) const {
        return other == pixel || (is_known(other) && film_.material[other] == film_.material[pixel] && alike_(pixel, other));
    }

    const Film& film_;
    const Likeness& alike_;
    std::vector<Difference>& differences_;
};

}  // namespace

void share_rare(const Film& film, const Likeness& alike, std::vector<Difference>& differences) {
    const auto width = static_cast<int>(film.width), height = static_cast<int>(film.height);
    RareLight rare(film, alike, differences);
    std::vector<Given> given(film.pixels());
    tbb::parallel_for(0, height, [&](int y) {
        for (int x = 0; x < width; ++x) given[pixel_at(film, x, y)] = rare.of(x, y);
    });
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            if (const Given& g = given[pixel_at(film, x, y)]; g.kept < 1) rare.give(x, y, g);
}

}  // namespace lumel
