#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/unique_ptr.h>
#include <nanobind/stl/vector.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <numeric>

#include "arrays.h"
#include "lumel/solver/session.h"
#include "lumel/transport/lamp_reach.h"

using namespace lumel;

namespace {

/// The value of a name in a table of names.
template <class Value, size_t N>
Value named(const char* what, const std::string& name, const std::array<std::pair<const char*, Value>, N>& table) {
    for (const auto& [known, value] : table)
        if (name == known) return value;
    throw nb::value_error((std::string("unknown ") + what).c_str());
}

constexpr std::array<std::pair<const char*, Transport>, 3> kTransports{
    {{"walk", Transport::kWalk}, {"rays", Transport::kRays}, {"bundles", Transport::kBundles}}};
constexpr std::array<std::pair<const char*, AreaKind>, 2> kAreas{{{"patches", AreaKind::kPatches}, {"pixels", AreaKind::kPixels}}};
/// The name of a value in such a table.
template <class Value, size_t N>
const char* name_of(Value value, const std::array<std::pair<const char*, Value>, N>& table) {
    return std::find_if(table.begin(), table.end(), [&](const auto& entry) { return entry.second == value; })->first;
}

constexpr std::array<std::pair<const char*, Iteration>, 2> kIterations{{{"frozen", Iteration::kFrozen}, {"plain", Iteration::kPlain}}};

/// Ways to trace the rays of a step: one by one, in packets as they come, or in packets as shooting does.
enum class Tracing { kSingle, kPackets, kOrdered };
constexpr std::array<std::pair<const char*, Tracing>, 3> kTracings{
    {{"single", Tracing::kSingle}, {"packets", Tracing::kPackets}, {"ordered", Tracing::kOrdered}}};

/// A session that works with a given number of threads, and lets other Python threads run meanwhile.
class BoundSession {
public:
    BoundSession(const Scene& scene, const std::vector<Camera>& cameras, const std::string& transport, const std::string& areas,
                 const std::string& estimator, float defensive, float gather, std::optional<bool> weight_diffuse, bool first_shot,
                 uint32_t direct_samples, uint64_t seed, int threads, const std::string& iteration, uint32_t window,
                 uint64_t adaptive_patches, float most_gathering, const std::optional<std::string>& isa)
        : limit_(tbb::global_control::max_allowed_parallelism, static_cast<size_t>(threads)), arena_(threads) {
        SessionConfig config;
        config.solver = {.transport = named("transport", transport, kTransports),
                         .defensive = defensive,
                         .gather = gather,
                         .first_shot = first_shot,
                         .direct_samples = direct_samples,
                         .seed = seed,
                         .iteration = named("iteration", iteration, kIterations),
                         .window = window};
        config.areas = named("areas", areas, kAreas);
        config.weight_diffuse = weight_diffuse;
        config.adaptive_patches = adaptive_patches;
        config.most_gathering = most_gathering;
        if (isa) config.isa = named("isa", *isa, kIsas);
        config.estimator = find_estimator(estimator);
        if (!config.estimator) throw nb::value_error("unknown estimator");
        run([&] { session_ = std::make_unique<Session>(scene, cameras, config); });
    }

    void begin_replica(uint64_t solve_rays) {
        run([&] { session_->solver().begin_replica(solve_rays); });
    }
    void step(uint64_t work) {
        run([&] { session_->solver().step(work); });
    }
    void end_replica() {
        run([&] { session_->solver().end_replica(); });
    }
    void forget() {
        run([&] { session_->solver().forget(); });
    }
    void reconstruct() {
        run([&] { session_->reconstruct(); });
    }
    bool eye_pass(uint32_t camera, uint32_t samples) {
        bool done = false;
        run([&] { done = session_->eye_pass(camera, samples); });
        return done;
    }
    std::vector<MeasuredArea> measured(uint32_t camera, const Estimator& estimator, uint32_t most) {
        std::vector<MeasuredArea> all;
        run([&] { all = session_->measured(camera, estimator, most); });
        return all;
    }
    /// The mean samples of all pixels, and the standard errors of their radiance.
    std::pair<std::vector<EyeSample>, std::vector<Rgb>> seen(uint32_t camera) {
        const Film& film = session_->film(camera);
        std::pair<std::vector<EyeSample>, std::vector<Rgb>> all{std::vector<EyeSample>(film.pixels()), std::vector<Rgb>(film.pixels())};
        run([&] {
            tbb::parallel_for(size_t{0}, film.pixels(),
                              [&](size_t pixel) { all.first[pixel] = film.mean(pixel), all.second[pixel] = film.standard_error(pixel); });
        });
        return all;
    }
    std::vector<LampReach> lamp_reach(uint32_t samples) {
        std::vector<LampReach> all;
        run([&] { all = lumel::lamp_reach(session_->accel(), samples, 0); });
        return all;
    }
    Session& session() { return *session_; }

    // For `lumel bench`: the rays of a step, to be traced again and again. Gives how many there are.
    uint64_t capture(uint64_t rays) {
        run([&] { captured_ = session_->solver().departures(rays); });
        uint64_t count = 0;
        for (const RayBlock& block : captured_)
            count += static_cast<uint64_t>(-std::accumulate(block.traced.begin(), block.traced.begin() + block.size, 0));
        return count;
    }
    void trace_captured(const std::string& way) {
        const Tracing tracing = named("way", way, kTracings);
        run([&] {
            tbb::parallel_for(size_t{0}, captured_.size(), [&](size_t block) {
                const FlushDenormals flush;
                const RayBlock& rays = captured_[block];
                HitBlock hits;
                if (tracing != Tracing::kSingle)
                    session_->accel().intersect(rays, hits, tracing == Tracing::kPackets ? Coherence::kNone : Coherence::kOrigins);
                else
                    for (uint32_t i = 0; i < rays.size; ++i)
                        if (rays.traced[i]) hits.set(i, session_->accel().intersect(rays[i]));
            });
        });
    }

private:
    template <class Work>
    void run(Work&& work) {
        nb::gil_scoped_release release;
        arena_.execute(work);
    }
    tbb::global_control limit_;
    tbb::task_arena arena_;
    std::unique_ptr<Session> session_;
    std::vector<RayBlock> captured_;
};

/// Layers of a film, by name: (height, width, 3) or (height, width).
nb::typed<nb::dict, nb::str, Array> layers(BoundSession& self, uint32_t camera) {
    const Film& film = self.session().film(camera);
    const auto [mean, error] = self.seen(camera);
    nb::typed<nb::dict, nb::str, Array> d;
    const auto add_rgb = [&](const char* name, auto&& of) {
        std::vector<Rgb> values;
        values.reserve(mean.size());
        for (const EyeSample& pixel : mean) values.push_back(of(pixel));
        d[name] = to_numpy(flat(values), {film.height, film.width, 3});
    };
    const auto add_scalar = [&](const char* name, auto&& of) {
        std::vector<float> values;
        values.reserve(mean.size());
        for (const EyeSample& pixel : mean) values.push_back(of(pixel));
        d[name] = to_numpy(std::move(values), {film.height, film.width});
    };
    using Pixel = const EyeSample&;
    add_rgb("emission", [](Pixel p) { return p.emission; });
    add_rgb("direct", [](Pixel p) { return p.direct; });
    add_rgb("indirect.diffuse", [](Pixel p) { return p.indirect_diffuse; });
    add_rgb("indirect.specular", [](Pixel p) { return p.indirect_specular; });
    add_rgb("albedo", [](Pixel p) { return p.albedo; });
    add_rgb("normal", [](Pixel p) { return p.normal; });
    add_rgb("stderr.solution", [](Pixel p) { return p.solution_stderr; });
    add_scalar("depth", [](Pixel p) { return p.depth; });
    add_scalar("weight", [](Pixel p) { return p.trust.weight; });
    add_scalar("hits", [](Pixel p) { return p.trust.hits; });
    add_scalar("correction", [](Pixel p) { return p.trust.correction; });
    add_scalar("flag", [](Pixel p) { return p.trust.flag; });
    d["stderr"] = to_numpy(flat(error), {film.height, film.width, 3});
    return d;
}

/// The areas of interest of a camera, estimated one by one: `index` (n,) is the patch (plus the number of patches on its back) or the
/// pixel; `value` and `stderr` (n, 3) W/(m2 sr), and what the estimate is made of. With `most` about as many of them, evenly chosen.
nb::typed<nb::dict, nb::str, Doubles> areas(BoundSession& self, uint32_t camera, const std::string& name, uint32_t most) {
    const Estimator* estimator = find_estimator(name);
    if (!estimator || camera >= self.session().cameras().size()) throw nb::value_error("unknown estimator or camera");
    const auto measured = self.measured(camera, *estimator, most);
    const size_t n = measured.size();
    nb::typed<nb::dict, nb::str, Doubles> d;
    const auto add_rgb = [&](const char* key, auto&& of) {
        std::vector<double> values;
        for (const MeasuredArea& area : measured) {
            const Rgb64 v = of(area);
            values.insert(values.end(), {v.x, v.y, v.z});
        }
        d[key] = to_numpy(std::move(values), {n, 3});
    };
    const auto add_scalar = [&](const char* key, auto&& of) {
        std::vector<double> values;
        for (const MeasuredArea& area : measured) values.push_back(static_cast<double>(of(area)));
        d[key] = to_numpy(std::move(values), {n});
    };
    add_scalar("index", [](const MeasuredArea& a) { return a.index; });
    add_rgb("value", [](const MeasuredArea& a) { return a.at.estimate.value; });
    add_rgb("variance", [](const MeasuredArea& a) { return a.at.estimate.variance; });
    add_rgb("mean", [](const MeasuredArea& a) { return a.at.samples.f + a.at.samples.plain; });
    add_rgb("mean.variance", [](const MeasuredArea& a) { return a.at.samples.var_f + a.at.samples.var_plain; });
    add_scalar("albedo", [](const MeasuredArea& a) { return a.albedo; });
    add_scalar("weight", [](const MeasuredArea& a) { return a.at.samples.g; });
    add_scalar("weight.variance", [](const MeasuredArea& a) { return a.at.samples.var_g; });
    add_scalar("weight.variance.looks", [](const MeasuredArea& a) { return a.at.samples.var_g_of_looks(); });
    add_rgb("moment.fg", [](const MeasuredArea& a) { return a.at.samples.fg; });
    add_scalar("moment.gg", [](const MeasuredArea& a) { return a.at.samples.gg; });
    add_scalar("hits", [](const MeasuredArea& a) { return a.at.samples.hits; });
    add_scalar("uncovered", [](const MeasuredArea& a) { return a.at.samples.uncovered(); });
    add_scalar("flag", [](const MeasuredArea& a) { return a.at.trust.flag; });
    add_scalar("borrowed", [](const MeasuredArea& a) { return a.at.borrowed; });
    return d;
}

/// Irradiance of all sides: mean and variance of the mean, each (2, patches, 3): front, back.
nb::typed<nb::tuple, Array, Array> field(const SideField& f) {
    const size_t patches = f.mean.size() / 2;
    return nb::typed<nb::tuple, Array, Array>(
        nb::make_tuple(to_numpy(flat(f.mean), {2, patches, 3}), to_numpy(flat(f.variance), {2, patches, 3})));
}

/// What bundles met and carried.
void add_bundles(const BundleStats& stats, nb::dict& d) {
    const SweepCounters& c = stats.raster;
    d["directions"] = c.directions;
    d["fragments"] = c.fragments;
    d["pairs"] = c.pairs;
    d["mean_depth"] = c.lines > 0 ? static_cast<double>(c.fragments) / static_cast<double>(c.lines) : 0.0;
    d["parity_violations_per_million"] = c.lines > 0 ? 1e6 * static_cast<double>(c.parity_violations) / static_cast<double>(c.lines) : 0.0;
    d["window"] = stats.window;
    const auto share = [&](double flux) { return stats.sent > 0 ? flux / stats.sent : 0.0; };
    d["received_share"] = share(stats.received);
    d["escaped_share"] = share(stats.escaped);
    d["mispaired_share"] = share(stats.mispaired);
}

nb::typed<nb::dict, nb::str, nb::object> stats(BoundSession& self) {
    const Session& session = self.session();
    Solver& solver = self.session().solver();
    nb::typed<nb::dict, nb::str, nb::object> d;
    const SolverStats counted = solver.stats();
    d["isa"] = name_of(session.isa(), kIsas);
    d["rays"] = counted.rays;
    d["escaped_rays"] = counted.escaped;
    d["replicas"] = solver.replicas();
    d["measured_sides"] = solver.areas().size();
    d["open"] = session.defensive().open();
    d["defensive_area"] = session.defensive().area();
    if (session.transport() == Transport::kBundles) add_bundles(counted.bundles, d);
    if (session.is_plain()) d["variance_growth"] = session.variance_growth();
    return d;
}

}  // namespace

/// Shares of the flux of every lamp (area lamps, then point lamps) that arrive on each shape first, and in the last column that leave the
/// scene: (lamps, shapes + 1).
Array reach_of_lamps(BoundSession& self, uint32_t samples) {
    const auto all = self.lamp_reach(samples);
    std::vector<float> values;
    for (const LampReach& lamp : all) {
        values.insert(values.end(), lamp.onto.begin(), lamp.onto.end());
        values.push_back(lamp.escaped);
    }
    return to_numpy(std::move(values), {all.size(), self.session().scene().shapes() + size_t{1}});
}

void bind_session(nb::module_& m) {
    nb::class_<BoundSession>(m, "Session")
        .def(nb::init<const Scene&, const std::vector<Camera>&, const std::string&, const std::string&, const std::string&, float, float,
                      std::optional<bool>, bool, uint32_t, uint64_t, int, const std::string&, uint32_t, uint64_t, float,
                      const std::optional<std::string>&>(),
             nb::arg("scene"), nb::arg("cameras"), nb::arg("transport"), nb::arg("areas"), nb::arg("estimator"), nb::arg("defensive"),
             nb::arg("gather"), nb::arg("weight_diffuse").none(), nb::arg("first_shot"), nb::arg("direct_samples"), nb::arg("seed"),
             nb::arg("threads"), nb::arg("iteration") = "frozen", nb::arg("window") = 0, nb::arg("adaptive_patches") = 0,
             nb::arg("most_gathering") = 0.0f, nb::arg("isa") = nb::none())
        .def("begin_replica", &BoundSession::begin_replica, nb::arg("solve_rays"))
        .def("step", &BoundSession::step, nb::arg("work"))
        .def("end_replica", &BoundSession::end_replica)
        .def("forget", &BoundSession::forget)
        .def("reconstruct", &BoundSession::reconstruct)
        .def("eye_pass", &BoundSession::eye_pass, nb::arg("camera"), nb::arg("samples"))
        .def("capture", &BoundSession::capture, nb::arg("rays"))
        .def("trace_captured", &BoundSession::trace_captured, nb::arg("way"))
        .def("stop", [](BoundSession& self) { self.session().stop(); })
        .def("layers", layers, nb::arg("camera"))
        .def("lamp_reach", reach_of_lamps, nb::arg("samples"))
        .def("landed",
             [](BoundSession& self) {
                 auto landed = self.session().solver().stats().landed;
                 const size_t shapes = landed.size();
                 return to_numpy(std::move(landed), {shapes});
             })
        .def("areas", areas, nb::arg("camera"), nb::arg("estimator"), nb::arg("most") = ~uint32_t{0})
        .def("direct", [](BoundSession& self) { return field(self.session().solver().direct()); })
        .def("indirect", [](BoundSession& self) { return field(self.session().indirect()); })
        .def("borrowed", [](BoundSession& self) { return self.session().borrowed(); })
        .def("unfilled", [](BoundSession& self) { return self.session().unfilled(); })
        .def("flagged", [](BoundSession& self) { return self.session().flagged(); })
        .def_prop_ro("rays", [](BoundSession& self) { return self.session().solver().stats().rays; })
        .def_prop_ro("directions", [](BoundSession& self) { return self.session().solver().stats().bundles.raster.directions; })
        .def_prop_ro("steps", [](BoundSession& self) { return self.session().solver().steps(); })
        .def_prop_ro(
            "scene", [](BoundSession& self) -> const Scene& { return self.session().scene(); }, nb::rv_policy::reference_internal)
        .def_prop_ro("stats", stats);
    m.def("isas", [] {
        std::vector<std::string> names;
        for (const auto& [name, isa] : kIsas)
            if (has(isa)) names.emplace_back(name);
        return names;
    });
    m.def("estimators", [] {
        std::vector<std::string> names;
        for (const Estimator& e : estimators()) names.emplace_back(e.name);
        return names;
    });
}
