// What can be said of a motion without torque before it is computed.
#include <algorithm>
#include <cstdint>
#include <limits>
#include <rbdyn/closed_form/poinsot_motion.hpp>

#include "data.hpp"

namespace binding {

using rbdyn::PoinsotMotion, rbdyn::RigidBody;

namespace {

/// Of a way.
int counted(std::int64_t count) {
    constexpr int most = std::numeric_limits<int>::max();
    rbdyn::require(count <= most, "PoinsotMotion", "count", static_cast<double>(count),
                   "a way has at most " + std::to_string(most) + " points; ask for fewer");
    return static_cast<int>(std::max<std::int64_t>(count, 0));
}

}  // namespace

void bind_poinsot(py::module_& m) {
    py::class_<PoinsotMotion>(m, "PoinsotMotion", R"(The motion of a rigid body without torque (Def. 7.2, 7.53-7.56).

About the centre of mass of a free body, or about a point of it that is held where no moment acts. Body axes; the
world's are those of the body at the start.)")
        .def(py::init(
                 [](const RigidBody& body, const ArrayLike& angular_velocity, const std::optional<ArrayLike>& point) {
                     std::optional<Vector3> at;
                     if (point) at = vector3(*point, "PoinsotMotion", "point");
                     return PoinsotMotion(body, vector3(angular_velocity, "PoinsotMotion", "angular_velocity"), at);
                 }),
             py::arg("body"), py::arg("angular_velocity"), py::kw_only(), py::arg("point") = py::none(),
             R"(angular_velocity (3,) [rad/s], body axes; point (3,) [m], body axes: the centre of mass by default.

Raises InvalidInput for a body without three moments of inertia there.)")
        .def_property_readonly("kind", &PoinsotMotion::kind,
                               "rest, permanent, symmetric (a regular precession), separatrix or generic.")
        .def_property_readonly(
            "is_permanent", [](const PoinsotMotion& p) { return p.is_permanent(); },
            R"(Whether the angular velocity stays as it is (Thm 7.12), within the rounding of axes that were computed:
|I omega x omega| at most 1e-12 of |I omega| |omega|.)")
        .def_property_readonly("growth_rate", &PoinsotMotion::growth_rate,
                               R"(The rate at which a small disturbance of a permanent rotation grows [1/s].

Zero about a stable axis; nan for a rotation that is not permanent.)")
        .def_property_readonly("period", &PoinsotMotion::period,
                               "Of the angular velocity in body axes [s]; infinite where it has none.")
        .def_property_readonly("precession_rate", &PoinsotMotion::precession_rate,
                               "Mean rate at which the axis that K circles goes round K [rad/s] (Prop. 7.3).")
        .def_property_readonly("proper_rotation_rate", &PoinsotMotion::proper_rotation_rate,
                               "Mean rate at which the body turns about that axis [rad/s].")
        .def_property_readonly("tilt", &PoinsotMotion::tilt, "Least and largest angle between that axis and K [rad].")
        .def_property_readonly(
            "angular_momentum", [](const PoinsotMotion& p) { return to_python(p.angular_momentum()); },
            "K (3,) [kg m^2/s], body axes.")
        .def_property_readonly("kinetic_energy", &PoinsotMotion::kinetic_energy, "[J]")
        .def_property_readonly("plane_distance", &PoinsotMotion::plane_distance,
                               "omega.K/|K|: where Poinsot's plane lies [rad/s] (Prop. 7.1).")
        .def(
            "polhode",
            [](const PoinsotMotion& p, std::int64_t count, const std::optional<double>& until) {
                const int points = counted(count);
                return rows_of(unlocked([&] { return p.polhode(points, until); }));
            },
            py::arg("count") = 200, py::arg("until") = py::none(),
            R"(The way of omega in the body (count, 3) [rad/s], up to a time [s], by default one period.

Raises InvalidInput for a time in which |omega| makes more than 2^64 rad: its digits do not tell where omega is then.)")
        .def(
            "herpolhode",
            [](const PoinsotMotion& p, std::int64_t count, const std::optional<double>& until) {
                const int points = counted(count);
                return rows_of(unlocked([&] { return p.herpolhode(points, until); }));
            },
            py::arg("count") = 200, py::arg("until") = py::none(),
            "The way of omega in the world (count, 3) [rad/s], up to a time [s]; times as of polhode().")
        .def(py::pickle(
            [](const PoinsotMotion& p) {
                const auto point = p.point() ? py::object(tuple_of(*p.point())) : py::none();
                return py::make_tuple(p.body(), tuple_of(p.angular_velocity()), point);
            },
            [](const py::tuple& d) {
                const auto point = d[2].is_none() ? std::nullopt : std::optional(vector_from(d[2]));
                return PoinsotMotion(d[0].cast<const RigidBody&>(), vector_from(d[1]), point);
            }))
        .def("__repr__", [](const PoinsotMotion& p) { return "<PoinsotMotion: " + std::string(p.kind()) + ">"; });
}

}  // namespace binding
