// A cycloid by the angle of its rolling circle: r(u) = vertex + R (u + sin u) x + R (1 - cos u) y.
//
// The circle of radius R rolls on the line y = 2 R, from below if y is up: the curve is the tautochrone. x and y are
// directions made orthonormal: y loses its part along x. Own axes: x, y, x cross y.
// All is written in half the angle, c = cos(u/2) and s = sin(u/2), in which nothing cancels near the cusps:
//   r' = 2 R c (c, s),  |r'| = 2 R |c|,  r'.r'' = -2 R^2 c s,  r' x r'' = 2 R^2 c^2 along the third axis
// Cusps: u = pi, 3 pi, ... and their opposites, where r' = 0 and there is no tangent.
// Invariant: curvature 1/(4 R |c|).
#pragma once

#include <cmath>
#include <optional>
#include <string>

#include "rbdyn/basics/error.hpp"
#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/curve/axes.hpp"
#include "rbdyn/curve/point.hpp"

namespace rbdyn::inline RBDYN_FORM {

struct Cycloid {
    double radius = 0.0;               // of the rolling circle, [m], positive
    Vector3 x = Vector3::Zero();       // direction of the tangent at the vertex
    Vector3 y = Vector3::Zero();       // side of the cusps
    Vector3 vertex = Vector3::Zero();  // where u = 0, world, [m]

    /// Throws InvalidInput unless the radius is positive, x and y span a plane, and all is finite.
    void validate() const;

    Placement placement() const { return placed(vertex, curves::axes_of_plane(x, y)); }
    Domain domain() const { return {}; }
    bool closed() const { return false; }
    std::string name() const { return "cycloid of radius " + text(radius); }

    /// The curve in its own axes.
    template <class S>
    CurvePoint<S> own(const S& u) const {
        using std::cos, std::sin;
        const S zero(0), R(radius), twice(2.0 * radius), half = S(0.5) * u;
        const S c = cos(half), s = sin(half), cc = c * c, sc = s * c;
        const S along = twice * cc, up = twice * sc;
        return {{R * u + up, twice * (s * s), zero},
                {along, up, zero},
                {-up, R - twice * (s * s), zero},
                (S(4.0) * R * R) * cc,
                (S(-2.0) * R * R) * sc,
                {zero, zero, (S(2.0) * R * R) * cc}};
    }
    /// r''' in own axes.
    Vector3 third(double u) const { return {-radius * std::cos(u), -radius * std::sin(u), 0.0}; }

    /// Signed arc length from u0 to u1, [m]: 8 R an arch, 4 R sin(u/2) from the vertex on the arch of u = 0.
    double length(double u0, double u1) const;
    /// Whether r' is not zero: at a cusp, cos(u/2) is what rounding of u makes of it.
    bool regular_at(double u) const;
    bool straight() const { return false; }
    /// The binormal where the curvature is zero, in own axes; nothing where the curve bends.
    std::optional<Vector3> straight_binormal(double) const { return std::nullopt; }

    bool operator==(const Cycloid&) const = default;
};

}  // namespace rbdyn::inline RBDYN_FORM
