// Definitions of rbdyn/engine/dop853_step.hpp.
#pragma once

#include "rbdyn/engine/dop853_step.hpp"

#include <cstddef>
#include <cstring>
#include <span>
#include <utility>
#include <vector>

#include "rbdyn/basics/instant.hpp"
#include "rbdyn/engine/dop853_coefficients.hpp"
#include "rbdyn/expression/evaluate.hpp"
#include "rbdyn/series/lanes.hpp"

namespace rbdyn::inline RBDYN_FORM {

namespace dop853 {

// lanes are never handed over by value: in registers of four that is another call on each processor
template <class Lanes>
RBDYN_INLINE_LANES void get(const double* from, Lanes& lanes) {
    std::memcpy(&lanes, from, sizeof lanes);
}
template <class Lanes>
RBDYN_INLINE_LANES void put(double* to, const Lanes& lanes) {
    std::memcpy(to, &lanes, sizeof lanes);
}
template <class Lanes>
inline constexpr std::ptrdiff_t width = sizeof(Lanes) / sizeof(double);

}  // namespace dop853

RBDYN_INLINE void Dop853Step::follow(Evaluator<double>& equations, bool calls_back, int variables) {
    equations_ = &equations;
    asks_each_ = calls_back;
    n_ = variables;
    const std::size_t count = padded(static_cast<std::size_t>(variables));
    stride_ = static_cast<std::ptrdiff_t>(count);
    for (std::vector<double>* v : {&y_, &fifth_, &third_, &defect_}) v->assign(count, 0.0);
    differences_.assign(count * dop853::stages, 0.0);
    coefficients_.assign(count * (order + 1), 0.0);
}

RBDYN_INLINE bool Dop853Step::evaluate(Instant t, double* slope) {
    const auto is_finite_too = [this](const double* values) {
        double check = 0.0;
        for (int i = 0; i < n_; ++i) check += 0.0 * values[i];
        return check == 0.0;
    };
    if (asks_each_ && !is_finite_too(y_.data())) return false;
    ++evaluations_;
    equations_->rates(t.hi, {y_.data(), static_cast<std::size_t>(n_)}, slope);
    return !asks_each_ || is_finite_too(slope);
}

RBDYN_INLINE Dop853Step::Run Dop853Step::widest() {
#ifdef RBDYN_WIDE_LANES
    if (__builtin_cpu_supports("avx2")) return &wide;
#endif
    return &plain;
}

template <class Lanes>
RBDYN_INLINE_LANES bool Dop853Step::run(Part part, const Start& from, double h) {
    switch (part) {
        case Part::step:
        case Part::state:
            if (!stages<Lanes>(std::make_integer_sequence<int, 11>{}, from, h)) return false;
            if (part == Part::state) {
                state<12, Lanes>(from, h);
                return asks_each_ || is_finite<Lanes>(difference(1), 11 * stride_);
            }
            if (!stage<12, Lanes>(from, h)) return false;
            estimate<Lanes>();
            return asks_each_ ||
                   (is_finite<Lanes>(difference(1), 12 * stride_) && is_finite<Lanes>(y_.data(), stride_));
        case Part::interpolant: {
            if (!stage<13, Lanes>(from, h) || !stage<14, Lanes>(from, h) || !stage<15, Lanes>(from, h)) return false;
            polynomial<Lanes>(from, h);
            std::vector<double>& slope = fifth_;
            if (!evaluate(from.t + defect_place * h, slope.data())) return false;
            for (std::ptrdiff_t i = 0; i < stride_; i += dop853::width<Lanes>) {
                Lanes rate, change;
                dop853::get(slope.data() + i, rate);
                dop853::get(defect_.data() + i, change);
                dop853::put(defect_.data() + i, h * rate - change);
            }
            return asks_each_ ||
                   (is_finite<Lanes>(difference(13), 3 * stride_) && is_finite<Lanes>(slope.data(), stride_));
        }
        case Part::finish: close<Lanes>(from, h); return true;
    }
    return false;
}

template <int row, int lo, int hi, class Lanes>
RBDYN_INLINE_LANES void Dop853Step::weighted(std::ptrdiff_t i, Lanes& sum) const {
    if constexpr (hi - lo == 1) {
        constexpr double weight = dop853::weight(row, lo);
        Lanes k;
        dop853::get(difference(lo) + i, k);
        sum = weight * k;
    } else {
        constexpr int middle = (lo + hi) / 2;
        Lanes first, second;
        weighted<row, lo, middle>(i, first);
        weighted<row, middle, hi>(i, second);
        sum = first + second;
    }
}

template <int s, class Lanes>
RBDYN_INLINE_LANES void Dop853Step::advance(const double* slope, std::ptrdiff_t i, Lanes& sum) const {
    Lanes first;
    dop853::get(slope + i, first);
    sum = dop853::c[s] * first;
    if constexpr (s > 1) {
        Lanes rest;
        weighted<s, first_of(s), s>(i, rest);
        sum = sum + rest;
    }
}

template <int s, class Lanes>
RBDYN_INLINE_LANES void Dop853Step::state(const Start& from, double h) {
    for (std::ptrdiff_t i = 0; i < stride_; i += dop853::width<Lanes>) {
        Lanes x, low, change;
        dop853::get(from.x + i, x);
        dop853::get(from.low + i, low);
        advance<s>(from.slope, i, change);
        dop853::put(y_.data() + i, x + (low + h * change));
    }
}

template <int s, class Lanes>
RBDYN_INLINE_LANES bool Dop853Step::stage(const Start& from, double h) {
    state<s, Lanes>(from, h);
    double* k = difference(s);
    const bool is_there = evaluate(from.t + dop853::c[s] * h, k);
    for (std::ptrdiff_t i = 0; i < stride_; i += dop853::width<Lanes>) {
        Lanes rate, first;
        dop853::get(k + i, rate);
        dop853::get(from.slope + i, first);
        dop853::put(k + i, rate - first);
    }
    return is_there;
}

template <class Lanes, int... s>
RBDYN_INLINE_LANES bool Dop853Step::stages(std::integer_sequence<int, s...>, const Start& from, double h) {
    return (stage<s + 1, Lanes>(from, h) && ...);
}

template <class Lanes>
RBDYN_INLINE_LANES void Dop853Step::estimate() {
    for (std::ptrdiff_t i = 0; i < stride_; i += dop853::width<Lanes>) {
        Lanes sum;
        weighted<dop853::fifth, 5, 12>(i, sum);
        dop853::put(fifth_.data() + i, sum);
        weighted<dop853::third, 5, 12>(i, sum);
        dop853::put(third_.data() + i, sum);
    }
}

/// Also the state at the place of its defect, and the change there in a whole step.
template <class Lanes>
RBDYN_INLINE_LANES void Dop853Step::polynomial(const Start& from, double h) {
    constexpr std::ptrdiff_t width = dop853::width<Lanes>;
    for (std::ptrdiff_t i = 0; i < stride_; i += width) {
        Lanes beyond, bend, f3, f4, f5, f6, c[order + 1];
        weighted<12, 5, 12>(i, beyond);  // what the slope at the start does not do
        dop853::get(difference(12) + i, bend);
        weighted<dop853::dense, 5, 16>(i, f3);
        weighted<dop853::dense + 1, 5, 16>(i, f4);
        weighted<dop853::dense + 2, 5, 16>(i, f5);
        weighted<dop853::dense + 3, 5, 16>(i, f6);
        // y = x + s (dx + (1-s) (f1 + s (f2 + (1-s) (f3 + s (f4 + (1-s) (f5 + s f6)))))) in powers of s
        const Lanes f1 = -h * beyond, f2 = h * (2.0 * beyond - bend);
        f3 = h * f3;
        f4 = h * f4;
        f5 = h * f5;
        f6 = h * f6;
        dop853::get(from.x + i, c[0]);
        dop853::get(from.slope + i, c[1]);
        c[1] = h * c[1];
        c[2] = f3 + (f2 - f1);
        c[3] = f5 + (f4 - 2.0 * f3) - f2;
        c[4] = f6 - 3.0 * f5 - 2.0 * f4 + f3;
        c[5] = 3.0 * (f5 - f6) + f4;
        c[6] = 3.0 * f6 - f5;
        c[7] = -f6;
        Lanes value = c[order], change = static_cast<double>(order) * c[order];
        for (int k = order - 1; k >= 0; --k) {
            value = value * defect_place + c[k];
            if (k > 0) change = change * defect_place + static_cast<double>(k) * c[k];
        }
        dop853::put(y_.data() + i, value);
        dop853::put(defect_.data() + i, change);
        // rows of coefficients from lanes of variables
        double lanes[order + 1][width];
        for (int k = 0; k <= order; ++k) dop853::put(lanes[k], c[k]);
        double* row = coefficients_.data() + i * (order + 1);
        for (std::ptrdiff_t l = 0; l < width; ++l)
            for (int k = 0; k <= order; ++k) *row++ = lanes[k][l];
    }
}

template <class Lanes>
RBDYN_INLINE_LANES void Dop853Step::close(const Start& from, double h) {
    for (std::ptrdiff_t i = 0; i < stride_; i += dop853::width<Lanes>) {
        Lanes a, low, slope, bend, change;
        dop853::get(from.x + i, a);
        dop853::get(from.low + i, low);
        dop853::get(from.slope + i, slope);
        dop853::get(difference(12) + i, bend);
        advance<12>(from.slope, i, change);
        // exact_sum()
        const Lanes b = low + h * change, sum = a + b, v = sum - a;
        dop853::put(next_.x + i, sum);
        dop853::put(next_.low + i, (a - (sum - v)) + (b - v));
        dop853::put(next_.slope + i, slope + bend);
    }
}

/// What is not makes a multiple of zero that is no number.
template <class Lanes>
RBDYN_INLINE_LANES bool Dop853Step::is_finite(const double* a, std::ptrdiff_t count) {
    constexpr std::ptrdiff_t width = dop853::width<Lanes>;
    Lanes check{}, lanes;
    for (std::ptrdiff_t i = 0; i < count; i += width) {
        dop853::get(a + i, lanes);
        check = check + 0.0 * lanes;
    }
    double each[width];
    dop853::put(each, check);
    for (const double one : each)
        if (one != 0.0) return false;
    return true;
}

// after what they are made of, so that this is part of each

RBDYN_INLINE bool Dop853Step::plain(Dop853Step& step, Part part, const Start& from, double h) {
#if defined(__GNUC__) || defined(__clang__)
    return step.run<series::Pair>(part, from, h);
#else
    return step.run<double>(part, from, h);
#endif
}

#ifdef RBDYN_WIDE_LANES
__attribute__((target("avx2"))) RBDYN_INLINE bool Dop853Step::wide(Dop853Step& step, Part part, const Start& from,
                                                                   double h) {
    return step.run<series::Quad>(part, from, h);
}
#endif

}  // namespace rbdyn::inline RBDYN_FORM
