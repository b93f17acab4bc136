// Loads on a body, and couplings between two.
#include <rbdyn/scene/couplings.hpp>
#include <rbdyn/scene/loads.hpp>

#include "binding.hpp"

namespace binding {

void bind_loads(py::module_& m) {
    using rbdyn::Drag, rbdyn::Force, rbdyn::Spring, rbdyn::text;

    py::class_<Force>(m, "Force", "A force on a body, constant or a function of time, position and velocity.")
        .def(py::init([](const VectorOrFunction& f, const std::string& frame) {
                 if (frame != "world")
                     throw InvalidInput("Force: frame is \"" + frame +
                                        "\"; it is \"world\", a particle has no axes of its own");
                 if (PyCallable_Check(f.ptr()) != 0) return Force(recorded_force(f, "Force"));
                 return Force(vector3(f, "Force", "f"));
             }),
             py::arg("f"), py::kw_only(), py::arg("frame") = "world",
             R"(f: a vector [N], world axes, or f(t, position, velocity) that returns one.

A function is called once, with an Expression and two arrays of three, and recorded. Raises InvalidInput if it cannot
be.)")
        .def("__repr__", [](const Force& f) {
            return f.is_constant() ? "Force(" + list_text(f.constant()) + ")"
                                   : "Force(function of t, position, velocity)";
        });

    py::class_<Drag>(m, "Drag", "Resistance of a medium at rest: -(linear + quadratic |v|) v.")
        .def(py::init([](double linear, double quadratic) {
                 const Drag drag{linear, quadratic};
                 drag.validate();
                 return drag;
             }),
             py::arg("linear") = 0.0, py::arg("quadratic") = 0.0, "linear [kg/s], quadratic [kg/m]; zero or positive.")
        .def_readonly("linear", &Drag::linear, "[kg/s]")
        .def_readonly("quadratic", &Drag::quadratic, "[kg/m]")
        .def("__repr__",
             [](const Drag& d) { return "Drag(linear=" + text(d.linear) + ", quadratic=" + text(d.quadratic) + ")"; });

    py::class_<Spring>(m, "Spring", R"(A spring with a damper along it.

-(stiffness (length - rest_length) + damping d(length)/dt) along the line of its ends.)")
        .def(py::init([](double stiffness, double rest_length, double damping) {
                 const Spring spring{stiffness, rest_length, damping};
                 spring.validate();
                 return spring;
             }),
             py::arg("stiffness"), py::arg("rest_length") = 0.0, py::arg("damping") = 0.0,
             "stiffness [N/m], rest_length [m], damping [kg/s]; zero or positive.")
        .def_readonly("stiffness", &Spring::stiffness, "[N/m]")
        .def_readonly("rest_length", &Spring::rest_length, "[m]")
        .def_readonly("damping", &Spring::damping, "[kg/s]")
        .def("__repr__", [](const Spring& s) {
            return "Spring(stiffness=" + text(s.stiffness) + ", rest_length=" + text(s.rest_length) +
                   ", damping=" + text(s.damping) + ")";
        });
}

}  // namespace binding
