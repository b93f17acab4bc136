// Curves: geometry that can be asked, and that a rail follows.
#include <cmath>
#include <map>
#include <optional>
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

// what each kind is made from, as Python's tuples hold it
py::tuple data(const rbdyn::Line& c) { return py::make_tuple(to_python(c.direction), to_python(c.point)); }
py::tuple data(const rbdyn::Circle& c) {
    return py::make_tuple(c.radius, to_python(c.start), to_python(c.toward), to_python(c.center));
}
py::tuple data(const rbdyn::Helix& c) {
    return py::make_tuple(c.radius, c.pitch, to_python(c.start), to_python(c.toward), to_python(c.center));
}
py::tuple data(const rbdyn::Polynomial& c) { return py::make_tuple(rows_of(c.coefficients)); }
py::tuple data(const rbdyn::Parabola& c) {
    return py::make_tuple(c.a, to_python(c.x), to_python(c.y), to_python(c.vertex));
}
py::tuple data(const rbdyn::Cycloid& c) {
    return py::make_tuple(c.radius, to_python(c.x), to_python(c.y), to_python(c.vertex));
}
py::tuple data(const rbdyn::Spline& c) { return py::make_tuple(rows_of(c.points), c.closed); }
py::tuple data(const rbdyn::FunctionCurve& c) {
    return py::make_tuple(c.function, std::pair(c.domain.begin, c.domain.end), c.closed);
}

const char* class_of(const rbdyn::CurveKinds::Kind& kind) {
    static const char* names[] = {"Line", "Circle", "Parabola", "Cycloid", "Helix", "Polynomial", "Spline", "Curve"};
    static_assert(std::variant_size_v<rbdyn::CurveKinds::Kind> == std::size(names));
    return names[kind.index()];
}

/// The call that makes a curve anew: a class and its arguments.
py::tuple call_that_makes(const Curve& c) {
    py::object type = py::module_::import("rbdyn._core").attr(class_of(c.kind()));
    const py::object partial = py::module_::import("functools").attr("partial");
    if (const auto* polynomial = std::get_if<rbdyn::Polynomial>(&c.kind()))
        type = partial(type, py::arg("domain") = std::pair(polynomial->domain.begin, polynomial->domain.end));
    if (const auto* spline = std::get_if<rbdyn::Spline>(&c.kind())) {
        py::dict slopes;
        for (const auto& [k, slope] : spline->slopes) slopes[py::int_(k)] = to_python(slope);
        type = partial(type, py::arg("slopes") = slopes);
    }
    return py::make_tuple(type, std::visit([](const auto& kind) { return data(kind); }, c.kind()));
}

/// A quantity of a curve at parameters.
template <class F>
auto at(const Curve& c, const ArrayLike& u, const char* quantity, const F& f) {
    return finite_over(u, "Curve", "parameter", quantity, f, [&] {
        const rbdyn::Domain d = c.domain();
        const bool has_ends = std::isfinite(d.begin) || std::isfinite(d.end);
        return "the " + c.name() + " has none there that a double holds: give a parameter " +
               (has_ends ? "of its domain, " + text(d.begin) + " to " + text(d.end) : "nearer to 0");
    });
}

std::string rows_text(const std::vector<Vector3>& vectors) {
    std::string list;
    for (const Vector3& v : vectors) list += (list.empty() ? "" : ", ") + list_text(v);
    return "[" + list + "]";
}

rbdyn::Domain domain_of(const std::optional<std::pair<double, double>>& domain) {
    return domain ? rbdyn::Domain{domain->first, domain->second} : rbdyn::Domain{};
}

void bind_base(py::module_& m) {
    py::class_<Curve>(
        m, "Curve",
        R"(A curve r(u) in the world, of any function: Curve(lambda u: [u, np.sin(u), 0.2 * u**2], domain=(0, 3)).

Base of Line, Circle, Parabola, Cycloid, Helix, Polynomial and Spline. A parameter u is a number, or an array of any
shape: a vector then comes back with its components last.)")
        .def(py::init([](const py::object& function, const std::optional<std::pair<double, double>>& domain,
                         bool closed) {
                 rbdyn::FunctionCurve kind{user_curve(function, true, "Curve").function, domain_of(domain), closed, {}};
                 const py::object name = py::getattr(function, "__name__", py::none());
                 if (!name.is_none() && std::string(py::str(name)) != "<lambda>") kind.label = py::str(name);
                 return Curve(kind);
             }),
             py::arg("function"), py::arg("domain") = py::none(), py::arg("closed") = false,
             R"(function: of u, gives the three components of r(u) [m], in plain Python and NumPy; it is called once and
recorded, with its derivatives. domain: first and last parameter; without it the curve has no ends. closed: it ends
where it began, in r and r', and its parameter counts on; domain is one round.)")
        .def_property_readonly(
            "domain", [](const Curve& c) { return std::pair(c.domain().begin, c.domain().end); },
            "The first and the last parameter; infinite where the curve goes on.")
        .def_property_readonly("closed", &Curve::closed,
                               "Whether it comes back to where it started; its parameter counts on.")
        .def_property_readonly("name", &Curve::name, "What it is, in words.")
        .def(
            "position",
            [](const Curve& c, const ArrayLike& u) {
                return at(c, u, "position", [&](double x) { return c.position(x); });
            },
            py::arg("u"), "r(u), (3,) or (n, 3) [m].")
        .def(
            "length",
            [](const Curve& c, const ArrayLike& u0, const ArrayLike& u1) {
                return over_both(u0, u1, "Curve", "u0", "u1", [&](double a, double b) {
                    const double length = c.length(a, b);
                    if (!std::isfinite(length))
                        rbdyn::refuse("Curve", "the arc length from " + rbdyn::text(a) + " to " + rbdyn::text(b),
                                      length, "no double holds it; measure shorter stretches");
                    return length;
                });
            },
            py::arg("u0"), py::arg("u1"), "Arc length from u0 to u1, negative if u1 < u0 [m]. Arrays are broadcast.")
        .def(
            "frenet",
            [](const Curve& c, const ArrayLike& u) {
                const py::object tangent = at(c, u, "tangent", [&](double x) { return c.frenet(x).tangent; });
                const py::object normal = at(c, u, "normal", [&](double x) { return c.frenet(x).normal; });
                const py::object binormal = at(c, u, "binormal", [&](double x) { return c.frenet(x).binormal; });
                return FrenetObject(py::module_::import("rbdyn.frames").attr("Frenet")(tangent, normal, binormal));
            },
            py::arg("u"),
            R"(Tangent, normal and binormal (eqs. 7.9, 7.10): a named tuple of unit vectors, each (3,) or (n, 3).

On a straight stretch the frame of least rotation. Raises InvalidInput at a cusp.)")
        .def(
            "curvature",
            [](const Curve& c, const ArrayLike& u) {
                return at(c, u, "curvature", [&](double x) { return c.curvature(x); });
            },
            py::arg("u"), "1/rho of eq. 7.10 [1/m]; 0 where straight. Raises InvalidInput at a cusp.")
        .def(
            "torsion",
            [](const Curve& c, const ArrayLike& u) {
                return at(c, u, "torsion", [&](double x) { return c.torsion(x); });
            },
            py::arg("u"), "Torsion [1/m], positive for a right-handed helix; 0 where straight.")
        .def("__eq__", [](const Curve& a,
                          const py::object& b) { return py::isinstance<Curve>(b) && a == b.cast<const Curve&>(); })
        .def("__hash__", [](const Curve& c) { return py::hash(py::str(c.name())); })
        .def("__reduce__", &call_that_makes)
        .def("__repr__", [](const Curve& c) { return "<Curve: " + c.name() + ">"; });
}

}  // namespace

py::object curve_object(const Curve& curve) {
    if (std::holds_alternative<rbdyn::FunctionCurve>(curve.kind())) return py::cast(curve);
    const py::tuple call = call_that_makes(curve);
    return call[0](*call[1].cast<py::tuple>());
}

void bind_curves(py::module_& m) {
    using rbdyn::Circle, rbdyn::Cycloid, rbdyn::Helix, rbdyn::Line, rbdyn::Parabola, rbdyn::Polynomial, rbdyn::Spline;
    const std::vector<double> origin = {0.0, 0.0, 0.0};
    bind_base(m);

    py::class_<CurveOf<Line>, Curve>(m, "Line",
                                     "A straight line by its length: r(u) = point + u direction/|direction|.")
        .def(py::init([](const ArrayLike& direction, const ArrayLike& point) {
                 return CurveOf<Line>({vector3(direction, "Line", "direction"), vector3(point, "Line", "point")});
             }),
             py::arg("direction"), py::arg("point") = origin,
             "direction: of any length but zero. point: where u = 0 [m]. World axes; u in m.")
        .def_property_readonly(
            "direction", [](const CurveOf<Line>& c) { return to_python(c.kind.direction); },
            "Of its tangent (3,), as given.")
        .def_property_readonly(
            "point", [](const CurveOf<Line>& c) { return to_python(c.kind.point); }, "Where u = 0 (3,) [m].")
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
        .def_property_readonly(
            "radius", [](const CurveOf<Circle>& c) { return c.kind.radius; }, "[m]")
        .def_property_readonly(
            "start", [](const CurveOf<Circle>& c) { return to_python(c.kind.start); },
            "Direction from the center to u = 0 (3,), as given.")
        .def_property_readonly(
            "toward", [](const CurveOf<Circle>& c) { return to_python(c.kind.toward); },
            "Direction to the side on which u grows (3,), as given.")
        .def_property_readonly(
            "center", [](const CurveOf<Circle>& c) { return to_python(c.kind.center); }, "(3,) [m].")
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
        .def_property_readonly(
            "radius", [](const CurveOf<Helix>& c) { return c.kind.radius; }, "[m]")
        .def_property_readonly(
            "pitch", [](const CurveOf<Helix>& c) { return c.kind.pitch; }, "[m] a turn.")
        .def_property_readonly(
            "start", [](const CurveOf<Helix>& c) { return to_python(c.kind.start); },
            "Direction from the center to u = 0 (3,), as given.")
        .def_property_readonly(
            "toward", [](const CurveOf<Helix>& c) { return to_python(c.kind.toward); },
            "Direction to the side on which u grows (3,), as given.")
        .def_property_readonly(
            "center", [](const CurveOf<Helix>& c) { return to_python(c.kind.center); }, "(3,) [m].")
        .def("__repr__", [](const CurveOf<Helix>& c) {
            return "Helix(radius=" + text(c.kind.radius) + ", pitch=" + text(c.kind.pitch) +
                   ", start=" + list_text(c.kind.start) + ", toward=" + list_text(c.kind.toward) +
                   ", center=" + list_text(c.kind.center) + ")";
        });

    py::class_<CurveOf<Polynomial>, Curve>(m, "Polynomial", "A polynomial curve: r(u) = sum of c_k u^k.")
        .def(
            py::init([](const ArrayLike& coefficients, const std::optional<std::pair<double, double>>& domain) {
                const Polynomial kind{
                    rows(coefficients, "Polynomial", "coefficients", "a vector for each power of u, beginning with 0"),
                    domain_of(domain)};
                return unlocked([&] { return CurveOf<Polynomial>(kind); });
            }),
            py::arg("coefficients"), py::kw_only(), py::arg("domain") = py::none(),
            R"(coefficients: (n, 3), vectors in the world in increasing powers of u [m]. domain: first and last parameter; without
it the curve has no ends.)")
        .def_property_readonly(
            "coefficients", [](const CurveOf<Polynomial>& c) { return rows_of(c.kind.coefficients); },
            "In increasing powers of u (n, 3) [m].")
        .def("__repr__",
             [](const CurveOf<Polynomial>& c) { return "Polynomial(" + rows_text(c.kind.coefficients) + ")"; });

    py::class_<CurveOf<Parabola>, Curve>(
        m, "Parabola", "A parabola by the distance along its tangent at the vertex: r(u) = vertex + u x + a u^2 y.")
        .def(
            py::init([](double a, const ArrayLike& x, const ArrayLike& y, const ArrayLike& vertex) {
                return CurveOf<Parabola>({a, vector3(x, "Parabola", "x"), vector3(y, "Parabola", "y"),
                                          vector3(vertex, "Parabola", "vertex")});
            }),
            py::arg("a"), py::arg("x"), py::arg("y"), py::arg("vertex") = origin,
            R"(a [1/m], not zero. x: direction of the tangent at the vertex; y: side to which the parabola opens, if a is
positive; made orthonormal. vertex [m]. World axes; u in m.)")
        .def_property_readonly(
            "a", [](const CurveOf<Parabola>& c) { return c.kind.a; }, "[1/m].")
        .def_property_readonly(
            "x", [](const CurveOf<Parabola>& c) { return to_python(c.kind.x); },
            "Direction of the tangent at the vertex (3,), as given.")
        .def_property_readonly(
            "y", [](const CurveOf<Parabola>& c) { return to_python(c.kind.y); }, "Direction across it (3,), as given.")
        .def_property_readonly(
            "vertex", [](const CurveOf<Parabola>& c) { return to_python(c.kind.vertex); }, "Where u = 0 (3,) [m].")
        .def("__repr__", [](const CurveOf<Parabola>& c) {
            return "Parabola(a=" + text(c.kind.a) + ", x=" + list_text(c.kind.x) + ", y=" + list_text(c.kind.y) +
                   ", vertex=" + list_text(c.kind.vertex) + ")";
        });

    py::class_<CurveOf<Cycloid>, Curve>(
        m, "Cycloid",
        R"(A cycloid by the angle of its rolling circle: r(u) = vertex + radius ((u + sin u) x + (1 - cos u) y).

The tautochrone, if y is up. At its cusps, u = pi, 3 pi, ... and their opposites, it has no tangent.)")
        .def(
            py::init([](double radius, const ArrayLike& x, const ArrayLike& y, const ArrayLike& vertex) {
                return CurveOf<Cycloid>({radius, vector3(x, "Cycloid", "x"), vector3(y, "Cycloid", "y"),
                                         vector3(vertex, "Cycloid", "vertex")});
            }),
            py::arg("radius"), py::arg("x"), py::arg("y"), py::arg("vertex") = origin,
            R"(radius of the rolling circle [m], positive. x: direction of the tangent at the vertex; y: side of the cusps;
made orthonormal. vertex: where u = 0 [m]. World axes; u in rad.)")
        .def_property_readonly(
            "radius", [](const CurveOf<Cycloid>& c) { return c.kind.radius; }, "[m]")
        .def_property_readonly(
            "x", [](const CurveOf<Cycloid>& c) { return to_python(c.kind.x); },
            "Direction of the tangent at the vertex (3,), as given.")
        .def_property_readonly(
            "y", [](const CurveOf<Cycloid>& c) { return to_python(c.kind.y); }, "Direction across it (3,), as given.")
        .def_property_readonly(
            "vertex", [](const CurveOf<Cycloid>& c) { return to_python(c.kind.vertex); }, "Where u = 0 (3,) [m].")
        .def("__repr__", [](const CurveOf<Cycloid>& c) {
            return "Cycloid(radius=" + text(c.kind.radius) + ", x=" + list_text(c.kind.x) +
                   ", y=" + list_text(c.kind.y) + ", vertex=" + list_text(c.kind.vertex) + ")";
        });

    py::class_<CurveOf<Spline>, Curve>(m, "Spline",
                                       R"(A cubic spline through points, r(k) = points[k]; C2, not-a-knot at its ends.

Three points give a parabola, two a line. Where slopes gives r' at a point, that is what it is there, and r'' may jump:
at an end, or where the curvature of a rail changes at once.)")
        .def(
            py::init([](const ArrayLike& points, bool closed, const std::map<int, ArrayLike>& slopes) {
                Spline kind{rows(points, "Spline", "points", "one a row"), closed, {}};
                for (const auto& [k, slope] : slopes)
                    kind.slopes.emplace(k, vector3(slope, "Spline", "slope at point " + std::to_string(k)));
                return unlocked([&] { return CurveOf<Spline>(kind); });
            }),
            py::arg("points"), py::arg("closed") = false, py::kw_only(), py::arg("slopes") = py::dict(),
            R"(points: (n, 3), at u = 0 .. n-1 [m]; neighbours differ. closed: from the last point on to the first, which is
not repeated; the parameter counts on, n a round. slopes: {index of a point: r' there} [m]. World axes.)")
        .def_property_readonly(
            "points", [](const CurveOf<Spline>& c) { return rows_of(c.kind.points); }, "At u = 0 .. n-1 (n, 3) [m].")
        .def_property_readonly(
            "slopes",
            [](const CurveOf<Spline>& c) {
                py::typing::Dict<py::int_, py::array_t<double>> result;
                for (const auto& [k, slope] : c.kind.slopes) result[py::int_(k)] = to_python(slope);
                return result;
            },
            "{index of a point: r' there} [m].")
        .def("__repr__", [](const CurveOf<Spline>& c) {
            std::string more = c.kind.closed ? ", closed=True" : "", list;
            for (const auto& [k, slope] : c.kind.slopes)
                list += (list.empty() ? "" : ", ") + std::to_string(k) + ": " + list_text(slope);
            if (!list.empty()) more += ", slopes={" + list + "}";
            return "Spline(" + rows_text(c.kind.points) + more + ")";
        });
}

}  // namespace binding
