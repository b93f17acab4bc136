// Definitions of rbdyn/expression/series_sizes.hpp.
#pragma once

#include "rbdyn/expression/series_sizes.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "rbdyn/expression/program.hpp"
#include "rbdyn/expression/series_evaluator.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE SeriesSizes::SeriesSizes(const Program& program, int order, bool functions_round)
    : program_(&program),
      row_(order + 1),
      functions_round_(functions_round),
      sizes_(static_cast<std::size_t>(program.slots() * row_), 0.0) {}

RBDYN_INLINE void SeriesSizes::operator()(const SeriesEvaluator& series) {
    const auto take = [&](int slot) {
        for (int k = 0; slot >= 0 && k < row_; ++k) of(slot)[k] = std::abs(series.coefficients(slot)[k]);
    };
    for (int slot = 0; slot <= program_->inputs(); ++slot) take(slot);
    for (const Instruction& i : program_->instructions()) {
        if (i.code == Code::combine) {
            combine(i, series);
            continue;
        }
        take(i.out);
        take(i.out2);
        const auto value = [&](int slot) { return slot >= 0 ? std::abs(series.coefficients(slot)[0]) : 0.0; };
        const double out = value(i.out), out2 = value(i.out2), a = value(i.a), b = value(i.b);
        // what is lost in an operand, times how much the result changes with it
        const auto lost = [&](int result, int operand, double slope) {
            if (operand < 0 || !(slope > 0.0) || !std::isfinite(slope)) return;
            const bool is_function = i.code != Code::divide && i.code != Code::norm;
            if (functions_round_ && is_function) of(result)[0] += slope * std::abs(series.coefficients(operand)[0]);
            for (int k = 0; k < row_; ++k)
                of(result)[k] += slope * std::max(0.0, of(operand)[k] - std::abs(series.coefficients(operand)[k]));
        };
        // the argument's own rounding, by the coefficients of the function's slope
        const auto turned = [&](int result, int slope) {
            if (!functions_round_ || result < 0 || slope < 0) return;
            for (int k = 1; k < row_; ++k) of(result)[k] += a * std::abs(series.coefficients(slope)[k]);
        };
        switch (i.code) {
            case Code::combine:
            case Code::call: break;
            case Code::divide:
                lost(i.out, i.a, 1.0 / b);
                lost(i.out, i.b, out / b);
                break;
            case Code::square_root: lost(i.out, i.a, 0.5 / out); break;
            case Code::norm:
                for (const int operand : {i.a, i.b, i.c}) lost(i.out, operand, 1.0);
                break;
            case Code::sine_cosine:
            case Code::hyperbolic:
                lost(i.out, i.a, out2);
                lost(i.out2, i.a, out);
                turned(i.out, i.out2);
                turned(i.out2, i.out);
                break;
            case Code::tangent: lost(i.out, i.a, out2); break;
            case Code::exponential: lost(i.out, i.a, out); break;
            case Code::logarithm: lost(i.out, i.a, 1.0 / a); break;
            case Code::expm1: lost(i.out, i.a, out2); break;
            case Code::log1p:
            case Code::arsinh:
            case Code::artanh: lost(i.out, i.a, 1.0 / out2); break;
            case Code::power: lost(i.out, i.a, std::abs(i.value) * out / a); break;
            case Code::angle:
                lost(i.out, i.a, 1.0 / std::hypot(a, b));
                lost(i.out, i.b, 1.0 / std::hypot(a, b));
                break;
        }
    }
}

RBDYN_INLINE const double* SeriesSizes::output(int index) const {
    return sizes_.data() + static_cast<std::ptrdiff_t>(program_->output(index)) * row_;
}

RBDYN_INLINE void SeriesSizes::combine(const Instruction& i, const SeriesEvaluator& series) {
    std::vector<double> sum(static_cast<std::size_t>(row_), 0.0);
    const auto weight = [&](int w) { return std::abs(scalars_[static_cast<std::size_t>(w)]); };
    if (i.weight >= 0) sum[0] = weight(i.weight);
    for (int j = 0; j < i.terms; ++j) {
        const Term& t = program_->terms(i)[j];
        for (int k = 0; k < row_; ++k) sum[static_cast<std::size_t>(k)] += weight(t.weight) * of(t.slot)[k];
    }
    for (int j = 0; j < i.products; ++j) {
        const ProductTerm& t = program_->products(i)[j];
        for (int k = 0; k < row_; ++k) {
            double product = 0.0;
            for (int l = 0; l <= k; ++l) {
                const double a = std::abs(series.coefficients(t.a)[l]), b = of(t.b)[k - l];
                product += a * b + (of(t.a)[l] - a) * std::abs(series.coefficients(t.b)[k - l]);
            }
            sum[static_cast<std::size_t>(k)] += weight(t.weight) * product;
        }
    }
    std::copy(sum.begin(), sum.end(), of(i.out));
}

}  // namespace rbdyn::inline RBDYN_FORM
