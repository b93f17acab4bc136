// The heavy body in Euler angles, and the run of its state; simulate() of it is in verbs.cpp.
#include <cmath>
#include <rbdyn/model/euler_top.hpp>
#include <rbdyn/own_motion.hpp>
#include <rbdyn/trajectory/run_bytes.hpp>

#include "run.hpp"

namespace binding {

using rbdyn::EulerTop, rbdyn::StateRun;

namespace {

Vectors states(const StateRun& run, const ArrayLike& times, const SideName& name) {
    const rbdyn::Side side = side_of(name);
    return states_over(times, run.variables(), "StateRun", [&](double t) { return run.state(t, side); });
}

/// A state is six finite numbers.
void require_state(const std::vector<double>& x) {
    for (std::size_t i = 0; i < x.size(); ++i)
        rbdyn::require(std::isfinite(x[i]), "EulerTop", "variable " + std::to_string(i) + " of the state", x[i],
                       "it is finite: angles in rad, rates in rad/s, which have no bound where sin theta is 0; start "
                       "elsewhere, or give the body to a Scene, which is computed in quaternions");
}

}  // namespace

void bind_euler_top(py::module_& m) {
    py::class_<EulerTop>(m, "EulerTop",
                         R"(A heavy rigid body with a fixed point in Euler angles (7.50-7.52, 7.58), for teaching.

simulate(top, top.state(angles, angular_velocity), until) runs it; a state is (theta, psi, phi, theta', psi', phi')
[rad, rad/s]. Euler angles fail at theta = 0 and pi, where the motion does not: a run ends where |sin theta| falls to
`least`, status "stopped by event", the event "sin theta too small for Euler angles". A body of a Scene is computed in
quaternions and goes on.)")
        .def(py::init([](const rbdyn::RigidBody& body, double gravity, const ArrayLike& point, double least) {
                 return EulerTop(body, gravity, vector3(point, "EulerTop", "point"), least);
             }),
             py::arg("body"), py::arg("gravity"), py::arg("point") = py::make_tuple(0.0, 0.0, 0.0), py::kw_only(),
             py::arg("least") = EulerTop::default_least,
             R"(gravity [m/s^2], along -z of the world; point (3,), the one that is held, in body axes [m].

The body's axes are principal at that point. Raises InvalidInput for others.)")
        .def_static(
            "state",
            [](const rbdyn::EulerAngles& angles, const ArrayLike& angular_velocity) {
                const std::vector<double> x =
                    EulerTop::state(angles, finite_vector3(angular_velocity, "EulerTop", "angular_velocity"));
                require_state(x);
                return py::array_t<double>(static_cast<py::ssize_t>(x.size()), x.data());
            },
            py::arg("angles"), py::arg("angular_velocity"),
            "The state (6,) of EulerAngles and an angular velocity in body axes (3,) [rad/s].")
        .def(
            "rates",
            [](const EulerTop& top, const ArrayLike& state) {
                const std::vector<double> x = list_of_doubles(state, "EulerTop", "state");
                rbdyn::require(x.size() == 6, "EulerTop", "number of variables of the state",
                               static_cast<double>(x.size()), "it has six, theta, psi, phi and their rates");
                require_state(x);
                py::array_t<double> rate(6);
                const std::span<double> rates(rate.mutable_data(), 6);
                top(0.0, std::span<const double>(x), rates);
                for (const double r : rates)
                    rbdyn::require(
                        std::isfinite(r), "EulerTop", "a rate where sin theta is " + rbdyn::text(std::sin(x[0])), r,
                        "Euler angles fail where that is 0, or numbers leave doubles; give another state, or "
                        "the body to a Scene, which is computed in quaternions");
                return rate;
            },
            py::arg("state"), "The derivative (6,) of a state (6,) in time: the right side of the equations.")
        .def("__repr__", [](const EulerTop&) { return "<EulerTop>"; });

    py::class_<StateRun>(m, "StateRun",
                         "The motion of a model that is no scene: its state at any time. print() shows it.")
        .def_property_readonly(
            "status", [](const StateRun& r) { return name_of(r.status()); },
            "reached end, stopped by event, stopped by user, step limit, not finite, accuracy not reached or "
            "inconsistent.")
        .def_property_readonly(
            "advice", [](const StateRun& r) { return advice(r.status()); }, "What to do about the status.")
        .def_property_readonly("start", &StateRun::start, "[s]")
        .def_property_readonly("end", &StateRun::end, "[s]")
        .def_property_readonly("certain_until", &StateRun::certain_until,
                               "The time up to which the motion is as accurate as asked for [s].")
        .def_property_readonly("engine", &StateRun::engine, "What computed it.")
        .def_property_readonly("error", &StateRun::error,
                               "Estimated global error, each variable relative to its own scale; None with rtol.")
        .def_property_readonly(
            "events",
            [](const StateRun& r) {
                std::vector<BoundEvent> events;
                for (const rbdyn::Event& e : r.events()) events.push_back({e, std::nullopt});
                return events;
            },
            "A list of Event in order of time.")
        .def("state", &states, py::arg("t"), py::arg("side") = after(),
             R"(The variables at a time [s], or at each of an array of times; they come last.

side: at a jump the state "after" it, or "before". Raises InvalidInput for a time the run does not hold.)")
        .def(py::pickle([](const StateRun& r) { return py::bytes(rbdyn::bytes_of(r)); },
                        [](const py::bytes& d) { return rbdyn::state_run_from(std::string(d)); }))
        .def("__str__", &printed<StateRun>)
        .def("__repr__", [](const StateRun& r) {
            return "<StateRun: " + std::string(name_of(r.status())) + " at t = " + rbdyn::text(r.end()) + " s>";
        });
}

}  // namespace binding
