// Definitions of rbdyn/model/leading_sign.hpp.
#pragma once

#include "rbdyn/model/leading_sign.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>
#include <vector>

#include "rbdyn/expression/borrowed_series.hpp"
#include "rbdyn/expression/evaluate.hpp"
#include "rbdyn/expression/program.hpp"
#include "rbdyn/expression/rounding_sizes.hpp"
#include "rbdyn/expression/series_evaluator.hpp"
#include "rbdyn/expression/term_sizes.hpp"
#include "rbdyn/model/at_zero.hpp"
#include "rbdyn/model/equations.hpp"
#include "rbdyn/model/hybrid.hpp"

namespace rbdyn::inline RBDYN_FORM::leading {

RBDYN_INLINE int by_values(const Mode& mode, double t, std::span<const double> x, int output, bool is_zero) {
    RoundingSizes f(mode.equations->program);
    f.set_parameters(mode.parameters);
    const std::size_t n = x.size();
    using State = std::vector<double>;
    const auto rates = [&](double time, const State& state) {
        f(time, state);
        State slope(n);
        for (std::size_t i = 0; i < n; ++i) slope[i] = f.output(static_cast<int>(i));
        return slope;
    };
    const State y(x.begin(), x.end());
    const auto moved = [&](double h, const State& slope) {
        State z = y;
        for (std::size_t i = 0; i < n; ++i) z[i] += h * slope[i];
        return z;
    };
    const State a = rates(t, y);
    const double begin = is_zero ? f.output(output) : 0.0;
    // positions change by their velocities, velocities by accelerations: the time in which they do so as much as they
    // are
    double time = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < n; ++i)
        if (a[i] != 0.0 && y[i] != 0.0) time = std::min(time, std::abs(y[i] / a[i]));
    if (!std::isfinite(time)) time = std::max(1.0, std::abs(t));
    // where nothing moves no time is special: from the rounding of times to far ones
    for (int k = -40; k <= 30; k += 2) {
        const double h = std::ldexp(time, k);
        const State b = rates(t + 0.5 * h, moved(0.5 * h, a)), c = rates(t + 0.5 * h, moved(0.5 * h, b)),
                    d = rates(t + h, moved(h, c)), e = rates(t + h, moved(h, a));
        State mean(n), rough(n);
        for (std::size_t i = 0; i < n; ++i) {
            mean[i] = (a[i] + 2.0 * (b[i] + c[i]) + d[i]) / 6.0;
            rough[i] = 0.5 * (a[i] + e[i]);
        }
        f(t + h, moved(h, rough));
        const double other = f.output(output) - begin;
        f(t + h, moved(h, mean));
        const double g = f.output(output) - begin;
        const double noise = 64.0 * std::numeric_limits<double>::epsilon() * f.size(output);
        if (std::abs(g) > noise + 4.0 * std::abs(g - other)) return g > 0.0 ? 1 : -1;
    }
    return 0;
}

}  // namespace rbdyn::inline RBDYN_FORM::leading

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE Leading leading_term(const Mode& mode, double t, std::span<const double> x, int output, int known_zeros,
                                  double doubt) {
    // most are told by their first coefficients
    constexpr int few = 4, most = 24;
    constexpr double rounding = 64.0 * std::numeric_limits<double>::epsilon();
    const Program& program = mode.equations->program;
    if (program.has_calls()) return {known_zeros, leading::by_values(mode, t, x, output, known_zeros > 0)};
    const BorrowedSeries borrowed(program, most);
    SeriesEvaluator& series = *borrowed;
    series.set_parameters(mode.parameters);
    series.begin(t, 1.0);
    for (std::size_t i = 0; i < x.size(); ++i) series.set_input(static_cast<int>(i), 0, x[i]);
    int done = -1;
    for (const int order : {few, most}) {
        for (int k = done + 1; k <= order; ++k) {
            series.advance(k);
            if (k < most)
                for (int i = 0; i < program.inputs(); ++i) series.set_input(i, k + 1, series.output(i)[k] / (k + 1));
        }
        const double* g = series.output(output);
        const TermSizes::Sizes sizes = TermSizes(series, order, TermSizes::many)(program.output(output));
        for (int k = std::max(known_zeros, done + 1); k <= order; ++k)
            if (std::abs(g[k]) >
                (k == known_zeros ? std::max(doubt, rounding) : rounding) * sizes[static_cast<std::size_t>(k)])
                return {k, g[k] > 0.0 ? 1 : -1};
        done = order;
    }
    return {most + 1, 0};
}

RBDYN_INLINE int leading_sign(const Mode& mode, double t, std::span<const double> x, int output, int known_zeros) {
    return leading_term(mode, t, x, output, known_zeros).sign;
}

RBDYN_INLINE bool only_dips(const Mode& mode, double t, std::span<const double> x, int output, double size) {
    constexpr int order = 2;
    const Program& program = mode.equations->program;
    if (program.has_calls()) return false;
    const BorrowedSeries borrowed(program, order);
    SeriesEvaluator& series = *borrowed;
    series.set_parameters(mode.parameters);
    series.begin(t, 1.0);
    for (std::size_t i = 0; i < x.size(); ++i) series.set_input(static_cast<int>(i), 0, x[i]);
    for (int k = 0; k <= order; ++k) {
        series.advance(k);
        if (k < order)
            for (int i = 0; i < program.inputs(); ++i) series.set_input(i, k + 1, series.output(i)[k] / (k + 1));
    }
    const double* g = series.output(output);
    const double rounding =
        4.0 * std::numeric_limits<double>::epsilon() * std::max(size, size_of_terms(mode, t, x, output));
    return g[2] > 0.0 && g[1] * g[1] <= 4.0 * g[2] * deepest_dip * rounding;
}

RBDYN_INLINE bool has_no_rates(const Mode& mode, double t, std::span<const double> x, std::span<const double> known) {
    const Program& program = mode.equations->program;
    if (program.has_calls()) return false;
    RoundingSizes f(program);
    f.set_parameters(mode.parameters);
    f(t, x, known);
    for (std::size_t i = 0; i < x.size(); ++i) {
        const int rate = static_cast<int>(i);
        if (!(std::abs(f.output(rate)) <= 64.0 * std::numeric_limits<double>::epsilon() * f.size(rate))) return false;
    }
    return true;
}

RBDYN_INLINE bool is_timeless(const Mode& mode, double t, std::span<const double> x) {
    const Program& program = mode.equations->program;
    if (program.has_calls()) return false;
    // as functions of time alone, the state being what it is
    constexpr int order = 24;
    const BorrowedSeries borrowed(program, order);
    SeriesEvaluator& series = *borrowed;
    series.set_parameters(mode.parameters);
    series.begin(t, 1.0);
    for (int k = 0; k <= order; ++k) {
        for (int i = 0; i < program.inputs(); ++i)
            series.set_input(i, k, k == 0 ? x[static_cast<std::size_t>(i)] : 0.0);
        series.advance(k);
    }
    const auto depends = [&](int output) {
        const double* g = series.output(output);
        return std::any_of(g + 1, g + order + 1, [](double one) { return one != 0.0; });
    };
    for (std::size_t i = 0; i < x.size(); ++i)
        if (depends(static_cast<int>(i))) return false;
    return std::none_of(mode.equations->guards.begin(), mode.equations->guards.end(),
                        [&](const Guard& g) { return g.output >= 0 ? depends(g.output) : g.watch >= 0; });
}

RBDYN_INLINE void find_leading_powers(Mode& mode, double t, std::span<const double> x) {
    constexpr int most = 6;
    const Program& program = mode.equations->program;
    const auto& switches = program.switches();
    if (program.has_calls()) return;
    struct Beginning {
        double* flag;
        double before;
        int output;
        const Instruction* norm;
    };
    std::vector<Beginning> starts;
    for (std::size_t k = 0; k < switches.size(); ++k) {
        const int output = program.outputs() + static_cast<int>(k);
        const Instruction* norm = switches[k].is_norm ? program.norm(output) : nullptr;
        if (norm == nullptr) continue;
        double& flag = mode.parameters[static_cast<std::size_t>(switches[k].parameter)];
        starts.push_back({&flag, flag, output, norm});
    }
    // of a long chain a series takes longer to be made than a step; values tell of all that is far from zero
    constexpr std::size_t many = 1000;
    if (program.instructions().size() > many) {
        constexpr double far = 0x1p-30;
        RoundingSizes values(program);
        values.set_parameters(mode.parameters);
        values(t, x);
        std::erase_if(starts, [&](const Beginning& s) {
            return s.before == 0.0 && values.output(s.output) > far * values.size(s.output);
        });
    }
    if (starts.empty()) return;
    const BorrowedSeries borrowed(program, most);
    SeriesEvaluator& series = *borrowed;
    const auto expand = [&](int order) {
        series.set_parameters(mode.parameters);
        series.begin(t, 1.0);
        for (std::size_t i = 0; i < x.size(); ++i) series.set_input(static_cast<int>(i), 0, x[i]);
        for (int k = 0; k <= order; ++k) {
            series.advance(k);
            if (k < order) series.integrate(k);
        }
    };
    const auto any = [&](const Beginning& s, const auto& is_so) {
        return std::ranges::any_of(std::array{s.norm->a, s.norm->b, s.norm->c},
                                   [&](int slot) { return slot >= 0 && is_so(slot); });
    };
    // a guard that fires beside zero, for the series of what passes near it tell no difference, has not fired at it: by
    // more than rounding, and than it moves in the rounding of the time
    for (const Beginning& s : starts) *s.flag = 0.0;
    expand(std::ranges::any_of(starts, [](const Beginning& s) { return s.before != 0.0; }) ? 1 : 0);
    std::erase_if(starts, [&](const Beginning& s) {
        return any(s, [&](int slot) {
            const double* c = series.coefficients(slot);
            if (s.before == 0.0) return c[0] != 0.0;
            const double size = TermSizes(series, 0, TermSizes::many)(slot)[0] + std::abs(c[1] * t);
            return std::abs(c[0]) > 64.0 * std::numeric_limits<double>::epsilon() * size;
        });
    });
    for (const Beginning& s : starts) *s.flag = s.before;
    for (int m = 1; m <= most && !starts.empty(); ++m) {
        expand(m);
        std::erase_if(starts, [&](const Beginning& s) {
            return any(s, [&](int slot) {
                // each by itself: what is asked for within another's rate is known in part
                const double size = TermSizes(series, m, TermSizes::many)(slot)[static_cast<std::size_t>(m)];
                return std::abs(series.coefficients(slot)[m]) > 64.0 * std::numeric_limits<double>::epsilon() * size;
            });
        });
        for (const Beginning& s : starts) *s.flag = m + 1;
    }
    // what stays zero begins with no power
    for (const Beginning& s : starts) *s.flag = s.before;
}

}  // namespace rbdyn::inline RBDYN_FORM
