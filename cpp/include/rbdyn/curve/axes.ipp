// Definitions of rbdyn/curve/axes.hpp.
#pragma once

#include "rbdyn/curve/axes.hpp"

#include <cmath>

#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/double_double_vector.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/curve/point.hpp"

namespace rbdyn::inline RBDYN_FORM::curves {

RBDYN_INLINE double snapped(double x) {
    if (std::abs(x) <= snap) return 0.0;
    if (std::abs(std::abs(x) - 1.0) <= snap) return std::copysign(1.0, x);
    return x;
}

RBDYN_INLINE DoubleDouble snapped(const DoubleDouble& x) {
    const double near = snapped(x.hi);
    return near == 0.0 || std::abs(near) == 1.0 ? near : x;
}

RBDYN_INLINE long double product(const LongVector& a, const LongVector& b) {
    return a[0] * b[0] + (a[1] * b[1] + a[2] * b[2]);
}

RBDYN_INLINE LongVector unit_long(const Vector3& v) {
    int exponent = 0;
    std::frexp(largest(v), &exponent);
    const LongVector scaled(std::ldexp(v[0], -exponent), std::ldexp(v[1], -exponent), std::ldexp(v[2], -exponent));
    return scaled / norm(scaled);
}

RBDYN_INLINE Vector3 unit(const Vector3& v) {
    const LongVector e = unit_long(v);
    return {static_cast<double>(e[0]), static_cast<double>(e[1]), static_cast<double>(e[2])};
}

RBDYN_INLINE WideVector wide_unit(const Vector3& v) {
    int exponent = 0;
    std::frexp(largest(v), &exponent);
    const Vector3 scaled(std::ldexp(v[0], -exponent), std::ldexp(v[1], -exponent), std::ldexp(v[2], -exponent));
    const WideVector e = widened(scaled);
    return e / sqrt(dot<DoubleDouble>(e, e));
}

RBDYN_INLINE LongVector across(const LongVector& a, const LongVector& b) {
    const LongVector once = b - a * product(a, b);
    return once - a * product(a, once);  // again: removes what the first subtraction left by rounding
}

RBDYN_INLINE double sine_between(const Vector3& a, const Vector3& b) {
    return static_cast<double>(norm(across(unit_long(a), unit_long(b))));
}

RBDYN_INLINE WideMatrix columns(const WideVector& x, const WideVector& y, const WideVector& z) {
    WideMatrix axes;
    for (int i = 0; i < 3; ++i) {
        axes(i, 0) = snapped(x[i]);
        axes(i, 1) = snapped(y[i]);
        axes(i, 2) = snapped(z[i]);
    }
    return axes;
}

RBDYN_INLINE WideMatrix axes_of_plane(const Vector3& start, const Vector3& toward) {
    const WideVector x = wide_unit(start), t = wide_unit(toward);
    const WideVector across = t - x * dot<DoubleDouble>(x, t);
    const WideVector y = across / sqrt(dot<DoubleDouble>(across, across));
    return columns(x, y, cross<DoubleDouble>(x, y));
}

RBDYN_INLINE WideMatrix axes_of_line(const Vector3& direction) {
    WideVector x = wide_unit(direction);
    for (int i = 0; i < 3; ++i) {
        if (std::abs(x[i].hi) <= snap) x[i] = 0.0;
    }
    const DoubleDouble horizontal = sqrt(x[0] * x[0] + x[1] * x[1]);
    if (horizontal.hi == 0.0) return columns(x, {1.0, 0.0, 0.0}, {0.0, x[2], 0.0});
    const WideVector z(x[1] / horizontal, -x[0] / horizontal, 0.0);
    return columns(x, cross<DoubleDouble>(z, x), z);
}

RBDYN_INLINE Placement seen_from(const Placement& view, const Placement& own) {
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

RBDYN_INLINE WidePlacement seen_exactly_from(const Placement& view, const Placement& own) {
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

}  // namespace rbdyn::inline RBDYN_FORM::curves
