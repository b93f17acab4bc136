// Loads on a body, and couplings between two.
#include <optional>
#include <rbdyn/scene/couplings.hpp>
#include <rbdyn/scene/loads.hpp>

#include "binding.hpp"

namespace binding {

namespace {

using rbdyn::Drag, rbdyn::Force, rbdyn::Function, rbdyn::Lorentz, rbdyn::Potential, rbdyn::Spring, rbdyn::text;

/// A function, in Python or by its address; else a vector.
bool is_function(const py::object& f) {
    return PyCallable_Check(f.ptr()) != 0 || py::hasattr(f, "address") ||
           (py::isinstance<py::tuple>(f) && py::hasattr(f, "signature"));
}

Force force_of(const VectorOrFunction& f, const std::string& frame, std::optional<bool> trace) {
    if (frame != "world")
        throw InvalidInput("Force: frame is \"" + frame + "\"; it is \"world\", a particle has no axes of its own");
    if (!is_function(f)) return Force(vector3(f, "Force", "f"));
    const UserFunction user = user_force(f, trace, "Force");
    return user.callback ? Force(user.callback) : Force(user.function, user.name);
}

/// Adds ==, hash and pickling by the tuple of what it is made of.
template <class Load, class Parts, class Make>
void as_data(py::class_<Load>& type, Parts parts, Make make) {
    type.def("__eq__",
             [](const Load& a, const py::object& b) { return py::isinstance<Load>(b) && a == b.cast<const Load&>(); })
        .def("__hash__", [parts](const Load& a) { return py::hash(parts(a)); })
        .def(py::pickle([parts](const Load& a) { return parts(a); }, [make](const py::tuple& d) { return make(d); }));
}

}  // namespace

void bind_loads(py::module_& m) {
    py::class_<Force> force(m, "Force", "A force on a body, constant or a function of time, position and velocity.");
    force
        .def(py::init(&force_of), py::arg("f"), py::kw_only(), py::arg("frame") = "world",
             py::arg("trace") = py::none(),
             R"(f: a vector [N], world axes, or f(t, position, velocity) that returns one; with seven parameters
f(t, x, y, z, vx, vy, vz). A C function, void (double t, double *position, double *velocity, double *force), is given as
a numba cfunc, a SciPy LowLevelCallable or a ctypes function pointer.

trace: by default a function in Python is recorded, and then runs at native speed in every engine; if it cannot be, it is
called back, and plan() says which line is why. True: it must be recorded, else InvalidInput. False: it is called back.
What a function raises while it is called back arrives unchanged, with the partial run as its `.run`.)")
        .def_property_readonly("name", &Force::name, "Of its function.")
        .def_property_readonly(
            "traced", [](const Force& f) { return static_cast<bool>(f.function()); },
            "Whether its function is recorded.")
        .def_property_readonly(
            "function",
            [](const Force& f) -> std::optional<Function> {
                return f.function() ? std::optional(f.function()) : std::nullopt;
            },
            "The recorded function of (t, x, y, z, vx, vy, vz), if there is one.")
        .def("__repr__", [](const Force& f) {
            if (f.is_constant()) return "Force(" + list_text(f.constant()) + ")";
            return "Force(" + f.name() + (f.callback() ? ", called back)" : ", traced)");
        });
    as_data(
        force,
        [](const Force& f) -> py::tuple {
            if (f.callback())
                throw py::type_error("Force: function \"" + f.name() +
                                     "\" is called back, and only what is traced can be "
                                     "hashed or pickled");
            if (f.is_constant()) return py::make_tuple(f.constant()[0], f.constant()[1], f.constant()[2]);
            return py::make_tuple(f.function(), f.name());
        },
        [](const py::tuple& d) {
            if (d.size() == 3) return Force(Vector3(d[0].cast<double>(), d[1].cast<double>(), d[2].cast<double>()));
            return Force(d[0].cast<Function>(), d[1].cast<std::string>());
        });

    py::class_<Potential> potential(m, "Potential", R"(A force by its potential: F = +grad U (the chapter's sign).

The gradient is exact: it is derived from the recorded function.)");
    potential
        .def(py::init([](const py::object& f) {
                 const UserFunction user = user_potential(f, true, "Potential");
                 return Potential(user.function, user.name);
             }),
             py::arg("U"),
             R"(U: U(position), or U(x, y, z), in J; world axes. It is recorded: called once, with an array
of three expressions. Raises InvalidInput if it cannot be; then a Force may take its place.)")
        .def_property_readonly("name", &Potential::name, "Of its function.")
        .def_property_readonly("function", &Potential::function, "The recorded function of (x, y, z).")
        .def("__repr__", [](const Potential& p) { return "Potential(" + p.name() + ", traced)"; });
    as_data(
        potential, [](const Potential& p) { return py::make_tuple(p.function(), p.name()); },
        [](const py::tuple& d) { return Potential(d[0].cast<Function>(), d[1].cast<std::string>()); });

    py::class_<Lorentz> lorentz(m, "Lorentz",
                                "A force across the velocity, strength v x field: that of a uniform magnetic field.");
    lorentz
        .def(py::init([](double strength, const ArrayLike& field) {
                 const Lorentz l{strength, vector3(field, "Lorentz", "field")};
                 l.validate();
                 return l;
             }),
             py::arg("strength"), py::arg("field"),
             "strength: a charge [C], say; field (3,): the field [T], world axes. Their product is in kg/s.")
        .def_readonly("strength", &Lorentz::strength)
        .def_property_readonly("field", [](const Lorentz& l) { return to_python(l.field); })
        .def("__repr__", [](const Lorentz& l) {
            return "Lorentz(strength=" + text(l.strength) + ", field=" + list_text(l.field) + ")";
        });
    as_data(
        lorentz, [](const Lorentz& l) { return py::make_tuple(l.strength, l.field[0], l.field[1], l.field[2]); },
        [](const py::tuple& d) {
            return Lorentz{d[0].cast<double>(), Vector3(d[1].cast<double>(), d[2].cast<double>(), d[3].cast<double>())};
        });

    py::class_<Drag> drag(m, "Drag", "Resistance of a medium at rest: -(linear + quadratic |v|) v.");
    drag.def(py::init([](double linear, double quadratic) {
                 const Drag d{linear, quadratic};
                 d.validate();
                 return d;
             }),
             py::arg("linear") = 0.0, py::arg("quadratic") = 0.0, "linear [kg/s], quadratic [kg/m]; zero or positive.")
        .def_readonly("linear", &Drag::linear, "[kg/s]")
        .def_readonly("quadratic", &Drag::quadratic, "[kg/m]")
        .def("__repr__",
             [](const Drag& d) { return "Drag(linear=" + text(d.linear) + ", quadratic=" + text(d.quadratic) + ")"; });
    as_data(
        drag, [](const Drag& d) { return py::make_tuple(d.linear, d.quadratic); },
        [](const py::tuple& d) {
            return Drag{d[0].cast<double>(), d[1].cast<double>()};
        });

    py::class_<Spring> spring(m, "Spring", R"(A spring with a damper along it.

-(stiffness (length - rest_length) + damping d(length)/dt) along the line of its ends.)");
    spring
        .def(py::init([](double stiffness, double rest_length, double damping) {
                 const Spring s{stiffness, rest_length, damping};
                 s.validate();
                 return s;
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
    as_data(
        spring, [](const Spring& s) { return py::make_tuple(s.stiffness, s.rest_length, s.damping); },
        [](const py::tuple& d) {
            return Spring{d[0].cast<double>(), d[1].cast<double>(), d[2].cast<double>()};
        });
}

}  // namespace binding
