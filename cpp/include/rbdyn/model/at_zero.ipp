// Definitions of rbdyn/model/at_zero.hpp.
#pragma once

#include "rbdyn/model/at_zero.hpp"

#include <cmath>
#include <cstddef>
#include <limits>
#include <span>

#include "rbdyn/expression/evaluate.hpp"
#include "rbdyn/expression/program.hpp"
#include "rbdyn/expression/series_evaluator.hpp"
#include "rbdyn/expression/series_sizes.hpp"
#include "rbdyn/model/equations.hpp"
#include "rbdyn/model/hybrid.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE bool is_zero_at(const Mode& mode, double t, std::span<const double> x, int output, double few) {
    JacobianEvaluator f(mode.equations->program, true);
    f.set_parameters(mode.parameters);
    f.differentiate(t, x);
    const double value = std::abs(f.output(output));
    if (value <= few * f.magnitude(output)) return true;
    // time acts by itself and by the state
    double by_state = 0.0, rate = f.derivative(output, static_cast<int>(x.size()));
    for (std::size_t i = 0; i < x.size(); ++i) {
        const int variable = static_cast<int>(i);
        const double slope = f.derivative(output, variable);
        by_state += std::abs(slope * x[i]);
        rate += slope * f.output(variable);
    }
    return value <= few * (f.magnitude(output) + by_state + std::abs(t * rate));
}

RBDYN_INLINE double size_of_terms(const Mode& mode, double t, std::span<const double> x, int output) {
    const Program& program = mode.equations->program;
    JacobianEvaluator f(program);
    f.set_parameters(mode.parameters);
    f.differentiate(t, x);
    double sum = f.magnitude(output);
    if (!program.has_calls()) {
        SeriesEvaluator value(program, 0);
        value.set_parameters(mode.parameters);
        value.begin(t, 1.0);
        for (std::size_t i = 0; i < x.size(); ++i) value.set_input(static_cast<int>(i), 0, x[i]);
        value.advance(0);
        SeriesSizes sizes(program, 0);
        sizes.set_parameters(mode.parameters);
        sizes(value);
        sum = sizes.output(output)[0];
    }
    for (std::size_t i = 0; i < x.size(); ++i) sum += std::abs(f.derivative(output, static_cast<int>(i)) * x[i]);
    constexpr double few = 16.0 * std::numeric_limits<double>::epsilon();
    const double here = f.output(output);
    f(t + few * std::abs(t), x);
    return sum + std::abs(f.output(output) - here) / few;
}

RBDYN_INLINE bool is_level_at(const Mode& mode, double t, std::span<const double> x, int output) {
    JacobianEvaluator f(mode.equations->program, true);
    f.set_parameters(mode.parameters);
    f.differentiate(t, x);
    bool is_level = f.output(output) == 0.0;
    for (int i = 0; i <= static_cast<int>(x.size()); ++i) is_level = is_level && f.derivative(output, i) == 0.0;
    return is_level;
}

}  // namespace rbdyn::inline RBDYN_FORM
