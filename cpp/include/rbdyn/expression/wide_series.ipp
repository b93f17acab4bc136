// Definitions of rbdyn/expression/wide_series.hpp.
#pragma once

#include "rbdyn/expression/wide_series.hpp"

#include <algorithm>
#include <cstddef>
#include <limits>
#include <span>
#include <vector>

#include "rbdyn/basics/double_double_functions.hpp"
#include "rbdyn/expression/program.hpp"
#include "rbdyn/expression/program_weights.hpp"
#include "rbdyn/expression/series_evaluator.hpp"

namespace rbdyn::inline RBDYN_FORM {

namespace wide_series {

/// sum_{j=from..to} a_j b_{k-j}
inline DoubleDouble product(const DoubleDouble* a, const DoubleDouble* b, int k, int from, int to) {
    DoubleDouble sum = 0.0;
    for (int j = from; j <= to; ++j) sum += a[j] * b[k - j];
    return sum;
}

/// (1/k) sum_{j=1..k} j a_j b_{k-j}, the coefficient of the integral of a' b.
inline DoubleDouble of_slope(const DoubleDouble* a, const DoubleDouble* b, int k) {
    DoubleDouble sum = 0.0;
    for (int j = 1; j <= k; ++j) sum += static_cast<double>(j) * a[j] * b[k - j];
    return sum / static_cast<double>(k);
}

/// As SeriesEvaluator::stays_at_zero().
inline bool stays_at_zero(const DoubleDouble* a, const DoubleDouble* out, int k) {
    return a[0].hi == 0.0 && a[k].hi == 0.0 && out[k - 1].hi == 0.0;
}

}  // namespace wide_series

RBDYN_INLINE WideSeries::WideSeries(const Program& program, int order)
    : program_(&program),
      order_(order),
      storage_(static_cast<std::size_t>(program.slots()) * static_cast<std::size_t>(order + 1)),
      valuations_(static_cast<std::size_t>(program.states()), -1) {}

RBDYN_INLINE void WideSeries::set_parameters(std::span<const double> parameters) {
    const std::vector<DoubleDouble> wide(parameters.begin(), parameters.end());
    program_->set_parameters(std::span<const DoubleDouble>(wide), scalars_);
}

RBDYN_INLINE void WideSeries::expand(double t, double unit, std::span<const DoubleDouble> x) {
    std::ranges::fill(valuations_, -1);
    if (program_->uses_time()) {
        DoubleDouble* time = slot(program_->time_slot());
        std::fill_n(time, order_ + 1, DoubleDouble(0.0));
        time[0] = t;
        if (order_ > 0) time[1] = unit;
    }
    const int n = static_cast<int>(x.size());
    for (int i = 0; i < n; ++i) slot(i)[0] = x[static_cast<std::size_t>(i)];
    for (int k = 0; k <= order_; ++k) {
        advance(k);
        if (k == order_) break;
        for (int i = 0; i < n; ++i) slot(i)[k + 1] = slot(program_->output(i))[k] * unit / static_cast<double>(k + 1);
    }
}

RBDYN_INLINE DoubleDouble WideSeries::input(int variable, double tau) const {
    const DoubleDouble* c = slot(variable);
    DoubleDouble sum = c[order_];
    for (int k = order_; k-- > 0;) sum = sum * tau + c[k];
    return sum;
}

RBDYN_INLINE void WideSeries::give(SeriesEvaluator& series) const {
    for (int s = 0; s < program_->slots(); ++s)
        for (int k = 0; k <= order_; ++k) series.set_input(s, k, static_cast<double>(slot(s)[k]));
}

RBDYN_INLINE void WideSeries::advance(int k) {
    for (const Instruction& i : program_->instructions()) compute(i, k);
}

RBDYN_INLINE DoubleDouble WideSeries::combined(const Instruction& i, int k) const {
    const auto weight = [&](int index) { return scalars_[static_cast<std::size_t>(index)]; };
    DoubleDouble sum = k == 0 && i.weight >= 0 ? weight(i.weight) : DoubleDouble(0.0);
    for (const Term *t = program_->terms(i), *end = t + i.terms; t != end; ++t)
        sum += weight(t->weight) * slot(t->slot)[k];
    for (const ProductTerm *p = program_->products(i), *end = p + i.products; p != end; ++p)
        sum += weight(p->weight) * wide_series::product(slot(p->a), slot(p->b), k, 0, k);
    return sum;
}

RBDYN_INLINE void WideSeries::compute(const Instruction& i, int k) {
    using wide_series::of_slope, wide_series::product;
    const auto view = [&](int index) { return index >= 0 ? slot(index) : nullptr; };
    DoubleDouble *const out = view(i.out), *const out2 = view(i.out2);
    const DoubleDouble *const a = view(i.a), *const b = view(i.b), *const c = view(i.c);
    const auto order = static_cast<double>(k);
    switch (i.code) {
        case Code::combine: out[k] = combined(i, k); break;
        case Code::divide: out[k] = (a[k] - product(b, out, k, 1, k)) / b[0]; break;
        case Code::square_root:
            if (k > 0 && wide_series::stays_at_zero(a, out, k))
                out[k] = 0.0;
            else
                out[k] = k == 0 ? sqrt(a[0]) : (a[k] - product(out, out, k, 1, k - 1)) / (2.0 * out[0]);
            break;
        case Code::norm: norm(i, k); break;
        case Code::sine_cosine:
            if (k == 0) {
                const auto [sine, cosine] = sine_cosine(a[0]);
                out[0] = sine;
                out2[0] = cosine;
                break;
            }
            out[k] = of_slope(a, out2, k);
            out2[k] = -of_slope(a, out, k);
            break;
        case Code::hyperbolic:
            out[k] = k == 0 ? sinh(a[0]) : of_slope(a, out2, k);
            out2[k] = k == 0 ? cosh(a[0]) : of_slope(a, out, k);
            break;
        case Code::tangent: {
            // t' = (1 - t^2) a'
            out[k] = k == 0 ? tanh(a[0]) : of_slope(a, out2, k);
            const DoubleDouble cosine = cosh(a[0]);
            out2[k] = k == 0 ? 1.0 / (cosine * cosine) : -product(out, out, k, 0, k);
            break;
        }
        case Code::angle: {
            // (x^2 + y^2) p' = x y' - y x'; y is a, x is b, their square c
            if (k == 0) {
                out[0] = atan2(a[0], b[0]);
                break;
            }
            DoubleDouble turn = 0.0;
            for (int j = 1; j <= k; ++j) turn += static_cast<double>(j) * (a[j] * b[k - j] - b[j] * a[k - j]);
            for (int j = 1; j < k; ++j) turn -= static_cast<double>(j) * out[j] * c[k - j];
            out[k] = turn / (order * c[0]);
            break;
        }
        case Code::call: {
            const double nothing = std::numeric_limits<double>::quiet_NaN();
            for (const int result : program_->calls()[static_cast<std::size_t>(i.extra)].results)
                slot(result)[k] = nothing;
            break;
        }
        case Code::exponential:
            out[k] = k > 0 ? of_slope(a, out, k) : b != nullptr ? pow(b[0], c[0]) : exp(a[0]);
            break;
        case Code::expm1:
            out[k] = k == 0 ? expm1(a[0]) : of_slope(a, out2, k);
            out2[k] = k == 0 ? exp(a[0]) : out[k];
            break;
        case Code::log1p:
        case Code::arsinh:
        case Code::artanh: {
            // d y' = a', d = 1 + a, sqrt(1 + a^2), for which d' = a y', or 1 - a^2
            if (k == 0) {
                out[0] = inverse(i.code, a[0]);
                out2[0] = inverse_divisor(i.code, a[0]);
                break;
            }
            DoubleDouble sum = order * a[k];
            for (int j = 1; j < k; ++j) sum -= static_cast<double>(j) * out[j] * out2[k - j];
            out[k] = sum / (order * out2[0]);
            out2[k] = i.code == Code::log1p    ? a[k]
                      : i.code == Code::arsinh ? of_slope(out, a, k)
                                               : -product(a, a, k, 0, k);
            break;
        }
        case Code::logarithm: {
            // a l' = a'
            if (k == 0) {
                out[0] = log(a[0]);
                break;
            }
            DoubleDouble sum = order * a[k];
            for (int j = 1; j < k; ++j) sum -= static_cast<double>(j) * out[j] * a[k - j];
            out[k] = sum / (order * a[0]);
            break;
        }
        case Code::power: {
            // a p' = r a' p
            if (k == 0) {
                out[0] = pow(a[0], i.value);
                break;
            }
            if (wide_series::stays_at_zero(a, out, k)) {
                out[k] = 0.0;
                break;
            }
            DoubleDouble sum = 0.0;
            for (int j = 1; j <= k; ++j) sum += ((i.value + 1.0) * j - order) * a[j] * out[k - j];
            out[k] = sum / (order * a[0]);
            break;
        }
    }
}

RBDYN_INLINE void WideSeries::norm(const Instruction& i, int k) {
    // |v| for v = t^m d(t), d(0) not zero: t^m |d(t)|
    int& m = valuations_[static_cast<std::size_t>(i.extra)];
    DoubleDouble* const out = slot(i.out);
    const DoubleDouble* const part[3] = {slot(i.a), slot(i.b), slot(i.c)};
    if (m < 0) {
        const bool ignored = i.weight >= 0 && k < scalars_[static_cast<std::size_t>(i.weight)].hi;
        DoubleDouble square = 0.0;
        for (const DoubleDouble* v : part) square += v[k] * v[k];
        out[k] = ignored ? DoubleDouble(0.0) : sqrt(square);
        if (!ignored && square.hi > 0.0) m = k;
        return;
    }
    DoubleDouble square = 0.0;
    for (const DoubleDouble* v : part) square += wide_series::product(v, v, k + m, m, k);
    out[k] = (square - wide_series::product(out, out, k + m, m + 1, k - 1)) / (2.0 * out[m]);
}

}  // namespace rbdyn::inline RBDYN_FORM
