// Definitions of rbdyn/curve/polynomial.hpp.
#pragma once

#include "rbdyn/curve/polynomial.hpp"

#include <algorithm>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "rbdyn/basics/double_double_vector.hpp"
#include "rbdyn/basics/error.hpp"
#include "rbdyn/basics/interruption.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/curve/axes.hpp"
#include "rbdyn/curve/checks.hpp"
#include "rbdyn/curve/own_axes.hpp"
#include "rbdyn/curve/point.hpp"
#include "rbdyn/curve/polynomial_piece.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE void Polynomial::validate() const {
    require(coefficients.size() >= 2, "polynomial", "number of coefficients", static_cast<double>(coefficients.size()),
            "it must be at least 2, in increasing powers of u");
    double largest = 0.0;
    for (std::size_t k = 0; k < coefficients.size(); ++k) {
        if (k % 64 == 0) Interruption::point();
        if (!is_finite(coefficients[k]))
            curves::require_finite("polynomial", "coefficient " + std::to_string(k), coefficients[k]);
        if (k > 0) largest = std::max(largest, curves::largest(coefficients[k]));
    }
    require(largest > 0.0, "polynomial", "the largest coefficient after the first", largest,
            "one must not be zero: a curve is not a single point");
    curves::require_domain("polynomial", domain);
}

RBDYN_INLINE PolynomialForm::PolynomialForm(const Polynomial& polynomial)
    : domain_(polynomial.domain), axes_(axes_of(polynomial)), piece_(turned_into(axes_, polynomial)) {
    placement_ = placed(polynomial.coefficients.front(), axes_.axes);
}

RBDYN_INLINE std::optional<Vector3> PolynomialForm::straight_binormal(double u) const {
    // one normal all along, also where the curve goes back on itself
    if (straight()) return Vector3(0.0, 0.0, own(u).first.x() < 0.0 ? -1.0 : 1.0);
    if (piece_.bends_at(u)) return std::nullopt;
    if (const auto before = piece_.binormal_before(u)) return before;
    return curves::binormal_of_line(placement_.axes, own(u).first);
}

RBDYN_INLINE bool PolynomialForm::operator==(const PolynomialForm& other) const {
    return domain_ == other.domain_ && placement_ == other.placement_ && piece_ == other.piece_;
}

RBDYN_INLINE curves::OwnAxes PolynomialForm::axes_of(const Polynomial& polynomial) {
    // directions alone count: however small a coefficient, its power of u may make it large
    std::vector<Vector3> directions;
    for (std::size_t k = 1; k < polynomial.coefficients.size(); ++k) {
        if (k % 64 == 0) Interruption::point();
        if (!polynomial.coefficients[k].isZero(0.0)) directions.push_back(curves::unit(polynomial.coefficients[k]));
    }
    return curves::own_axes(directions, 0.0);
}

RBDYN_INLINE curves::PolynomialPiece PolynomialForm::turned_into(const curves::OwnAxes& axes,
                                                                 const Polynomial& polynomial) {
    std::vector<curves::WideVector> c{widened(Vector3(Vector3::Zero()))};
    for (std::size_t k = 1; k < polynomial.coefficients.size(); ++k) {
        if (k % 64 == 0) Interruption::point();
        c.push_back(axes.of(widened(polynomial.coefficients[k])));
    }
    return curves::PolynomialPiece(c);
}

RBDYN_INLINE PolynomialForm Polynomial::form() const {
    validate();
    return PolynomialForm(*this);
}

}  // namespace rbdyn::inline RBDYN_FORM
