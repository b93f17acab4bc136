// A polynomial curve: r(u) = sum_k c_k u^k, c_k vectors in the world.
//
// Own axes: those of the line or plane that the coefficients from c_1 on lie in (own_axes.hpp), so that what lies
// outside is exactly zero; the own origin is c_0 always. Invariant: own axes and world give the same curve to rounding
// error.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/curve/own_axes.hpp"
#include "rbdyn/curve/point.hpp"
#include "rbdyn/curve/polynomial_piece.hpp"

namespace rbdyn::inline RBDYN_FORM {

class PolynomialForm;

struct Polynomial {
    std::vector<Vector3> coefficients;  // in increasing powers of u, world, [m]
    Domain domain = {};

    /// Throws InvalidInput unless there are two coefficients, all finite, one of them after the first not zero, and
    /// the domain's begin is before its end.
    void validate() const;

    /// Checked, and turned into its own axes; a Curve does this once.
    PolynomialForm form() const;

    bool operator==(const Polynomial&) const = default;
};

/// A polynomial curve in its own axes, ready to be evaluated.
class PolynomialForm {
public:
    explicit PolynomialForm(const Polynomial& polynomial);

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
    std::optional<Vector3> straight_binormal(double u) const;

    bool operator==(const PolynomialForm& other) const;

private:
    static curves::OwnAxes axes_of(const Polynomial& polynomial);
    static curves::PolynomialPiece turned_into(const curves::OwnAxes& axes, const Polynomial& polynomial);

    Domain domain_;
    curves::OwnAxes axes_;
    curves::PolynomialPiece piece_;
    Placement placement_;
};

}  // namespace rbdyn::inline RBDYN_FORM
