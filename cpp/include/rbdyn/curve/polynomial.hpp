// A polynomial curve: r(u) = sum_k c_k u^k, c_k vectors in the world.
//
// Own axes: those of the line or plane that the coefficients from c_1 on lie in (own_axes.hpp), so that what lies
// outside is exactly zero; the own origin is c_0 always. Invariant: own axes and world give the same curve to rounding
// error.
#pragma once

#include <algorithm>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "rbdyn/curve/checks.hpp"
#include "rbdyn/curve/own_axes.hpp"
#include "rbdyn/curve/polynomial_piece.hpp"

namespace rbdyn {

class PolynomialForm;

struct Polynomial {
    std::vector<Vector3> coefficients;  // in increasing powers of u, world, [m]
    Domain domain = {};

    /// Throws InvalidInput unless there are two coefficients, all finite, one of them after the first not zero, and
    /// the domain's begin is before its end.
    void validate() const {
        require(coefficients.size() >= 2, "polynomial", "number of coefficients",
                static_cast<double>(coefficients.size()), "it must be at least 2, in increasing powers of u");
        double largest = 0.0;
        for (std::size_t k = 0; k < coefficients.size(); ++k) {
            curves::require_finite("polynomial", "coefficient " + std::to_string(k), coefficients[k]);
            if (k > 0) largest = std::max(largest, curves::largest(coefficients[k]));
        }
        require(largest > 0.0, "polynomial", "the largest coefficient after the first", largest,
                "one must not be zero: a curve is not a single point");
        curves::require_domain("polynomial", domain);
    }

    /// Checked, and turned into its own axes; a Curve does this once.
    PolynomialForm form() const;

    bool operator==(const Polynomial&) const = default;
};

/// A polynomial curve in its own axes, ready to be evaluated.
class PolynomialForm {
public:
    explicit PolynomialForm(const Polynomial& polynomial)
        : domain_(polynomial.domain), axes_(axes_of(polynomial)), piece_(turned_into(axes_, polynomial)) {
        placement_ = placed(polynomial.coefficients.front(), axes_.axes);
    }

    Placement placement() const { return placement_; }
    Domain domain() const { return domain_; }
    bool closed() const { return false; }
    std::string name() const { return "polynomial of degree " + std::to_string(piece_.degree()); }

    /// The curve in its own axes.
    template <class S>
    CurvePoint<S> own(const S& u) const {
        return piece_.own<S>(u);
    }
    /// r''' in own axes.
    Vector3 third(double u) const { return piece_.third(u); }

    /// Signed arc length from u0 to u1, [m].
    double length(double u0, double u1) const { return piece_.length(u0, u1, name()); }
    bool regular_at(double u) const { return piece_.regular_at(u); }
    bool straight() const { return axes_.dimension == 1; }
    /// The binormal where the curvature is zero within rounding, in own axes; nothing where the curve bends.
    std::optional<Vector3> straight_binormal(double u) const {
        // one normal all along, also where the curve goes back on itself
        if (straight()) return Vector3(0.0, 0.0, own(u).first.x() < 0.0 ? -1.0 : 1.0);
        if (piece_.bends_at(u)) return std::nullopt;
        if (const auto before = piece_.binormal_before(u)) return before;
        return curves::binormal_of_line(placement_.axes, own(u).first);
    }

    bool operator==(const PolynomialForm& other) const {
        return domain_ == other.domain_ && placement_ == other.placement_ && piece_ == other.piece_;
    }

private:
    static curves::OwnAxes axes_of(const Polynomial& polynomial) {
        // directions alone count: however small a coefficient, its power of u may make it large
        std::vector<Vector3> directions;
        for (std::size_t k = 1; k < polynomial.coefficients.size(); ++k)
            if (!polynomial.coefficients[k].isZero(0.0)) directions.push_back(curves::unit(polynomial.coefficients[k]));
        return curves::own_axes(directions, 0.0);
    }
    static curves::PolynomialPiece turned_into(const curves::OwnAxes& axes, const Polynomial& polynomial) {
        std::vector<curves::WideVector> c{widened(Vector3(Vector3::Zero()))};
        for (std::size_t k = 1; k < polynomial.coefficients.size(); ++k)
            c.push_back(axes.of(widened(polynomial.coefficients[k])));
        return curves::PolynomialPiece(c);
    }

    Domain domain_;
    curves::OwnAxes axes_;
    curves::PolynomialPiece piece_;
    Placement placement_;
};

inline PolynomialForm Polynomial::form() const {
    validate();
    return PolynomialForm(*this);
}

}  // namespace rbdyn
