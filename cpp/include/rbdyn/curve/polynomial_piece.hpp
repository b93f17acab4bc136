// A polynomial in own axes, r(u) = sum_k c_k u^k: a whole curve, or one stretch of a spline.
//
// Notation: a_j = r^(j)/j!, the Taylor coefficients at u.
// What rounding makes of a coefficient or a sum is judged by the sizes of the terms it is the sum of.
#pragma once

#include <array>
#include <limits>
#include <optional>
#include <string>
#include <type_traits>
#include <vector>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/curve/axes.hpp"
#include "rbdyn/curve/point.hpp"

namespace rbdyn::inline RBDYN_FORM::curves {

class PolynomialPiece {
public:
    /// From coefficients in increasing powers, two at least, and the sizes of the terms each is the sum of: without
    /// them, coefficients are exact.
    explicit PolynomialPiece(const std::vector<WideVector>& coefficients, std::vector<Vector3> sizes = {});

    int degree() const { return static_cast<int>(position_.size()) - 1; }

    template <class S>
    CurvePoint<S> own(const S& u) const {
        if constexpr (std::is_same_v<S, double>)
            return curve_point<S>(horner(position_, u), horner(first_, u), horner(second_, u));
        else
            return curve_point<S>(horner(wide_[0], u), horner(wide_[1], u), horner(wide_[2], u));
    }
    /// r'''.
    Vector3 third(double u) const { return horner(third_, u); }

    /// Signed arc length from u0 to u1, [m]: closed form for degree 1, quadrature else.
    double length(double u0, double u1, const std::string& name) const;

    /// Whether r' is not zero, beyond rounding.
    bool regular_at(double u) const;

    /// Whether the curvature at u is not zero, beyond rounding.
    bool bends_at(double u) const { return degree() >= 2 && turning(2, u).has_value(); }

    /// The limit of the binormal from the side of smaller u; nothing where all of the bending is rounding.
    ///
    /// For h -> 0 the cross product at u + h is that of a_1 with the first a_j not along it, times j (j - 1) h^(j - 2).
    std::optional<Vector3> binormal_before(double u) const;

    bool operator==(const PolynomialPiece&) const = default;

private:
    /// A Taylor coefficient of the curve, and the sum of the sizes of the terms it is the sum of.
    struct Term {
        Vector3 value, size;
    };

    static std::vector<Vector3> derivative(const std::vector<Vector3>& c);

    template <class S>
    static Vector3Of<S> horner(const std::vector<Vector3>& c, const S& u) {
        Vector3Of<S> sum(S(0), S(0), S(0));
        for (auto k = c.rbegin(); k != c.rend(); ++k)
            for (int i = 0; i < 3; ++i) sum[i] = sum[i] * u + S((*k)[i]);
        return sum;
    }

    template <class S>
    static Vector3Of<S> horner(const std::vector<WideVector>& c, const S& u) {
        Vector3Of<S> sum(S(0), S(0), S(0));
        for (auto k = c.rbegin(); k != c.rend(); ++k)
            for (int i = 0; i < 3; ++i) sum[i] = sum[i] * u + exactly<S>((*k)[i]);
        return sum;
    }

    /// a_j at u.
    Term taylor(int j, double u) const;

    /// a_1 x a_j, unless it is rounding.
    std::optional<Vector3> turning(int j, double u) const;

    /// Relative to the sum of the sizes of its terms, Horner's sum is wrong by less than degree times epsilon (Higham,
    /// Accuracy and Stability, 5.1); four times that leaves room for the rounding of coefficients and products.
    double noise() const { return 4.0 * degree() * std::numeric_limits<double>::epsilon(); }

    static double rounding_of_cross(const Term& a, const Term& b);

    std::vector<Vector3> position_, sizes_;
    std::vector<Vector3> first_, second_, third_;
    std::array<std::vector<WideVector>, 3> wide_;  // r, r', r'' in 32 digits
};

}  // namespace rbdyn::inline RBDYN_FORM::curves
