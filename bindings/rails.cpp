// Rails: the guides of particles, and their friction.
#include <optional>
#include <rbdyn/scene/joints.hpp>

#include "data.hpp"

namespace binding {

namespace {

rbdyn::Given dynamic(const rbdyn::Coulomb& c) { return c.mu_dynamic.value_or(c.mu_static); }

}  // namespace

std::string words_of(const rbdyn::Coulomb& c) {
    std::string words = "Coulomb(mu_static=" + text(c.mu_static) + ", mu_dynamic=" + text(dynamic(c));
    if (!c.rolling.is_zero()) words += ", rolling=" + text(c.rolling);
    if (!c.pivoting.is_zero()) words += ", pivoting=" + text(c.pivoting);
    return words + ")";
}

namespace {

py::tuple coulomb_data(const rbdyn::Coulomb& c) {
    return py::make_tuple(to_python(c.mu_static), to_python(dynamic(c)), to_python(c.rolling), to_python(c.pivoting));
}

rbdyn::Coulomb coulomb_from(const py::tuple& d) {
    rbdyn::Coulomb friction{given_from(d[0]), given_from(d[1])};
    if (d.size() > 2) friction.rolling = given_from(d[2]);
    if (d.size() > 3) friction.pivoting = given_from(d[3]);
    return friction;
}

using rbdyn::TimeFunction;

const Words<rbdyn::RailSide> sides = {
    {"both", rbdyn::RailSide::both}, {"+", rbdyn::RailSide::plus}, {"-", rbdyn::RailSide::minus}};
const Words<rbdyn::RailEnds> endings = {{"stop", rbdyn::RailEnds::stop}, {"release", rbdyn::RailEnds::release}};

/// What stays the same of a number, whatever becomes of it.
std::string fixed_text(const rbdyn::Given& number) {
    return number.varies() ? number.parameter().name() : rbdyn::text(number.now());
}

rbdyn::Function recorded(const UserFunction& f) { return f.function; }

TimeFunction speed_of(const py::object& drive) {
    if (has_parameters(drive)) return TimeFunction(function_of_numbers(drive, 1, 1, "Rail", "drive"));
    const bool is_function = PyCallable_Check(drive.ptr()) != 0;
    return is_function ? TimeFunction(recorded(user_time_function(drive, true, "Rail: drive")))
                       : TimeFunction(number(drive, "Rail", "drive"));
}

py::typing::Union<rbdyn::Curve> curve_of(const rbdyn::Rail& rail) {
    return py::reinterpret_steal<py::typing::Union<rbdyn::Curve>>(curve_object(rail.curve()).release());
}

std::optional<Vectors> vector_or_none(const std::optional<rbdyn::Vector3>& v) {
    return v ? std::optional(py::reinterpret_borrow<Vectors>(to_python(*v))) : std::nullopt;
}

}  // namespace

void bind_rails(py::module_& m) {
    using rbdyn::Coulomb, rbdyn::Curve, rbdyn::Rail, rbdyn::RailOptions, rbdyn::RigidMotion;

    py::class_<Coulomb>(m, "Coulomb", R"(Coulomb-Morin friction (eq. 7.23).

Sliding, the tangential reaction is mu_dynamic times the perpendicular one, against the slip; at rest it is whatever
rest needs, up to mu_static times the perpendicular one. In a joint the perpendicular one is what of the whole reaction
lies across its axis.

At contacts torques resist what does not slip: against rolling, the relative angular velocity along the surface, rolling
[m] times the normal force, and against pivoting, the one along its normal, pivoting [m] times it; at rest each is
whatever rest needs, up to that.)")
        .def(py::init([](const NumberOrParameter& mu_static, const std::optional<NumberOrParameter>& mu_dynamic,
                         const NumberOrParameter& rolling, const NumberOrParameter& pivoting) {
                 Coulomb friction{given(mu_static, "Coulomb", "mu_static")};
                 if (mu_dynamic) friction.mu_dynamic = given(*mu_dynamic, "Coulomb", "mu_dynamic");
                 friction.rolling = given(rolling, "Coulomb", "rolling");
                 friction.pivoting = given(pivoting, "Coulomb", "pivoting");
                 friction.validate();
                 return friction;
             }),
             py::arg("mu_static"), py::arg("mu_dynamic") = py::none(), py::arg("rolling") = 0.0,
             py::arg("pivoting") = 0.0,
             "mu_static: zero or positive. mu_dynamic: at most mu_static, and equal to it by default. rolling, "
             "pivoting: "
             "lengths [m], zero or positive, of contacts alone.")
        .def_property_readonly(
            "mu_static", [](const Coulomb& c) { return to_python(c.mu_static); }, "At rest.")
        .def_property_readonly(
            "mu_dynamic", [](const Coulomb& c) { return to_python(dynamic(c)); }, "Sliding.")
        .def_property_readonly(
            "rolling", [](const Coulomb& c) { return to_python(c.rolling); }, "Torque against rolling over N [m].")
        .def_property_readonly(
            "pivoting", [](const Coulomb& c) { return to_python(c.pivoting); }, "Torque against pivoting over N [m].")
        .def("__eq__",
             [](const Coulomb& a, const py::object& b) {
                 if (!py::isinstance<Coulomb>(b)) return false;
                 return a == b.cast<const Coulomb&>();
             })
        .def(py::pickle([](const Coulomb& c) { return coulomb_data(c); },
                        [](const py::tuple& d) { return coulomb_from(d); }))
        .def("__hash__",
             [](const Coulomb& c) {
                 return py::hash(py::make_tuple(fixed_text(c.mu_static), fixed_text(dynamic(c)), fixed_text(c.rolling),
                                                fixed_text(c.pivoting)));
             })
        .def("__repr__", [](const Coulomb& c) { return words_of(c); });

    py::class_<Rail>(m, "Rail", R"(A guide along a curve, smooth or rough (eqs. 7.7-7.17, 7.23-7.26).

A body on it starts with parameter or arc_length [m], and speed = ds/dt along the curve as placed [m/s]. Slip, and with
it reverse, stick and slip events, is speed - drive.)")
        .def(py::init([](const Curve& curve, const std::optional<Coulomb>& friction, const NumberOrFunction& drive,
                         const MotionOrNone& motion, const std::string& side, const std::string& ends,
                         const std::optional<ArrayLike>& up) {
                 RailOptions options;
                 options.drive = speed_of(drive);
                 if (!motion.is_none())
                     options.motion = RigidMotion(recorded(user_motion(motion, true, "Rail: motion")));
                 options.side = one_of(side, sides, "Rail", "side");
                 options.ends = one_of(ends, endings, "Rail", "ends");
                 if (up) options.up = vector3(*up, "Rail", "up");
                 return Rail(curve, friction, options);
             }),
             py::arg("curve"), py::kw_only(), py::arg("friction") = py::none(), py::arg("drive") = 0.0,
             py::arg("motion") = py::none(), py::arg("side") = "both", py::arg("ends") = "stop",
             py::arg("up") = py::none(),
             R"(friction: Coulomb, or none.

drive: the speed with which the rail's surface slides along itself [m/s], a number or a function of time [s]; the curve
stays.

motion: a rigid motion of the rail itself, a function of time that returns a displacement (3,) [m], a rotation matrix
(3, 3), a pair of them, or a homogeneous matrix (4, 4); the curve is where it was given for no displacement and no
rotation. The reaction then has power, also without friction (Theorem 7.7 needs a rail at rest).

side: "both", or "+" or "-" for a rail that only pushes, along the curve's normal or against it: the normal on the side
of up where the body starts, or else that of Frenet's axes there (of a straight rail the one nearest to world z, or to
world x if it is vertical), carried on continuously; push_direction(parameter) shows it. Pulled away, the body leaves
("detach") and flies; where it meets the curve again from that side it lands ("land") and keeps its velocity along the
curve. For plane curves at rest.

ends: "stop", the run ends where the body reaches an end of the curve, or "release", it goes on freely.

up: a direction (3,), world axes, on the "+" side of the curve where the body starts; of a straight rail, the part of up
across it is the direction in which side "+" pushes.

Functions are recorded: called before anything runs, with expressions. Raises InvalidInput if they cannot be.)")
        .def_property_readonly(
            "curve", [](const Rail& rail) { return curve_of(rail); }, "What it follows.")
        .def_property_readonly("friction", &Rail::friction, "Friction, if any of its coefficients is not zero.")
        .def(
            "drive",
            [](const Rail& rail, const ArrayLike& t) {
                return finite_over(
                    t, "Rail", "time", "drive", [&](double x) { return rail.drive()(x); },
                    [] { return std::string("a drive is finite while it is followed; give another time, in s"); });
            },
            py::arg("t"), "The speed of the rail's surface along itself at a time [m/s].")
        .def_property_readonly(
            "side", [](const Rail& rail) { return word_for(rail.side(), sides); }, R"("both", "+" or "-".)")
        .def_property_readonly(
            "ends", [](const Rail& rail) { return word_for(rail.ends(), endings); }, R"("stop" or "release".)")
        .def_property_readonly(
            "up", [](const Rail& rail) { return vector_or_none(rail.up()); },
            "A direction on the \"+\" side where the body starts, (3,) world axes; None if none was given.")
        .def(
            "push_direction", [](const Rail& rail, double parameter) { return vector_or_none(rail.pushes(parameter)); },
            py::arg("parameter"),
            R"(The way the rail pushes a body that starts at a parameter: a unit vector (3,), world axes.

None if it holds on both sides. Raises InvalidInput if its curve is not plane, or up says no side there.)")
        .def_property_readonly(
            "moves", [](const Rail& rail) { return rail.motion().present(); }, "Whether the rail itself moves.")
        .def("__eq__",
             [](const Rail& a, const py::object& b) { return py::isinstance<Rail>(b) && a == b.cast<const Rail&>(); })
        .def("__hash__", [](const Rail& rail) { return py::hash(curve_object(rail.curve())); })
        .def(py::pickle(
            [](const Rail& rail) {
                const py::object drive = rail.drive().is_constant() ? py::object(py::float_(rail.drive().constant()))
                                                                    : py::cast(rail.drive().function());
                const py::object motion = rail.motion().present() ? py::cast(rail.motion().function()) : py::none();
                return py::make_tuple(curve_object(rail.curve()), rail.friction(), drive, motion,
                                      word_for(rail.side(), sides), word_for(rail.ends(), endings),
                                      vector_or_none(rail.up()));
            },
            [](const py::tuple& d) {
                RailOptions options;
                options.drive = py::isinstance<rbdyn::Function>(d[2]) ? TimeFunction(d[2].cast<rbdyn::Function>())
                                                                      : TimeFunction(d[2].cast<double>());
                if (!d[3].is_none()) options.motion = RigidMotion(d[3].cast<rbdyn::Function>());
                options.side = one_of(d[4].cast<std::string>(), sides, "Rail", "side");
                options.ends = one_of(d[5].cast<std::string>(), endings, "Rail", "ends");
                if (!d[6].is_none()) options.up = vector3(d[6], "Rail", "up");
                return Rail(d[0].cast<const Curve&>(), d[1].cast<std::optional<Coulomb>>(), options);
            }))
        .def("__repr__", [](const Rail& rail) {
            std::string result = "Rail(" + std::string(py::repr(curve_object(rail.curve())));
            if (const auto friction = rail.friction())
                result += ", friction=" + std::string(py::repr(py::cast(*friction)));
            if (!rail.drive().is_zero())
                result += ", drive=" +
                          (rail.drive().is_constant() ? rbdyn::text(rail.drive().constant()) : "function of time");
            if (rail.motion().present()) result += ", motion=function of time";
            if (rail.side() != rbdyn::RailSide::both) result += ", side=\"" + word_for(rail.side(), sides) + "\"";
            if (rail.up()) result += ", up=" + list_text(*rail.up());
            if (rail.ends() != rbdyn::RailEnds::stop) result += ", ends=\"" + word_for(rail.ends(), endings) + "\"";
            return result + ")";
        });
}

}  // namespace binding
