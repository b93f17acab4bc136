// How a point of a body accelerates.
#pragma once

#include <cstddef>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/mechanics/tree_state.hpp"

namespace rbdyn::inline RBDYN_FORM::mechanics {

/// The acceleration [m/s^2] of the point at an arm from a body's origin; of the world, none.
inline Vector3 acceleration_at(const TreeState& state, int body, const Vector3& arm) {
    if (body < 0) return Vector3::Zero();
    const auto i = static_cast<std::size_t>(body);
    const TreeState::Body& b = state.bodies[i];
    const Vector3& omega = state.moving[i].omega;
    return b.origin_acceleration + b.angular_acceleration.cross(arm) + omega.cross(Vector3(omega.cross(arm)));
}

}  // namespace rbdyn::inline RBDYN_FORM::mechanics
