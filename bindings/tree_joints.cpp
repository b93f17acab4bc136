// Joints with more than one coordinate, and the weld.
#include <optional>
#include <rbdyn/scene/joints.hpp>

#include "data.hpp"

namespace binding {

namespace {

using rbdyn::Cylindrical, rbdyn::Fixed, rbdyn::Planar, rbdyn::Universal;

const std::vector<double> nowhere = {0.0, 0.0, 0.0};

template <class Joint>
void bind_places(py::class_<Joint>& joint) {
    joint
        .def_property_readonly(
            "at", [](const Joint& j) { return to_python(j.at); }, "In the parent's axes (3,) [m].")
        .def_property_readonly(
            "point", [](const Joint& j) { return to_python(j.point); }, "In body axes (3,) [m].");
}

}  // namespace

void bind_tree_joints(py::module_& m) {
    py::class_<Universal> universal(m, "Universal", R"(Two hinges with a massless cross between them.

The body turns about first, fixed in its parent, and then about second, fixed in the body, at right angles at angles
zero. It starts with angles (2,) [rad] and rates (2,) [rad/s].)");
    universal
        .def(py::init([](const ArrayLike& first, const ArrayLike& second, const ArrayLike& at, const ArrayLike& point) {
                 const Universal j{vector3(first, "Universal", "first"), vector3(second, "Universal", "second"),
                                   vector3(at, "Universal", "at"), vector3(point, "Universal", "point")};
                 j.validate();
                 return j;
             }),
             py::arg("first"), py::arg("second"), py::kw_only(), py::arg("at") = nowhere, py::arg("point") = nowhere,
             R"(first, second (3,): directions, of any length; at (3,): where in the parent the cross is; point (3,):
which point of the body is held there, body axes [m].

Also a constraint (Scene.constrain): then first is in the axes of a, second in those of b.)")
        .def_property_readonly(
            "first", [](const Universal& j) { return to_python(j.first); }, "As given (3,), the parent's axes.")
        .def_property_readonly(
            "second", [](const Universal& j) { return to_python(j.second); }, "As given (3,), body axes.")
        .def("__repr__", [](const Universal& j) {
            return "Universal(first=" + list_text(j.first) + ", second=" + list_text(j.second) +
                   ", at=" + list_text(j.at) + ", point=" + list_text(j.point) + ")";
        });
    bind_places(universal);
    as_data(
        universal,
        [](const Universal& j) {
            return py::make_tuple(tuple_of(j.first), tuple_of(j.second), tuple_of(j.at), tuple_of(j.point));
        },
        [](const py::tuple& d) {
            return Universal{vector_from(d[0]), vector_from(d[1]), vector_from(d[2]), vector_from(d[3])};
        });

    py::class_<Cylindrical> cylindrical(m, "Cylindrical", R"(A hinge that slides along its axis.

The body starts with angle [rad], rate [rad/s], displacement [m] and displacement_rate [m/s].)");
    cylindrical
        .def(
            py::init([](const ArrayLike& axis, const ArrayLike& at, const ArrayLike& point) {
                const Cylindrical j{vector3(axis, "Cylindrical", "axis"), vector3(at, "Cylindrical", "at"),
                                    vector3(point, "Cylindrical", "point")};
                j.validate();
                return j;
            }),
            py::arg("axis"), py::kw_only(), py::arg("at") = nowhere, py::arg("point") = nowhere,
            R"(axis (3,): a direction, of any length; at (3,): where in the parent it passes; point (3,): which point of the
body is on it, body axes [m].)")
        .def_property_readonly(
            "axis", [](const Cylindrical& j) { return to_python(j.axis); }, "As given (3,), the parent's axes.")
        .def("__repr__", [](const Cylindrical& j) {
            return "Cylindrical(axis=" + list_text(j.axis) + ", at=" + list_text(j.at) +
                   ", point=" + list_text(j.point) + ")";
        });
    bind_places(cylindrical);
    as_data(
        cylindrical,
        [](const Cylindrical& j) { return py::make_tuple(tuple_of(j.axis), tuple_of(j.at), tuple_of(j.point)); },
        [](const py::tuple& d) {
            return Cylindrical{vector_from(d[0]), vector_from(d[1]), vector_from(d[2])};
        });

    py::class_<Planar> planar(
        m, "Planar", R"(Motion along a plane: the origin of the body's axes moves in it, and the body turns across it.

The body starts with position (2,) [m] of its origin from at, along x and y, velocity (2,) [m/s], angle [rad] from x to y,
and rate [rad/s].)");
    planar
        .def(py::init([](const ArrayLike& x, const ArrayLike& y, const ArrayLike& at) {
                 const Planar j{vector3(x, "Planar", "x"), vector3(y, "Planar", "y"), vector3(at, "Planar", "at")};
                 j.validate();
                 return j;
             }),
             py::arg("x"), py::arg("y"), py::kw_only(), py::arg("at") = nowhere,
             "x, y (3,): directions at right angles; at (3,): a point of the plane [m]; the parent's axes.")
        .def_property_readonly(
            "x", [](const Planar& j) { return to_python(j.x); }, "As given (3,), the parent's axes.")
        .def_property_readonly(
            "y", [](const Planar& j) { return to_python(j.y); }, "As given (3,), the parent's axes.")
        .def_property_readonly(
            "at", [](const Planar& j) { return to_python(j.at); }, "In the parent's axes (3,) [m].")
        .def("__repr__", [](const Planar& j) {
            return "Planar(x=" + list_text(j.x) + ", y=" + list_text(j.y) + ", at=" + list_text(j.at) + ")";
        });
    as_data(
        planar, [](const Planar& j) { return py::make_tuple(tuple_of(j.x), tuple_of(j.y), tuple_of(j.at)); },
        [](const py::tuple& d) {
            return Planar{vector_from(d[0]), vector_from(d[1]), vector_from(d[2])};
        });

    py::class_<Fixed> fixed(m, "Fixed", "A weld: no motion against the parent, in an attitude relative to it.");
    fixed
        .def(
            py::init([](const std::optional<AttitudeLike>& attitude, const ArrayLike& at, const ArrayLike& point) {
                const Fixed j{attitude ? binding::attitude(*attitude, "Fixed") : rbdyn::Attitude(),
                              vector3(at, "Fixed", "at"), vector3(point, "Fixed", "point")};
                j.validate();
                return j;
            }),
            py::kw_only(), py::arg("attitude") = py::none(), py::arg("at") = nowhere, py::arg("point") = nowhere,
            R"(attitude: of the body in its parent, that of the parent by default; at (3,): where in the parent; point (3,): which
point of the body is held there, body axes [m].)")
        .def_property_readonly(
            "rotation_matrix", [](const Fixed& j) { return to_python(j.attitude.matrix()); },
            "Body axes to the parent's (3, 3).")
        .def("__repr__",
             [](const Fixed& j) { return "Fixed(at=" + list_text(j.at) + ", point=" + list_text(j.point) + ")"; });
    bind_places(fixed);
    as_data(
        fixed,
        [](const Fixed& j) {
            const auto& q = j.attitude.exact();
            const auto pair = [](const rbdyn::DoubleDouble& x) { return py::make_tuple(x.hi, x.lo); };
            return py::make_tuple(py::make_tuple(pair(q.w), pair(q.x), pair(q.y), pair(q.z)), tuple_of(j.at),
                                  tuple_of(j.point));
        },
        [](const py::tuple& d) {
            const auto q = d[0].cast<std::array<std::pair<double, double>, 4>>();
            const auto wide = [&](std::size_t i) { return rbdyn::DoubleDouble(q[i].first, q[i].second); };
            return Fixed{rbdyn::Attitude(rbdyn::QuaternionOf<rbdyn::DoubleDouble>{wide(0), wide(1), wide(2), wide(3)}),
                         vector_from(d[1]), vector_from(d[2])};
        });
}

}  // namespace binding
