// A straight line by its length: r(u) = point + u direction/|direction|, u in metres.
//
// Own axes: first along the direction, second the normal, third the binormal. A line bends nowhere, so that its
// normal is a choice: the perpendicular nearest to world z (upward), or world x for a vertical line; the binormal is
// horizontal. In own axes r = (u, 0, 0). Invariant: |r'| = 1, r'' = 0.
#pragma once

#include <optional>
#include <string>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/curve/axes.hpp"
#include "rbdyn/curve/checks.hpp"
#include "rbdyn/curve/point.hpp"

namespace rbdyn::inline RBDYN_FORM {

struct Line {
    Vector3 direction = Vector3::Zero();  // any length but zero, world
    Vector3 point = Vector3::Zero();      // where u = 0, world, [m]

    /// Throws InvalidInput if the direction is zero or a number is not finite.
    void validate() const;

    Placement placement() const { return placed(point, curves::axes_of_line(direction)); }
    Domain domain() const { return {}; }
    bool closed() const { return false; }
    std::string name() const { return "line along " + curves::vector_text(direction); }

    /// The curve in its own axes.
    template <class S>
    CurvePoint<S> own(const S& u) const {
        const S zero(0), one(1);
        return {{u, zero, zero}, {one, zero, zero}, {zero, zero, zero}, one, zero, {zero, zero, zero}};
    }
    /// r''' in own axes.
    Vector3 third(double) const { return Vector3::Zero(); }

    /// Signed arc length from u0 to u1, [m].
    double length(double u0, double u1) const { return u1 - u0; }
    bool regular_at(double) const { return true; }
    bool straight() const { return true; }
    /// The binormal where the curvature is zero, in own axes; nothing where the curve bends.
    std::optional<Vector3> straight_binormal(double) const { return Vector3(0, 0, 1); }

    bool operator==(const Line&) const = default;
};

}  // namespace rbdyn::inline RBDYN_FORM
