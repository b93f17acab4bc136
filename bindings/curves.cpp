// Curves: geometry that can be asked, and that a rail follows.
#include <rbdyn/curve/curve.hpp>
#include <utility>

#include "binding.hpp"

namespace binding {

using rbdyn::Curve;
using rbdyn::text;

namespace {

/// A curve that still knows what it was made from.
template <class Kind>
struct CurveOf : Curve {
    explicit CurveOf(const Kind& made_from) : Curve(made_from), kind(made_from) {}
    Kind kind;
};

template <class F>
auto at(const ArrayLike& u, F&& f) {
    return over(u, "Curve", "parameter", std::forward<F>(f));
}

void bind_base(py::module_& m) {
    py::class_<Curve>(m, "Curve", R"(A curve r(u) of any kind, in the world. Base of Line, Circle, Helix and Polynomial.

A parameter u is a number, or an array of any shape: a vector then comes back with its components last.)")
        .def_property_readonly(
            "domain", [](const Curve& c) { return std::pair(c.domain().begin, c.domain().end); },
            "The first and the last parameter; infinite where the curve goes on.")
        .def_property_readonly("closed", &Curve::closed,
                               "Whether it comes back to where it started; its parameter counts on.")
        .def_property_readonly("name", &Curve::name, "What it is, in words.")
        .def(
            "position",
            [](const Curve& c, const ArrayLike& u) { return at(u, [&](double x) { return c.position(x); }); },
            py::arg("u"), "r(u), (3,) or (n, 3) [m].")
        .def(
            "length",
            [](const Curve& c, const ArrayLike& u0, const ArrayLike& u1) {
                auto f = py::vectorize([&](double a, double b) { return c.length(a, b); });
                return py::reinterpret_borrow<Values>(
                    py::object(f(doubles(u0, "Curve", "u0"), doubles(u1, "Curve", "u1"))));
            },
            py::arg("u0"), py::arg("u1"), "Arc length from u0 to u1, negative if u1 < u0 [m]. Arrays are broadcast.")
        .def(
            "frenet",
            [](const Curve& c, const ArrayLike& u) {
                const py::object tangent = at(u, [&](double x) { return c.frenet(x).tangent; });
                const py::object normal = at(u, [&](double x) { return c.frenet(x).normal; });
                const py::object binormal = at(u, [&](double x) { return c.frenet(x).binormal; });
                return FrenetObject(py::module_::import("rbdyn.frames").attr("Frenet")(tangent, normal, binormal));
            },
            py::arg("u"),
            R"(Tangent, normal and binormal (eqs. 7.9, 7.10): a named tuple of unit vectors, each (3,) or (n, 3).

On a straight stretch the frame of least rotation. Raises InvalidInput at a cusp.)")
        .def(
            "curvature",
            [](const Curve& c, const ArrayLike& u) { return at(u, [&](double x) { return c.curvature(x); }); },
            py::arg("u"), "1/rho of eq. 7.10 [1/m]; 0 where straight. Raises InvalidInput at a cusp.")
        .def(
            "torsion", [](const Curve& c, const ArrayLike& u) { return at(u, [&](double x) { return c.torsion(x); }); },
            py::arg("u"), "Torsion [1/m], positive for a right-handed helix; 0 where straight.")
        .def("__eq__", [](const Curve& a,
                          const py::object& b) { return py::isinstance<Curve>(b) && a == b.cast<const Curve&>(); })
        .def("__hash__", [](const Curve& c) { return py::hash(py::str(c.name())); })
        .def("__repr__", [](const Curve& c) { return "<Curve: " + c.name() + ">"; });
}

}  // namespace

void bind_curves(py::module_& m) {
    using rbdyn::Circle, rbdyn::Helix, rbdyn::Line, rbdyn::Polynomial;
    const std::vector<double> origin = {0.0, 0.0, 0.0};
    bind_base(m);

    py::class_<CurveOf<Line>, Curve>(m, "Line",
                                     "A straight line by its length: r(u) = point + u direction/|direction|.")
        .def(py::init([](const ArrayLike& direction, const ArrayLike& point) {
                 return CurveOf<Line>({vector3(direction, "Line", "direction"), vector3(point, "Line", "point")});
             }),
             py::arg("direction"), py::arg("point") = origin,
             "direction: of any length but zero. point: where u = 0 [m]. World axes; u in m.")
        .def_property_readonly("direction", [](const CurveOf<Line>& c) { return to_python(c.kind.direction); })
        .def_property_readonly("point", [](const CurveOf<Line>& c) { return to_python(c.kind.point); })
        .def("__repr__", [](const CurveOf<Line>& c) {
            return "Line(direction=" + list_text(c.kind.direction) + ", point=" + list_text(c.kind.point) + ")";
        });

    py::class_<CurveOf<Circle>, Curve>(
        m, "Circle", "A circle by its angle: r(u) = center + radius (cos u start + sin u toward); the angle counts on.")
        .def(
            py::init([](double radius, const ArrayLike& start, const ArrayLike& toward, const ArrayLike& center) {
                return CurveOf<Circle>({radius, vector3(start, "Circle", "start"), vector3(toward, "Circle", "toward"),
                                        vector3(center, "Circle", "center")});
            }),
            py::arg("radius"), py::arg("start"), py::arg("toward"), py::arg("center") = origin,
            R"(radius [m], positive. start, toward: directions from the center to u = 0 and to the side on which u grows, made
orthonormal. center [m]. World axes; u in rad.)")
        .def_property_readonly("radius", [](const CurveOf<Circle>& c) { return c.kind.radius; })
        .def_property_readonly("start", [](const CurveOf<Circle>& c) { return to_python(c.kind.start); })
        .def_property_readonly("toward", [](const CurveOf<Circle>& c) { return to_python(c.kind.toward); })
        .def_property_readonly("center", [](const CurveOf<Circle>& c) { return to_python(c.kind.center); })
        .def("__repr__", [](const CurveOf<Circle>& c) {
            return "Circle(radius=" + text(c.kind.radius) + ", start=" + list_text(c.kind.start) +
                   ", toward=" + list_text(c.kind.toward) + ", center=" + list_text(c.kind.center) + ")";
        });

    py::class_<CurveOf<Helix>, Curve>(
        m, "Helix",
        "A circular helix by its angle: r(u) = center + radius (cos u start + sin u toward) + pitch/(2 pi) u axis.")
        .def(
            py::init([](double radius, double pitch, const ArrayLike& start, const ArrayLike& toward,
                        const ArrayLike& center) {
                return CurveOf<Helix>({radius, pitch, vector3(start, "Helix", "start"),
                                       vector3(toward, "Helix", "toward"), vector3(center, "Helix", "center")});
            }),
            py::arg("radius"), py::arg("pitch"), py::arg("start"), py::arg("toward"), py::arg("center") = origin,
            R"(radius [m], positive. pitch [m] a turn, along start x toward; negative for a left-handed helix, not zero.
start, toward: directions from the axis to u = 0 and to the side on which u grows, made orthonormal. center: point of
the axis beside u = 0 [m]. World axes; u in rad.)")
        .def_property_readonly("radius", [](const CurveOf<Helix>& c) { return c.kind.radius; })
        .def_property_readonly("pitch", [](const CurveOf<Helix>& c) { return c.kind.pitch; })
        .def_property_readonly("start", [](const CurveOf<Helix>& c) { return to_python(c.kind.start); })
        .def_property_readonly("toward", [](const CurveOf<Helix>& c) { return to_python(c.kind.toward); })
        .def_property_readonly("center", [](const CurveOf<Helix>& c) { return to_python(c.kind.center); })
        .def("__repr__", [](const CurveOf<Helix>& c) {
            return "Helix(radius=" + text(c.kind.radius) + ", pitch=" + text(c.kind.pitch) +
                   ", start=" + list_text(c.kind.start) + ", toward=" + list_text(c.kind.toward) +
                   ", center=" + list_text(c.kind.center) + ")";
        });

    py::class_<CurveOf<Polynomial>, Curve>(m, "Polynomial", "A polynomial curve: r(u) = sum of c_k u^k.")
        .def(
            py::init([](const ArrayLike& coefficients, const std::optional<std::pair<double, double>>& domain) {
                const Array c = doubles(coefficients, "Polynomial", "coefficients");
                if (c.ndim() != 2 || c.shape(1) != 3)
                    throw InvalidInput("Polynomial: coefficients has shape " + shape_of(c) +
                                       "; it is (n, 3), a vector for each power of u, beginning with 0");
                Polynomial kind;
                for (py::ssize_t k = 0; k < c.shape(0); ++k)
                    kind.coefficients.emplace_back(c.at(k, 0), c.at(k, 1), c.at(k, 2));
                if (domain) kind.domain = {domain->first, domain->second};
                return CurveOf<Polynomial>(kind);
            }),
            py::arg("coefficients"), py::kw_only(), py::arg("domain") = py::none(),
            R"(coefficients: (n, 3), vectors in the world in increasing powers of u [m]. domain: first and last parameter; without
it the curve has no ends.)")
        .def_property_readonly("coefficients",
                               [](const CurveOf<Polynomial>& c) {
                                   const auto n = static_cast<py::ssize_t>(c.kind.coefficients.size());
                                   py::array_t<double> result({n, py::ssize_t{3}});
                                   double* out = result.mutable_data();
                                   for (const Vector3& v : c.kind.coefficients) write(out, v);
                                   return result;
                               })
        .def("__repr__", [](const CurveOf<Polynomial>& c) {
            std::string list;
            for (const Vector3& v : c.kind.coefficients) list += (list.empty() ? "" : ", ") + list_text(v);
            return "Polynomial([" + list + "])";
        });
}

}  // namespace binding
