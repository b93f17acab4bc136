// Loads on a body.
#include <optional>
#include <rbdyn/scene/loads.hpp>

#include "data.hpp"

namespace binding {

namespace {

using rbdyn::Drag, rbdyn::Force, rbdyn::Frame, rbdyn::Function, rbdyn::Lorentz, rbdyn::Potential, rbdyn::Torque,
    rbdyn::TorsionSpring;

using Number = NumberOrParameter;

/// A function, in Python or by its address; else a vector.
bool is_function(const py::object& f) {
    return PyCallable_Check(f.ptr()) != 0 || py::hasattr(f, "address") ||
           (py::isinstance<py::tuple>(f) && py::hasattr(f, "signature"));
}

const Words<Frame> frames = {{"world", Frame::world}, {"body", Frame::body}};

Force force_of(const VectorOrFunction& f, const std::string& frame, std::optional<bool> trace) {
    const Frame axes = one_of(frame, frames, "Force", "frame");
    if (has_parameters(f)) return Force(function_of_numbers(f, 7, 3, "Force", "f"), shown(f), axes);
    if (!is_function(f)) return Force(vector3(f, "Force", "f"), axes);
    const UserFunction user = user_force(f, trace, "Force");
    return user.callback ? Force(user.callback, axes) : Force(user.function, user.name, axes);
}
Torque torque_of(const VectorOrFunction& f, const std::string& frame, std::optional<bool> trace) {
    const Frame axes = one_of(frame, frames, "Torque", "frame");
    if (has_parameters(f)) return Torque(function_of_numbers(f, 13, 3, "Torque", "f"), shown(f), axes);
    if (!is_function(f)) return Torque(vector3(f, "Torque", "f"), axes);
    const UserFunction user = user_torque(f, trace, "Torque");
    return user.callback ? Torque(user.callback, axes) : Torque(user.function, user.name, axes);
}

/// What a force and a torque have in common: a vector or a function, in axes of the world or of the body.
template <class Load>
void bind_vector_load(py::class_<Load>& load, const std::string& kind, Frame usual, const char* arguments) {
    load.def_property_readonly(
            "name", [](const Load& l) { return l.name(); }, "Of its function.")
        .def_property_readonly(
            "frame", [](const Load& l) { return word_for(l.frame(), frames); }, R"("world" or "body".)")
        .def_property_readonly(
            "traced", [](const Load& l) { return static_cast<bool>(l.function()); },
            "Whether its function is recorded.")
        .def_property_readonly(
            "function",
            [](const Load& l) -> std::optional<Function> {
                return l.function() ? std::optional(l.function()) : std::nullopt;
            },
            arguments)
        .def("__repr__", [kind, usual](const Load& l) {
            const std::string what = l.is_constant() ? list_text(l.constant()) : l.name();
            const std::string axes = l.frame() == usual ? "" : ", frame=\"" + word_for(l.frame(), frames) + "\"";
            return kind + "(" + what + axes + (l.is_constant() ? ")" : l.callback() ? ", called back)" : ", traced)");
        });
    as_data(
        load,
        [kind](const Load& l) -> py::tuple {
            if (l.callback())
                throw py::type_error(kind + ": function \"" + l.name() +
                                     "\" is called back, and only what is traced can be hashed or pickled");
            const std::string axes = word_for(l.frame(), frames);
            if (l.is_constant()) return py::make_tuple(tuple_of(l.constant()), axes);
            return py::make_tuple(l.function(), axes, l.name());
        },
        [kind](const py::tuple& d) {
            const Frame axes = one_of(d[1].cast<std::string>(), frames, kind, "frame");
            if (d.size() == 2) return Load(vector_from(d[0]), axes);
            return Load(d[0].cast<Function>(), d[2].cast<std::string>(), axes);
        });
}

template <class Load>
void bind_joint_load(py::module_& m, const char* name, const char* doc, const char* f_doc) {
    const std::string kind = name;
    py::class_<Load> load(m, name, doc);
    load.def(py::init([kind](const NumberOrFunction& f, std::optional<bool> trace) {
                 if (!is_function(f)) return Load(rbdyn::JointLoad(given(f, kind, "f")));
                 const UserFunction user = user_joint_load(f, trace, kind);
                 return user.callback ? Load(rbdyn::JointLoad(user.callback))
                                      : Load(rbdyn::JointLoad(user.function, user.name));
             }),
             py::arg("f"), py::kw_only(), py::arg("trace") = py::none(), f_doc)
        .def_property_readonly(
            "name", [](const Load& l) { return l.name(); }, "Of its function.")
        .def("__repr__", [kind](const Load& l) {
            return kind + "(" +
                   (l.is_constant() ? text(l.constant()) : l.name() + (l.callback() ? ", called back" : ", traced")) +
                   ")";
        });
    as_data(
        load,
        [kind](const Load& l) -> py::tuple {
            if (l.callback())
                throw py::type_error(kind + ": function \"" + l.name() +
                                     "\" is called back, and only what is traced can be hashed or pickled");
            if (l.is_constant()) return py::make_tuple(to_python(l.constant()));
            return py::make_tuple(l.function(), l.name());
        },
        [](const py::tuple& d) {
            if (d.size() == 1) return Load(rbdyn::JointLoad(given_from(d[0])));
            return Load(rbdyn::JointLoad(d[0].cast<Function>(), d[1].cast<std::string>()));
        });
}

}  // namespace

void bind_loads(py::module_& m) {
    py::class_<Force> force(m, "Force", "A force on a body, constant or a function of time, position and velocity.");
    force.def(
        py::init(&force_of), py::arg("f"), py::kw_only(), py::arg("frame") = "world", py::arg("trace") = py::none(),
        R"(f: a vector [N], numbers of which may be rb.parameter, or f(t, position, velocity) that returns one; with
seven parameters f(t, x, y, z, vx, vy, vz). Position and velocity are those of the point it acts at, world axes. A C function,
void (double t, double *position, double *velocity, double *force), is given as a numba cfunc, a SciPy LowLevelCallable
or a ctypes function pointer.

frame: the axes the force is in, "world", or "body", those of the rigid body it acts on.

trace: by default a function in Python is recorded, and then runs at native speed in every engine; if it cannot be, it is
called back, and plan() says which line is why. True: it must be recorded, else InvalidInput. False: it is called back.
What a function raises while it is called back arrives unchanged, with the partial run as its `.run`.)");
    bind_vector_load(force, "Force", Frame::world,
                     "The recorded function of (t, x, y, z, vx, vy, vz), if there is one.");

    py::class_<Torque> torque(
        m, "Torque", "A torque on a rigid body, constant or a function of time, attitude and angular velocity.");
    torque.def(
        py::init(&torque_of), py::arg("f"), py::kw_only(), py::arg("frame") = "body", py::arg("trace") = py::none(),
        R"(f: a vector [N m], or f(t, rotation_matrix, angular_velocity) that returns one. The matrix (3, 3) turns body axes
into the world's; the angular velocity [rad/s] is in the axes of the torque. A C function, void (double t,
double *rotation_matrix, double *angular_velocity, double *torque) with the matrix row by row, is given as for Force.

frame: the axes the torque is in, "body" or "world". trace: as for Force.)");
    bind_vector_load(torque, "Torque", Frame::body,
                     "The recorded function of t, the matrix row by row, and the angular velocity, if there is one.");

    py::class_<TorsionSpring> torsion(m, "TorsionSpring",
                                      R"(A spring about a hinge, with a damper, between the body and its parent.

Its torque about the axis is -(stiffness (angle - rest_angle) + damping rate).)");
    torsion
        .def(py::init([](const Number& stiffness, const Number& rest_angle, const Number& damping) {
                 const TorsionSpring s{given(stiffness, "TorsionSpring", "stiffness"),
                                       given(rest_angle, "TorsionSpring", "rest_angle"),
                                       given(damping, "TorsionSpring", "damping")};
                 s.validate();
                 return s;
             }),
             py::arg("stiffness"), py::arg("rest_angle") = 0.0, py::arg("damping") = 0.0,
             "stiffness [N m/rad] and damping [N m s], zero or positive; rest_angle [rad].")
        .def_property_readonly(
            "stiffness", [](const TorsionSpring& x) { return to_python(x.stiffness); }, "[N m/rad]")
        .def_property_readonly(
            "rest_angle", [](const TorsionSpring& x) { return to_python(x.rest_angle); }, "[rad]")
        .def_property_readonly(
            "damping", [](const TorsionSpring& x) { return to_python(x.damping); }, "[N m s]")
        .def("__repr__", [](const TorsionSpring& s) {
            return "TorsionSpring(stiffness=" + text(s.stiffness) + ", rest_angle=" + text(s.rest_angle) +
                   ", damping=" + text(s.damping) + ")";
        });
    as_data(
        torsion,
        [](const TorsionSpring& s) {
            return py::make_tuple(to_python(s.stiffness), to_python(s.rest_angle), to_python(s.damping));
        },
        [](const py::tuple& d) {
            return TorsionSpring{given_from(d[0]), given_from(d[1]), given_from(d[2])};
        });

    bind_joint_load<rbdyn::JointTorque>(
        m, "JointTorque", R"(A torque about the axis of a joint: on the body, its opposite on its parent.

Of a hinge, also one that slides or in a plane; of a universal joint about its first axis. No part of the reaction.)",
        "f: a number [N m], or f(t, angle, rate) that returns one. trace: as for Force.");
    bind_joint_load<rbdyn::JointForce>(
        m, "JointForce", R"(A force along a slide: on the body, its opposite on its parent. No part of the reaction.)",
        "f: a number [N], or f(t, displacement, rate) that returns one. trace: as for Force.");

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
        .def(py::init([](const Number& strength, const ArrayLike& field) {
                 const Lorentz l{given(strength, "Lorentz", "strength"), vector3(field, "Lorentz", "field")};
                 l.validate();
                 return l;
             }),
             py::arg("strength"), py::arg("field"),
             "strength: a charge [C], say; field (3,): the field [T], world axes. Their product is in kg/s.")
        .def_property_readonly(
            "strength", [](const Lorentz& x) { return to_python(x.strength); },
            "A charge [C], say; strength times field is in kg/s.")
        .def_property_readonly(
            "field", [](const Lorentz& l) { return to_python(l.field); }, "World axes (3,) [T], say.")
        .def("__repr__", [](const Lorentz& l) {
            return "Lorentz(strength=" + text(l.strength) + ", field=" + list_text(l.field) + ")";
        });
    as_data(
        lorentz,
        [](const Lorentz& l) { return py::make_tuple(to_python(l.strength), l.field[0], l.field[1], l.field[2]); },
        [](const py::tuple& d) {
            return Lorentz{given_from(d[0]), Vector3(d[1].cast<double>(), d[2].cast<double>(), d[3].cast<double>())};
        });

    py::class_<Drag> drag(m, "Drag", "Resistance of a medium at rest: -(linear + quadratic |v|) v.");
    drag.def(py::init([](const Number& linear, const Number& quadratic) {
                 const Drag d{given(linear, "Drag", "linear"), given(quadratic, "Drag", "quadratic")};
                 d.validate();
                 return d;
             }),
             py::arg("linear") = 0.0, py::arg("quadratic") = 0.0, "linear [kg/s], quadratic [kg/m]; zero or positive.")
        .def_property_readonly(
            "linear", [](const Drag& x) { return to_python(x.linear); }, "[kg/s]")
        .def_property_readonly(
            "quadratic", [](const Drag& x) { return to_python(x.quadratic); }, "[kg/m]")
        .def("__repr__",
             [](const Drag& d) { return "Drag(linear=" + text(d.linear) + ", quadratic=" + text(d.quadratic) + ")"; });
    as_data(
        drag, [](const Drag& d) { return py::make_tuple(to_python(d.linear), to_python(d.quadratic)); },
        [](const py::tuple& d) {
            return Drag{given_from(d[0]), given_from(d[1])};
        });
}

}  // namespace binding
