// A ball joint. Its coordinates are the attitude of the body in the world, a quaternion, and its velocities the angular
// velocity in world axes: nothing of them depends on how the parent turns.
#pragma once

#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/double_double_vector.hpp"
#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/expression/expression.hpp"
#include "rbdyn/mechanics/joint/held.hpp"
#include "rbdyn/mechanics/moving.hpp"
#include "rbdyn/rotation/quaternion.hpp"

namespace rbdyn::inline RBDYN_FORM {

namespace mechanics {

/// q' = 1/2 (0, omega) q, omega in world axes.
template <class S>
void quaternion_rate(const S* q, const Vector3Of<S>& omega, S* rate) {
    const Vector3Of<S> h = omega * S(0.5);
    rate[0] = -(h[0] * q[1]) - h[1] * q[2] - h[2] * q[3];
    rate[1] = h[0] * q[0] + h[1] * q[3] - h[2] * q[2];
    rate[2] = h[1] * q[0] + h[2] * q[1] - h[0] * q[3];
    rate[3] = h[2] * q[0] + h[0] * q[2] - h[1] * q[1];
}

/// Turns a child as its quaternion and its angular velocity say; the rates of the latter are those of its omega.
template <class S>
void turn_freely(Moving<S>& child, const S* q, const S* omega) {
    QuaternionOf<S> attitude{q[0], q[1], q[2], q[3]};
    if constexpr (!std::is_same_v<S, Expression>) attitude = normalized(attitude);
    child.axes = axes<S>(attitude);
    child.omega = {omega[0], omega[1], omega[2]};
    for (int k = 0; k < 3; ++k) {
        Twist<S> one;
        one.turn[k] = S(1.0);
        child.joint.push_back(one);
    }
}

struct SphericalLaw : Held {
    static constexpr int positions = 4, velocities = 3;

    template <class S>
    Moving<S> move(const Moving<S>& parent, const S* q, const S* v) const {
        Moving<S> child = carry(parent);
        turn_freely<S>(child, q, v);
        return child;
    }
};

}  // namespace mechanics

}  // namespace rbdyn::inline RBDYN_FORM
