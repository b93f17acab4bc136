// The gap between a path and a graph over a chord, as a polynomial in time.
//
//   G(s) = side (eta(s) - f(xi(s))) = sum_k G_k s^k,   0 <= s <= 1 along a part of the path
//
// in the coordinates of the graph (curve/cover.hpp). G has the sign and the zeros, with their multiplicity, of the
// distance along the normal. The composition is cut off at degree 32; `dropped` bounds the rest on [0, 1].
//
// What is rounding in a coefficient of order m: a fraction of its terms, and derivative m of a polynomial whose values
// are rounded; by Markov's inequality that is up to T_n^(m)(1) = product of (n^2 - i^2)/(2 i + 1), i < m, times the
// rounding of the values, near the ends of a graph of degree n.
#pragma once

#include <array>
#include <cstddef>
#include <limits>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/curve/cover.hpp"
#include "rbdyn/curve/point.hpp"
#include "rbdyn/series/roots.hpp"

namespace rbdyn::inline RBDYN_FORM::curves {

/// Highest degree of a path.
inline constexpr int max_path_degree = 24;
using PathCoefficients = std::array<double, max_path_degree + 1>;

/// A part of a path as seen from a graph.
struct PathView {
    PathCoefficients xi, eta;
    int degree;

    /// Coefficients at the end whose sum is at most `negligible` are left out.
    PathView(const Graph& g, const PathCoefficients& x, const PathCoefficients& y, int path_degree, double negligible);
    /// Bounds how far the path goes, in half chords.
    double motion() const;
};

class Gap {
public:
    static constexpr int max_degree = 32;
    // a contact of a higher order is not told from a path along the curve
    static constexpr int max_contact = 8;

    Gap(const Graph& g, const PathView& path, double side);

    int degree() const { return degree_; }
    double dropped() const { return dropped_; }
    double operator[](int k) const { return c_[static_cast<std::size_t>(k)]; }
    const double* from(int k) const { return c_.data() + k; }
    /// Sum of the sizes of the coefficients from order k on.
    double size(int k) const;

    /// What the rounding of f makes of the coefficient of order m, if the path goes as far as `motion`.
    static double rounding(int m, double motion);

    /// The first order from `first` on whose coefficient is more than rounding, `relative` that of its terms; a number
    /// above the degree if there is none.
    int leading(int first, double relative) const;

    /// The order of a contact at s = 0 that is known to be at least 2, where the curve is at p: what is rounding is
    /// taken out. The coefficient of s^2 comes from the curve's own derivatives by u,
    ///   f' = eta'/xi',  f'' = (xi' eta'' - eta' xi'')/xi'^3.
    /// Where a reaction has just come to zero that coefficient is zero, too, and rounding may give it either sign: what
    /// would lead back through the curve and is next to nothing beside all that follows is none.
    int contact(const CurvePoint<double>& p);

private:
    using Coefficients = std::array<double, series::max_degree + 1>;
    static constexpr double epsilon = std::numeric_limits<double>::epsilon();

    bool is_next_to_nothing(int m) const { return (*this)[m] < 0.0 && -(*this)[m] <= 1e-9 * size(m + 1); }

    /// f(xi(s)) up to max_degree, `dropped` bounding the rest; returns its degree.
    int compose(const double* f, int order, const double* xi, Coefficients& out, double& dropped) const;

    const Graph& graph_;
    const PathView& path_;
    double side_;
    Coefficients c_;
    int degree_;
    double dropped_;
};

}  // namespace rbdyn::inline RBDYN_FORM::curves
