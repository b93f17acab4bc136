// Definitions of rbdyn/series/roots.hpp.
#pragma once

#include "rbdyn/series/roots.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <vector>

#include "rbdyn/series/polynomial.hpp"

namespace rbdyn::inline RBDYN_FORM::series {

RBDYN_INLINE Bounds bounds(const double* c, int degree) {
    Bounds b{c[degree], c[degree]};
    for (int k = degree - 1; k >= 0; --k) {
        b.low = c[k] + (b.low < 0.0 ? b.low : 0.0);
        b.high = c[k] + (b.high > 0.0 ? b.high : 0.0);
    }
    return b;
}

RBDYN_INLINE Bounds slope_bounds(const double* c, int degree) {
    Bounds b{degree * c[degree], degree * c[degree]};
    for (int k = degree - 1; k >= 1; --k) {
        b.low = k * c[k] + (b.low < 0.0 ? b.low : 0.0);
        b.high = k * c[k] + (b.high > 0.0 ? b.high : 0.0);
    }
    return b;
}

RBDYN_INLINE bool keeps_sign(const double* c, int degree) {
    const double sign = c[0] < 0.0 ? -1.0 : 1.0;
    const int middle = degree / 2 + 1;
    double low = 0.0, high = 0.0;
    int i = middle - 1;
    for (int k = degree; k >= middle; --k, --i) {
        high = sign * c[k] + (high < 0.0 ? high : 0.0);
        if (i >= 1) low = sign * c[i] + (low < 0.0 ? low : 0.0);
    }
    for (; i >= 1; --i) low = sign * c[i] + (low < 0.0 ? low : 0.0);
    return sign * c[0] + (low < 0.0 ? low : 0.0) + (high < 0.0 ? high : 0.0) > 0.0;
}

RBDYN_INLINE void left_half(const double* c, int degree, double* out) {
    double power = 1.0;
    for (int k = 0; k <= degree; ++k, power *= 0.5) out[k] = c[k] * power;
}

RBDYN_INLINE void right_half(double* c, int degree) {
    for (int i = 0; i < degree; ++i)
        for (int k = degree - 1; k >= i; --k) c[k] += c[k + 1];
}

RBDYN_INLINE double bracketed_root(const double* c, int degree, double lo, double hi) {
    const bool rises = value(c, degree, lo) < 0.0;
    double x = 0.5 * (lo + hi), last_step = std::numeric_limits<double>::infinity();
    // Newton's method is there after a few; where it goes on in equal parts, far from the root of a power, halves
    constexpr int few = 8, most = 250;
    for (int iteration = 0; iteration < most; ++iteration) {
        double g = c[degree], slope = 0.0;
        for (int k = degree - 1; k >= 0; --k) {
            slope = slope * x + g;
            g = g * x + c[k];
        }
        if (g == 0.0) return x;
        ((g < 0.0) == rises ? lo : hi) = x;
        double next = x - g / slope;
        // far from a root very near to zero, of which Newton's method sees nothing but the rounding of x
        if (!(next > lo && next < hi)) next = lo > 0.0 ? 0.5 * (lo + hi) : 0x1p-32 * hi;
        if (iteration >= few && std::abs(next - x) > 0.25 * last_step)
            next = !(lo > 0.0) ? 0x1p-32 * hi : hi > 4.0 * lo ? std::sqrt(lo) * std::sqrt(hi) : 0.5 * (lo + hi);
        last_step = std::abs(next - x);
        if (next == x || std::abs(next - x) <= 1e-17 * std::abs(x)) return next;
        x = next;
        if (hi - lo <= 2.3e-16 * std::abs(hi)) return x;
    }
    return x;
}

RBDYN_INLINE void RootFinder::find(const double* g, int degree, std::vector<double>& roots) {
    flats_.clear();
    multiple_.clear();
    // roots at zero belong to what came before
    while (degree > 0 && g[0] == 0.0) {
        ++g;
        --degree;
    }
    while (degree > 0 && g[degree] == 0.0) --degree;
    if (degree == 0 || bounds(g, degree).exclude_zero()) return;
    g_ = g;
    degree_ = degree;
    visits_ = 0;
    const std::size_t known = roots.size();
    noise_ = noise(1.0);
    search(g, 0.0, 1.0, roots);
    // what g alone does not tell sharply is a root by the signs on both sides, and found by a derivative
    std::size_t kept = known;
    double settled = 0.0;  // up to here
    for (std::size_t k = known; k < roots.size(); ++k) {
        const double x = roots[k];
        if (x <= settled) continue;
        std::optional<Flat> about;
        if (std::abs(slope(x)) * sharp * x <= noise(x)) about = surroundings({x, x});
        if (about) settled = about->hi;
        if (about) multiple_.push_back(*about);
        if (about && !changes(*about)) continue;
        roots[kept++] = about ? located(*about) : x;
    }
    roots.resize(kept);
    for (const Flat& flat : flats_) {
        const std::optional<Flat> about = surroundings(flat);
        if (about) multiple_.push_back(*about);
        if (!about || !changes(*about)) continue;
        const auto first = roots.begin() + static_cast<std::ptrdiff_t>(known);
        const auto place = std::lower_bound(first, roots.end(), about->lo);
        const double x = located(*about);
        if (x <= 1.0 && (place == roots.end() || *place > about->hi)) roots.insert(place, x);
    }
}

RBDYN_INLINE double RootFinder::noise(double x) const {
    return 4.0 * std::numeric_limits<double>::epsilon() * value_of_sizes(g_, degree_, x);
}

RBDYN_INLINE void RootFinder::search(const double* d, double lo, double width, std::vector<double>& roots) {
    const Bounds b = bounds(d, degree_);
    if (b.exclude_zero()) return;
    if (is_noise(std::max(-b.low, b.high), lo)) return add_flat(lo, lo + width);
    if (width <= narrowest * lo || ++visits_ > max_visits || slope_bounds(d, degree_).exclude_zero()) {
        // monotone, or too narrow to tell: a change of sign is one root, unless all of g here is rounding
        const double hi = lo + width;
        const double at_lo = value(g_, degree_, lo), at_hi = value(g_, degree_, hi);
        if (is_noise(std::max(std::abs(at_lo), std::abs(at_hi)), lo)) return add_flat(lo, hi);
        // whether it is passed at the end is seen by its surroundings
        if (at_hi == 0.0 && at_lo != 0.0)
            roots.push_back(hi);
        else if ((at_lo < 0.0 && at_hi > 0.0) || (at_lo > 0.0 && at_hi < 0.0))
            roots.push_back(bracketed_root(g_, degree_, lo, hi));
        return;
    }
    Coefficients half;
    left_half(d, degree_, half.data());
    search(half.data(), lo, 0.5 * width, roots);
    right_half(half.data(), degree_);
    search(half.data(), lo + 0.5 * width, 0.5 * width, roots);
}

RBDYN_INLINE void RootFinder::add_flat(double lo, double hi) {
    if (!flats_.empty() && flats_.back().hi == lo)
        flats_.back().hi = hi;
    else
        flats_.push_back({lo, hi});
}

RBDYN_INLINE std::optional<RootFinder::Flat> RootFinder::surroundings(const Flat& flat) const {
    const double least = std::max(flat.hi - flat.lo, sharp * flat.hi);
    Flat about = flat;
    for (double margin = least; about.lo > 0.0; margin *= 2.0) {
        about.lo = std::max(0.0, flat.lo - margin);
        if (std::abs(value(g_, degree_, about.lo)) > noise(about.lo)) break;
    }
    for (double margin = least; margin <= widest_flat * flat.hi; margin *= 2.0) {
        about.hi = flat.hi + margin;
        if (std::abs(value(g_, degree_, about.hi)) > noise(about.hi)) return about;
    }
    return std::nullopt;
}

RBDYN_INLINE bool RootFinder::changes(const Flat& about) const {
    return (value(g_, degree_, about.lo) < 0.0) != (value(g_, degree_, about.hi) < 0.0);
}

RBDYN_INLINE double RootFinder::located(const Flat& about) const {
    const double half = 0.5 * (about.hi - about.lo);
    double x = 0.5 * (about.lo + about.hi);
    // the middle is off, and a term of lower order rules until it is less so
    for (int iteration = 0; iteration < 100; ++iteration) {
        Coefficients c;
        std::copy_n(g_, degree_ + 1, c.begin());
        shift(c.data(), degree_, x);
        // the odd term that rules over the interval
        std::size_t ruling = 1;
        double largest = 0.0, power = half;
        for (std::size_t m = 1; m <= static_cast<std::size_t>(degree_); m += 2, power *= half * half) {
            if (!(std::abs(c[m]) * power > largest)) continue;
            largest = std::abs(c[m]) * power;
            ruling = m;
        }
        const double next =
            std::clamp(x - c[ruling - 1] / (static_cast<double>(ruling) * c[ruling]), about.lo, about.hi);
        const bool is_there = std::abs(next - x) <= 4.0 * std::numeric_limits<double>::epsilon() * x;
        x = next;
        if (is_there) break;
    }
    return x;
}

RBDYN_INLINE double RootFinder::slope(double x) const {
    double sum = 0.0;
    for (int k = degree_; k >= 1; --k) sum = sum * x + k * g_[k];
    return sum;
}

}  // namespace rbdyn::inline RBDYN_FORM::series
