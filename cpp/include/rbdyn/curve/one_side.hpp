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

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>

#include "rbdyn/curve/curve.hpp"

namespace rbdyn::curves {

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
inline Departure departure(const Curve& curve, double u, const Vector3& normal) {
    constexpr int places = 128;
    constexpr double flat = 1e-9;  // relative to the way from u: what a few roundings of the user's numbers make
    const Domain d = curve.domain();
    const Vector3 origin = curve.position(u);
    const double lo = std::isfinite(d.begin) ? d.begin : u - 32.0, hi = std::isfinite(d.end) ? d.end : u + 32.0;
    const double least = curve.first(u).norm();
    Departure result{u, 0.0, true};
    for (int k = 1; k <= places; ++k) {
        const double at = lo + (hi - lo) * (k - 0.5) / places;
        const Vector3 r = curve.position(at) - origin;
        const double off = std::abs(normal.dot(r));
        result.is_none = result.is_none && off <= flat * (r.norm() + least);
        if (off > result.distance) result = {at, off, result.is_none};
    }
    return result;
}

/// How a bead that starts at u is pushed. Throws InvalidInput unless the curve is plane and `up` says a side.
[[gnu::cold]] inline OneSide one_side(const Curve& curve, double u, const std::optional<Vector3>& up,
                                      const std::string& name) {
    // nearer than this to a right angle, the given digits of `up` say no side
    constexpr double least = 1e-8;
    const Frenet frenet = curve.frenet(u);
    OneSide result{curve.placement().axes, 1.0, frenet.tangent};
    if (curve.straight()) {
        const Vector3 along = column(result.axes, 0);
        const double way = along.dot(frenet.tangent) > 0.0 ? 1.0 : -1.0;
        if (!up) {
            result.sign = column(result.axes, 2).dot(frenet.binormal) > 0.0 ? 1.0 : -1.0;
            return result;
        }
        require(sine_between(along, *up) > least, name, "sine of the angle between up and its rail",
                sine_between(along, *up), "up points away from a straight rail, to the side that it pushes to");
        // the first axis stays what the curve is evaluated along
        const Matrix3 turned = rounded(axes_of_plane(along, *up));
        for (int i = 0; i < 3; ++i)
            for (int j = 1; j < 3; ++j) result.axes(i, j) = turned(i, j);
        result.sign = way;
        return result;
    }
    const Vector3 third = column(result.axes, 2);
    if (!departure(curve, u, third).is_none) {
        const Departure off = departure(curve, u, frenet.binormal);
        require(
            off.is_none, name,
            "distance of its rail at parameter " + text(off.parameter) + " from the plane of its curve at parameter " +
                text(u),
            off.distance,
            "a rail that holds on one side only is a plane curve, for a bead that leaves a curve in space flies past "
            "it and nothing says where it lands; use side \"both\", or flatten the curve");
        require(
            false, name, "angle of its rail's plane with that found for it, squared and halved",
            1.0 - std::abs(third.dot(frenet.binormal)),
            "the plane of a rail that holds on one side only is one of the world's, or that of a kind of curve that "
            "knows it (a circle, a polynomial, a spline); use side \"both\", or turn the scene");
    }
    const Vector3 normal = third.cross(frenet.tangent);
    if (up) {
        const double cosine = normal.dot(*up) / norm(*up);
        require(std::abs(cosine) > least, name, "cosine of the angle between up and the normal of its rail", cosine,
                "up points to one side of the curve where the bead starts, in the plane of the curve");
        result.sign = cosine > 0.0 ? 1.0 : -1.0;
        return result;
    }
    // on a straight stretch Frenet's axes may be those of a line in another plane
    const double along = std::abs(third.dot(frenet.binormal)) > 0.5 ? third.dot(frenet.binormal)
                         : std::abs(normal.z()) > least             ? normal.z()
                                                                    : normal.x();
    result.sign = along < 0.0 ? -1.0 : 1.0;
    return result;
}

}  // namespace rbdyn::curves
