// A polynomial in own axes, r(u) = sum_k c_k u^k: a whole curve, or one stretch of a spline.
//
// Notation: a_j = r^(j)/j!, the Taylor coefficients at u.
// What rounding makes of a coefficient or a sum is judged by the sizes of the terms it is the sum of.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "rbdyn/curve/arc_length.hpp"
#include "rbdyn/curve/axes.hpp"
#include "rbdyn/curve/point.hpp"

namespace rbdyn::curves {

class PolynomialPiece {
public:
    /// From coefficients in increasing powers, two at least, and the sizes of the terms each is the sum of: without
    /// them, coefficients are exact.
    explicit PolynomialPiece(const std::vector<WideVector>& coefficients, std::vector<Vector3> sizes = {})
        : sizes_(std::move(sizes)) {
        for (const WideVector& c : coefficients) position_.push_back(rounded(c));
        while (position_.size() > 2 && position_.back().isZero(0.0)) position_.pop_back();
        wide_[0].assign(coefficients.begin(), coefficients.begin() + static_cast<std::ptrdiff_t>(position_.size()));
        for (std::size_t j : {1, 2})
            for (std::size_t k = 1; k < wide_[j - 1].size(); ++k)
                wide_[j].push_back(wide_[j - 1][k] * DoubleDouble(static_cast<double>(k)));
        if (sizes_.empty())
            for (const Vector3& c : position_) sizes_.push_back(rbdyn::sizes(c));
        sizes_.resize(position_.size(), Vector3::Zero());
        first_ = derivative(position_);
        second_ = derivative(first_);
        third_ = derivative(second_);
    }

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
    double length(double u0, double u1, const std::string& name) const {
        if (degree() == 1) return norm(first_.front()) * (u1 - u0);
        // points and parameters are themselves rounded: no length is known better than that
        double size = 0.0;
        for (double u : {u0, u1})
            size = std::max(size, norm(horner(position_, u)) + std::abs(u) * norm(horner(first_, u)));
        const double floor = 8.0 * std::numeric_limits<double>::epsilon() * size;
        return arc_length([&](double u) { return norm(horner(first_, u)); }, u0, u1, floor, name);
    }

    /// Whether r' is not zero, beyond rounding.
    bool regular_at(double u) const {
        const Term a = taylor(1, u);
        for (int i = 0; i < 3; ++i)
            if (std::abs(a.value[i]) > noise() * a.size[i]) return true;
        return false;
    }

    /// Whether the curvature at u is not zero, beyond rounding.
    bool bends_at(double u) const { return degree() >= 2 && turning(2, u).has_value(); }

    /// The limit of the binormal from the side of smaller u; nothing where all of the bending is rounding.
    ///
    /// For h -> 0 the cross product at u + h is that of a_1 with the first a_j not along it, times j (j - 1) h^(j - 2).
    std::optional<Vector3> binormal_before(double u) const {
        for (int j = 2; j <= degree(); ++j)
            if (const auto product = turning(j, u)) return (j % 2 == 0 ? 1.0 : -1.0) * unit(*product);
        return std::nullopt;
    }

    bool operator==(const PolynomialPiece&) const = default;

private:
    /// A Taylor coefficient of the curve, and the sum of the sizes of the terms it is the sum of.
    struct Term {
        Vector3 value, size;
    };

    static std::vector<Vector3> derivative(const std::vector<Vector3>& c) {
        std::vector<Vector3> result;
        for (std::size_t k = 1; k < c.size(); ++k) result.push_back(static_cast<double>(k) * c[k]);
        return result;
    }

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
    Term taylor(int j, double u) const {
        Term term{Vector3::Zero(), Vector3::Zero()};
        for (int k = degree(); k >= j; --k) {
            double choices = 1.0;  // k over j
            for (int i = 1; i <= j; ++i) choices = choices * (k - j + i) / i;
            term.value = term.value * u + choices * position_[static_cast<std::size_t>(k)];
            term.size = term.size * std::abs(u) + choices * sizes_[static_cast<std::size_t>(k)];
        }
        return term;
    }

    /// a_1 x a_j, unless it is rounding.
    std::optional<Vector3> turning(int j, double u) const {
        const Term a = taylor(1, u), b = taylor(j, u);
        const Vector3 product = a.value.cross(b.value);
        if (norm(product) <= noise() * rounding_of_cross(a, b)) return std::nullopt;
        return product;
    }

    /// Relative to the sum of the sizes of its terms, Horner's sum is wrong by less than degree times epsilon (Higham,
    /// Accuracy and Stability, 5.1); four times that leaves room for the rounding of coefficients and products.
    double noise() const { return 4.0 * degree() * std::numeric_limits<double>::epsilon(); }

    static double rounding_of_cross(const Term& a, const Term& b) {
        const Vector3 x = rbdyn::sizes(a.value), y = rbdyn::sizes(b.value);
        const auto sum = [](const Vector3& p, const Vector3& q) {
            return Vector3(p[1] * q[2] + p[2] * q[1], p[2] * q[0] + p[0] * q[2], p[0] * q[1] + p[1] * q[0]);
        };
        return norm(sum(x, b.size) + sum(a.size, y));
    }

    std::vector<Vector3> position_, sizes_;
    std::vector<Vector3> first_, second_, third_;
    std::array<std::vector<WideVector>, 3> wide_;  // r, r', r'' in 32 digits
};

}  // namespace rbdyn::curves
