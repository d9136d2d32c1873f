#include <nanobind/stl/array.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/unique_ptr.h>
#include <nanobind/stl/vector.h>

#include "arrays.h"
#include "lumel/scene/camera.h"
#include "lumel/scene/scene.h"

using namespace lumel;

namespace {

using Triple = std::array<float, 3>;

Vec3 vec(const Triple& t) { return {t[0], t[1], t[2]}; }
Triple triple(Vec3 v) { return {v.x, v.y, v.z}; }

Material make_material(std::string name, Triple diffuse, Triple specular, Triple mirror, float alpha, bool fresnel, Triple eta, Triple k,
                       bool two_sided) {
    Material material;
    material.name = std::move(name);
    material.diffuse = vec(diffuse), material.specular = vec(specular), material.mirror = vec(mirror);
    material.alpha = alpha;
    material.fresnel = {fresnel, vec(eta), vec(k)};
    material.two_sided = two_sided;
    material.tabulate();
    return material;
}

std::unique_ptr<Scene> make_scene(Rows<float, 3> vertices, Rows<float, 3> normals, Rows<uint32_t, 3> triangles,
                                  Column<uint32_t> triangle_shape, Column<uint32_t> shape_material, Rows<float, 3> shape_emission,
                                  std::vector<Material> materials, Rows<float, 3> point_positions, Rows<float, 3> point_intensities,
                                  uint64_t patches) {
    std::vector<PointLamp> points;
    for (size_t i = 0; i < point_positions.shape(0); ++i)
        points.push_back({rows<Vec3>(point_positions)[i], rows<Rgb>(point_intensities)[i]});
    const MeshInput input{rows<Vec3>(vertices),   rows<Vec3>(normals),    rows<Indices>(triangles),
                          column(triangle_shape), column(shape_material), rows<Rgb>(shape_emission)};
    nb::gil_scoped_release release;
    return std::make_unique<Scene>(input, std::move(materials), std::move(points), patches);
}

Camera make_camera(Triple origin, Triple right, Triple up, Triple forward, float tan_x, float tan_y, uint32_t width, uint32_t height) {
    return {vec(origin), vec(right), vec(up), vec(forward), tan_x, tan_y, width, height};
}

nb::typed<nb::dict, nb::str, nb::int_> report(const Scene& scene) {
    const MeshReport& r = scene.report();
    nb::typed<nb::dict, nb::str, nb::int_> d;
    d["given"] = r.given, d["nonfinite"] = r.nonfinite, d["bad_index"] = r.bad_index;
    d["degenerate"] = r.degenerate, d["huge"] = r.huge, d["duplicate"] = r.duplicate;
    return d;
}

/// Area, centroid and normal of every patch, and the material of it, as (patches, 8) float: 1 + 3 + 3 + 1.
Array patch_geometry(const Scene& scene) {
    std::vector<float> values;
    values.reserve(size_t{scene.patches()} * 8);
    for (uint32_t patch = 0; patch < scene.patches(); ++patch) {
        const SurfacePoint p = scene.centre_of_patch(patch);
        const Vec3 x = scene.position(p), n = scene.geometric_normal(p.triangle);
        const auto material = static_cast<float>(scene.material_index(p.triangle));
        values.insert(values.end(), {scene.patch_area(patch), x.x, x.y, x.z, n.x, n.y, n.z, material});
    }
    return to_numpy(std::move(values), {scene.patches(), 8});
}

}  // namespace

void bind_scene(nb::module_& m) {
    nb::class_<Material>(m, "Material")
        .def_static("make", make_material, nb::arg("name"), nb::arg("diffuse"), nb::arg("specular"), nb::arg("mirror"), nb::arg("alpha"),
                    nb::arg("fresnel"), nb::arg("eta"), nb::arg("k"), nb::arg("two_sided"))
        .def(
            "albedo_s", [](const Material& material, float cos) { return triple(material.albedo_s(cos)); }, nb::arg("cos"))
        .def(
            "scatter_s", [](const Material& material, Triple wi, Triple wo) { return triple(material.scatter_s(vec(wi), vec(wo))); },
            nb::arg("wi"), nb::arg("wo"))
        .def_prop_ro("max_albedo", &Material::max_albedo);
    nb::class_<Camera>(m, "Camera")
        .def_static("make", make_camera, nb::arg("origin"), nb::arg("right"), nb::arg("up"), nb::arg("forward"), nb::arg("tan_x"),
                    nb::arg("tan_y"), nb::arg("width"), nb::arg("height"));
    nb::class_<Scene>(m, "Scene")
        .def_static("make", make_scene, nb::arg("vertices"), nb::arg("normals"), nb::arg("triangles"), nb::arg("triangle_shape"),
                    nb::arg("shape_material"), nb::arg("shape_emission"), nb::arg("materials"), nb::arg("point_positions"),
                    nb::arg("point_intensities"), nb::arg("patches"))
        .def_prop_ro("patches", &Scene::patches)
        .def_prop_ro("is_uniform", [](const Scene& scene) { return scene.tessellation().is_uniform(); })
        .def_prop_ro("triangles", &Scene::triangles)
        .def_prop_ro("glossy_sides", &Scene::glossy_sides)
        .def_prop_ro("divided_sides", &Scene::divided_sides)
        .def_prop_ro("total_area", &Scene::total_area)
        .def_prop_ro("radius", &Scene::radius)
        .def_prop_ro("lamp_areas",
                     [](const Scene& scene) {
                         std::vector<float> areas(scene.shapes());
                         for (const AreaLamp& lamp : scene.area_lamps()) areas[lamp.shape] = lamp.area;
                         return areas;
                     })
        .def_prop_ro("report", report)
        .def("patch_geometry", patch_geometry);
}
