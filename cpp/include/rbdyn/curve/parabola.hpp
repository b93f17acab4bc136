// A parabola by the distance along its tangent at the vertex: r(u) = vertex + u x + a u^2 y, u in metres.
//
// x and y are directions made orthonormal: y loses its part along x. Own axes: x, y, x cross y.
// Invariant: |r'|^2 = 1 + 4 a^2 u^2, r'.r'' = 4 a^2 u, r' x r'' = 2 a along the third axis.
#pragma once

#include <optional>
#include <string>

#include "rbdyn/basics/error.hpp"
#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/curve/axes.hpp"
#include "rbdyn/curve/point.hpp"

namespace rbdyn::inline RBDYN_FORM {

struct Parabola {
    double a = 0.0;                    // [1/m], not zero; half the curvature at the vertex
    Vector3 x = Vector3::Zero();       // direction of the tangent at the vertex
    Vector3 y = Vector3::Zero();       // side to which the parabola opens, if a is positive
    Vector3 vertex = Vector3::Zero();  // world, [m]

    /// Throws InvalidInput unless a is not zero, x and y span a plane, and all is finite.
    void validate() const;

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
    double length(double u0, double u1) const;
    bool regular_at(double) const { return true; }
    bool straight() const { return false; }
    /// The binormal where the curvature is zero, in own axes; nothing where the curve bends.
    std::optional<Vector3> straight_binormal(double) const { return std::nullopt; }

    bool operator==(const Parabola&) const = default;
};

}  // namespace rbdyn::inline RBDYN_FORM
