// The point of a disc or an ellipsoid that is nearest to a centre outside it, or farthest from one it moves around in.
//
// The centre is at c - a, a = apart, from the centre c of the part; the point is at c - s, and a - s leads from the
// centre to it. Of a disc across m, with p what of a is across m: nearest is s = p within the rim, where |p| < r, and r
// p/|p| on the rim, to which the gap goes over with the same rate; farthest is -r p/|p|. Of an ellipsoid with the axes
// e_i, as long as its semi-axes a_i, by Lagrange's multiplier l of its surface:
//     s = sum p_i e_i,   p_i = e_i.a/(a_i^2 + l),   |p| = 1,   l > -min a_i^2 (nearest),   l < -max a_i^2 (farthest).
// 1/|p| is nearly linear in l and concave or convex, so that Newton's method for it goes up to the zero from its far
// side (C. Reinsch, Numer. Math. 16, 451, 1971): as often as values need, and then once for each doubling of the terms
// of a series that are right. The far side is where the part touches at its flattest place. In a bowl it stays there
// while it is deep inside: there U = l (sum (e_i.a)^2/(a_i^2 (l + a_i^2)) - 1) is beyond the square of the distance
// (the dual of the maximum), and the distance itself has a kink where two places are as far.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <type_traits>

#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/double_double_functions.hpp"
#include "rbdyn/basics/double_double_vector.hpp"
#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/expression/elementary.hpp"
#include "rbdyn/expression/expression.hpp"
#include "rbdyn/mechanics/moving.hpp"

namespace rbdyn::inline RBDYN_FORM {

namespace mechanics {

/// s and its rate, and how far the point is from the centre.
template <class S>
struct NearestPoint {
    Vector3Of<S> s = none<S>(), s_rate = none<S>();
    S far = S(0.0);
    S flat = S(1.0);  // of the farthest point of a disc: |p|^2/|a|^2, zero where all of the rim is as far
};

namespace nearest {

/// b where x > 0, else c.
template <class S, class B, class C>
S where(const S& x, B&& b, C&& c) {
    if constexpr (std::is_same_v<S, Expression>)
        return select(x, b, c, "");
    else
        return static_cast<double>(x) > 0.0 ? b() : c();
}

/// A vector and its rate.
template <class S>
struct Led {
    Vector3Of<S> value = none<S>(), rate = none<S>();
};

/// A disc tilted by less lies flat [rad]: with all of its rim no point of it goes on.
inline constexpr double least_tilt = 0x1p-23;

template <class S>
NearestPoint<S> of_disc(const Led<S>& normal, const S& radius, const Led<S>& apart, bool is_farthest) {
    using std::sqrt;
    const S along = dot<S>(apart.value, normal.value),
            along_rate = dot<S>(apart.rate, normal.value) + dot<S>(apart.value, normal.rate);
    const Vector3Of<S> p = apart.value - normal.value * along,
                       p_rate = apart.rate - normal.value * along_rate - normal.rate * along;
    const S square = dot<S>(p, p), slope = dot<S>(p, p_rate);
    const auto rim = [&] { return radius / sqrt(square); };
    const auto rim_rate = [&] { return S(0.0) - rim() * slope / square; };
    const auto nothing = [] { return S(0.0); };
    NearestPoint<S> result;
    S part, part_rate;
    if (is_farthest) {
        // all of the rim is as far where p is nothing, within half of where what touches ends
        constexpr double half = 0.5 * least_tilt;
        const S whole = along * along + square, leans = square - whole * S(half * half);
        part = S(0.0) - where<S>(leans, rim, nothing);
        part_rate = S(0.0) - where<S>(leans, rim_rate, nothing);
        const S across = where<S>(
                             leans, [&] { return sqrt(square); }, nothing) +
                         radius;
        result.far = sqrt(along * along + across * across);
        result.flat = square / whole;
    } else {
        const S beyond = square - radius * radius;
        part = where<S>(beyond, rim, [] { return S(1.0); });
        part_rate = where<S>(beyond, rim_rate, nothing);
    }
    result.s = p * part;
    result.s_rate = p_rate * part + p * part_rate;
    if (!is_farthest) {
        const Vector3Of<S> d = apart.value - result.s;
        result.far = sqrt(dot<S>(d, d));
    }
    return result;
}

class OfEllipsoid {
public:
    OfEllipsoid(const Vector3& semi_axes, double surface_radius, bool is_farthest) : is_farthest_(is_farthest) {
        for (std::size_t i = 0; i < 3; ++i) {
            const DoubleDouble one(semi_axes[static_cast<Eigen::Index>(i)]);
            squares_[i] = is_farthest ? DoubleDouble(-(one * one)) : DoubleDouble(one * one);
        }
        const double least = semi_axes.minCoeff(), most = semi_axes.maxCoeff();
        start_ = is_farthest ? 0.5 * (most * most + surface_radius * least) : surface_radius * least;
        // values: at most 7 to an aspect of 10 and 15 to 1000, of 20,000 places each; series: to 2^6 terms
        passes_ = 12 + static_cast<int>(std::ceil(3.0 * std::log10(most / least)));
    }

    template <class S>
    NearestPoint<S> of(const std::array<Led<S>, 3>& axes, const Led<S>& apart) const {
        using std::sqrt;
        std::array<S, 3> z, z_rate, p;
        for (std::size_t i = 0; i < 3; ++i) {
            z[i] = dot<S>(axes[i].value, apart.value);
            z_rate[i] = dot<S>(axes[i].rate, apart.value) + dot<S>(axes[i].value, apart.rate);
        }
        NearestPoint<S> result;
        if constexpr (!std::is_same_v<S, Expression>)
            if (is_farthest_ && !(static_cast<double>(beyond<S>(z, S(start_))) > 0.0)) {
                result.far = sqrt(least_bound<S>(z));
                return result;
            }
        const S l = multiplier<S>(z);
        S slope = S(0.0), weight = S(0.0);
        std::array<S, 3> part;
        for (std::size_t i = 0; i < 3; ++i) {
            part[i] = sign<S>() / (exactly<S>(squares_[i]) + l);
            p[i] = z[i] * part[i];
            slope += p[i] * z_rate[i] * part[i];
            weight += p[i] * p[i] * part[i];
        }
        const auto ratio = [&] { return slope / weight; };
        const S l_rate = is_farthest_ ? where<S>(beyond<S>(z, S(start_)), ratio, [] { return S(0.0); }) : ratio();
        for (std::size_t i = 0; i < 3; ++i) {
            const S p_rate = (z_rate[i] - p[i] * l_rate) * part[i];
            result.s += axes[i].value * p[i];
            result.s_rate += axes[i].rate * p[i] + axes[i].value * p_rate;
        }
        const Vector3Of<S> d = apart.value - result.s;
        const auto distance = [&] { return sqrt(dot<S>(d, d)); };
        const auto limit = [&] { return sqrt(bound<S>(z, l)); };
        result.far = is_farthest_ ? where<S>(beyond<S>(z, S(start_)), distance, limit) : distance();
        return result;
    }

private:
    // of the farthest point all is told with the signs of a_i^2 + l turned: l > max a_i^2, p_i = -e_i.a/(l - a_i^2)
    template <class S>
    S sign() const {
        return S(is_farthest_ ? -1.0 : 1.0);
    }
    template <class S>
    std::array<S, 3> points(const std::array<S, 3>& z, const S& l) const {
        return {z[0] / (exactly<S>(squares_[0]) + l), z[1] / (exactly<S>(squares_[1]) + l),
                z[2] / (exactly<S>(squares_[2]) + l)};
    }
    /// |p|^2 - 1.
    template <class S>
    S beyond(const std::array<S, 3>& z, const S& l) const {
        const auto p = points<S>(z, l);
        return p[0] * p[0] + p[1] * p[1] + p[2] * p[2] - S(1.0);
    }
    /// U, of the farthest point.
    template <class S>
    S bound(const std::array<S, 3>& z, const S& l) const {
        S sum = S(1.0);
        for (std::size_t i = 0; i < 3; ++i)
            sum += z[i] * z[i] / ((exactly<S>(squares_[i]) + l) * exactly<S>(DoubleDouble(-squares_[i])));
        return sum * l;
    }
    template <class S>
    S newton(const std::array<S, 3>& z) const {
        using std::sqrt;
        S l(start_);
        for (int pass = 0; pass < passes_; ++pass) {
            S square = S(0.0), weight = S(0.0);
            for (std::size_t i = 0; i < 3; ++i) {
                const S part = S(1.0) / (exactly<S>(squares_[i]) + l), p = z[i] * part, both = p * p;
                square += both;
                weight += both * part;
            }
            l = l + (sqrt(square) - S(1.0)) * square / weight;
        }
        return l;
    }
    template <class S>
    S multiplier(const std::array<S, 3>& z) const {
        if (!is_farthest_) return newton<S>(z);
        return where<S>(
            beyond<S>(z, S(start_)), [&] { return newton<S>(z); }, [&] { return S(start_); });
    }
    /// The square of the distance deep inside: the least of U.
    template <class S>
    S least_bound(const std::array<S, 3>& z) const {
        double low = 0.0, high = start_;
        for (const DoubleDouble& square : squares_) low = std::max(low, -square.hi);
        std::array<double, 3> near;
        for (std::size_t i = 0; i < 3; ++i) near[i] = static_cast<double>(z[i]);
        for (int pass = 0; pass < 50; ++pass) {
            const double middle = 0.5 * (low + high);
            (beyond<double>(near, middle) > 0.0 ? low : high) = middle;
        }
        return bound<S>(z, S(high));
    }

    bool is_farthest_;
    std::array<DoubleDouble, 3> squares_;  // of the semi-axes; against them of the farthest point
    double start_ = 0.0;
    int passes_ = 0;
};

}  // namespace nearest

}  // namespace mechanics

}  // namespace rbdyn::inline RBDYN_FORM
