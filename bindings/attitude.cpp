// Attitudes in any form, and Euler angles.
#include <cmath>
#include <rbdyn/rotation/attitude.hpp>
#include <utility>

#include "binding.hpp"

namespace binding {

using rbdyn::Attitude, rbdyn::EulerAngles, rbdyn::Matrix3, rbdyn::Quaternion, rbdyn::text;

namespace {

constexpr const char* forms =
    "it is a quaternion (w, x, y, z), a rotation matrix (3, 3), EulerAngles, or a scipy Rotation";

py::array_t<double> to_array(const Quaternion& q) {
    const double components[] = {q.w, q.x, q.y, q.z};
    return py::array_t<double>(4, components);
}

/// Angles, rates or second derivatives, in the order theta, psi, phi.
Vector3 triple(const ArrayLike& value, const char* what) { return finite_vector3(value, "EulerAngles", what); }

/// Angles that are asked for what derives from them.
const EulerAngles& finite(const EulerAngles& a) {
    for (const auto& [name, angle] : {std::pair{"theta", a.theta}, std::pair{"psi", a.psi}, std::pair{"phi", a.phi}})
        rbdyn::require(std::isfinite(angle), "EulerAngles", name, angle, "it is finite; give it in rad");
    return a;
}

/// What came of finite numbers.
Vectors told(const Vector3& v, const char* what) {
    require_finite(
        v, "EulerAngles", [&] { return "a component of " + std::string(what); },
        [] { return std::string("it is beyond what a double holds; give smaller numbers, in SI units"); });
    return Vectors(to_python(v));
}

}  // namespace

Attitude attitude(py::handle value, const std::string& object) {
    if (py::isinstance<EulerAngles>(value)) return value.cast<const EulerAngles&>();
    // scipy's Rotation has the scalar last
    const bool is_rotation = py::hasattr(value, "as_quat");
    const Array a =
        is_rotation ? doubles(value.attr("as_quat")(), object, "attitude") : doubles(value, object, "attitude");
    const double* d = a.data();
    if (a.ndim() == 1 && a.size() == 4)
        return is_rotation ? Quaternion{d[3], d[0], d[1], d[2]} : Quaternion{d[0], d[1], d[2], d[3]};
    if (!is_rotation && a.ndim() == 2 && a.shape(0) == 3 && a.shape(1) == 3)
        return Matrix3(Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(d));
    throw InvalidInput(object + ": attitude has shape " + shape_of(a) + "; " + forms);
}

py::array_t<double> to_array(const Matrix3& m) {
    py::array_t<double> result({3, 3});
    Eigen::Map<Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(result.mutable_data()) = m;
    return result;
}

void bind_attitude(py::module_& m) {
    py::class_<EulerAngles>(m, "EulerAngles", R"(Nutation theta, precession psi, proper rotation phi [rad].

R(body to world) = Rz(psi) Rx(theta) Rz(phi). Any size; (-theta, psi + pi, phi + pi) and whole turns of each are the
same attitude. Where sin(theta) = 0 the rates fail and the motion does not. Arrays of angles, rates and second
derivatives are in the order theta, psi, phi.)")
        .def(py::init([](double theta, double psi, double phi) {
                 return EulerAngles{theta, psi, phi};
             }),
             py::arg("theta"), py::arg("psi"), py::arg("phi"), "theta, psi, phi [rad].")
        .def_readonly("theta", &EulerAngles::theta, "Nutation [rad].")
        .def_readonly("psi", &EulerAngles::psi, "Precession [rad].")
        .def_readonly("phi", &EulerAngles::phi, "Proper rotation [rad].")
        .def_static(
            "of",
            [](const AttitudeLike& value, const std::optional<EulerAngles>& previous) {
                const Attitude given = attitude(value, "EulerAngles");
                return previous ? continue_from(*previous, given.quaternion()) : given.euler_angles();
            },
            py::arg("attitude"), py::kw_only(), py::arg("previous") = py::none(),
            R"(The angles of an attitude: a quaternion (w, x, y, z), a matrix (3, 3), EulerAngles or a scipy Rotation.

theta in [0, pi], psi and phi in [-pi, pi], phi = 0 where theta is exactly 0 or pi; or with previous angles, those of
the same attitude that are nearest to them: continuous along a motion sampled so closely that no angle changes by a
quarter turn, through theta = 0 and pi too, where theta goes on and psi keeps its value. Raises InvalidInput for what
is no rotation to within 1e-6.)")
        .def_property_readonly(
            "quaternion", [](const EulerAngles& a) { return to_array(Attitude(a).quaternion()); },
            "(w, x, y, z), unit. Raises InvalidInput unless the angles are finite.")
        .def_property_readonly(
            "rotation_matrix", [](const EulerAngles& a) { return to_array(Attitude(a).matrix()); },
            "R, (3, 3): its columns are the body's axes in the world. Raises InvalidInput unless the angles are "
            "finite.")
        .def_property_readonly(
            "matrix", [](const EulerAngles& a) { return to_array(Matrix3(euler_matrix(finite(a)))); },
            "A of eq. 7.51, (3, 3): omega in body axes = A (theta', psi', phi'); det A = sin(theta).")
        .def(
            "angular_velocity",
            [](const EulerAngles& a, const ArrayLike& rates) {
                return told(angular_velocity(finite(a), triple(rates, "rates")), "the angular velocity");
            },
            py::arg("rates"), "omega in body axes [rad/s] from theta', psi', phi' (eq. 7.49).")
        .def(
            "angular_acceleration",
            [](const EulerAngles& a, const ArrayLike& rates, const ArrayLike& second) {
                return told(angular_acceleration(finite(a), triple(rates, "rates"), triple(second, "second")),
                            "the angular acceleration");
            },
            py::arg("rates"), py::arg("second"),
            "omega' in body axes [rad/s^2] from the rates and theta'', psi'', phi'' (eq. 7.50).")
        .def(
            "rates",
            [](const EulerAngles& a, const ArrayLike& omega) {
                return Vectors(to_python(euler_rates(finite(a), triple(omega, "angular_velocity"))));
            },
            py::arg("angular_velocity"),
            R"(theta', psi', phi' [rad/s] from omega in body axes (eq. 7.49).

Where theta is 0 or pi: psi' = 0, or psi' and phi' infinite if omega is not in the plane of e_3 and the axis of
nutation.)")
        .def(
            "right_side",
            [](const EulerAngles& a, const ArrayLike& rates, const ArrayLike& moments, const ArrayLike& torque) {
                const Vector3 about = triple(moments, "moments");
                for (int i = 0; i < 3; ++i)
                    rbdyn::require(about[i] > 0.0, "EulerAngles", "moments[" + std::to_string(i) + "]", about[i],
                                   "a principal moment is positive, in kg m^2");
                return told(euler_right_side(finite(a), triple(rates, "rates"), about, triple(torque, "torque")),
                            "the right side");
            },
            py::arg("rates"), py::arg("moments"), py::arg("torque"),
            R"(b of eq. 7.52 [rad/s^2], its sign corrected: A (theta'', psi'', phi'') = b.

moments: principal, about a fixed point or the centre of mass [kg m^2]. torque: about the same, body axes [N m].)")
        .def("__eq__",
             [](const EulerAngles& a, const py::object& b) {
                 return py::isinstance<EulerAngles>(b) && a == b.cast<const EulerAngles&>();
             })
        .def("__hash__", [](const EulerAngles& a) { return py::hash(py::make_tuple(a.theta, a.psi, a.phi)); })
        .def("__iter__", [](const EulerAngles& a) { return py::iter(py::make_tuple(a.theta, a.psi, a.phi)); })
        .def(py::pickle([](const EulerAngles& a) { return py::make_tuple(a.theta, a.psi, a.phi); },
                        [](const py::tuple& d) {
                            return EulerAngles{d[0].cast<double>(), d[1].cast<double>(), d[2].cast<double>()};
                        }))
        .def("__repr__", [](const EulerAngles& a) {
            return "EulerAngles(theta=" + text(a.theta) + ", psi=" + text(a.psi) + ", phi=" + text(a.phi) + ")";
        });
}

}  // namespace binding
