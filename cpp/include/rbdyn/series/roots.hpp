// Every real root of a polynomial in an interval, in order, none missed and none twice.
//
// Exclusion: on an interval of centre m and half-width r, with g(m + r x) = sum d_k x^k, no root where
// |d_0| > sum_{k>0} |d_k|; at most one where |d_1| > sum_{k>1} k |d_k|, since g is then monotone. Otherwise the
// interval is halved (Moore, Kearfott and Cloud, "Introduction to Interval Analysis", SIAM 2009, ch. 8; centred form).
#pragma once

#include <array>
#include <cmath>
#include <vector>

namespace rbdyn::series {

/// Highest degree whose roots are sought.
inline constexpr int max_degree = 40;
using Coefficients = std::array<double, max_degree + 1>;

inline double value(const double* c, int degree, double x) {
    double sum = c[degree];
    for (int k = degree - 1; k >= 0; --k) sum = sum * x + c[k];
    return sum;
}

/// Coefficients of g(a + b x).
inline void compose_linear(const double* c, int degree, double a, double b, double* out) {
    for (int k = 0; k <= degree; ++k) out[k] = c[k];
    if (a != 0.0)
        for (int i = 0; i < degree; ++i)
            for (int k = degree - 1; k >= i; --k) out[k] += a * out[k + 1];
    double power = 1.0;
    for (int k = 1; k <= degree; ++k) out[k] *= power *= b;
}

/// The root of g between lo and hi where its signs differ, by Newton's method kept inside the bracket.
inline double bracketed_root(const double* c, int degree, double lo, double hi) {
    const bool rises = value(c, degree, lo) < 0.0;
    double x = 0.5 * (lo + hi);
    for (int iteration = 0; iteration < 100; ++iteration) {
        double g = c[degree], slope = 0.0;
        for (int k = degree - 1; k >= 0; --k) {
            slope = slope * x + g;
            g = g * x + c[k];
        }
        if (g == 0.0) return x;
        ((g < 0.0) == rises ? lo : hi) = x;
        double next = x - g / slope;
        if (!(next > lo && next < hi)) next = 0.5 * (lo + hi);
        if (next == x || std::abs(next - x) <= 1e-17 * std::abs(x)) return next;
        x = next;
        if (hi - lo <= 2.3e-16 * std::abs(hi)) return x;
    }
    return x;
}

/// Finds the roots of g on (0, 1] at which its sign changes.
class RootFinder {
public:
    /// Appends the roots in increasing order. `g` holds degree + 1 coefficients.
    void find(const double* g, int degree, std::vector<double>& roots) {
        while (degree > 0 && g[degree] == 0.0) --degree;
        double rest = 0.0;
        for (int k = 1; k <= degree; ++k) rest += std::abs(g[k]);
        if (degree == 0 || std::abs(g[0]) > rest) return;
        g_ = g;
        degree_ = degree;
        visits_ = 0;
        Coefficients centred;
        compose_linear(g, degree, 0.5, 0.5, centred.data());
        search(centred.data(), 0.5, 0.5, 0, roots);
    }

private:
    void search(const double* d, double centre, double half, int depth, std::vector<double>& roots) {
        double rest = 0.0, slope_rest = 0.0;
        for (int k = 1; k <= degree_; ++k) rest += std::abs(d[k]);
        if (std::abs(d[0]) > rest) return;
        for (int k = 2; k <= degree_; ++k) slope_rest += k * std::abs(d[k]);
        const double lo = centre - half, hi = centre + half;
        if (std::abs(d[1]) > slope_rest || depth >= max_depth || ++visits_ > max_visits) {
            // monotone, or too narrow to tell: a change of sign is one root
            const double at_lo = value(g_, degree_, lo), at_hi = value(g_, degree_, hi);
            if (at_hi == 0.0 && at_lo != 0.0)
                roots.push_back(hi);
            else if ((at_lo < 0.0 && at_hi > 0.0) || (at_lo > 0.0 && at_hi < 0.0))
                roots.push_back(bracketed_root(g_, degree_, lo, hi));
            return;
        }
        Coefficients part;
        compose_linear(d, degree_, -0.5, 0.5, part.data());
        search(part.data(), centre - 0.5 * half, 0.5 * half, depth + 1, roots);
        compose_linear(d, degree_, 0.5, 0.5, part.data());
        search(part.data(), centre + 0.5 * half, 0.5 * half, depth + 1, roots);
    }

    // two roots 2^-40 of a step apart are told apart; closer ones are a graze within rounding
    static constexpr int max_depth = 40;
    // 40 roots, each 40 halvings deep, never need more; only rounding noise around zero does
    static constexpr int max_visits = 4000;

    const double* g_ = nullptr;
    int degree_ = 0;
    int visits_ = 0;
};

}  // namespace rbdyn::series
