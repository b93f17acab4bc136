// Particles, and the joints of rigid bodies to the ground: what moves, and how it may.
#include <optional>
#include <rbdyn/body/particle.hpp>
#include <rbdyn/scene/joints.hpp>
#include <string>

#include "data.hpp"

namespace binding {

namespace {

using rbdyn::Coulomb, rbdyn::Free, rbdyn::Particle, rbdyn::Prismatic, rbdyn::Revolute, rbdyn::Spherical;

const std::vector<double> origin = {0.0, 0.0, 0.0};

/// A joint along an axis.
template <class Joint>
Joint axis_joint(const std::string& called, const ArrayLike& axis, const ArrayLike& at, const ArrayLike& point,
                 const MotionOrNone& motion, const std::optional<Coulomb>& friction) {
    Joint j{vector3(axis, called, "axis"), vector3(at, called, "at"), vector3(point, called, "point")};
    if (!motion.is_none()) j.motion = recorded_time_function(motion, called + ": motion");
    j.friction = friction;
    return j;
}

constexpr bool is_hinge(const Revolute*) { return true; }
constexpr bool is_hinge(const Prismatic*) { return false; }

template <class Joint>
void bind_axis_joint(py::module_& m, const char* name, const char* doc, const char* at_doc) {
    const std::string called = name;
    constexpr bool turns = is_hinge(static_cast<Joint*>(nullptr));
    py::class_<Joint> joint(m, name, doc);
    if constexpr (turns)
        joint
            .def(py::init([called](const ArrayLike& axis, const ArrayLike& at, const ArrayLike& point,
                                   const MotionOrNone& motion, const std::optional<Coulomb>& friction,
                                   const NumberOrParameter& pin_radius) {
                     Joint j = axis_joint<Joint>(called, axis, at, point, motion, friction);
                     j.pin_radius = given(pin_radius, called, "pin_radius");
                     j.validate();
                     return j;
                 }),
                 py::arg("axis"), py::kw_only(), py::arg("at") = origin, py::arg("point") = origin,
                 py::arg("motion") = py::none(), py::arg("friction") = py::none(), py::arg("pin_radius") = 0.0, at_doc)
            .def_property_readonly(
                "pin_radius", [](const Joint& j) { return to_python(j.pin_radius); }, "Where its friction acts [m].");
    else
        joint.def(py::init([called](const ArrayLike& axis, const ArrayLike& at, const ArrayLike& point,
                                    const MotionOrNone& motion, const std::optional<Coulomb>& friction) {
                      const Joint j = axis_joint<Joint>(called, axis, at, point, motion, friction);
                      j.validate();
                      return j;
                  }),
                  py::arg("axis"), py::kw_only(), py::arg("at") = origin, py::arg("point") = origin,
                  py::arg("motion") = py::none(), py::arg("friction") = py::none(), at_doc);
    joint
        .def_property_readonly(
            "axis", [](const Joint& j) { return to_python(j.axis); }, "Its direction as given (3,), the parent's axes.")
        .def_property_readonly(
            "at", [](const Joint& j) { return to_python(j.at); }, "In the parent's axes (3,) [m].")
        .def_property_readonly(
            "driven", [](const Joint& j) { return j.motion.has_value(); }, "Whether its coordinate is prescribed.")
        .def_property_readonly(
            "friction", [](const Joint& j) { return j.friction; }, "Its friction, or None.")
        .def_property_readonly(
            "point", [](const Joint& j) { return to_python(j.point); }, "In body axes (3,) [m].")
        .def("__repr__", [called](const Joint& j) {
            std::string words =
                called + "(axis=" + list_text(j.axis) + ", at=" + list_text(j.at) + ", point=" + list_text(j.point);
            if (j.friction) words += ", friction=" + words_of(*j.friction);
            if constexpr (turns)
                if (!j.pin_radius.is_zero()) words += ", pin_radius=" + text(j.pin_radius);
            return words + ")";
        });
    as_data(
        joint,
        [](const Joint& j) {
            const py::object motion = !j.motion                 ? py::object(py::none())
                                      : j.motion->is_constant() ? py::object(py::float_(j.motion->constant()))
                                                                : py::cast(j.motion->function());
            py::object pin = py::float_(0.0);
            if constexpr (turns) pin = to_python(j.pin_radius);
            return py::make_tuple(tuple_of(j.axis), tuple_of(j.at), tuple_of(j.point), motion,
                                  j.friction ? py::cast(*j.friction) : py::object(py::none()), pin);
        },
        [](const py::tuple& d) {
            Joint j{vector_from(d[0]), vector_from(d[1]), vector_from(d[2])};
            if (d.size() > 3 && py::isinstance<py::float_>(d[3])) j.motion = rbdyn::TimeFunction(d[3].cast<double>());
            if (d.size() > 3 && py::isinstance<rbdyn::Function>(d[3]))
                j.motion = rbdyn::TimeFunction(d[3].cast<rbdyn::Function>());
            if (d.size() > 4 && !d[4].is_none()) j.friction = d[4].cast<Coulomb>();
            if constexpr (turns)
                if (d.size() > 5) j.pin_radius = given_from(d[5]);
            return j;
        });
}

}  // namespace

void bind_joints(py::module_& m) {
    py::class_<Particle> particle(m, "Particle", "A material point.");
    particle
        .def(py::init([](const NumberOrParameter& mass) {
                 const Particle p{given(mass, "Particle", "mass")};
                 p.validate();
                 return p;
             }),
             py::arg("mass"), "mass [kg], positive and finite; a number, or rb.parameter.")
        .def_property_readonly(
            "mass", [](const Particle& p) { return to_python(p.mass); }, "[kg]")
        .def("__repr__", [](const Particle& p) { return "Particle(mass=" + text(p.mass) + ")"; });
    as_data(
        particle, [](const Particle& p) { return py::make_tuple(to_python(p.mass)); },
        [](const py::tuple& d) { return Particle{given_from(d[0])}; });

    py::class_<Free> free(m, "Free", R"(No constraint.

A particle then starts with position [m] and velocity [m/s], world axes; a rigid body with those of the origin of its
axes, attitude, and angular_velocity (body axes) or angular_velocity_world [rad/s].)");
    free.def(py::init<>()).def("__repr__", [](const Free&) { return "Free()"; });
    as_data(
        free, [](const Free&) { return py::tuple(); }, [](const py::tuple&) { return Free{}; });

    py::class_<Spherical> spherical(m, "Spherical",
                                    R"(A ball joint: one point of a rigid body is held, and it turns as it likes (7.57).

The body starts with attitude, and angular_velocity (body axes) or angular_velocity_world [rad/s].)");
    spherical
        .def(py::init([](const ArrayLike& at, const ArrayLike& point) {
                 const Spherical j{vector3(at, "Spherical", "at"), vector3(point, "Spherical", "point")};
                 j.validate();
                 return j;
             }),
             py::kw_only(), py::arg("at") = origin, py::arg("point") = origin,
             "at (3,): where in the world; point (3,): which point of the body, body axes [m].")
        .def_property_readonly(
            "at", [](const Spherical& j) { return to_python(j.at); }, "In the world (3,) [m].")
        .def_property_readonly(
            "point", [](const Spherical& j) { return to_python(j.point); }, "In body axes (3,) [m].")
        .def("__repr__", [](const Spherical& j) {
            return "Spherical(at=" + list_text(j.at) + ", point=" + list_text(j.point) + ")";
        });
    as_data(
        spherical, [](const Spherical& j) { return py::make_tuple(tuple_of(j.at), tuple_of(j.point)); },
        [](const py::tuple& d) {
            return Spherical{vector_from(d[0]), vector_from(d[1])};
        });

    bind_axis_joint<Revolute>(
        m, "Revolute", R"(A hinge: a rigid body turns about a fixed axis (7.60).

The body starts with angle [rad] and rate [rad/s], right-handed about the axis. At angle 0 body axes and world axes
coincide, so that the axis is the same direction in both.)",
        R"(axis (3,): a direction, of any length; at (3,): where it passes, both in the parent's axes (the world's by
default); point (3,): which point of the body is held there, body axes [m]; motion: the angle [rad] as a function of time
[s], if it is prescribed: then the start has none; friction: Coulomb(...), a torque about the axis of up to mu times
pin_radius [m] times what of the whole reaction force lies across the axis.)");
    bind_axis_joint<Prismatic>(
        m, "Prismatic", R"(A slide: a rigid body moves along an axis without turning.

The body starts with displacement [m] and rate [m/s] along the axis. Body axes are those of the world.)",
        R"(axis (3,): a direction, of any length; at (3,): where the point is at displacement 0, both in the parent's axes (the
world's by default); point (3,): that point of the body, body axes [m]; motion: the displacement [m] as a function of time
[s], if it is prescribed: then the start has none; friction: Coulomb(...), a force along the axis of up to mu times what
of the whole reaction force lies across the axis.)");
}

}  // namespace binding
