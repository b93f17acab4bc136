// A parabola by the distance along its tangent at the vertex: r(u) = vertex + u x + a u^2 y, u in metres.
//
// x and y are directions made orthonormal: y loses its part along x. Own axes: x, y, x cross y.
// Invariant: |r'|^2 = 1 + 4 a^2 u^2, r'.r'' = 4 a^2 u, r' x r'' = 2 a along the third axis.
#pragma once

#include <cmath>
#include <optional>
#include <string>

#include "rbdyn/curve/axes.hpp"
#include "rbdyn/curve/checks.hpp"
#include "rbdyn/curve/point.hpp"

namespace rbdyn {

struct Parabola {
    double a = 0.0;                    // [1/m], not zero; half the curvature at the vertex
    Vector3 x = Vector3::Zero();       // direction of the tangent at the vertex
    Vector3 y = Vector3::Zero();       // side to which the parabola opens, if a is positive
    Vector3 vertex = Vector3::Zero();  // world, [m]

    /// Throws InvalidInput unless a is not zero, x and y span a plane, and all is finite.
    void validate() const {
        curves::require_finite("parabola", "a", a);
        require(a != 0.0, "parabola", "a", a, "it must not be zero: use Line for a curve that does not bend");
        curves::require_plane("parabola", x, y, "x", "y");
        curves::require_finite("parabola", "vertex", vertex);
    }

    Placement placement() const { return placed(vertex, curves::axes_of_plane(x, y)); }
    Domain domain() const { return {}; }
    bool closed() const { return false; }
    std::string name() const { return "parabola of a = " + text(a); }

    /// The curve in its own axes.
    template <class S>
    CurvePoint<S> own(const S& u) const {
        const S zero(0), one(1), bend(2.0 * a);
        const S slope = bend * u;
        return {{u, S(a) * (u * u), zero}, {one, slope, zero}, {zero, bend, zero},
                one + slope * slope,       bend * slope,       {zero, zero, bend}};
    }
    /// r''' in own axes.
    Vector3 third(double) const { return Vector3::Zero(); }

    /// Signed arc length from u0 to u1, [m].
    ///
    /// Notation: w = 2 a u, q = sqrt(1 + w^2). From the vertex it is (w q + asinh w)/(4 a); what is differences of that
    /// on one side of the vertex is written as products.
    double length(double u0, double u1) const {
        if ((u0 < 0.0 && u1 > 0.0) || (u0 > 0.0 && u1 < 0.0)) return length(u0, 0.0) + length(0.0, u1);
        const long double w0 = 2.0L * a * u0, w1 = 2.0L * a * u1;
        const long double q0 = std::hypot(1.0L, w0), q1 = std::hypot(1.0L, w1);
        if (w0 == 0.0L && w1 == 0.0L) return u1 - u0;
        const long double ratio = (w1 + w0) / (w1 * q1 + w0 * q0);
        const long double difference = 2.0L * a * (static_cast<long double>(u1) - u0);
        const long double turn = difference * (w1 + w0) / (w1 * q0 + w0 * q1);
        return static_cast<double>((difference * ratio * (1.0L + w1 * w1 + w0 * w0) + std::asinh(turn)) / (4.0L * a));
    }
    bool regular_at(double) const { return true; }
    bool straight() const { return false; }
    /// The binormal where the curvature is zero, in own axes; nothing where the curve bends.
    std::optional<Vector3> straight_binormal(double) const { return std::nullopt; }

    bool operator==(const Parabola&) const = default;
};

}  // namespace rbdyn
