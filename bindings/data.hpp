// Values that are data: equality, hash and pickling by the tuple of what they are made of.
#pragma once

#include <array>
#include <rbdyn/scene/joints.hpp>
#include <string>

#include "binding.hpp"

namespace binding {

template <class T, class... Options, class Parts, class Make>
void as_data(py::class_<T, Options...>& type, Parts parts, Make make) {
    type.def("__eq__", [](const T& a, const py::object& b) { return py::isinstance<T>(b) && a == b.cast<const T&>(); })
        .def("__hash__",
             [parts](const T& a) {
                 // of a number of the user's the name: it stays what it is
                 py::list fixed;
                 for (const py::handle part : parts(a))
                     fixed.append(py::isinstance<rbdyn::Parameter>(part) ? py::object(part.attr("name"))
                                                                         : py::reinterpret_borrow<py::object>(part));
                 return py::hash(py::tuple(fixed));
             })
        .def(py::pickle([parts](const T& a) { return parts(a); }, [make](const py::tuple& d) { return make(d); }));
}

/// A number as it was given, from data.
inline rbdyn::Given given_from(const py::handle& data) { return given(data, "data", "a number"); }

/// Friction in words (rails.cpp).
std::string words_of(const rbdyn::Coulomb& c);

/// A vector as plain data, and from it.
inline py::tuple tuple_of(const Vector3& v) { return py::make_tuple(v[0], v[1], v[2]); }
inline Vector3 vector_from(const py::handle& data) {
    const auto d = data.cast<std::array<double, 3>>();
    return {d[0], d[1], d[2]};
}

}  // namespace binding
