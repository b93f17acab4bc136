// Definitions of rbdyn/scene/constraints.hpp and rbdyn/scene/surfaces.hpp.
#pragma once

#include "rbdyn/scene/constraints.hpp"

#include <cmath>

#include "rbdyn/basics/error.hpp"
#include "rbdyn/scene/joints.hpp"
#include "rbdyn/scene/surfaces.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE void Plane::validate() const {
    joints::require_finite("Plane", "point", point);
    joints::require_finite("Plane", "normal", normal);
    require(normal.norm() > 0.0, "Plane", "length of normal", normal.norm(),
            "a normal has a direction; its length is free");
}

RBDYN_INLINE void Sphere::validate() const {
    joints::require_finite("Sphere", "center", center);
    require(std::isfinite(radius) && radius > 0.0, "Sphere", "radius", radius, "a sphere has a positive radius [m]");
}

RBDYN_INLINE void Rod::validate() const {
    require(std::isfinite(length) && length > 0.0, "Rod", "length", length,
            "a rod has a positive length [m]; Ball() holds two points together");
}

RBDYN_INLINE void Hinge::validate() const { joints::require_direction("Hinge", axis); }

RBDYN_INLINE void PointOnPlane::validate() const { plane.validate(); }

}  // namespace rbdyn::inline RBDYN_FORM
