// Bodies and joints: what moves, and how it may.
#include <optional>
#include <rbdyn/body/particle.hpp>
#include <rbdyn/scene/joints.hpp>

#include "binding.hpp"

namespace binding {

void bind_joints(py::module_& m) {
    using rbdyn::Coulomb, rbdyn::Curve, rbdyn::Free, rbdyn::Particle, rbdyn::Rail, rbdyn::text, rbdyn::TimeFunction;

    py::class_<Particle>(m, "Particle", "A material point.")
        .def(py::init([](double mass) {
                 const Particle particle{mass};
                 particle.validate();
                 return particle;
             }),
             py::arg("mass"), "mass [kg], positive and finite.")
        .def_readonly("mass", &Particle::mass, "[kg]")
        .def("__eq__",
             [](const Particle& a, const py::object& b) {
                 return py::isinstance<Particle>(b) && a.mass == b.cast<const Particle&>().mass;
             })
        .def("__hash__", [](const Particle& p) { return py::hash(py::float_(p.mass)); })
        .def("__repr__", [](const Particle& p) { return "Particle(mass=" + text(p.mass) + ")"; });

    py::class_<Free>(m, "Free",
                     "No constraint. A particle then starts with position [m] and velocity [m/s], world axes.")
        .def(py::init<>())
        .def("__eq__", [](const Free&, const py::object& b) { return py::isinstance<Free>(b); })
        .def("__hash__", [](const Free&) { return 1; })
        .def("__repr__", [](const Free&) { return "Free()"; });

    py::class_<Coulomb>(m, "Coulomb", R"(Coulomb-Morin friction (eq. 7.23).

Sliding, the tangential reaction is mu_dynamic times the perpendicular one, against the slip; at rest it is whatever
rest needs, up to mu_static times the perpendicular one.)")
        .def(py::init([](double mu_static, std::optional<double> mu_dynamic) {
                 const Coulomb friction{mu_static, mu_dynamic};
                 friction.validate();
                 return friction;
             }),
             py::arg("mu_static"), py::arg("mu_dynamic") = py::none(),
             "mu_static: zero or positive. mu_dynamic: at most mu_static, and equal to it by default.")
        .def_readonly("mu_static", &Coulomb::mu_static)
        .def_property_readonly("mu_dynamic", &Coulomb::dynamic)
        .def("__eq__",
             [](const Coulomb& a, const py::object& b) {
                 if (!py::isinstance<Coulomb>(b)) return false;
                 const auto& c = b.cast<const Coulomb&>();
                 return a.mu_static == c.mu_static && a.dynamic() == c.dynamic();
             })
        .def("__hash__", [](const Coulomb& c) { return py::hash(py::make_tuple(c.mu_static, c.dynamic())); })
        .def("__repr__", [](const Coulomb& c) {
            return "Coulomb(mu_static=" + text(c.mu_static) + ", mu_dynamic=" + text(c.dynamic()) + ")";
        });

    py::class_<Rail>(m, "Rail", R"(A bilateral guide along a curve, smooth or rough (eqs. 7.7-7.17, 7.23-7.26).

A body on it starts with parameter or arc_length [m], and speed = ds/dt along the curve as placed [m/s]. Slip, and with
it reverse, stick and slip events, is speed - drive.)")
        .def(
            py::init([](const Curve& curve, const std::optional<Coulomb>& friction, const NumberOrFunction& drive,
                        const std::string& ends) {
                if (ends != "stop")
                    throw InvalidInput("Rail: ends is \"" + ends +
                                       "\"; the end of a curve stops the run, so it is \"stop\"");
                const TimeFunction speed = PyCallable_Check(drive.ptr()) != 0
                                               ? recorded_time_function(drive, "Rail: drive")
                                               : TimeFunction(number(drive, "Rail", "drive"));
                return Rail(curve, friction, {.drive = speed});
            }),
            py::arg("curve"), py::kw_only(), py::arg("friction") = py::none(), py::arg("drive") = 0.0,
            py::arg("ends") = "stop",
            R"(friction: Coulomb, or none. drive: the speed with which the rail's surface slides along itself [m/s], a number or
a function of time [s]; the curve stays. ends: "stop", the run ends where the body reaches an end of the curve.

A function is called once, with an Expression, and recorded. Raises InvalidInput if it cannot be.)")
        .def_property_readonly("curve", &Rail::curve)
        .def_property_readonly("friction", &Rail::friction, "Friction, if any of its coefficients is not zero.")
        .def(
            "drive",
            [](const Rail& rail, const ArrayLike& t) {
                return over(t, "Rail", "time", [&](double x) { return rail.drive()(x); });
            },
            py::arg("t"), "The speed of the rail's surface along itself at a time [m/s].")
        .def("__repr__", [](const Rail& rail) {
            std::string result = "Rail(" + std::string(py::repr(py::cast(rail.curve())));
            if (const auto friction = rail.friction())
                result += ", friction=" + std::string(py::repr(py::cast(*friction)));
            if (!rail.drive().is_zero())
                result +=
                    ", drive=" + (rail.drive().is_constant() ? text(rail.drive().constant()) : "function of time");
            return result + ")";
        });
}

}  // namespace binding
