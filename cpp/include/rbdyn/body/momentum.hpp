// Momentum, angular momentum and kinetic energy of a rigid body in motion, about any of its points.
//
//   Q = m v_G                                                                                 (eq. 7.29)
//   K_Q = m (G - Q) x v_Q + I_Q omega                                                         (eq. 7.33)
//   T = m v_Q^2 / 2 + m v_Q . omega x (G - Q) + omega . I_Q omega / 2                         (after eq. 7.37)
//
// v_Q is the velocity of the body's point at Q. All vectors in body axes, points from the body's origin. About a point
// C at rest, or with v_C along G - C, the first term of 7.33 vanishes: K_C = I_C omega.
#pragma once

#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/body/rigid_body.hpp"

namespace rbdyn::inline RBDYN_FORM {

/// v_P from the velocity of another of the body's points [m/s].
Vector3 velocity_of(const Vector3& point, const Vector3& pole, const Vector3& pole_velocity, const Vector3& omega);

/// Q [kg m/s].
Vector3 momentum(const RigidBody& body, const Vector3& pole, const Vector3& pole_velocity, const Vector3& omega);

/// K_Q [kg m^2/s].
Vector3 angular_momentum(const RigidBody& body, const Vector3& pole, const Vector3& pole_velocity,
                         const Vector3& omega);

/// T [J].
double kinetic_energy(const RigidBody& body, const Vector3& pole, const Vector3& pole_velocity, const Vector3& omega);

}  // namespace rbdyn::inline RBDYN_FORM
