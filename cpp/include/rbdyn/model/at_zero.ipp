// Definitions of rbdyn/model/at_zero.hpp.
#pragma once

#include "rbdyn/model/at_zero.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>

#include "rbdyn/expression/borrowed_series.hpp"
#include "rbdyn/expression/gradient.hpp"
#include "rbdyn/expression/program.hpp"
#include "rbdyn/expression/series_evaluator.hpp"
#include "rbdyn/expression/series_sizes.hpp"
#include "rbdyn/model/equations.hpp"
#include "rbdyn/model/hybrid.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE AtZero::AtZero(const Mode& mode, double t, std::span<const double> x)
    : f_(mode.equations->program), t_(t), x_(x.begin(), x.end()) {
    f_.set_parameters(mode.parameters);
    f_(t, x);
}

RBDYN_INLINE bool AtZero::operator()(int output, double few) {
    const double value = std::abs(f_.output(output));
    return value <= few * f_.magnitude(output) || value <= few * size(output);
}

RBDYN_INLINE double AtZero::size(int output) {
    // time acts by itself and by the state
    double by_state = 0.0, rate = 0.0;
    for (const auto& [variable, slope] : f_.gradient(output)) {
        const bool is_time = variable == static_cast<int>(x_.size());
        if (!is_time) by_state += std::abs(slope * x_[static_cast<std::size_t>(variable)]);
        rate += is_time ? slope : slope * f_.output(variable);
    }
    return f_.magnitude(output) + by_state + std::abs(t_ * rate);
}

RBDYN_INLINE bool is_zero_at(const Mode& mode, double t, std::span<const double> x, int output, double few) {
    return AtZero(mode, t, x)(output, few);
}

RBDYN_INLINE double size_of_terms(const Mode& mode, double t, std::span<const double> x, int output) {
    const Program& program = mode.equations->program;
    GradientEvaluator f(program);
    f.set_parameters(mode.parameters);
    f(t, x);
    double sum = f.magnitude(output);
    if (!program.has_calls()) {
        const BorrowedSeries borrowed(program, 0);
        SeriesEvaluator& value = *borrowed;
        value.set_parameters(mode.parameters);
        value.begin(t, 1.0);
        for (std::size_t i = 0; i < x.size(); ++i) value.set_input(static_cast<int>(i), 0, x[i]);
        value.advance(0);
        SeriesSizes sizes(program, 0);
        sizes.set_parameters(mode.parameters);
        sizes(value);
        sum = sizes.output(output)[0];
    }
    for (const auto& [variable, slope] : f.gradient(output))
        if (variable < static_cast<int>(x.size())) sum += std::abs(slope * x[static_cast<std::size_t>(variable)]);
    constexpr double few = 16.0 * std::numeric_limits<double>::epsilon();
    const double here = f.output(output);
    f(t + few * std::abs(t), x);
    return sum + std::abs(f.output(output) - here) / few;
}

RBDYN_INLINE bool is_level_at(const Mode& mode, double t, std::span<const double> x, int output) {
    GradientEvaluator f(mode.equations->program);
    f.set_parameters(mode.parameters);
    f(t, x);
    if (f.output(output) != 0.0) return false;
    const auto& slopes = f.gradient(output);
    return std::all_of(slopes.begin(), slopes.end(), [](const auto& slope) { return slope.second == 0.0; });
}

}  // namespace rbdyn::inline RBDYN_FORM
