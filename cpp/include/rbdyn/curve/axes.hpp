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

#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/double_double_vector.hpp"
#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/curve/point.hpp"

namespace rbdyn::inline RBDYN_FORM::curves {

using LongVector = Triple<long double>;
using WideVector = Vector3Of<DoubleDouble>;
using WideMatrix = Matrix3Of<DoubleDouble>;

/// Entries this near to 0, 1 or -1 are rounding: two units in the last place of 1.
inline constexpr double snap = 4e-16;

double snapped(double x);

DoubleDouble snapped(const DoubleDouble& x);

/// The sum of a_i b_i, and |v|.
long double product(const LongVector& a, const LongVector& b);
inline long double norm(const LongVector& v) { return std::sqrt(product(v, v)); }

/// The largest size of a component.
inline double largest(const Vector3& v) { return std::max(std::abs(v[0]), std::max(std::abs(v[1]), std::abs(v[2]))); }

/// v/|v| for any finite v that is not zero; scaled by a power of two first, so that no square overflows or vanishes.
LongVector unit_long(const Vector3& v);

Vector3 unit(const Vector3& v);

/// The same in 32 digits.
WideVector wide_unit(const Vector3& v);

/// |v| without overflow or underflow on the way.
inline double norm(const Vector3& v) { return std::hypot(v.x(), v.y(), v.z()); }

/// The part of direction `b` across direction `a`, both of unit length.
LongVector across(const LongVector& a, const LongVector& b);

/// Sine of the angle between two directions.
double sine_between(const Vector3& a, const Vector3& b);

WideMatrix columns(const WideVector& x, const WideVector& y, const WideVector& z);

/// First axis along `start`, second in the half-plane of `toward`, third start x toward.
WideMatrix axes_of_plane(const Vector3& start, const Vector3& toward);

/// First axis along `direction`; second the perpendicular nearest to world z, or world x if the direction is vertical;
/// the third is then horizontal.
WideMatrix axes_of_line(const Vector3& direction);

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
Placement seen_from(const Placement& view, const Placement& own);

/// The same in 32 digits.
struct WidePlacement {
    WideVector origin;
    WideMatrix axes;
};
WidePlacement seen_exactly_from(const Placement& view, const Placement& own);

}  // namespace rbdyn::inline RBDYN_FORM::curves
