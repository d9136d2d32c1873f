#include "lumel/eye/smooth_level.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

namespace lumel {

namespace {

constexpr size_t kMost = 24;       // nodes of a fit
constexpr size_t kFewest = 6;
constexpr int kRings = 3;
constexpr double kAlike = 9;       // squared differences that noise explains, in variances
constexpr uint32_t kFewestGroups = 8;
constexpr double kMostGroups = 0.6;  // of the nodes: above, a coarser level hardly says more
constexpr double kChance = 1;        // standard errors of a misfit that noise explains
constexpr double kFewestRays = 1e-3; // that are expected at a node
constexpr double kDarkest = 0.01;    // light of a node at least, of that around

double distance2(Vec3 a, Vec3 b) { return double{dot(a - b, a - b)}; }

FitTerms terms(const SmoothNode& at, const SmoothNode& from, double scale) {
    const Vec3 dn = at.normal - from.normal, dx = at.x - from.x;
    return {1, double{dn.x}, double{dn.y}, double{dn.z}, double{dx.x} * scale, double{dx.y} * scale, double{dx.z} * scale};
}

/// The light at another place than its node's.
Rgb64 light_at(const LinearLight& l, const SmoothNode& at, const SmoothNode& from) {
    const FitTerms t = terms(at, from, 1);
    Rgb64 light = l.light;
    for (int k = 1; k < kFitTerms; ++k) light += l.slope[k - 1] * t[k];
    return light;
}

/// a and b in shares that sum to 1, with the variance given.
LinearLight mixed(const LinearLight& a, double share_a, const LinearLight& b, double variance) {
    LinearLight m{a.light * share_a + b.light * (1 - share_a), {}, variance};
    for (size_t k = 0; k < m.slope.size(); ++k) m.slope[k] = a.slope[k] * share_a + b.slope[k] * (1 - share_a);
    return m;
}

/// Squares of what is left between nodes and what is said of them, over their variances.
class Misfit {
public:
    /// `unit`: variance of a unit of area.
    void add(const SmoothNode& n, Rgb64 said, double unit) {
        if (!(unit > 0)) return;  // no light anywhere near
        const double weight = n.area / unit, light = std::max(lum(said), 0.0);
        squares_ += weight * sqr(n.value() - lum(said)), weights_ += weight, ++count_;
        // Few rays vary more than many: the fourth moment of a Poisson variate, whose mean is the light over its unit.
        chance2_ += 2 + 1 / std::max(light * weight * light, kFewestRays);
    }
    Misfit& operator+=(const Misfit& o) {
        squares_ += o.squares_, weights_ += o.weights_, count_ += o.count_, chance2_ += o.chance2_;
        return *this;
    }
    /// Mean square of what noise does not explain, where what is said followed the nodes by `used` numbers.
    double beyond_noise(double used) const {
        return weights_ > 0 ? std::max(0.0, squares_ - (count_ - used) - kChance * std::sqrt(chance2_)) / weights_ : 0;
    }

private:
    double squares_ = 0, weights_ = 0, count_ = 0, chance2_ = 0;
};

template <class Body>
void for_each_in_parallel(size_t count, const Body& body) {
    tbb::parallel_for(tbb::blocked_range<uint32_t>(0, static_cast<uint32_t>(count), 256), [&](const auto& range) {
        for (uint32_t i = range.begin(); i < range.end(); ++i) body(i);
    });
}

}  // namespace

SmoothLevel::SmoothLevel(std::vector<SmoothNode> nodes, NodeLists touching)
    : nodes_(std::move(nodes)), touching_(std::move(touching)), around_(nodes_.size()) {
    for_each_in_parallel(nodes_.size(), [&](uint32_t node) {
        Around& a = around_[node];
        for (uint32_t other : touching_.of(node)) a.value += nodes_[other].value() * nodes_[other].area, a.area += nodes_[other].area;
        if (a.area > 0) a.value /= a.area;
    });
}

std::vector<uint32_t> SmoothLevel::rings(uint32_t node) const {
    std::vector<uint32_t> found{node};
    size_t first = 0;
    for (int ring = 0; ring < kRings; ++ring) {
        const size_t last = found.size();
        for (; first < last && found.size() < kMost; ++first)
            for (uint32_t other : touching_.of(found[first]))
                if (found.size() < kMost && are_alike(nodes_[other], nodes_[node]) &&
                    std::find(found.begin(), found.end(), other) == found.end())
                    found.push_back(other);
    }
    return found;
}

bool SmoothLevel::agree(uint32_t a, double unit_a, uint32_t b, double unit_b) const {
    return sqr(around_[a].value - around_[b].value) <= kAlike * (unit_a / around_[a].area + unit_b / around_[b].area);
}

double SmoothLevel::mean_unit(std::span<const uint32_t> nodes) const {
    double unit = 0;
    for (uint32_t node : nodes) unit += nodes_[node].variance * nodes_[node].area / static_cast<double>(nodes.size());
    return unit;
}

std::vector<uint32_t> SmoothLevel::alike(uint32_t node) const {
    std::vector<uint32_t> around = rings(node);
    const double unit = mean_unit(around);
    std::erase_if(around, [&](uint32_t other) { return !agree(node, unit, other, unit); });
    return around;
}

SmoothLevel::Groups SmoothLevel::groups() const {
    constexpr uint32_t kFree = 0xffffffffu;
    Groups g;
    g.of.assign(nodes_.size(), kFree);
    std::vector<uint32_t> members;
    for (uint32_t node = 0; node < nodes_.size(); ++node) {
        if (g.of[node] != kFree || !(nodes_[node].area > 0)) continue;
        members.clear();
        for (uint32_t other : alike(node))
            if (g.of[other] == kFree) g.of[other] = g.count, members.push_back(other);
        g.members.add(members);
        ++g.count;
    }
    return g;
}

SmoothLevel SmoothLevel::merged(const Groups& groups) const {
    std::vector<SmoothNode> nodes(groups.count);
    NodeLists touching;
    std::vector<uint32_t> met;
    for (uint32_t group = 0; group < groups.count; ++group) {
        SmoothNode& sum = nodes[group];
        met.assign(1, group);
        for (uint32_t node : groups.members.of(group)) {
            const SmoothNode& n = nodes_[node];
            const auto area = static_cast<float>(n.area);
            sum.area += n.area, sum.x += n.x * area, sum.normal += n.normal * area, sum.light += n.light * n.area;
            sum.variance += sqr(n.area) * n.variance;
            for (uint32_t other : touching_.of(node))
                if (std::find(met.begin(), met.end(), groups.of[other]) == met.end()) met.push_back(groups.of[other]);
        }
        const auto over = static_cast<float>(1 / sum.area);
        sum.x *= over, sum.normal *= over, sum.light = sum.light * (1 / sum.area), sum.variance /= sqr(sum.area);
        for (uint32_t node : groups.members.of(group))
            sum.spread2 += nodes_[node].area * (nodes_[node].spread2 + distance2(nodes_[node].x, sum.x)) / sum.area;
        touching.add(met);
    }
    return {std::move(nodes), std::move(touching)};
}

LinearLight SmoothLevel::blended(const SmoothNode& at, uint32_t node, const std::vector<LinearLight>& lights) const {
    LinearLight sum;
    double weights = 0;
    const double unit = nodes_[node].variance * nodes_[node].area;
    for (uint32_t other : touching_.of(node)) {
        const SmoothNode& n = nodes_[other];
        if (!are_alike(n, nodes_[node]) || !agree(node, unit, other, unit)) continue;
        const double weight = n.area * std::exp(-0.5 * distance2(n.x, at.x) / n.spread2);
        sum.light += light_at(lights[other], at, n) * weight;
        for (size_t k = 0; k < sum.slope.size(); ++k) sum.slope[k] += lights[other].slope[k] * weight;
        sum.variance += lights[other].variance * weight;
        weights += weight;
    }
    if (!(weights > 0)) return lights[node];
    sum.light = sum.light * (1 / weights), sum.variance /= weights;
    for (Rgb64& slope : sum.slope) slope = slope * (1 / weights);
    return sum;
}

SmoothLevel::Coarse SmoothLevel::coarse() const {
    Coarse c{.groups = groups()};
    if (c.groups.count < kFewestGroups || c.groups.count > kMostGroups * static_cast<double>(nodes_.size())) return {};
    const SmoothLevel above = merged(c.groups);
    const std::vector<LinearLight> lights = above.smooth();
    c.at.resize(nodes_.size());
    for_each_in_parallel(nodes_.size(), [&](uint32_t node) {
        if (nodes_[node].area > 0) c.at[node] = above.blended(nodes_[node], c.groups.of[node], lights);
    });
    c.unit = units(c, above);
    c.bias2 = bias2(c, above);
    return c;
}

std::vector<double> SmoothLevel::units(const Coarse& coarse, const SmoothLevel& above) const {
    struct Sums {
        double noise = 0, light = 0, area = 0;
    };
    std::vector<Sums> of_group(coarse.groups.count), around(coarse.groups.count);
    for (uint32_t node = 0; node < nodes_.size(); ++node) {
        const SmoothNode& n = nodes_[node];
        if (!(n.area > 0)) continue;
        Sums& s = of_group[coarse.groups.of[node]];
        s.noise += sqr(n.area) * n.variance, s.light += n.area * n.value(), s.area += n.area;
    }
    for (uint32_t group = 0; group < coarse.groups.count; ++group)
        for (uint32_t other : above.touching_.of(group)) {
            const Sums& s = of_group[other];
            around[group].noise += s.noise, around[group].light += s.light, around[group].area += s.area;
        }
    std::vector<double> units(nodes_.size());
    for_each_in_parallel(nodes_.size(), [&](uint32_t node) {
        if (!(nodes_[node].area > 0)) return;
        const Sums& s = around[coarse.groups.of[node]];
        const double light = std::max(lum(coarse.at[node].light), kDarkest * s.light / s.area);
        if (s.light > 0) units[node] = s.noise / s.light * light;
    });
    return units;
}

std::vector<double> SmoothLevel::bias2(const Coarse& coarse, const SmoothLevel& above) const {
    std::vector<Misfit> of_group(coarse.groups.count);
    for (uint32_t node = 0; node < nodes_.size(); ++node)
        if (nodes_[node].area > 0) of_group[coarse.groups.of[node]].add(nodes_[node], coarse.at[node].light, coarse.unit[node]);
    std::vector<double> bias2(coarse.groups.count);
    for (uint32_t group = 0; group < coarse.groups.count; ++group) {
        Misfit around;
        for (uint32_t other : above.touching_.of(group)) around += of_group[other];
        bias2[group] = around.beyond_noise(0);
    }
    return bias2;
}

std::vector<LinearLight> SmoothLevel::smooth() const {
    const Coarse above = coarse();
    std::vector<LinearLight> lights(nodes_.size());
    for_each_in_parallel(nodes_.size(), [&](uint32_t node) {
        if (nodes_[node].area > 0) lights[node] = smooth(node, above);
    });
    return lights;
}

LinearLight SmoothLevel::smooth(uint32_t node, const Coarse& coarse) const {
    const SmoothNode& here = nodes_[node];
    const LinearLight own{here.light, {}, here.variance};
    std::vector<uint32_t> around = rings(node);
    // Where more rays came than are expected, that is noise as well.
    const double usual = mean_unit(around);
    double expected = 0;
    if (!coarse.at.empty())
        for (uint32_t other : around) expected += coarse.unit[other] / static_cast<double>(around.size());
    const double more = expected > 0 ? std::max(1.0, usual / expected) : 1;
    const auto unit = [&](uint32_t other) { return expected > 0 ? more * coarse.unit[other] : usual; };
    if (!(unit(node) > 0)) return own;
    double reach2 = 0;
    // What has no light anywhere near has no noise to be weighed by.
    std::erase_if(around, [&](uint32_t other) { return !(unit(other) > 0) || !agree(node, unit(node), other, unit(other)); });
    for (uint32_t other : around) reach2 = std::max(reach2, distance2(nodes_[other].x, here.x));
    if (around.size() < kFewest || !(reach2 > 0)) return own;

    // What the fit leaves unexplained, and by how much the coarser level is off.
    const Fitted fit = fitted(node, around, unit, 1 / std::sqrt(reach2));
    LinearLight said = fit.light;
    Misfit left, off;
    // Replicas that differ by more than is usual tell of rays that came together.
    const auto most_unit = [&](uint32_t other) { return std::max(unit(other), nodes_[other].variance * nodes_[other].area); };
    for (uint32_t other : around) {
        left.add(nodes_[other], light_at(fit.light, nodes_[other], here), most_unit(other));
        if (!coarse.at.empty()) off.add(nodes_[other], coarse.at[other].light, most_unit(other));
    }
    if (!coarse.at.empty()) {
        const double bias2 = std::max(coarse.bias2[coarse.groups.of[node]], off.beyond_noise(0)),
                     variance = coarse.at[node].variance + bias2, share = variance / (variance + said.variance);
        said = mixed(said, share, coarse.at[node], share * said.variance);
    }
    const double variance = most_unit(node) / here.area, unexplained = left.beyond_noise(fit.used),
                 share = unexplained / (unexplained + variance);
    // The errors of both are not independent: add them as if they were one.
    return mixed(own, share, said, sqr((1 - share) * std::sqrt(said.variance) + share * std::sqrt(variance)));
}

template <class Unit>
SmoothLevel::Fitted SmoothLevel::fitted(uint32_t node, std::span<const uint32_t> around, const Unit& unit, double scale) const {
    const SmoothNode& here = nodes_[node];
    LinearFit fit;
    for (uint32_t other : around) fit.add(nodes_[other].area / unit(other), terms(nodes_[other], here, scale));
    fit.factorise();
    const FitTerms weights = fit.solve({1});
    std::array<FitTerms, 3> right{};
    Fitted f{{}, fit.used()};
    for (uint32_t other : around) {
        const SmoothNode& n = nodes_[other];
        const FitTerms t = terms(n, here, scale);
        for (int k = 0; k < kFitTerms; ++k) {
            const double weight = n.area / unit(other) * t[k];
            right[0][k] += weight * n.light.x, right[1][k] += weight * n.light.y, right[2][k] += weight * n.light.z;
        }
        f.light.variance += sqr(product(t, weights)) * n.area / unit(other);
    }
    for (FitTerms& channel : right) channel = fit.solve(channel);
    f.light.light = {right[0][0], right[1][0], right[2][0]};
    for (int k = 1; k < kFitTerms; ++k) f.light.slope[k - 1] = Rgb64{right[0][k], right[1][k], right[2][k]} * (k > 3 ? scale : 1.0);
    return f;
}

}  // namespace lumel
