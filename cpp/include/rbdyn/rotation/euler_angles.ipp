// Definitions of rbdyn/rotation/euler_angles.hpp.
#pragma once

#include "rbdyn/rotation/euler_angles.hpp"

#include <cmath>
#include <limits>
#include <numbers>

#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/double_double_functions.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/rotation/quaternion.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE QuaternionOf<DoubleDouble> exact_quaternion(const EulerAngles& angles) {
    const DoubleDouble half = 0.5, psi = angles.psi, phi = angles.phi;
    const auto tilt = sine_cosine(half * angles.theta), sum = sine_cosine(half * (psi + phi)),
               difference = sine_cosine(half * (psi - phi));
    return {tilt.cosine * sum.cosine, tilt.sine * difference.cosine, tilt.sine * difference.sine,
            tilt.cosine * sum.sine};
}

RBDYN_INLINE EulerAngles euler_angles(const Quaternion& q) {
    // w, z = cos(theta/2) (cos, sin) (psi + phi)/2 and x, y = sin(theta/2) (cos, sin) (psi - phi)/2
    const double upright = std::hypot(q.w, q.z), fallen = std::hypot(q.x, q.y);
    double half_sum = std::atan2(q.z, q.w), half_difference = std::atan2(q.y, q.x);
    if (fallen == 0.0) half_difference = half_sum;
    if (upright == 0.0) half_sum = half_difference;
    return {2.0 * std::atan2(fallen, upright), rotations::nearest(half_sum + half_difference, 0.0),
            rotations::nearest(half_sum - half_difference, 0.0)};
}

RBDYN_INLINE EulerAngles continue_from(const EulerAngles& previous, const Quaternion& q) {
    using rotations::nearest, rotations::no_component;
    const double upright = std::hypot(q.w, q.z), fallen = std::hypot(q.x, q.y);
    const double sum = 2.0 * std::atan2(q.z, q.w), difference = 2.0 * std::atan2(q.y, q.x);
    const double theta = 2.0 * std::atan2(fallen, upright);
    if (fallen <= no_component || upright <= no_component) {
        const double up = nearest(theta, previous.theta), down = nearest(-theta, previous.theta);
        const double phi = fallen <= no_component ? sum - previous.psi : previous.psi - difference;
        return {std::abs(up - previous.theta) <= std::abs(down - previous.theta) ? up : down, previous.psi,
                nearest(phi, previous.phi)};
    }
    const auto candidate = [&](double sign, double half_turn) {
        return EulerAngles{nearest(sign * theta, previous.theta),
                           nearest(0.5 * (sum + difference) + half_turn, previous.psi),
                           nearest(0.5 * (sum - difference) + half_turn, previous.phi)};
    };
    const auto distance = [&](const EulerAngles& a) {
        return std::hypot(a.theta - previous.theta, a.psi - previous.psi, a.phi - previous.phi);
    };
    const EulerAngles straight = candidate(1.0, 0.0), crossed = candidate(-1.0, std::numbers::pi);
    return distance(straight) <= distance(crossed) ? straight : crossed;
}

RBDYN_INLINE Vector3 angular_velocity(const EulerAngles& angles, const Vector3& rates) {
    return euler_matrix(angles) * rates;
}

RBDYN_INLINE Vector3 angular_acceleration(const EulerAngles& angles, const Vector3& rates, const Vector3& second) {
    return euler_matrix(angles) * second + euler_matrix_rate(angles, rates);
}

RBDYN_INLINE Vector3 euler_rates(const EulerAngles& angles, const Vector3& omega) {
    using rotations::no_component;
    const double across = omega[0] * std::sin(angles.phi) + omega[1] * std::cos(angles.phi);
    const double along = omega[0] * std::cos(angles.phi) - omega[1] * std::sin(angles.phi);
    if (std::abs(std::sin(angles.theta)) > no_component) return euler_inverse(angles, omega);
    if (std::abs(across) <= no_component * omega.norm()) return {along, 0.0, omega[2]};
    const double psi = std::copysign(std::numeric_limits<double>::infinity(), across * std::sin(angles.theta));
    return {along, psi, std::cos(angles.theta) > 0.0 ? -psi : psi};
}

}  // namespace rbdyn::inline RBDYN_FORM
