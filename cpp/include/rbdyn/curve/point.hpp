// What a curve says of one of its points, and where a curve's own axes lie.
//
// A curve is a map u -> r(u). The chapter's P(s), eq. 7.8, is the same curve by its arc length s, ds/du = |r'(u)|;
// the tangent of eq. 7.9 is t = r'/|r'|, the curvature of eq. 7.10 is 1/rho = |r' x r''|/|r'|^3.
//
// Conventions: primes are derivatives by the curve's own parameter u, which need not be a length.
// Invariant: the three scalar and vector products agree with the derivatives to rounding error.
#pragma once

#include <limits>

#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/double_double_vector.hpp"
#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/vector.hpp"

namespace rbdyn::inline RBDYN_FORM {

/// A curve and its derivatives at a parameter, in numbers of type S.
template <class S>
struct CurvePoint {
    // r, r', r'' (m, and m by powers of the parameter)
    Vector3Of<S> position{S(0), S(0), S(0)}, first{S(0), S(0), S(0)}, second{S(0), S(0), S(0)};
    S speed_squared = S(0);                             // |r'|^2
    S first_dot_second = S(0);                          // r' . r''
    Vector3Of<S> first_cross_second{S(0), S(0), S(0)};  // r' x r''
};

/// The point with these derivatives.
template <class S>
CurvePoint<S> curve_point(const Vector3Of<S>& position, const Vector3Of<S>& first, const Vector3Of<S>& second) {
    return {position, first, second, dot<S>(first, first), dot<S>(first, second), cross<S>(first, second)};
}

/// Position and orientation of a curve's own axes: r_world = origin + axes * r_own.
struct Placement {
    Vector3 origin = Vector3::Zero();    // world, [m]
    Matrix3 axes = Matrix3::Identity();  // columns: the own axes in the world, orthonormal, right-handed
    Matrix3 rest = Matrix3::Zero();      // what these are short of 32 digits

    /// The axes in 32 digits.
    Matrix3Of<DoubleDouble> exact_axes() const;

    bool operator==(const Placement&) const = default;
};

/// The placement with these axes.
Placement placed(const Vector3& origin, const Matrix3Of<DoubleDouble>& axes);

/// The parameters a curve is defined for; the ends may be infinite, and are unless they are given.
struct Domain {
    double begin = -std::numeric_limits<double>::infinity();
    double end = std::numeric_limits<double>::infinity();

    bool operator==(const Domain&) const = default;
};

/// The chapter's moving axes (text after eq. 7.10): unit vectors, binormal = tangent x normal.
struct Frenet {
    Vector3 tangent, normal, binormal;
};

}  // namespace rbdyn::inline RBDYN_FORM
