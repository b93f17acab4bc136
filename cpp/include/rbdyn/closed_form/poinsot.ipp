// Definitions of rbdyn/closed_form/poinsot.hpp.
#pragma once

#include "rbdyn/closed_form/poinsot.hpp"

#include <algorithm>
#include <cmath>

#include "rbdyn/basics/vector.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE bool is_permanent_rotation(const Matrix3& inertia, const Vector3& omega, double rtol) {
    const Vector3 k = inertia * omega;
    return k.cross(omega).norm() <= rtol * k.norm() * omega.norm();
}

RBDYN_INLINE double disturbance_rate_squared(const Vector3& moments, int axis, double speed) {
    const double i = moments[axis], j = moments[(axis + 1) % 3], k = moments[(axis + 2) % 3];
    return speed * speed * ((i - j) / j) * ((k - i) / k);
}

RBDYN_INLINE double growth_rate(const Vector3& moments, int axis, double speed) {
    return std::sqrt(std::max(0.0, disturbance_rate_squared(moments, axis, speed)));
}

RBDYN_INLINE RegularPrecession regular_precession(double i1, double i3, const Vector3& omega) {
    const double across = i1 * std::hypot(omega[0], omega[1]), along = i3 * omega[2];
    // phi' = -alpha omega_3, alpha = (I3 - I1)/I1 (7.56)
    return {std::hypot(across, along) / i1, (i1 - i3) / i1 * omega[2], std::atan2(across, along)};
}

RBDYN_INLINE double poinsot_plane_distance(const Matrix3& inertia, const Vector3& omega) {
    const Vector3 k = inertia * omega;
    const double size = k.norm();
    return size > 0.0 ? k.dot(omega) / size : 0.0;
}

}  // namespace rbdyn::inline RBDYN_FORM
