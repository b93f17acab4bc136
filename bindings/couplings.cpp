// Couplings: forces between two bodies, or between a body and a point of the world.
#include <optional>
#include <rbdyn/scene/couplings.hpp>

#include "data.hpp"

namespace binding {

namespace {

using rbdyn::Central, rbdyn::Function, rbdyn::Gravitation, rbdyn::OwnFunction, rbdyn::PairForce, rbdyn::Spring;

using Number = NumberOrParameter;

template <class Law>
Law law_of(const UserFunction& user) {
    return user.callback ? Law(user.callback) : Law(user.function, user.name);
}

/// What a central force and a pair force have in common: a function of the user's.
template <class Law>
void bind_own_law(py::class_<Law>& law, const std::string& kind, const char* arguments) {
    law.def_property_readonly(
           "name", [](const Law& l) { return l.law().name(); }, "Of its function.")
        .def_property_readonly(
            "traced", [](const Law& l) { return static_cast<bool>(l.law().function()); },
            "Whether its function is recorded.")
        .def_property_readonly(
            "function",
            [](const Law& l) -> std::optional<Function> {
                return l.law().function() ? std::optional(l.law().function()) : std::nullopt;
            },
            arguments)
        .def("__repr__", [kind](const Law& l) {
            if (!l.law()) return kind + "(nothing)";
            return kind + "(" + l.law().name() + (l.law().callback() ? ", called back)" : ", traced)");
        });
    as_data(
        law,
        [kind](const Law& l) -> py::tuple {
            if (!l.law()) return py::tuple();
            if (l.law().callback())
                throw py::type_error(kind + ": function \"" + l.law().name() +
                                     "\" is called back, and only what is traced can be hashed or pickled");
            return py::make_tuple(l.law().function(), l.law().name());
        },
        [](const py::tuple& d) { return d.empty() ? Law() : Law(d[0].cast<Function>(), d[1].cast<std::string>()); });
}

}  // namespace

void bind_couplings(py::module_& m) {
    py::class_<Spring> spring(m, "Spring", R"(A spring with a damper along it.

-(stiffness (length - rest_length) + damping d(length)/dt) along the line of its ends.)");
    spring
        .def(py::init([](const Number& stiffness, const Number& rest_length, const Number& damping) {
                 const Spring s{given(stiffness, "Spring", "stiffness"), given(rest_length, "Spring", "rest_length"),
                                given(damping, "Spring", "damping")};
                 s.validate();
                 return s;
             }),
             py::arg("stiffness"), py::arg("rest_length") = 0.0, py::arg("damping") = 0.0,
             "stiffness [N/m], rest_length [m], damping [kg/s]; zero or positive.")
        .def_property_readonly(
            "stiffness", [](const Spring& x) { return to_python(x.stiffness); }, "[N/m]")
        .def_property_readonly(
            "rest_length", [](const Spring& x) { return to_python(x.rest_length); }, "[m]")
        .def_property_readonly(
            "damping", [](const Spring& x) { return to_python(x.damping); }, "[kg/s]")
        .def("__repr__", [](const Spring& s) {
            return "Spring(stiffness=" + text(s.stiffness) + ", rest_length=" + text(s.rest_length) +
                   ", damping=" + text(s.damping) + ")";
        });
    as_data(
        spring,
        [](const Spring& s) {
            return py::make_tuple(to_python(s.stiffness), to_python(s.rest_length), to_python(s.damping));
        },
        [](const py::tuple& d) {
            return Spring{given_from(d[0]), given_from(d[1]), given_from(d[2])};
        });

    py::class_<Gravitation> gravitation(m, "Gravitation", R"(The attraction of two bodies.

constant m_a m_b / r^2, between their centres of mass. A point of the world has no mass; it takes Central.)");
    gravitation
        .def(py::init([](const Number& constant) {
                 const Gravitation g{given(constant, "Gravitation", "constant")};
                 g.validate();
                 return g;
             }),
             py::arg("constant"), "constant [m^3/(kg s^2)], zero or positive.")
        .def_property_readonly(
            "constant", [](const Gravitation& x) { return to_python(x.constant); }, "[m^3/(kg s^2)]")
        .def("__repr__", [](const Gravitation& g) { return "Gravitation(constant=" + text(g.constant) + ")"; });
    as_data(
        gravitation, [](const Gravitation& g) { return py::make_tuple(to_python(g.constant)); },
        [](const py::tuple& d) { return Gravitation{given_from(d[0])}; });

    py::class_<Central> central(m, "Central", R"(A force along the line of its ends, a function of their distance.

Its energy is found by quadrature, zero at the distance that the run starts with.)");
    central.def(py::init([](const py::object& f, std::optional<bool> trace) {
                    return law_of<Central>(user_central(f, trace, "Central"));
                }),
                py::arg("f"), py::kw_only(), py::arg("trace") = py::none(),
                R"(f: f(distance) -> N; positive pushes apart. A C function is double (double distance).

trace: as for Force.)");
    bind_own_law(central, "Central", "The recorded function of the distance, if there is one.");

    py::class_<PairForce> pair(m, "PairForce",
                               R"(Any force between two bodies: one on the first, its opposite on the second.

It keeps momentum. It need not be along the line of its ends, and then does not keep angular momentum.)");
    pair.def(
        py::init([](const py::object& f, std::optional<bool> trace) {
            return law_of<PairForce>(user_pair_force(f, trace, "PairForce"));
        }),
        py::arg("f"), py::kw_only(), py::arg("trace") = py::none(),
        R"(f: f(t, r_a, r_b, v_a, v_b) -> the force on the first end (3,) [N]; places and velocities in world axes. With
thirteen parameters they are numbers. A C function is void (double t, double *r_a, double *r_b, double *v_a, double *v_b,
double *force).

trace: as for Force.)");
    bind_own_law(pair, "PairForce",
                 "The recorded function of (t, r_a, r_b, v_a, v_b), thirteen numbers, if there is one.");
}

}  // namespace binding
