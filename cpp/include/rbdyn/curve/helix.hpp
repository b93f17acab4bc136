// A circular helix by its angle: r(u) = center + radius (cos u start + sin u toward) + h u axis.
//
// Notation: h = pitch/(2 pi), metres along the axis a radian; axis = start x toward. A negative pitch makes a
// left-handed helix. Own axes: start, toward, axis.
// Invariant: |r'|^2 = R^2 + h^2, r'.r'' = 0, r' x r'' = (R h sin u, -R h cos u, R^2).
#pragma once

#include <cmath>
#include <numbers>
#include <optional>
#include <string>

#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/error.hpp"
#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/curve/axes.hpp"
#include "rbdyn/curve/point.hpp"

namespace rbdyn::inline RBDYN_FORM {

struct Helix {
    double radius = 0.0;               // [m], positive
    double pitch = 0.0;                // [m] a turn, along start x toward; not zero
    Vector3 start = Vector3::Zero();   // direction from the axis to u = 0
    Vector3 toward = Vector3::Zero();  // side on which u grows
    Vector3 center = Vector3::Zero();  // point of the axis beside u = 0, world, [m]

    /// Throws InvalidInput unless the radius is positive, the pitch not zero, start and toward span a plane, and all
    /// is finite.
    void validate() const;

    Placement placement() const { return placed(center, curves::axes_of_plane(start, toward)); }
    Domain domain() const { return {}; }
    bool closed() const { return false; }
    std::string name() const { return "helix of radius " + text(radius) + " and pitch " + text(pitch); }

    /// Metres along the axis a radian.
    double rise() const { return pitch / (2.0 * std::numbers::pi); }
    DoubleDouble exact_rise() const { return DoubleDouble(pitch) / (2.0 * double_double::pi); }

    /// The curve in its own axes.
    template <class S>
    CurvePoint<S> own(const S& u) const {
        using std::cos, std::sin;
        const S R(radius), h = exactly<S>(exact_rise()), zero(0), c = cos(u), s = sin(u);
        const S x = R * c, y = R * s;
        return {{x, y, h * u}, {-y, x, h}, {-x, -y, zero}, R * R + h * h, zero, {h * y, -(h * x), R * R}};
    }
    /// r''' in own axes.
    Vector3 third(double u) const { return {radius * std::sin(u), -radius * std::cos(u), 0.0}; }

    /// Signed arc length from u0 to u1, [m].
    double length(double u0, double u1) const { return std::hypot(radius, rise()) * (u1 - u0); }
    bool regular_at(double) const { return true; }
    bool straight() const { return false; }
    /// The binormal where the curvature is zero, in own axes; nothing where the curve bends.
    std::optional<Vector3> straight_binormal(double) const { return std::nullopt; }

    bool operator==(const Helix&) const = default;
};

}  // namespace rbdyn::inline RBDYN_FORM
