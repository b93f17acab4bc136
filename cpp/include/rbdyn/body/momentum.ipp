// Definitions of rbdyn/body/momentum.hpp.
#pragma once

#include "rbdyn/body/momentum.hpp"

#include "rbdyn/basics/vector.hpp"
#include "rbdyn/body/rigid_body.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE Vector3 velocity_of(const Vector3& point, const Vector3& pole, const Vector3& pole_velocity,
                                 const Vector3& omega) {
    return pole_velocity + omega.cross(point - pole);
}

RBDYN_INLINE Vector3 momentum(const RigidBody& body, const Vector3& pole, const Vector3& pole_velocity,
                              const Vector3& omega) {
    return body.mass() * velocity_of(body.com(), pole, pole_velocity, omega);
}

RBDYN_INLINE Vector3 angular_momentum(const RigidBody& body, const Vector3& pole, const Vector3& pole_velocity,
                                      const Vector3& omega) {
    return body.mass() * (body.com() - pole).cross(pole_velocity) + body.inertia(pole) * omega;
}

RBDYN_INLINE double kinetic_energy(const RigidBody& body, const Vector3& pole, const Vector3& pole_velocity,
                                   const Vector3& omega) {
    const double m = body.mass();
    return 0.5 * m * pole_velocity.squaredNorm() + m * pole_velocity.dot(omega.cross(body.com() - pole)) +
           0.5 * omega.dot(body.inertia(pole) * omega);
}

}  // namespace rbdyn::inline RBDYN_FORM
