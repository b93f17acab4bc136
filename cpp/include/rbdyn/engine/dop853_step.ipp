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
    for (Doubles* v : {&y_, &fifth_, &third_, &defect_}) v->assign(count, 0.0);
    differences_.assign(count * dop853::stages, 0.0);
    coefficients_.assign(count * (order + 1), 0.0);
}

RBDYN_INLINE bool Dop853Step::evaluate(double t, double* slope) {
    const auto is_finite_too = [this](const double* values) {
        double check = 0.0;
        for (int i = 0; i < n_; ++i) check += 0.0 * values[i];
        return check == 0.0;
    };
    if (asks_each_ && !is_finite_too(y_.data())) return false;
    ++evaluations_;
    equations_->rates(t, {y_.data(), static_cast<std::size_t>(n_)}, slope);
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
    const Arrays a = arrays(from, h);
    switch (part) {
        case Part::step:
        case Part::state: {
            Lanes first{};
            for (std::ptrdiff_t i = 0; i < a.stride; i += dop853::width<Lanes>) state<1>(a, i, first);
            if (!stages<Lanes>(std::make_integer_sequence<int, 11>{}, from, a)) return false;
            if (part == Part::state) return asks_each_ || is_finite<Lanes>(difference(1), 11 * stride_);
            if (!stage<12, 0, Lanes>(from, a)) return false;
            estimate<Lanes>(a);
            return asks_each_ || (is_finite<Lanes>(difference(1), 12 * stride_) && is_finite<Lanes>(a.y, stride_));
        }
        case Part::interpolant: return interpolant<Lanes>(from, a);
        case Part::finish: close<Lanes>(a); return true;
    }
    return false;
}

template <int row, int lo, int hi, class Lanes>
RBDYN_INLINE_LANES void Dop853Step::weighted(const double* k, std::ptrdiff_t stride, const Lanes& newest, Lanes& sum) {
    if constexpr (hi - lo == 1) {
        constexpr double weight = dop853::weight(row, lo);
        // of a stage the last one, which was just computed
        if constexpr (row < dop853::stages && lo == row - 1) {
            sum = weight * newest;
        } else {
            Lanes there;
            dop853::get(k + lo * stride, there);
            sum = weight * there;
        }
    } else {
        constexpr int middle = (lo + hi) / 2;
        Lanes first, second;
        weighted<row, lo, middle>(k, stride, newest, first);
        weighted<row, middle, hi>(k, stride, newest, second);
        sum = first + second;
    }
}

template <int s, class Lanes>
RBDYN_INLINE_LANES void Dop853Step::state(const Arrays& a, std::ptrdiff_t i, const Lanes& newest) {
    Lanes x, low, change;
    dop853::get(a.slope + i, change);
    change = dop853::c[s] * change;
    if constexpr (s > 1) {
        Lanes rest;
        weighted<s, first_of(s), s>(a.k + i, a.stride, newest, rest);
        change = change + rest;
    }
    dop853::get(a.x + i, x);
    dop853::get(a.low + i, low);
    dop853::put(a.y + i, x + (low + a.h * change));
}

template <int s, int next, class Lanes>
RBDYN_INLINE_LANES void Dop853Step::go_on(const Arrays& a) {
    for (std::ptrdiff_t i = 0; i < a.stride; i += dop853::width<Lanes>) {
        Lanes rate, first;
        dop853::get(a.k + s * a.stride + i, rate);
        dop853::get(a.slope + i, first);
        rate = rate - first;
        dop853::put(a.k + s * a.stride + i, rate);
        if constexpr (next > 0) state<next>(a, i, rate);
    }
}

template <int s, int next, class Lanes>
RBDYN_INLINE_LANES bool Dop853Step::stage(const Start& from, const Arrays& a) {
    const bool is_there = evaluate(time(from.t, dop853::c[s] * a.h), a.k + s * a.stride);
    go_on<s, next, Lanes>(a);
    return is_there;
}

template <class Lanes, int... s>
RBDYN_INLINE_LANES bool Dop853Step::stages(std::integer_sequence<int, s...>, const Start& from, const Arrays& a) {
    return (stage<s + 1, s + 2, Lanes>(from, a) && ...);
}

RBDYN_INLINE_LANES double Dop853Step::time(Instant t, double h) {
    const double sum = t.hi + h, v = sum - t.hi, low = (t.hi - (sum - v)) + (h - v);
    return sum + (low + t.lo);
}

template <class Lanes>
RBDYN_INLINE_LANES void Dop853Step::estimate(const Arrays& a) {
    for (std::ptrdiff_t i = 0; i < a.stride; i += dop853::width<Lanes>) {
        Lanes none{}, sum;
        weighted<dop853::fifth, 5, 12>(a.k + i, a.stride, none, sum);
        dop853::put(fifth_.data() + i, sum);
        weighted<dop853::third, 5, 12>(a.k + i, a.stride, none, sum);
        dop853::put(third_.data() + i, sum);
    }
}

template <class Lanes>
RBDYN_INLINE_LANES bool Dop853Step::interpolant(const Start& from, const Arrays& a) {
    for (std::ptrdiff_t i = 0; i < a.stride; i += dop853::width<Lanes>) {
        Lanes last;
        dop853::get(a.k + 12 * a.stride + i, last);
        state<13>(a, i, last);
    }
    if (!stage<13, 14, Lanes>(from, a) || !stage<14, 15, Lanes>(from, a) || !stage<15, 0, Lanes>(from, a)) return false;
    polynomial<Lanes>(a);
    // its estimates have served
    double* const slope = fifth_.data();
    if (!evaluate(time(from.t, defect_place * a.h), slope)) return false;
    double* const defect = defect_.data();
    for (std::ptrdiff_t i = 0; i < a.stride; i += dop853::width<Lanes>) {
        Lanes rate, change;
        dop853::get(slope + i, rate);
        dop853::get(defect + i, change);
        dop853::put(defect + i, a.h * rate - change);
    }
    return asks_each_ || (is_finite<Lanes>(difference(13), 3 * stride_) && is_finite<Lanes>(slope, stride_));
}

/// Also the state at the place of its defect, and the change there in a whole step.
template <class Lanes>
RBDYN_INLINE_LANES void Dop853Step::polynomial(const Arrays& a) {
    constexpr std::ptrdiff_t width = dop853::width<Lanes>;
    const double h = a.h;
    double *const defect = defect_.data(), *const coefficients = coefficients_.data();
    for (std::ptrdiff_t i = 0; i < a.stride; i += width) {
        const double* k = a.k + i;
        Lanes none{}, beyond, bend, f3, f4, f5, f6, c[order + 1];
        dop853::get(k + 11 * a.stride, none);
        weighted<12, 5, 12>(k, a.stride, none, beyond);  // what the slope at the start does not do
        dop853::get(k + 12 * a.stride, bend);
        weighted<dop853::dense, 5, 16>(k, a.stride, none, f3);
        weighted<dop853::dense + 1, 5, 16>(k, a.stride, none, f4);
        weighted<dop853::dense + 2, 5, 16>(k, a.stride, none, f5);
        weighted<dop853::dense + 3, 5, 16>(k, a.stride, none, f6);
        // y = x + s (dx + (1-s) (f1 + s (f2 + (1-s) (f3 + s (f4 + (1-s) (f5 + s f6)))))) in powers of s
        const Lanes f1 = -h * beyond, f2 = h * (2.0 * beyond - bend);
        f3 = h * f3;
        f4 = h * f4;
        f5 = h * f5;
        f6 = h * f6;
        dop853::get(a.x + i, c[0]);
        dop853::get(a.slope + i, c[1]);
        c[1] = h * c[1];
        c[2] = f3 + (f2 - f1);
        c[3] = f5 + (f4 - 2.0 * f3) - f2;
        c[4] = f6 - 3.0 * f5 - 2.0 * f4 + f3;
        c[5] = 3.0 * (f5 - f6) + f4;
        c[6] = 3.0 * f6 - f5;
        c[7] = -f6;
        Lanes value = c[order], change = static_cast<double>(order) * c[order];
        horner<order - 1>(c, value, change);
        dop853::put(a.y + i, value);
        dop853::put(defect + i, change);
        double lanes[(order + 1) * width];
        for (int j = 0; j <= order; ++j) dop853::put(lanes + j * width, c[j]);
        rows<0, Lanes>(lanes, coefficients + i * (order + 1));
    }
}

template <int k, class Lanes>
RBDYN_INLINE_LANES void Dop853Step::horner(const Lanes* c, Lanes& value, Lanes& change) {
    value = value * defect_place + c[k];
    if constexpr (k > 0) {
        change = change * defect_place + static_cast<double>(k) * c[k];
        horner<k - 1>(c, value, change);
    }
}

template <int lane, class Lanes>
RBDYN_INLINE_LANES void Dop853Step::rows(const double* lanes, double* out) {
    constexpr std::ptrdiff_t width = dop853::width<Lanes>;
    const double* c = lanes + lane;
    const double row[order + 1] = {c[0],         c[width],     c[2 * width], c[3 * width],
                                   c[4 * width], c[5 * width], c[6 * width], c[7 * width]};
    std::memcpy(out + lane * (order + 1), row, sizeof row);
    if constexpr (lane + 1 < width) rows<lane + 1, Lanes>(lanes, out);
}

template <class Lanes>
RBDYN_INLINE_LANES void Dop853Step::close(const Arrays& a) {
    for (std::ptrdiff_t i = 0; i < a.stride; i += dop853::width<Lanes>) {
        Lanes x, low, slope, bend, change, rest, newest;
        dop853::get(a.x + i, x);
        dop853::get(a.low + i, low);
        dop853::get(a.slope + i, slope);
        dop853::get(a.k + 12 * a.stride + i, bend);
        dop853::get(a.k + 11 * a.stride + i, newest);
        weighted<12, first_of(12), 12>(a.k + i, a.stride, newest, rest);
        change = dop853::c[12] * slope + rest;
        // exact_sum()
        const Lanes b = low + a.h * change, sum = x + b, v = sum - x;
        dop853::put(next_.x + i, sum);
        dop853::put(next_.low + i, (x - (sum - v)) + (b - v));
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
