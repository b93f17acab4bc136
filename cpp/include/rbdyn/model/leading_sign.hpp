// The sign that a function of the motion takes just after a time at which it is zero.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <vector>

#include "rbdyn/expression/evaluate.hpp"
#include "rbdyn/expression/series_evaluator.hpp"
#include "rbdyn/model/hybrid.hpp"

namespace rbdyn {

namespace leading {

/// The time in which a state changes by as much as its first derivative says, from its series in seconds, so that no
/// unit matters.
inline double time_scale(const SeriesEvaluator& series, int variables, int order) {
    double log_time = std::numeric_limits<double>::infinity();
    for (int i = 0; i < variables; ++i) {
        const double* c = series.coefficients(i);
        for (int k = 2; k <= order && c[1] != 0.0; ++k)
            if (c[k] != 0.0) log_time = std::min(log_time, std::log2(std::abs(c[1] / c[k])) / (k - 1));
    }
    return std::isfinite(log_time) ? std::exp2(log_time) : 1.0;
}

/// By values alone, for equations that call back: the sign a short way on, along a step of Heun's method.
inline int by_values(const Mode& mode, double t, std::span<const double> x, int output) {
    Evaluator<double> f(mode.equations->program);
    f.set_parameters(mode.parameters);
    const std::size_t n = x.size();
    std::vector<double> slope(n), y(n), moved(n);
    const auto rates = [&](double time, const std::vector<double>& state, std::vector<double>& out) {
        f(time, state);
        for (std::size_t i = 0; i < n; ++i) out[i] = f.output(static_cast<int>(i));
    };
    y.assign(x.begin(), x.end());
    rates(t, y, slope);
    // positions change by their velocities, velocities by accelerations: the time in which they do so as much as they
    // are
    double time = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < n; ++i)
        if (slope[i] != 0.0 && y[i] != 0.0) time = std::min(time, std::abs(y[i] / slope[i]));
    const double h = 1e-4 * (std::isfinite(time) ? time : std::max(1.0, std::abs(t)));
    for (std::size_t i = 0; i < n; ++i) moved[i] = y[i] + h * slope[i];
    std::vector<double> later(n);
    rates(t + h, moved, later);
    for (std::size_t i = 0; i < n; ++i) moved[i] = y[i] + 0.5 * h * (slope[i] + later[i]);
    f(t + h, moved);
    const double g = f.output(output);
    return std::abs(g) <= 1e-13 * f.magnitude(output) ? 0 : g > 0.0 ? 1 : -1;
}

}  // namespace leading

/// The sign an output of a mode's equations takes just after t: that of its first coefficient that is not zero. 0: it
/// stays zero.
/// `known_zeros`: how many of the first are zero but for rounding.
inline int leading_sign(const Mode& mode, double t, std::span<const double> x, int output, int known_zeros = 0) {
    constexpr int order = 8;
    const Program& program = mode.equations->program;
    if (program.has_calls()) return leading::by_values(mode, t, x, output);
    SeriesEvaluator series(program, order);
    series.set_parameters(mode.parameters);
    series.begin(t, 1.0);
    for (std::size_t i = 0; i < x.size(); ++i) series.set_input(static_cast<int>(i), 0, x[i]);
    for (int k = 0; k <= order; ++k) {
        series.advance(k);
        if (k < order)
            for (int i = 0; i < program.inputs(); ++i) series.set_input(i, k + 1, series.output(i)[k] / (k + 1));
    }
    const double time = leading::time_scale(series, program.inputs(), order);
    const double* g = series.output(output);
    double size = 0.0;
    for (int k = known_zeros; k <= order; ++k) size = std::max(size, std::abs(g[k]) * std::pow(time, k));
    // a function that is zero always has the rounding of its terms for coefficients
    Evaluator<double> values(program);
    values.set_parameters(mode.parameters);
    values(t, x);
    const double nothing =
        std::max(1e-13 * size, 64.0 * std::numeric_limits<double>::epsilon() * values.magnitude(output));
    for (int k = known_zeros; k <= order; ++k)
        if (std::abs(g[k]) * std::pow(time, k) > nothing) return g[k] > 0.0 ? 1 : -1;
    return 0;
}

}  // namespace rbdyn
