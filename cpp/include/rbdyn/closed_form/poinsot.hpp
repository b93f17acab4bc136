// Rates and angles of the motions without torque that need no integration (7.53-7.56): permanent rotations and what
// becomes of a disturbance, regular precession of a gyroscope, Poinsot's plane.
//
// Inertia about G, or about the fixed point; moments in principal axes, e3 the axis of a gyroscope.
#pragma once

#include <algorithm>
#include <cmath>

#include "rbdyn/basics/vector.hpp"

namespace rbdyn {

/// Whether omega stays as it is, being parallel to a principal axis (Def. 7.3, Thm 7.12): |I omega x omega| within rtol
/// of |I omega| |omega|.
inline bool is_permanent_rotation(const Matrix3& inertia, const Vector3& omega, double rtol = 1e-12) {
    const Vector3 k = inertia * omega;
    return k.cross(omega).norm() <= rtol * k.norm() * omega.norm();
}

/// lambda^2 of a small disturbance exp(lambda t) of the rotation about a principal axis (0, 1, 2) at a speed [rad/s]:
/// about the intermediate axis lambda = w sqrt((I2-I1)(I3-I2)/(I1 I3)); negative, an oscillation, about the others.
inline double disturbance_rate_squared(const Vector3& moments, int axis, double speed) {
    const double i = moments[axis], j = moments[(axis + 1) % 3], k = moments[(axis + 2) % 3];
    return speed * speed * ((i - j) / j) * ((k - i) / k);
}
/// The rate at which a small disturbance grows [1/s]; zero about a stable axis.
inline double growth_rate(const Vector3& moments, int axis, double speed) {
    return std::sqrt(std::max(0.0, disturbance_rate_squared(moments, axis, speed)));
}

/// The regular precession of a gyroscope, I1 = I2, without torque (Prop. 7.3): e3 turns about K at precession_rate, the
/// body about e3 at proper_rotation_rate [rad/s], at the constant angle tilt from K [rad].
struct RegularPrecession {
    double precession_rate, proper_rotation_rate, tilt;
};
inline RegularPrecession regular_precession(double i1, double i3, const Vector3& omega) {
    const double across = i1 * std::hypot(omega[0], omega[1]), along = i3 * omega[2];
    // phi' = -alpha omega_3, alpha = (I3 - I1)/I1 (7.56)
    return {std::hypot(across, along) / i1, (i1 - i3) / i1 * omega[2], std::atan2(across, along)};
}

/// The projection of omega on K, 2 T0/|K|: constant, and the distance of the plane on which Poinsot's ellipsoid of
/// inertia through omega rolls, the polhode on the herpolhode (7.55) [rad/s]. Zero at rest.
inline double poinsot_plane_distance(const Matrix3& inertia, const Vector3& omega) {
    const Vector3 k = inertia * omega;
    const double size = k.norm();
    return size > 0.0 ? k.dot(omega) / size : 0.0;
}

}  // namespace rbdyn
