// Rates and angles of the motions without torque that need no integration (7.53-7.56): permanent rotations and what
// becomes of a disturbance, regular precession of a gyroscope, Poinsot's plane.
//
// Inertia about G, or about the fixed point; moments in principal axes, e3 the axis of a gyroscope.
#pragma once

#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/vector.hpp"

namespace rbdyn::inline RBDYN_FORM {

/// Whether omega stays as it is, being parallel to a principal axis (Def. 7.3, Thm 7.12): |I omega x omega| within rtol
/// of |I omega| |omega|.
bool is_permanent_rotation(const Matrix3& inertia, const Vector3& omega, double rtol = 1e-12);

/// lambda^2 of a small disturbance exp(lambda t) of the rotation about a principal axis (0, 1, 2) at a speed [rad/s]:
/// about the intermediate axis lambda = w sqrt((I2-I1)(I3-I2)/(I1 I3)); negative, an oscillation, about the others.
double disturbance_rate_squared(const Vector3& moments, int axis, double speed);
/// The rate at which a small disturbance grows [1/s]; zero about a stable axis.
double growth_rate(const Vector3& moments, int axis, double speed);

/// The regular precession of a gyroscope, I1 = I2, without torque (Prop. 7.3): e3 turns about K at precession_rate, the
/// body about e3 at proper_rotation_rate [rad/s], at the constant angle tilt from K [rad].
struct RegularPrecession {
    double precession_rate, proper_rotation_rate, tilt;
};
RegularPrecession regular_precession(double i1, double i3, const Vector3& omega);

/// The projection of omega on K, 2 T0/|K|: constant, and the distance of the plane on which Poinsot's ellipsoid of
/// inertia through omega rolls, the polhode on the herpolhode (7.55) [rad/s]. Zero at rest.
double poinsot_plane_distance(const Matrix3& inertia, const Vector3& omega);

}  // namespace rbdyn::inline RBDYN_FORM
