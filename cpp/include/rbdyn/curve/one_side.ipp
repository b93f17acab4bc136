// Definitions of rbdyn/curve/one_side.hpp.
#pragma once

#include "rbdyn/curve/one_side.hpp"

#include <cmath>
#include <optional>
#include <string>

#include "rbdyn/basics/double_double_vector.hpp"
#include "rbdyn/basics/error.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/curve/axes.hpp"
#include "rbdyn/curve/curve.hpp"
#include "rbdyn/curve/point.hpp"

namespace rbdyn::inline RBDYN_FORM::curves {

RBDYN_INLINE Departure departure(const Curve& curve, double u, const Vector3& normal) {
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

RBDYN_INLINE OneSide one_side(const Curve& curve, double u, const std::optional<Vector3>& up, const std::string& name) {
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

}  // namespace rbdyn::inline RBDYN_FORM::curves
