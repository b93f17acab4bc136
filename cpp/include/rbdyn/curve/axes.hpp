// Own axes of a curve, made from the directions a user gives, and turned from one placement to another.
//
// In its own axes a curve has exact zeros (a circle has no third component) which a recorded model must not lose.
// So axes are exact where the input is along world axes, and rotations that are an identity or a permutation but for
// rounding are made exactly that.
//
// Conventions: columns are axes, right-handed. Invariant: axes^T axes = 1 within 2 units in the last place.
#pragma once

#include <algorithm>
#include <cmath>

#include "rbdyn/basics/vector.hpp"
#include "rbdyn/curve/point.hpp"

namespace rbdyn::curves {

// axes are computed in long double and rounded once, which is what keeps the invariant
using LongVector = Triple<long double>;

/// Entries this near to 0, 1 or -1 are rounding: two units in the last place of 1.
inline constexpr double snap = 4e-16;

inline double snapped(double x) {
    if (std::abs(x) <= snap) return 0.0;
    if (std::abs(std::abs(x) - 1.0) <= snap) return std::copysign(1.0, x);
    return x;
}

inline Matrix3 snapped(const Matrix3& m) {
    Matrix3 result;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) result(i, j) = snapped(m(i, j));
    return result;
}

/// The sum of a_i b_i, and |v|.
inline long double product(const LongVector& a, const LongVector& b) {
    return a[0] * b[0] + (a[1] * b[1] + a[2] * b[2]);
}
inline long double norm(const LongVector& v) { return std::sqrt(product(v, v)); }

/// The largest size of a component.
inline double largest(const Vector3& v) { return std::max(std::abs(v[0]), std::max(std::abs(v[1]), std::abs(v[2]))); }

/// v/|v| for any finite v that is not zero; scaled by a power of two first, so that no square overflows or vanishes.
inline LongVector unit_long(const Vector3& v) {
    int exponent = 0;
    std::frexp(largest(v), &exponent);
    const LongVector scaled(std::ldexp(v[0], -exponent), std::ldexp(v[1], -exponent), std::ldexp(v[2], -exponent));
    return scaled / norm(scaled);
}

inline Vector3 unit(const Vector3& v) {
    const LongVector e = unit_long(v);
    return {static_cast<double>(e[0]), static_cast<double>(e[1]), static_cast<double>(e[2])};
}

/// |v| without overflow or underflow on the way.
inline double norm(const Vector3& v) { return std::hypot(v.x(), v.y(), v.z()); }

/// The part of direction `b` across direction `a`, both of unit length.
inline LongVector across(const LongVector& a, const LongVector& b) {
    const LongVector once = b - a * product(a, b);
    return once - a * product(a, once);  // again: removes what the first subtraction left by rounding
}

/// Sine of the angle between two directions.
inline double sine_between(const Vector3& a, const Vector3& b) {
    return static_cast<double>(norm(across(unit_long(a), unit_long(b))));
}

inline Matrix3 columns(const LongVector& x, const LongVector& y, const LongVector& z) {
    Matrix3 axes;
    for (int i = 0; i < 3; ++i) {
        axes(i, 0) = static_cast<double>(x[i]);
        axes(i, 1) = static_cast<double>(y[i]);
        axes(i, 2) = static_cast<double>(z[i]);
    }
    return snapped(axes);
}

/// First axis along `start`, second in the half-plane of `toward`, third start x toward.
inline Matrix3 axes_of_plane(const Vector3& start, const Vector3& toward) {
    const LongVector x = unit_long(start);
    LongVector y = across(x, unit_long(toward));
    y /= norm(y);
    return columns(x, y, x.cross(y));
}

/// First axis along `direction`; second the perpendicular nearest to world z, or world x if the direction is vertical;
/// the third is then horizontal.
inline Matrix3 axes_of_line(const Vector3& direction) {
    LongVector x = unit_long(direction);
    for (int i = 0; i < 3; ++i) {
        if (std::abs(x[i]) <= snap) x[i] = 0.0L;
    }
    const long double horizontal = std::hypot(x[0], x[1]);
    if (horizontal == 0.0L) return columns(x, {1.0L, 0.0L, 0.0L}, {0.0L, x[2], 0.0L});
    const LongVector z(x[1] / horizontal, -x[0] / horizontal, 0.0L);
    return columns(x, z.cross(x), z);
}

/// m v, without the terms whose entry of m is zero.
template <class S>
Vector3Of<S> turned(const Matrix3& m, const Vector3Of<S>& v) {
    Vector3Of<S> result(S(0), S(0), S(0));
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) {
            if (m(i, j) == 0.0) continue;
            if (m(i, j) == 1.0) {
                result[i] = result[i] + v[j];
            } else if (m(i, j) == -1.0) {
                result[i] = result[i] - v[j];
            } else {
                result[i] = result[i] + S(m(i, j)) * v[j];
            }
        }
    return result;
}

/// The placement `own` as seen from the placement `view`: r_view = origin + axes * r_own.
inline Placement seen_from(const Placement& view, const Placement& own) {
    Placement result;
    if (view.axes != own.axes) {
        const auto column = [](const Matrix3& m, int j) { return LongVector(m(0, j), m(1, j), m(2, j)); };
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j)
                result.axes(i, j) = snapped(static_cast<double>(product(column(view.axes, i), column(own.axes, j))));
    }
    const Vector3 offset = own.origin - view.origin;
    const Matrix3 back = view.axes.transpose();
    result.origin = turned<double>(back, offset);
    // a component that is only what rounding left of its terms
    for (int i = 0; i < 3; ++i) {
        double terms = 0.0;
        for (int j = 0; j < 3; ++j) terms += std::abs(back(i, j)) * std::abs(offset[j]);
        if (std::abs(result.origin[i]) <= snap * terms) result.origin[i] = 0.0;
    }
    return result;
}

}  // namespace rbdyn::curves
