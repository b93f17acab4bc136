// Motions of what a run has: bodies and their points, couplings, constraints, contacts, watched functions.
#include "run.hpp"

namespace binding {

using rbdyn::BodyMotion, rbdyn::CouplingMotion, rbdyn::Side, rbdyn::Trajectory;

namespace {

struct BoundMotion {
    BodyMotion motion;
    const rbdyn::Scene::Body* body;  // of the run's scene, which the motion keeps
    std::string name;
};
struct BoundPoint {
    rbdyn::BodyPointMotion motion;
    std::string name;
};
struct BoundCoupling {
    CouplingMotion motion;
    std::string name;
};

struct BoundConstraint {
    rbdyn::ConstraintMotion motion;
    std::string name;
};

/// quantity(motion, t, side) as a method of time.
template <class Owner, class R>
auto of_time(R (decltype(Owner::motion)::*quantity)(double, Side) const) {
    return [quantity](const Owner& self, const ArrayLike& t, const SideName& name) {
        const Side side = side_of(name);
        return over(t, "Trajectory", "time", [&](double x) { return (self.motion.*quantity)(x, side); });
    };
}

std::vector<std::string> quantities_of(const rbdyn::Scene::Body& body) {
    std::vector<std::string> names = {"position", "velocity", "acceleration", "force"};
    const auto also = [&](std::initializer_list<const char*> more) {
        names.insert(names.end(), more.begin(), more.end());
    };
    if (body.rail() != nullptr)
        also({"parameter", "arc_length", "speed", "tangential_force", "reaction", "reaction_frenet"});
    if (body.rigid() == nullptr) return names;
    also({"center_of_mass", "center_of_mass_velocity", "center_of_mass_acceleration", "quaternion", "rotation_matrix",
          "euler_angles", "euler_rates", "angular_velocity", "angular_velocity_world", "angular_acceleration",
          "poisson_vector", "instantaneous_axis"});
    if (!std::holds_alternative<rbdyn::Free>(body.joint)) also({"reaction", "reaction_torque"});
    const auto is_on = [&]<class J>(const J*) { return std::holds_alternative<J>(body.joint); };
    if (is_on(static_cast<rbdyn::Revolute*>(nullptr)) || is_on(static_cast<rbdyn::Planar*>(nullptr)))
        also({"angle", "rate"});
    if (is_on(static_cast<rbdyn::Cylindrical*>(nullptr))) also({"angle", "rate", "displacement", "displacement_rate"});
    if (is_on(static_cast<rbdyn::Universal*>(nullptr))) also({"angles", "rates"});
    if (std::holds_alternative<rbdyn::Prismatic>(body.joint)) also({"displacement", "rate"});
    return names;
}

void bind_body_motions(py::module_& m) {
    using M = BodyMotion;
    py::class_<BoundMotion> body(m, "BodyMotion", R"(Motion of one body of a run. Each quantity is a method of time.

t: [s], a number or an array; scalars come back as float or (n,), vectors as (3,) or (n, 3), matrices as (3, 3) or
(n, 3, 3); world axes, but where body axes are named. side: at a jump the value "after" it, or "before". Raises
InvalidInput for a time outside the run, and for what the body or its joint does not have.)");
    const auto define = [&](const char* name, auto quantity, const char* doc) {
        body.def(name, of_time<BoundMotion>(quantity), py::arg("t"), py::arg("side") = after(), doc);
    };
    define("position", &M::position, "Of a particle, or of the origin of a rigid body's axes [m].");
    define("velocity", &M::velocity, "Of the same [m/s].");
    define("acceleration", &M::acceleration, "Of the same, from the model at the state [m/s^2].");
    define("force", &M::force, "Resultant of the active forces [N].");
    define("parameter", &M::parameter, "The curve's parameter. On a rail.");
    define("arc_length", &M::arc_length,
           "From the beginning of the curve, or from u = 0 where it has none [m]. On a rail.");
    define("speed", &M::speed, "ds/dt along the curve as placed [m/s], zero after a release. On a rail.");
    define("tangential_force", &M::tangential_force,
           "Q_s = F.t, the active force along the curve (eq. 7.15) [N]. On a rail.");
    define("reaction", &M::reaction, "Reaction of the rail or the joint on the body [N].");
    define("reaction_frenet", &M::reaction_frenet,
           "That of a rail along tangent, normal, binormal, which turn with it (eqs. 7.12-7.14) [N].");
    define("center_of_mass", &M::center_of_mass, "[m]");
    define("center_of_mass_velocity", &M::center_of_mass_velocity, "[m/s]");
    define("center_of_mass_acceleration", &M::center_of_mass_acceleration, "[m/s^2]");
    define("quaternion", &M::quaternion, "(w, x, y, z), body axes to the world's: (4,) or (n, 4). Of a rigid body.");
    define("rotation_matrix", &M::rotation_matrix,
           "Body axes to the world's, its columns the body's axes. Of a rigid body.");
    define("euler_angles", &M::euler_angles,
           R"(theta, psi, phi, continuous in time from the start of the run [rad]. Of a rigid body.

R = Rz(psi) Rx(theta) Rz(phi). An integrated run that keeps its end alone does not know their whole turns.)");
    define("euler_rates", &M::euler_rates,
           "Their rates [rad/s] (eq. 7.49); not finite where sin theta = 0. Of a rigid body.");
    define("angular_velocity", &M::angular_velocity, "In body axes [rad/s]. Of a rigid body.");
    define("angular_velocity_world", &M::angular_velocity_world, "In world axes [rad/s]. Of a rigid body.");
    define("angular_acceleration", &M::angular_acceleration, "In body axes [rad/s^2]. Of a rigid body.");
    define("poisson_vector", &M::poisson_vector, "The world's third axis in body axes (7.59). Of a rigid body.");
    define("reaction_torque", &M::reaction_torque,
           "Moment that the joint exerts on a rigid body, about the point it holds [N m].");
    define("angle", &M::angle, "Of a hinge, also one that slides, or in a plane [rad].");
    define("displacement", &M::displacement, "Of a slide, also of a hinge that slides [m].");
    define("rate", &M::rate, "Of the angle [rad/s], or of the displacement of a slide [m/s].");
    define("displacement_rate", &M::displacement_rate, "Of a hinge that slides [m/s].");
    define("angles", &M::angles, "Of a universal joint, about its first axis and its second [rad]: (2,) or (n, 2).");
    define("rates", &M::rates, "Of these angles [rad/s]: (2,) or (n, 2).");
    body.def(
            "instantaneous_axis",
            [](const BoundMotion& self, const ArrayLike& t, const SideName& name) {
                const Side side = side_of(name);
                return pair_over<AxisObject>("Axis", t,
                                             [&](double x) { return self.motion.instantaneous_axis(x, side); });
            },
            py::arg("t"), py::arg("side") = after(),
            R"(The instantaneous axis of rotation: (point, direction), of a rigid body.

point: that of the axis nearest to the centre of mass [m]; direction: of unit length, zero while the body does not turn.)")
        .def(
            "point",
            [](const BoundMotion& self, const ArrayLike& place, const ArrayLike& t, const SideName& name) {
                const Side side = side_of(name);
                const Vector3 p = vector3(place, self.name, "place");
                return pair_over<PointObject>("PointMotion", t,
                                              [&](double x) { return self.motion.point(p, x, side); });
            },
            py::arg("place"), py::arg("t"), py::arg("side") = after(),
            "(position, velocity) of the point of a rigid body at a place in body axes (3,) [m, m/s].")
        .def_property_readonly(
            "quantities", [](const BoundMotion& b) { return quantities_of(*b.body); },
            "Names of the quantities this body has.")
        .def("__repr__", [](const BoundMotion& b) { return "<BodyMotion: " + b.name + ">"; });

    using P = rbdyn::BodyPointMotion;
    py::class_<BoundPoint> point(
        m, "BodyPointMotion",
        "A point fixed in a rigid body of a run, run[handle.point([x, y, z])]; each a method of "
        "time [s].");
    point
        .def("position", of_time<BoundPoint>(&P::position), py::arg("t"), py::arg("side") = after(), "[m], world axes.")
        .def("velocity", of_time<BoundPoint>(&P::velocity), py::arg("t"), py::arg("side") = after(),
             "[m/s], world axes.")
        .def("acceleration", of_time<BoundPoint>(&P::acceleration), py::arg("t"), py::arg("side") = after(),
             "[m/s^2], world axes.")
        .def("__repr__", [](const BoundPoint& p) { return "<BodyPointMotion: " + p.name + ">"; });

    py::class_<BoundCoupling> spring(m, "CouplingMotion",
                                     "Length and force of a coupling of a run, each a method of time [s].");
    spring
        .def("length", of_time<BoundCoupling>(&CouplingMotion::length), py::arg("t"), py::arg("side") = after(),
             "Between its ends [m].")
        .def("force", of_time<BoundCoupling>(&CouplingMotion::force), py::arg("t"), py::arg("side") = after(),
             "On the first end [N], world axes.")
        .def_property_readonly(
            "quantities",
            [](const BoundCoupling&) {
                return std::vector<std::string>{"length", "force"};
            },
            "Names of the quantities a coupling has.")
        .def("__repr__", [](const BoundCoupling& s) { return "<CouplingMotion: " + s.name + ">"; });
}

void bind_constraint_motion(py::module_& m) {
    using M = rbdyn::ConstraintMotion;
    py::class_<BoundConstraint> constraint(m, "ConstraintMotion",
                                           "What a constraint of a run does, each a method of time [s].");
    constraint
        .def("force", of_time<BoundConstraint>(&M::force), py::arg("t"), py::arg("side") = after(),
             "On its first end [N], world axes.")
        .def("torque", of_time<BoundConstraint>(&M::torque), py::arg("t"), py::arg("side") = after(),
             "On its first end, about the point it holds [N m], world axes.")
        .def("gap", of_time<BoundConstraint>(&M::gap), py::arg("t"), py::arg("side") = after(),
             "How far its points are from where they should be [m], angles of its axes at the longest arm of what is "
             "held.")
        .def("__repr__", [](const BoundConstraint& c) { return "<ConstraintMotion: " + c.name + ">"; });
}

struct BoundContact {
    rbdyn::ContactMotion motion;
    std::string name;
};

void bind_contact_motion(py::module_& m) {
    using M = rbdyn::ContactMotion;
    py::class_<BoundContact> contact(m, "ContactMotion", "What a contact of a run does, each a method of time [s].");
    contact
        .def("gap", of_time<BoundContact>(&M::gap), py::arg("t"), py::arg("side") = after(),
             "The distance between the part and the surface [m], negative inside.")
        .def("force", of_time<BoundContact>(&M::force), py::arg("t"), py::arg("side") = after(),
             "On its first side, normal force and friction together [N], world axes.")
        .def("slip", of_time<BoundContact>(&M::slip), py::arg("t"), py::arg("side") = after(),
             "The velocity of the first side's point of contact relative to the second's, along the surface [m/s].")
        .def(
            "state",
            [](const BoundContact& self, const ArrayLike& t, const SideName& name) -> py::object {
                const Side side = side_of(name);
                const Array times = doubles(t, "Trajectory", "time");
                const auto state = [&](double x) { return self.motion.state(x, side); };
                if (times.ndim() == 0) return py::cast(unlocked([&] { return state(*times.data()); }));
                const std::vector<double> list = list_of_doubles(times, "Trajectory", "time");
                const auto words = unlocked([&] {
                    std::vector<std::string> all;
                    for (std::size_t i = 0; i < list.size(); ++i) {
                        if (i % 64 == 0) rbdyn::Interruption::point();
                        all.push_back(state(list[i]));
                    }
                    return all;
                });
                return py::cast(words);
            },
            py::arg("t"), py::arg("side") = after(),
            R"("open", "sticks" or "slides"; a list of them for several times.)")
        .def("__repr__", [](const BoundContact& c) { return "<ContactMotion: " + c.name + ">"; });
}

BoundContact motion_of_contact(const BoundTrajectory& self, const ContactHandle& handle) {
    self.handles->require(handle, "Trajectory");
    return {self.run[rbdyn::ContactHandle{handle.index}], handle.name};
}

BoundConstraint motion_of_constraint(const BoundTrajectory& self, const ConstraintHandle& handle) {
    self.handles->require(handle, "Trajectory");
    return {self.run[rbdyn::ConstraintHandle{handle.index}], handle.name};
}

BoundMotion motion_of_body(const BoundTrajectory& self, const BodyHandle& handle) {
    self.handles->require(handle, "Trajectory");
    const auto& body = self.run.scene().bodies()[static_cast<std::size_t>(handle.index)];
    return {self.run[rbdyn::BodyHandle{handle.index}], &body, handle.name};
}

BoundPoint motion_of_point(const BoundTrajectory& self, const BodyPoint& point) {
    self.handles->require(point.body, "Trajectory");
    return {self.run[rbdyn::BodyPoint{point.body.index, point.point}],
            point.body.name + " at " + list_text(point.point)};
}

BoundCoupling motion_of_coupling(const BoundTrajectory& self, const CouplingHandle& handle) {
    self.handles->require(handle, "Trajectory");
    return {self.run[rbdyn::CouplingHandle{handle.index}], handle.name};
}

/// A watched function of a run, a function of time.
struct BoundWatched {
    Trajectory run;
    rbdyn::WatchHandle watch;
    std::string name;
};

BoundWatched motion_of_watch(const BoundTrajectory& self, const WatchHandle& handle) {
    self.handles->require(handle, "Trajectory");
    return {self.run, {handle.index}, handle.name};
}

py::typing::Never motion_of_load(const BoundTrajectory& self, const LoadHandle& handle) {
    self.handles->require(handle, "Trajectory");
    throw InvalidInput("Trajectory: \"" + handle.name + "\" is a load, which has no motion; ask for its body's force");
}

void bind_watched(py::module_& m) {
    py::class_<BoundWatched>(m, "Watched", "A watched function of a run: its value at a time.")
        .def(
            "value",
            [](const BoundWatched& w, const ArrayLike& t, const SideName& name) {
                const Side side = side_of(name);
                return over(t, "Trajectory", "time", [&](double x) { return w.run.watched(w.watch, x, side); });
            },
            py::arg("t"), py::arg("side") = after(), "At a time [s], a number or an array.")
        .def_property_readonly(
            "quantities", [](const BoundWatched&) { return std::vector<std::string>{"value"}; },
            "Names of the quantities it has.")
        .def("__repr__", [](const BoundWatched& w) { return "<Watched: " + w.name + ">"; });
}

}  // namespace

void bind_motions(py::module_& m) {
    bind_body_motions(m);
    bind_constraint_motion(m);
    bind_contact_motion(m);
    bind_watched(m);
}

void bind_motion_of(py::class_<BoundTrajectory>& run) {
    run.def("__getitem__", &motion_of_body, py::arg("handle"))
        .def("__getitem__", &motion_of_point, py::arg("handle"))
        .def("__getitem__", &motion_of_coupling, py::arg("handle"))
        .def("__getitem__", &motion_of_constraint, py::arg("handle"))
        .def("__getitem__", &motion_of_contact, py::arg("handle"))
        .def("__getitem__", &motion_of_watch, py::arg("handle"))
        .def("__getitem__", &motion_of_load, py::arg("handle"));
}

}  // namespace binding
