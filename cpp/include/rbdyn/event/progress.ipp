// Definitions of rbdyn/event/progress.hpp.
#pragma once

#include "rbdyn/event/progress.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "rbdyn/basics/instant.hpp"
#include "rbdyn/expression/evaluate.hpp"
#include "rbdyn/model/equations.hpp"
#include "rbdyn/model/hybrid.hpp"
#include "rbdyn/series/piece.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE Progress::Progress(double tolerance) : hardly_(std::min(100.0 * tolerance, 1e-4)) {}

RBDYN_INLINE Progress::Verdict Progress::after(const Mode& mode, const Piece& piece, double length, double until,
                                               std::int64_t max_steps) {
    const auto n = at(piece.variables);
    if (low_.size() != n) {
        low_.assign(n, std::numeric_limits<double>::infinity());
        high_.assign(n, -std::numeric_limits<double>::infinity());
        x_.resize(n);
        count_ = 0;
    }
    for (std::size_t i = 0; i < n; ++i) {
        const double x = piece.variable(static_cast<int>(i))[0];
        low_[i] = std::min(low_[i], x);
        high_[i] = std::max(high_[i], x);
    }
    const Instant end = piece.at(length);
    if (is_slowing_down(end, piece.start, until, max_steps)) return Verdict::leads_nowhere;
    if (until - end <= few_steps * (end - piece.start)) {
        count_ = 0;
        return Verdict::gets_on;
    }
    piece.state(length, x_);
    if (count_ == 0) begin(piece);
    for (std::size_t i = 0; i < n; ++i) {
        const double step = std::abs(x_[i] - piece.variable(static_cast<int>(i))[0]);
        if (step > hardly_ * (high_[i] - low_[i])) {
            count_ = 0;
            return Verdict::gets_on;
        }
        way_[i] += step;
    }
    ++count_;
    if (mode.equations->program.has_calls() && count_ >= first_looked_at && count_ < first_looked_at + looked_at) {
        look(mode, piece, length);
        if (2 * crossings_ >= looked_at && jump_.variable >= 0) {
            pace_ = (end - since_) / count_;
            count_ = 0;
            return Verdict::jumps;
        }
    }
    if (count_ < row) return Verdict::gets_on;
    pace_ = (end - since_) / count_;
    count_ = 0;
    // what stands still goes nowhere, and need not
    if (std::ranges::all_of(way_, [](double way) { return way == 0.0; })) return Verdict::gets_on;
    for (std::size_t i = 0; i < n; ++i)
        if (std::abs(x_[i] - origin_[i]) > 0.05 * way_[i]) return Verdict::gets_on;
    const double more = (until - end) / pace_;
    return more > share * static_cast<double>(max_steps) ? Verdict::leads_nowhere : Verdict::gets_on;
}

RBDYN_INLINE bool Progress::is_slowing_down(Instant end, Instant start, double until, std::int64_t max_steps) {
    if (steps_ == 0) window_ = start;
    if (++steps_ < many_steps) return false;
    const double pace = (end - window_) / steps_;
    steps_ = 0;
    slower_ = last_pace_ > 0.0 && pace < 0.9 * last_pace_ ? slower_ + 1 : 0;
    last_pace_ = pace;
    return slower_ >= 3 && (until - end) / pace > static_cast<double>(max_steps);
}

RBDYN_INLINE double Progress::extent() const {
    double largest = 0.0;
    for (std::size_t i = 0; i < low_.size(); ++i) largest = std::max(largest, high_[i] - low_[i]);
    return largest;
}

RBDYN_INLINE void Progress::begin(const Piece& piece) {
    since_ = piece.start;
    origin_.resize(at(piece.variables));
    piece.state(0.0, origin_);
    way_.assign(origin_.size(), 0.0);
    crossings_ = 0;
    jump_ = {};
}

RBDYN_INLINE void Progress::look(const Mode& mode, const Piece& piece, double length) {
    Evaluator<double> f(mode.equations->program);
    f.set_parameters(mode.parameters);
    std::vector<double> y(x_.size());
    const auto rates = [&](const Instant& t, const std::vector<double>& x) {
        f(t.hi, x);
        std::vector<double> result(x.size());
        for (std::size_t i = 0; i < x.size(); ++i) result[i] = f.output(static_cast<int>(i));
        return result;
    };
    const Instant end = piece.at(length);
    const std::vector<double> here = rates(end, x_);
    // on the way of the step, and where the rates at its end would lead in a few more
    for (const double place : {0.25, 0.5, 0.75, 4.0}) {
        const double way = (place > 1.0 ? place : place - 1.0) * (end - piece.start);
        if (place < 1.0)
            piece.state(place * length, y);
        else
            for (std::size_t i = 0; i < y.size(); ++i) y[i] = x_[i] + way * here[i];
        const std::vector<double> there = rates(end + way, y);
        const int variable = most_different(here, there);
        if (variable < 0) continue;
        ++crossings_;
        if (jump_.variable >= 0) return;
        const auto k = at(variable);
        double lo = 0.0, hi = 1.0, before = here[k], after = there[k];
        std::vector<double> middle(y.size());
        for (int halving = 0; halving < 40; ++halving) {
            const double part = 0.5 * (lo + hi);
            for (std::size_t i = 0; i < middle.size(); ++i) middle[i] = x_[i] + part * (y[i] - x_[i]);
            const double value = rates(end + part * way, middle)[k];
            const bool is_after = std::abs(value - before) > std::abs(after - value);
            (is_after ? hi : lo) = part;
            (is_after ? after : before) = value;
        }
        if (std::abs(after - before) > 0.5 * std::abs(there[k] - here[k])) jump_ = {variable, before, after};
        return;
    }
}

RBDYN_INLINE int Progress::most_different(const std::vector<double>& a, const std::vector<double>& b) {
    int most = -1;
    double largest = 1e-3;
    for (std::size_t i = 0; i < a.size(); ++i) {
        const double size = std::max(std::abs(a[i]), std::abs(b[i]));
        if (!(std::abs(a[i] - b[i]) > largest * size)) continue;
        largest = std::abs(a[i] - b[i]) / size;
        most = static_cast<int>(i);
    }
    return most;
}

}  // namespace rbdyn::inline RBDYN_FORM
