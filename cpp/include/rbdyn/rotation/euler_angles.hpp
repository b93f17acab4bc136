// Euler's angles of the chapter: nutation theta, precession psi, proper rotation phi.
//
//   R(body -> world) = Rz(psi) Rx(theta) Rz(phi)
//   omega = A (theta', psi', phi'), omega in body axes                                        (eqs. 7.49, 7.51)
//   A (theta'', psi'', phi'') = b,  b = omega' - A' (theta', psi', phi')                      (eqs. 7.50, 7.52)
//
// det A = sin theta: where it vanishes the angles fail and the motion does not. theta = 0 leaves psi + phi only, and
// theta = pi leaves psi - phi. Misprints of the chapter, by R^T R' = [omega]x: 7.49 is in the body's basis, omega_3'
// ends in - psi' theta' sin theta (printed sin phi), b_2 in + psi' phi' sin phi sin theta (printed without sin phi).
//
// Three-vectors of angles, rates and second derivatives are in the order theta, psi, phi.
#pragma once

#include <cmath>
#include <limits>
#include <numbers>

#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/rotation/quaternion.hpp"

namespace rbdyn::inline RBDYN_FORM {

/// theta, psi, phi [rad], of any size: (-theta, psi + pi, phi + pi) and whole turns of each are the same attitude.
template <class S>
struct EulerAnglesOf {
    S theta = 0.0, psi = 0.0, phi = 0.0;

    bool operator==(const EulerAnglesOf&) const = default;
};

using EulerAngles = EulerAnglesOf<double>;

/// The unit quaternion of finite angles.
QuaternionOf<DoubleDouble> exact_quaternion(const EulerAngles& angles);
inline Quaternion quaternion(const EulerAngles& angles) { return rounded(exact_quaternion(angles)); }

namespace rotations {

/// An attitude's x, y or w, z count as rounding below this: components of a unit quaternion are good to a few 1e-16.
inline constexpr double no_component = 4.0 * std::numeric_limits<double>::epsilon();
inline constexpr double full_turn = 2.0 * std::numbers::pi;

/// angle + k 2 pi nearest to another.
inline double nearest(double angle, double to) { return angle + full_turn * std::round((to - angle) / full_turn); }

}  // namespace rotations

/// Of a unit quaternion: theta in [0, pi], psi and phi in [-pi, pi]; phi = 0 where theta is exactly 0 or pi.
EulerAngles euler_angles(const Quaternion& q);

/// The angles of a unit quaternion nearest to previous ones, among all that give its attitude: in a motion sampled
/// closely enough they are continuous, through theta = 0 and pi too, where theta goes on and psi keeps its value.
/// Closely enough: between samples no angle changes by as much as a quarter turn.
EulerAngles continue_from(const EulerAngles& previous, const Quaternion& q);

/// A of eq. 7.51: angular velocity, body axes, from the rates.
template <class S>
Eigen::Matrix<S, 3, 3> euler_matrix(const EulerAnglesOf<S>& a) {
    using std::sin, std::cos;
    const S zero = 0.0, one = 1.0;
    const S s = sin(a.theta), c = cos(a.theta), sp = sin(a.phi), cp = cos(a.phi);
    Eigen::Matrix<S, 3, 3> m;
    m << cp, sp * s, zero, -sp, cp * s, zero, zero, c, one;
    return m;
}

/// A' (theta', psi', phi'): what the angular acceleration, body axes, has beside A (theta'', psi'', phi'').
template <class S>
Vector3Of<S> euler_matrix_rate(const EulerAnglesOf<S>& a, const Vector3Of<S>& rates) {
    using std::sin, std::cos;
    const S s = sin(a.theta), c = cos(a.theta), sp = sin(a.phi), cp = cos(a.phi);
    const S theta_phi = rates[0] * rates[2], psi_phi = rates[1] * rates[2], psi_theta = rates[1] * rates[0];
    return {psi_phi * cp * s + psi_theta * sp * c - theta_phi * sp,
            psi_theta * cp * c - psi_phi * sp * s - theta_phi * cp, -psi_theta * s};
}

/// omega in body axes [rad/s] (eq. 7.49).
Vector3 angular_velocity(const EulerAngles& angles, const Vector3& rates);
/// omega' in body axes [rad/s^2], from the rates and second derivatives.
Vector3 angular_acceleration(const EulerAngles& angles, const Vector3& rates, const Vector3& second);

/// b of eq. 7.52, corrected: principal moments and torque [N m] in body axes at a fixed point or the centre of mass.
template <class S>
Vector3Of<S> euler_right_side(const EulerAnglesOf<S>& angles, const Vector3Of<S>& rates, const Vector3& moments,
                              const Vector3Of<S>& torque) {
    const Eigen::Matrix<S, 3, 3> a = euler_matrix(angles);
    Vector3Of<S> w, b;
    for (int i = 0; i < 3; ++i) w[i] = a(i, 0) * rates[0] + a(i, 1) * rates[1] + a(i, 2) * rates[2];
    const Vector3Of<S> rest = euler_matrix_rate(angles, rates);
    for (int i = 0; i < 3; ++i) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        b[i] = torque[i] / moments[i] + w[j] * w[k] * ((moments[j] - moments[k]) / moments[i]) - rest[i];
    }
    return b;
}

/// A^-1 v: rates from omega in body axes, or second derivatives from b. At theta = 0 and pi the share of v across the
/// axis of nutation has no finite image: infinite there, and psi' = 0 where that share is rounding.
template <class S>
Vector3Of<S> euler_inverse(const EulerAnglesOf<S>& a, const Vector3Of<S>& v) {
    using std::sin, std::cos;
    const S sp = sin(a.phi), cp = cos(a.phi);
    const S psi = (v[0] * sp + v[1] * cp) / sin(a.theta);
    return {v[0] * cp - v[1] * sp, psi, v[2] - psi * cos(a.theta)};
}

/// theta', psi', phi' [rad/s] from omega in body axes (eq. 7.49). Where theta is 0 or pi to rounding and omega has no
/// share across the axis of nutation, psi' is taken as 0; with such a share psi' and phi' are infinite.
Vector3 euler_rates(const EulerAngles& angles, const Vector3& omega);

}  // namespace rbdyn::inline RBDYN_FORM
