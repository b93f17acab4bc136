// Definitions of rbdyn/curve/polynomial_piece.hpp.
#pragma once

#include "rbdyn/curve/polynomial_piece.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/double_double_vector.hpp"
#include "rbdyn/basics/interruption.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/curve/arc_length.hpp"
#include "rbdyn/curve/axes.hpp"

namespace rbdyn::inline RBDYN_FORM::curves {

RBDYN_INLINE PolynomialPiece::PolynomialPiece(const std::vector<WideVector>& coefficients, std::vector<Vector3> sizes)
    : sizes_(std::move(sizes)) {
    for (const WideVector& c : coefficients) position_.push_back(rounded(c));
    while (position_.size() > 2 && position_.back().isZero(0.0)) position_.pop_back();
    wide_[0].assign(coefficients.begin(), coefficients.begin() + static_cast<std::ptrdiff_t>(position_.size()));
    for (const std::size_t j : {std::size_t{1}, std::size_t{2}})
        for (std::size_t k = 1; k < wide_[j - 1].size(); ++k) {
            if (k % 64 == 0) Interruption::point();
            wide_[j].push_back(wide_[j - 1][k] * DoubleDouble(static_cast<double>(k)));
        }
    if (sizes_.empty())
        for (const Vector3& c : position_) sizes_.push_back(rbdyn::sizes(c));
    sizes_.resize(position_.size(), Vector3::Zero());
    first_ = derivative(position_);
    second_ = derivative(first_);
    third_ = derivative(second_);
}

RBDYN_INLINE double PolynomialPiece::length(double u0, double u1, const std::string& name) const {
    if (degree() == 1) return norm(first_.front()) * (u1 - u0);
    // points and parameters are themselves rounded: no length is known better than that
    double size = 0.0;
    for (double u : {u0, u1}) size = std::max(size, norm(horner(position_, u)) + std::abs(u) * norm(horner(first_, u)));
    const double floor = 8.0 * std::numeric_limits<double>::epsilon() * size;
    return arc_length([&](double u) { return norm(horner(first_, u)); }, u0, u1, floor, name);
}

RBDYN_INLINE bool PolynomialPiece::regular_at(double u) const {
    const Term a = taylor(1, u);
    for (int i = 0; i < 3; ++i)
        if (std::abs(a.value[i]) > noise() * a.size[i]) return true;
    return false;
}

RBDYN_INLINE std::optional<Vector3> PolynomialPiece::binormal_before(double u) const {
    for (int j = 2; j <= degree(); ++j)
        if (const auto product = turning(j, u)) return (j % 2 == 0 ? 1.0 : -1.0) * unit(*product);
    return std::nullopt;
}

RBDYN_INLINE std::vector<Vector3> PolynomialPiece::derivative(const std::vector<Vector3>& c) {
    std::vector<Vector3> result;
    for (std::size_t k = 1; k < c.size(); ++k) result.push_back(static_cast<double>(k) * c[k]);
    return result;
}

RBDYN_INLINE PolynomialPiece::Term PolynomialPiece::taylor(int j, double u) const {
    Term term{Vector3::Zero(), Vector3::Zero()};
    for (int k = degree(); k >= j; --k) {
        double choices = 1.0;  // k over j
        for (int i = 1; i <= j; ++i) choices = choices * (k - j + i) / i;
        term.value = term.value * u + choices * position_[static_cast<std::size_t>(k)];
        term.size = term.size * std::abs(u) + choices * sizes_[static_cast<std::size_t>(k)];
    }
    return term;
}

RBDYN_INLINE std::optional<Vector3> PolynomialPiece::turning(int j, double u) const {
    const Term a = taylor(1, u), b = taylor(j, u);
    const Vector3 product = a.value.cross(b.value);
    if (norm(product) <= noise() * rounding_of_cross(a, b)) return std::nullopt;
    return product;
}

RBDYN_INLINE double PolynomialPiece::rounding_of_cross(const Term& a, const Term& b) {
    const Vector3 x = rbdyn::sizes(a.value), y = rbdyn::sizes(b.value);
    const auto sum = [](const Vector3& p, const Vector3& q) {
        return Vector3(p[1] * q[2] + p[2] * q[1], p[2] * q[0] + p[0] * q[2], p[0] * q[1] + p[1] * q[0]);
    };
    return norm(sum(x, b.size) + sum(a.size, y));
}

}  // namespace rbdyn::inline RBDYN_FORM::curves
