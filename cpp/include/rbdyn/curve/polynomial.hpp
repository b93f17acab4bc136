// A polynomial curve: r(u) = sum_k c_k u^k, c_k vectors in the world.
//
// If the coefficients from c_1 on lie along one line or in one plane, the own axes are that line's or that plane's, so
// that what lies outside is exactly zero; the own origin is c_0 always:
//   on a line     axes of Line along the first coefficient that is not zero
//   in a plane    world axes if the plane is parallel to x y, x z or y z; else first axis along that coefficient
//   in space      world axes
// Invariant: own axes and world give the same curve to rounding error.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "rbdyn/curve/arc_length.hpp"
#include "rbdyn/curve/axes.hpp"
#include "rbdyn/curve/checks.hpp"
#include "rbdyn/curve/point.hpp"

namespace rbdyn {

class PolynomialForm;

struct Polynomial {
    std::vector<Vector3> coefficients;  // in increasing powers of u, world, [m]
    Domain domain = {-std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};

    /// Throws InvalidInput unless there are two coefficients, all finite, one of them after the first not zero, and
    /// the domain's begin is before its end.
    void validate() const {
        require(coefficients.size() >= 2, "polynomial", "number of coefficients",
                static_cast<double>(coefficients.size()), "it must be at least 2, in increasing powers of u");
        double largest = 0.0;
        for (std::size_t k = 0; k < coefficients.size(); ++k) {
            curves::require_finite("polynomial", "coefficient " + std::to_string(k), coefficients[k]);
            if (k > 0) largest = std::max(largest, coefficients[k].cwiseAbs().maxCoeff());
        }
        require(largest > 0.0, "polynomial", "the largest coefficient after the first", largest,
                "one must not be zero: a curve is not a single point");
        require(domain.begin < domain.end, "polynomial", "begin of the domain", domain.begin,
                "it must be less than the end " + text(domain.end));
    }

    /// Checked, and turned into its own axes; a Curve does this once.
    PolynomialForm form() const;

    bool operator==(const Polynomial&) const = default;
};

/// A polynomial curve in its own axes, ready to be evaluated.
class PolynomialForm {
public:
    explicit PolynomialForm(const Polynomial& polynomial) : domain_(polynomial.domain) {
        polynomial.validate();
        std::vector<Vector3> c = polynomial.coefficients;
        while (c.back().isZero(0.0)) c.pop_back();
        const auto [axes, dimension] = own_axes(c);
        placement_ = {c.front(), axes};
        straight_ = dimension == 1;
        c.front().setZero();
        for (Vector3& coefficient : c) coefficient = in_own_axes(axes, dimension, coefficient);
        position_ = std::move(c);
        first_ = derivative(position_);
        second_ = derivative(first_);
        third_ = derivative(second_);
    }

    Placement placement() const { return placement_; }
    Domain domain() const { return domain_; }
    bool closed() const { return false; }
    std::string name() const { return "polynomial of degree " + std::to_string(degree()); }
    int degree() const { return static_cast<int>(position_.size()) - 1; }

    /// The curve in its own axes.
    template <class S>
    CurvePoint<S> own(const S& u) const {
        CurvePoint<S> p;
        p.position = horner(position_, u);
        p.first = horner(first_, u);
        p.second = horner(second_, u);
        p.speed_squared = dot<S>(p.first, p.first);
        p.first_dot_second = dot<S>(p.first, p.second);
        p.first_cross_second = cross<S>(p.first, p.second);
        return p;
    }
    /// r''' in own axes.
    Vector3 third(double u) const { return horner(third_, u); }

    /// Signed arc length from u0 to u1, [m]: closed form for degree 1, quadrature else.
    double length(double u0, double u1) const {
        if (degree() == 1) return curves::norm(first_.front()) * (u1 - u0);
        // points and parameters are themselves rounded: no length is known better than that
        double size = 0.0;
        for (double u : {u0, u1})
            size = std::max(size, curves::norm(horner(position_, u)) + std::abs(u) * curves::norm(horner(first_, u)));
        const double floor = 8.0 * std::numeric_limits<double>::epsilon() * size;
        return curves::arc_length([&](double u) { return curves::norm(horner(first_, u)); }, u0, u1, floor, name());
    }

    /// Whether r' is not zero, beyond rounding.
    bool regular_at(double u) const {
        const Term a = taylor(1, u);
        return (a.value.cwiseAbs().array() > noise() * a.size.array()).any();
    }

    /// The binormal where the curvature is zero within rounding, in own axes; nothing where the curve bends.
    ///
    /// Notation: a_j = r^(j)/j!. For h -> 0 the cross product at u + h is that of a_1 with the first a_j not along it,
    /// times j (j - 1) h^(j - 2); h < 0 gives the limit from the side of smaller u.
    std::optional<Vector3> straight_binormal(double u) const {
        const Term a = taylor(1, u);
        // one normal all along, also where the curve goes back on itself
        if (straight_) return Vector3(0.0, 0.0, a.value.x() < 0.0 ? -1.0 : 1.0);
        for (int j = 2; j <= degree(); ++j) {
            const Term b = taylor(j, u);
            const Vector3 product = a.value.cross(b.value);
            if (curves::norm(product) <= noise() * rounding_of_cross(a, b)) continue;
            if (j == 2) return std::nullopt;
            return (j % 2 == 0 ? 1.0 : -1.0) * curves::unit(product);
        }
        // all of the bending is rounding here: as on a line
        return curves::axes_of_line(a.value).col(2);
    }

    bool operator==(const PolynomialForm&) const = default;

private:
    /// A Taylor coefficient of the curve, and the sum of the sizes of the terms it is the sum of.
    struct Term {
        Vector3 value, size;
    };
    struct OwnAxes {
        Matrix3 axes;
        int dimension;
    };

    static OwnAxes own_axes(const std::vector<Vector3>& c) {
        // directions alone count: however small a coefficient, its power of u may make it large
        constexpr double flat = 1e-14;
        std::vector<Vector3> directions;
        bool used[3] = {false, false, false};
        for (std::size_t k = 1; k < c.size(); ++k) {
            if (c[k].isZero(0.0)) continue;
            directions.push_back(curves::unit(c[k]));
            for (int i = 0; i < 3; ++i) used[i] = used[i] || c[k][i] != 0.0;
        }
        const Vector3& along = directions.front();

        // the direction farthest from the first makes the plane best known
        const Vector3* farthest = &along;
        double sine = 0.0;
        for (const Vector3& d : directions) {
            if (curves::sine_between(along, d) <= sine) continue;
            sine = curves::sine_between(along, d);
            farthest = &d;
        }
        if (sine <= flat) return {curves::axes_of_line(along), 1};
        if (!used[2]) return {Matrix3::Identity(), 2};
        if (!used[1]) return {curves::axes_of_plane(Vector3::UnitX(), Vector3::UnitZ()), 2};
        if (!used[0]) return {curves::axes_of_plane(Vector3::UnitY(), Vector3::UnitZ()), 2};
        const Matrix3 axes = curves::axes_of_plane(along, *farthest);
        const bool plane = std::all_of(directions.begin(), directions.end(),
                                       [&](const Vector3& d) { return std::abs(axes.col(2).dot(d)) <= flat; });
        if (plane) return {axes, 2};
        return {Matrix3::Identity(), 3};
    }

    static Vector3 in_own_axes(const Matrix3& axes, int dimension, const Vector3& c) {
        Vector3 own = (axes.cast<long double>().transpose() * c.cast<long double>()).cast<double>();
        for (int i = 0; i < 3; ++i) {
            const bool rounding = dimension < 3 && std::abs(own[i]) <= curves::snap * curves::norm(c);
            if (i >= dimension || rounding) own[i] = 0.0;
        }
        return own;
    }

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

    /// r^(j)/j! at u.
    Term taylor(int j, double u) const {
        Term term{Vector3::Zero(), Vector3::Zero()};
        for (int k = degree(); k >= j; --k) {
            double choices = 1.0;  // k over j
            for (int i = 1; i <= j; ++i) choices = choices * (k - j + i) / i;
            const Vector3 c = choices * position_[static_cast<std::size_t>(k)];
            term.value = term.value * u + c;
            term.size = term.size * std::abs(u) + c.cwiseAbs();
        }
        return term;
    }

    /// Relative to the sum of the sizes of its terms, Horner's sum is wrong by less than degree times epsilon (Higham,
    /// Accuracy and Stability, 5.1); four times that leaves room for the rounding of coefficients and products.
    double noise() const { return 4.0 * degree() * std::numeric_limits<double>::epsilon(); }

    static double rounding_of_cross(const Term& a, const Term& b) {
        const Vector3 x = a.value.cwiseAbs(), y = b.value.cwiseAbs();
        const auto sum = [](const Vector3& p, const Vector3& q) {
            return Vector3(p[1] * q[2] + p[2] * q[1], p[2] * q[0] + p[0] * q[2], p[0] * q[1] + p[1] * q[0]);
        };
        return curves::norm(sum(x, b.size) + sum(a.size, y));
    }

    Domain domain_;
    Placement placement_;
    bool straight_ = false;
    std::vector<Vector3> position_, first_, second_, third_;  // coefficients in own axes
};

inline PolynomialForm Polynomial::form() const { return PolynomialForm(*this); }

}  // namespace rbdyn
