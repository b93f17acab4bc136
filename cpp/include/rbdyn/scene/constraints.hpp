// Constraints: what holds two points or two bodies to each other beside their joints, and closes loops.
//
// Axes, planes and curves are in the axes of b: of its body, or of the world. The line of a Hinge is, as the scene
// starts, its axis in a too; a Weld keeps the pose that a has to b as the scene starts.
#pragma once

#include <optional>
#include <variant>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/curve/curve.hpp"
#include "rbdyn/scene/joints.hpp"
#include "rbdyn/scene/surfaces.hpp"

namespace rbdyn::inline RBDYN_FORM {

/// Two points coincide: a pin, a ball joint.
struct Ball {
    bool operator==(const Ball&) const = default;
    void validate() const {}
};

/// Two points keep their distance [m]: a massless rod, or an inextensible thread that stays taut.
struct Rod {
    double length = 1.0;
    bool operator==(const Rod&) const = default;
    void validate() const;
};

/// Two bodies keep the pose to each other that they start with. Where b is a body, not a point of one, that is all of
/// it; points of both coincide.
struct Weld {
    bool operator==(const Weld&) const = default;
    void validate() const {}
};

/// Two points coincide, and the bodies turn against each other about an axis only.
struct Hinge {
    Vector3 axis{0, 0, 1};
    bool operator==(const Hinge&) const = default;
    void validate() const;
};

/// A point stays on a plane of b.
struct PointOnPlane {
    Plane plane;
    bool operator==(const PointOnPlane&) const = default;
    void validate() const;
};

/// A point stays on a curve of b.
struct PointOnCurve {
    Curve curve;
    bool operator==(const PointOnCurve&) const = default;
    void validate() const {}
};

/// Universal holds two points together and turns a shaft through a cross: `first` in the axes of a, `second` in those
/// of b.
using Constraint = std::variant<Ball, Rod, Weld, Hinge, PointOnPlane, PointOnCurve, Universal>;

}  // namespace rbdyn::inline RBDYN_FORM
