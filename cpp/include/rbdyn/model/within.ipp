// Definitions of rbdyn/model/within.hpp.
#pragma once

#include "rbdyn/model/within.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>
#include <vector>

#include "rbdyn/expression/evaluate.hpp"
#include "rbdyn/model/equations.hpp"
#include "rbdyn/model/hybrid.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE Within::Within(const Mode& mode, double time, std::span<const double> state, double most)
    : t(time), x(state) {
    if (mode.equations == nullptr || mode.equations->branches.empty()) return;
    Evaluator<double> values(mode.equations->program);
    values.set_parameters(mode.parameters);
    const auto evaluate = [&](double at_time) { values(at_time, x); };
    evaluate(t);
    const Guard* beyond = nullptr;
    double value = 0.0, margin = 0.0;
    for (const Guard& guard : mode.equations->guards) {
        if (guard.branch < 0) continue;
        const double g = values.output(guard.output),
                     noise = 64.0 * std::numeric_limits<double>::epsilon() * values.magnitude(guard.output);
        if (g > noise || std::abs(g) > 1e6 * noise) continue;
        beyond = &guard;
        value = g;
        margin = noise;
    }
    if (beyond == nullptr) return;
    std::vector<double> slope(x.size());
    for (std::size_t i = 0; i < x.size(); ++i) slope[i] = values.output(static_cast<int>(i));
    const std::vector<double> start(x.begin(), x.end());
    // the rate of the guard, from a small step of the whole state
    const double whole = time_of(start, slope, time), step = 0x1p-20 * whole;
    const auto go = [&](double h) {
        moved = start;
        for (std::size_t i = 0; i < moved.size(); ++i) moved[i] += h * slope[i];
        x = moved;
        t = time + h;
        evaluate(t);
        return values.output(beyond->output);
    };
    const double rate = (go(step) - value) / step;
    // exactly on the edge, and of no size: at t = 0, say
    const double h = margin > 0.0 ? (2.0 * margin - value) / rate : 0x1p-30 * step;
    if (rate != 0.0 && std::isfinite(rate) && std::abs(h) <= most * whole) {
        go(h);
    } else {
        t = time;
        x = state;
    }
}

RBDYN_INLINE double Within::time_of(const std::vector<double>& x, const std::vector<double>& slope, double t) {
    double time = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < x.size(); ++i)
        if (slope[i] != 0.0 && x[i] != 0.0) time = std::min(time, std::abs(x[i] / slope[i]));
    return std::isfinite(time) ? time : std::max(std::abs(t), 1.0);
}

}  // namespace rbdyn::inline RBDYN_FORM
