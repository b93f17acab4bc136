// Own axes of a curve, made from the directions a user gives, and turned from one placement to another.
//
// In its own axes a curve has exact zeros (a circle has no third component) which a recorded model must not lose.
// So axes are exact where the input is along world axes, and rotations that are an identity or a permutation but for
// rounding are made exactly that. Else they have 32 digits: an axis that is rounded turns what all runs compute.
//
// Conventions: columns are axes, right-handed. Invariant: axes^T axes = 1 within 2 units in the last place.
#pragma once

#include <algorithm>
#include <cmath>

#include "rbdyn/basics/vector.hpp"
#include "rbdyn/curve/point.hpp"

namespace rbdyn::curves {

using LongVector = Triple<long double>;
using WideVector = Vector3Of<DoubleDouble>;
using WideMatrix = Matrix3Of<DoubleDouble>;

/// Entries this near to 0, 1 or -1 are rounding: two units in the last place of 1.
inline constexpr double snap = 4e-16;

inline double snapped(double x) {
    if (std::abs(x) <= snap) return 0.0;
    if (std::abs(std::abs(x) - 1.0) <= snap) return std::copysign(1.0, x);
    return x;
}

inline DoubleDouble snapped(const DoubleDouble& x) {
    const double near = snapped(x.hi);
    return near == 0.0 || std::abs(near) == 1.0 ? near : x;
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

/// The same in 32 digits.
inline WideVector wide_unit(const Vector3& v) {
    int exponent = 0;
    std::frexp(largest(v), &exponent);
    const Vector3 scaled(std::ldexp(v[0], -exponent), std::ldexp(v[1], -exponent), std::ldexp(v[2], -exponent));
    const WideVector e = widened(scaled);
    return e / sqrt(dot<DoubleDouble>(e, e));
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

inline WideMatrix columns(const WideVector& x, const WideVector& y, const WideVector& z) {
    WideMatrix axes;
    for (int i = 0; i < 3; ++i) {
        axes(i, 0) = snapped(x[i]);
        axes(i, 1) = snapped(y[i]);
        axes(i, 2) = snapped(z[i]);
    }
    return axes;
}

/// First axis along `start`, second in the half-plane of `toward`, third start x toward.
inline WideMatrix axes_of_plane(const Vector3& start, const Vector3& toward) {
    const WideVector x = wide_unit(start), t = wide_unit(toward);
    const WideVector across = t - x * dot<DoubleDouble>(x, t);
    const WideVector y = across / sqrt(dot<DoubleDouble>(across, across));
    return columns(x, y, cross<DoubleDouble>(x, y));
}

/// First axis along `direction`; second the perpendicular nearest to world z, or world x if the direction is vertical;
/// the third is then horizontal.
inline WideMatrix axes_of_line(const Vector3& direction) {
    WideVector x = wide_unit(direction);
    for (int i = 0; i < 3; ++i) {
        if (std::abs(x[i].hi) <= snap) x[i] = 0.0;
    }
    const DoubleDouble horizontal = sqrt(x[0] * x[0] + x[1] * x[1]);
    if (horizontal.hi == 0.0) return columns(x, {1.0, 0.0, 0.0}, {0.0, x[2], 0.0});
    const WideVector z(x[1] / horizontal, -x[0] / horizontal, 0.0);
    return columns(x, cross<DoubleDouble>(z, x), z);
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

/// The same, of a matrix of 32 digits.
template <class S>
Vector3Of<S> turned(const WideMatrix& m, const Vector3Of<S>& v) {
    Vector3Of<S> result(S(0), S(0), S(0));
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) {
            const DoubleDouble& a = m(i, j);
            if (a.hi == 0.0) continue;
            if (a == DoubleDouble(1.0)) {
                result[i] = result[i] + v[j];
            } else if (a == DoubleDouble(-1.0)) {
                result[i] = result[i] - v[j];
            } else {
                result[i] = result[i] + exactly<S>(a) * v[j];
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
    Matrix3 back = view.axes;
    back.transposeInPlace();
    result.origin = turned<double>(back, offset);
    // a component that is only what rounding left of its terms
    for (int i = 0; i < 3; ++i) {
        double terms = 0.0;
        for (int j = 0; j < 3; ++j) terms += std::abs(back(i, j)) * std::abs(offset[j]);
        if (std::abs(result.origin[i]) <= snap * terms) result.origin[i] = 0.0;
    }
    return result;
}

/// The same in 32 digits.
struct WidePlacement {
    WideVector origin;
    WideMatrix axes;
};
inline WidePlacement seen_exactly_from(const Placement& view, const Placement& own) {
    const Placement rounded = seen_from(view, own);
    const WideMatrix axes = own.exact_axes(), back = view.exact_axes().transpose();
    WidePlacement result;
    if (view.axes == own.axes && view.rest == own.rest) {
        result.axes = widened(Matrix3(Matrix3::Identity()));
    } else {
        result.axes = product(back, axes);
        for (int j = 0; j < 3; ++j)
            for (int i = 0; i < 3; ++i) result.axes(i, j) = snapped(result.axes(i, j));
    }
    const WideVector offset = widened(own.origin) - widened(view.origin);
    result.origin = turned<DoubleDouble>(back, offset);
    for (int i = 0; i < 3; ++i)
        if (rounded.origin[i] == 0.0) result.origin[i] = 0.0;
    return result;
}

}  // namespace rbdyn::curves
