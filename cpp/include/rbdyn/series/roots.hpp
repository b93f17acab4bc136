// Every real root of a polynomial in an interval, in order, none missed and none twice.
//
// Exclusion: on [0, 1], g(x) = g_0 + x (g_1 + x (...)) lies between the bounds that Horner's scheme gives in interval
// arithmetic; no root where they exclude zero, at most one where those of g' do. Otherwise the interval is halved
// (Moore, Kearfott and Cloud, "Introduction to Interval Analysis", SIAM 2009, sec. 6.2 and 8.1). Around a root of
// higher multiplicity all values are rounding: there the signs on both sides tell whether g passes zero, and the
// derivative that is not rounding where.
//
// Invariant: no length of [0, 1] matters. A root x is told from others and from rounding by distances relative to x
// and by the sizes of the terms g_k x^k at x, so that roots of g(s x) are those of g divided by s.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "rbdyn/basics/form.hpp"

namespace rbdyn::inline RBDYN_FORM::series {

/// Highest degree whose roots are sought.
inline constexpr int max_degree = 40;
using Coefficients = std::array<double, max_degree + 1>;

/// Bounds of sum_k weight_k c_k x^k on [0, 1], weight_k = 1, or k for the slope (x g').
struct Bounds {
    double low, high;
    bool exclude_zero() const { return low > 0.0 || high < 0.0; }
};
Bounds bounds(const double* c, int degree);
Bounds slope_bounds(const double* c, int degree);

/// Whether g is bounded away from zero on [0, 1] on the side of g(0): a quicker, one-sided form of the same bounds,
/// with the upper half of the coefficients beside the lower one.
bool keeps_sign(const double* c, int degree);

/// Coefficients of g(x / 2), the left half; exact.
void left_half(const double* c, int degree, double* out);
/// From the coefficients of the left half those of the right one, g((1 + x) / 2), in place.
void right_half(double* c, int degree);

/// The root of g between lo and hi where its signs differ, by Newton's method kept inside the bracket.
double bracketed_root(const double* c, int degree, double lo, double hi);

/// Finds the roots of g on (0, 1] at which its sign changes.
class RootFinder {
public:
    /// Where all of g is rounding.
    struct Flat {
        double lo, hi;
    };

    /// Appends the roots in increasing order. `g` holds degree + 1 coefficients.
    void find(const double* g, int degree, std::vector<double>& roots);

    /// About where g touched zero, or passed it by a root of higher multiplicity, when it was searched last: all that
    /// rounding does not tell from a place there, and g more than that at both ends, as far as they are in (0, 1).
    const std::vector<Flat>& multiple() const { return multiple_; }

private:
    /// What rounding of coefficients and sums makes of g at x.
    double noise(double x) const;
    /// Whether a size that is met at x and beyond is rounding there; noise grows with x.
    bool is_noise(double size, double x) const { return size <= noise_ && size <= noise(x); }

    void search(const double* d, double lo, double width, std::vector<double>& roots);

    /// Intervals come in order.
    void add_flat(double lo, double hi);

    /// As far about an interval where g is rounding as it takes until g is none; none if that is not within the step
    /// or a little beyond. At x = 0 no more than g_0 is left, which is none.
    std::optional<Flat> surroundings(const Flat& flat) const;
    bool changes(const Flat& about) const;

    /// The root of odd multiplicity m in an interval: where the derivative of order m - 1 is zero.
    double located(const Flat& about) const;

    double slope(double x) const;

    // two roots 2^-40 of their place apart are told apart; closer ones, where g is rounding, are a graze
    static constexpr double narrowest = 0x1p-40;
    // 40 roots, each 40 halvings deep and as far from zero as doubles go, need no more; only rounding around zero does
    static constexpr int max_visits = 6000;
    // a root is known to this part of its place from g alone, or its derivatives tell more
    static constexpr double sharp = 0x1p-30;
    // beyond a flat by this part of its place; a root of multiplicity 30 is as wide
    static constexpr double widest_flat = 1.0;

    const double* g_ = nullptr;
    int degree_ = 0;
    int visits_ = 0;
    double noise_ = 0.0;  // of the values of g at 1
    std::vector<Flat> flats_, multiple_;
};

}  // namespace rbdyn::inline RBDYN_FORM::series
