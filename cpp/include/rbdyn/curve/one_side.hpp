// Which way a rail that only pushes does so: one normal n = b x t all along a plane curve, b its binormal, t its
// tangent.
//
// Conventions: without `up`, n is the normal of Frenet's axes where the bead starts (curve.hpp), on a straight stretch
// the perpendicular nearest to world z, or to world x if the stretch is vertical; with `up` it is the one of the two
// that is on the side of `up` there. A straight rail has no plane of its own: n is the part of `up` across it.
// A curve in space has no such n. A normal could be carried along it, but a bead that has left it flies past it:
// nothing says where it would land. Invariant: b is exactly plus or minus the third of the axes, in which a crossing of
// the curve is looked for.
#pragma once

#include <optional>
#include <string>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/curve/curve.hpp"

namespace rbdyn::inline RBDYN_FORM::curves {

/// The plane in which a bead may leave its rail, and the side that it may be on.
struct OneSide {
    Matrix3 axes;     // columns: own axes of the curve, of a straight one turned about it; the third across the plane
    double sign;      // of the binormal along the third axis
    Vector3 tangent;  // where the bead starts, world
    Vector3 binormal() const { return column(axes, 2) * sign; }
    /// The way the rail pushes where the bead starts, if it does so along its normal.
    Vector3 normal() const { return binormal().cross(tangent); }
};

/// How far a curve goes from a plane through its place at u: the farthest of places all over it, or within 32 units of
/// its parameter where it has no end.
struct Departure {
    double parameter, distance;  // [m]
    bool is_none;                // within rounding at all of them
};
Departure departure(const Curve& curve, double u, const Vector3& normal);

/// How a bead that starts at u is pushed. Throws InvalidInput unless the curve is plane and `up` says a side.
[[gnu::cold]] OneSide one_side(const Curve& curve, double u, const std::optional<Vector3>& up, const std::string& name);

}  // namespace rbdyn::inline RBDYN_FORM::curves
