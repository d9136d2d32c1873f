// Arrays between numpy and the core.
#pragma once

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>

#include <cstring>
#include <memory>
#include <span>
#include <vector>

#include "lumel/math/vec.h"

namespace nb = nanobind;

template <class T, size_t Columns>
using Rows = nb::ndarray<const T, nb::numpy, nb::shape<-1, Columns>, nb::c_contig, nb::device::cpu>;
template <class T>
using Column = nb::ndarray<const T, nb::numpy, nb::ndim<1>, nb::c_contig, nb::device::cpu>;
using Array = nb::ndarray<nb::numpy, float>;
using Doubles = nb::ndarray<nb::numpy, double>;

/// View the rows of an array as values of the core.
template <class Value, class Rows>
std::span<const Value> rows(const Rows& array) {
    return {reinterpret_cast<const Value*>(array.data()), array.shape(0)};
}
template <class T>
std::span<const T> column(const Column<T>& array) {
    return {array.data(), array.shape(0)};
}

/// Give numbers to numpy, which then owns them.
template <class T>
nb::ndarray<nb::numpy, T> to_numpy(std::vector<T> values, std::vector<size_t> shape) {
    auto owned = std::make_unique<std::vector<T>>(std::move(values));
    T* data = owned->data();
    nb::capsule owner(owned.release(), [](void* p) noexcept { delete static_cast<std::vector<T>*>(p); });
    return {data, shape.size(), shape.data(), owner};
}
inline std::vector<float> flat(std::span<const lumel::Rgb> colours) {
    std::vector<float> values;
    values.reserve(colours.size() * 3);
    for (const lumel::Rgb& c : colours) values.insert(values.end(), {c.x, c.y, c.z});
    return values;
}

void bind_scene(nb::module_& m);
void bind_accel(nb::module_& m);
void bind_raster(nb::module_& m);
void bind_session(nb::module_& m);
