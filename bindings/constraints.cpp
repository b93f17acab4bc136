// Constraints, and the surfaces they are on.
#include <rbdyn/scene/constraints.hpp>

#include "data.hpp"

namespace binding {

using rbdyn::Sphere, rbdyn::Ball, rbdyn::Hinge, rbdyn::Plane, rbdyn::PointOnCurve, rbdyn::PointOnPlane, rbdyn::Rod,
    rbdyn::Weld;

void bind_constraints(py::module_& m) {
    py::class_<Plane> plane(m, "Plane", "A plane through a point.");
    plane
        .def(py::init([](const ArrayLike& normal, const ArrayLike& point) {
                 const Plane p{vector3(normal, "Plane", "normal"), vector3(point, "Plane", "point")};
                 p.validate();
                 return p;
             }),
             py::arg("normal"), py::arg("point") = std::vector<double>{0.0, 0.0, 0.0},
             "normal (3,): a direction, of any length; point (3,) [m].")
        .def_property_readonly(
            "normal", [](const Plane& p) { return to_python(p.normal); }, "As given (3,).")
        .def_property_readonly(
            "point", [](const Plane& p) { return to_python(p.point); }, "[m] (3,).")
        .def("__repr__", [](const Plane& p) {
            return "Plane(normal=" + list_text(p.normal) + ", point=" + list_text(p.point) + ")";
        });
    as_data(
        plane, [](const Plane& p) { return py::make_tuple(tuple_of(p.normal), tuple_of(p.point)); },
        [](const py::tuple& d) {
            return Plane{vector_from(d[0]), vector_from(d[1])};
        });

    py::class_<Sphere> sphere(m, "Sphere", "A sphere as a surface: its outside, or its inside, a bowl.");
    sphere
        .def(py::init([](const ArrayLike& center, double radius, bool inside) {
                 const Sphere s{vector3(center, "Sphere", "center"), radius, inside};
                 s.validate();
                 return s;
             }),
             py::arg("center"), py::arg("radius"), py::arg("inside") = false,
             "center (3,) [m], radius [m]; inside: what touches is in it.")
        .def_property_readonly(
            "center", [](const Sphere& s) { return to_python(s.center); }, "[m] (3,).")
        .def_property_readonly(
            "radius", [](const Sphere& s) { return s.radius; }, "[m]")
        .def_property_readonly(
            "inside", [](const Sphere& s) { return s.inside; }, "Whether what touches is in it.")
        .def("__repr__", [](const Sphere& s) {
            return "Sphere(center=" + list_text(s.center) + ", radius=" + text(s.radius) +
                   (s.inside ? ", inside=True)" : ")");
        });
    as_data(
        sphere, [](const Sphere& s) { return py::make_tuple(tuple_of(s.center), s.radius, s.inside); },
        [](const py::tuple& d) {
            return Sphere{vector_from(d[0]), d[1].cast<double>(), d[2].cast<bool>()};
        });

    py::class_<Ball> ball(m, "Ball", "Two points coincide: a pin, a ball joint.");
    ball.def(py::init<>()).def("__repr__", [](const Ball&) { return "Ball()"; });
    as_data(
        ball, [](const Ball&) { return py::tuple(); }, [](const py::tuple&) { return Ball{}; });

    py::class_<Rod> rod(m, "Rod", "Two points keep their distance: a massless rod.");
    rod.def(py::init([](double length) {
                const Rod r{length};
                r.validate();
                return r;
            }),
            py::arg("length"), "length [m], positive.")
        .def_property_readonly(
            "length", [](const Rod& r) { return r.length; }, "[m]")
        .def("__repr__", [](const Rod& r) { return "Rod(length=" + text(r.length) + ")"; });
    as_data(
        rod, [](const Rod& r) { return py::make_tuple(r.length); },
        [](const py::tuple& d) { return Rod{d[0].cast<double>()}; });

    py::class_<Weld> weld(
        m, "Weld",
        R"(Two bodies keep the pose to each other that they start with, wherever their origins are; points given for
both coincide. Its force and torque are at a's point.)");
    weld.def(py::init<>()).def("__repr__", [](const Weld&) { return "Weld()"; });
    as_data(
        weld, [](const Weld&) { return py::tuple(); }, [](const py::tuple&) { return Weld{}; });

    py::class_<Hinge> hinge(m, "Hinge",
                            "Two points coincide, and the bodies turn against each other about an axis only.");
    hinge
        .def(py::init([](const ArrayLike& axis) {
                 const Hinge h{vector3(axis, "Hinge", "axis")};
                 h.validate();
                 return h;
             }),
             py::arg("axis"), "axis (3,): a direction in the axes of b; as the scene starts, its axis in a too.")
        .def_property_readonly(
            "axis", [](const Hinge& h) { return to_python(h.axis); }, "As given (3,), axes of b.")
        .def("__repr__", [](const Hinge& h) { return "Hinge(axis=" + list_text(h.axis) + ")"; });
    as_data(
        hinge, [](const Hinge& h) { return py::make_tuple(tuple_of(h.axis)); },
        [](const py::tuple& d) { return Hinge{vector_from(d[0])}; });

    py::class_<PointOnPlane> on_plane(m, "PointOnPlane", "A point stays on a plane.");
    on_plane
        .def(py::init([](const Plane& surface) { return PointOnPlane{surface}; }), py::arg("plane"),
             "plane: in the axes of b.")
        .def_property_readonly(
            "plane", [](const PointOnPlane& p) { return p.plane; }, "In the axes of b.")
        .def("__repr__", [](const PointOnPlane& p) {
            return "PointOnPlane(Plane(normal=" + list_text(p.plane.normal) + ", point=" + list_text(p.plane.point) +
                   "))";
        });
    as_data(
        on_plane, [](const PointOnPlane& p) { return py::make_tuple(p.plane); },
        [](const py::tuple& d) { return PointOnPlane{d[0].cast<Plane>()}; });

    py::class_<PointOnCurve> on_curve(m, "PointOnCurve", "A point stays on a curve.");
    on_curve
        .def(py::init([](const rbdyn::Curve& curve) { return PointOnCurve{curve}; }), py::arg("curve"),
             "curve: in the axes of b.")
        .def_property_readonly(
            "curve",
            [](const PointOnCurve& p) {
                return py::reinterpret_steal<py::typing::Union<rbdyn::Curve>>(curve_object(p.curve).release());
            },
            "In the axes of b.")
        .def("__repr__", [](const PointOnCurve& p) { return "PointOnCurve(" + p.curve.name() + ")"; });
    as_data(
        on_curve, [](const PointOnCurve& p) { return py::make_tuple(curve_object(p.curve)); },
        [](const py::tuple& d) { return PointOnCurve{d[0].cast<rbdyn::Curve>()}; });
}

}  // namespace binding
