// A circle by its angle: r(u) = center + radius (cos u start + sin u toward).
//
// Start and toward are directions from the centre, made orthonormal: toward loses its part along start. The angle is
// not confined to one turn, since a motion may go round many times. Own axes: start, toward, start x toward.
// Invariant: |r'| = radius, r'.r'' = 0, r' x r'' = radius^2 along the third axis.
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

struct Circle {
    double radius = 0.0;               // [m], positive
    Vector3 start = Vector3::Zero();   // direction from the centre to u = 0
    Vector3 toward = Vector3::Zero();  // side on which u grows
    Vector3 center = Vector3::Zero();  // world, [m]

    /// Throws InvalidInput unless the radius is positive, start and toward span a plane, and all is finite.
    void validate() const;

    Placement placement() const { return placed(center, curves::axes_of_plane(start, toward)); }
    Domain domain() const { return {}; }
    bool closed() const { return true; }
    double period() const { return 6.283185307179586; }
    std::string name() const { return "circle of radius " + text(radius); }

    /// The curve in its own axes.
    template <class S>
    CurvePoint<S> own(const S& u) const {
        using std::cos, std::sin;
        const S zero(0), R(radius), square = R * R;
        const S x = R * cos(u), y = R * sin(u);
        return {{x, y, zero}, {-y, x, zero}, {-x, -y, zero}, square, zero, {zero, zero, square}};
    }
    /// r''' in own axes.
    Vector3 third(double u) const { return {radius * std::sin(u), -radius * std::cos(u), 0.0}; }

    /// Signed arc length from u0 to u1, [m].
    double length(double u0, double u1) const { return radius * (u1 - u0); }
    bool regular_at(double) const { return true; }
    bool straight() const { return false; }
    /// The binormal where the curvature is zero, in own axes; nothing where the curve bends.
    std::optional<Vector3> straight_binormal(double) const { return std::nullopt; }

    bool operator==(const Circle&) const = default;
};

}  // namespace rbdyn::inline RBDYN_FORM
