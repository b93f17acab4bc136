// Definitions of rbdyn/engine/stiff_taylor.hpp.
#pragma once

#include "rbdyn/engine/stiff_taylor.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "rbdyn/basics/double_double_functions.hpp"
#include "rbdyn/basics/instant.hpp"
#include "rbdyn/engine/cvode_factory.hpp"
#include "rbdyn/engine/engine.hpp"
#include "rbdyn/engine/stiffness.hpp"
#include "rbdyn/engine/taylor.hpp"
#include "rbdyn/model/equations.hpp"

namespace rbdyn::inline RBDYN_FORM {

namespace stiff {

/// Steps of a series before it is looked at first, looks in a row, and steps that have to be ahead.
inline constexpr int first_look = 16, looks = 3, worth_it = 400;
/// Steps of BDF in a trial, which begins with order 1: what takes as long as a part of the steps ahead.
inline constexpr double share = 0.1, shortest_trial = 48.0, longest_trial = 1024.0;
/// Those by which its pace is measured, in a trial and after it.
inline constexpr int counted = 16, between_looks = 64;
/// How many times quicker than the series BDF has to be in a trial, and to go on.
inline constexpr double gain = 1.5, enough = 0.7;
/// What BDF is never asked for less than (see least_tolerance() of integrate.hpp).
inline constexpr double least_of_implicit = 2e-15;

}  // namespace stiff

RBDYN_INLINE void StiffTaylorEngine::start(const Equations& equations, std::span<const double> parameters, Instant t,
                                           std::span<const double> x) {
    mode_ = &equations;
    goes_on_ = is_implicit() && is_known();
    if (is_implicit() && !goes_on_) changes_.push_back({t.hi, TaylorEngine::name()});
    begin_series(stiff::first_look);
    TaylorEngine::start(equations, parameters, t, x);
    if (is_known()) phase_ = Phase::changing;
}

RBDYN_INLINE void StiffTaylorEngine::begin_series(int first_look) {
    phase_ = Phase::series;
    steps_ = looks_ = 0;
    looks_at_ = first_look;
}

RBDYN_INLINE std::optional<StepStatus> StiffTaylorEngine::begin_step(double limit) {
    // ten times what a trial took is to go by before the next
    if (phase_ == Phase::changing && !give_way(limit)) begin_series(static_cast<int>(price() * trial_ / stiff::share));
    if (is_implicit() && is_worth_it()) {
        const StepStatus status = implicit_step(limit);
        if (status == StepStatus::ok) return status;
        take_over(std::numeric_limits<int>::max());
    }
    return TaylorEngine::begin_step(limit);
}

RBDYN_INLINE std::optional<StepStatus> StiffTaylorEngine::end_step() {
    const std::optional<StepStatus> status = TaylorEngine::end_step();
    if (status == StepStatus::ok && ++steps_ >= looks_at_ && is_stiff(limit())) phase_ = Phase::changing;
    return status;
}

RBDYN_INLINE bool StiffTaylorEngine::is_stiff(double limit) {
    const double length = piece_.length * piece_.unit;
    // steps near the limit of stability go up and down: some looks in a row, then as many steps again
    looks_at_ = ++looks_ % stiff::looks == 0 ? 2 * steps_ : steps_ + 1;
    if (limit - t_ < stiff::worth_it * length) {
        looks_at_ = 2 * steps_;
        return false;
    }
    if (!Stiffness::may_rule(piece_, *mode_, scales_)) return false;
    Stiffness& fast = stiffness_of(*mode_);
    if (!fast.rules(piece_, parameters(), rounding(), scales_)) return false;
    reach_ = fast.reach();
    const double affordable = stiff::share * (limit - t_) / length / price();
    trial_ = static_cast<int>(std::clamp(affordable, stiff::shortest_trial, stiff::longest_trial));
    return true;
}

RBDYN_INLINE Stiffness& StiffTaylorEngine::stiffness_of(const Equations& equations) {
    for (auto& [known, stiffness] : known_)
        if (known == &equations) return *stiffness;
    known_.emplace_back(&equations, std::make_unique<Stiffness>(equations));
    return *known_.back().second;
}

RBDYN_INLINE double StiffTaylorEngine::price() {
    // ns, within a third on ten scenes of 2 to 400 variables: guards and Newton's equations are what BDF pays for,
    // instructions and orders what a series does
    const double n = mode_->variables(), guards = static_cast<double>(mode_->guards.size()),
                 instructions = static_cast<double>(mode_->program.instructions().size()),
                 solving = stiffness_of(*mode_).solving();
    return (700.0 + 1000.0 * guards + 150.0 * n + 4.0 * solving) /
           (300.0 + 9.0 * instructions * TaylorEngine::guard_order());
}

RBDYN_INLINE bool StiffTaylorEngine::is_known() const {
    return std::find(stiff_.begin(), stiff_.end(), mode_) != stiff_.end();
}

RBDYN_INLINE void StiffTaylorEngine::begin_implicit() {
    implicit_->start(*mode_, parameters(), t_, reached_);
    implicit_->recall(scales_.numbers());
    has_stepped_ = false;
    begin_count();
}

RBDYN_INLINE bool StiffTaylorEngine::give_way(double limit) {
    if (!implicit_) implicit_ = cvode::make("cvode-bdf", std::max(tolerance(), stiff::least_of_implicit), rounding());
    if (!implicit_) return false;
    reached_.resize(static_cast<std::size_t>(mode_->variables()));
    std::vector<double> low(reached_.size());
    TaylorEngine::standing(reached_, low);
    begin_implicit();
    if (!is_known()) {
        if (!succeeds(limit)) return false;
        stiff_.push_back(mode_);
        begin_implicit();
    }
    phase_ = Phase::implicit;
    if (!std::exchange(goes_on_, false)) changes_.push_back({t_.hi, implicit_->name()});
    return true;
}

RBDYN_INLINE bool StiffTaylorEngine::succeeds(double limit) {
    std::vector<double> x(reached_.size());
    Instant t = t_, counted_from = t_;
    bool is_quick = false;
    for (int step = 1; step <= trial_ && !is_quick; ++step) {
        if (implicit_->step(limit) != StepStatus::ok) break;
        const Piece& piece = implicit_->piece();
        t = piece.at(piece.length);
        const bool is_over = !(limit - t > 0.0);
        if (!is_over && step % stiff::counted != 0) continue;
        implicit_->state(piece.length, x);
        is_quick = quickness(t, x, (t - counted_from) / stiff::counted) >= stiff::gain;
        counted_from = t;
        if (is_over) break;
    }
    // nothing of it is handed out
    Work tried = implicit_->work();
    tried -= taken_;
    work_.rejected += tried.steps + tried.rejected;
    work_.right_hand_sides += tried.right_hand_sides;
    work_.jacobians += tried.jacobians;
    taken_ = implicit_->work();
    return is_quick;
}

RBDYN_INLINE double StiffTaylorEngine::quickness(Instant t, std::span<const double> x, double pace) {
    return pace * stiffness_of(*mode_).rate(t.hi, x) / (reach_ * price());
}

RBDYN_INLINE void StiffTaylorEngine::begin_count() {
    counted_ = implicit_->work().steps;
    counted_from_ = t_;
}

RBDYN_INLINE bool StiffTaylorEngine::is_worth_it() {
    const std::int64_t steps = implicit_->work().steps - counted_;
    if (steps < stiff::between_looks) return true;
    const double pace = (t_ - counted_from_) / static_cast<double>(steps);
    begin_count();
    if (quickness(t_, reached_, pace) >= stiff::enough) return true;
    std::erase(stiff_, mode_);
    take_over(stiff::first_look);
    return false;
}

RBDYN_INLINE void StiffTaylorEngine::take_over(int first_look) {
    std::vector<double> now(parameters().begin(), parameters().end());
    if (has_stepped_) drop_start_flags(*mode_, now);
    TaylorEngine::start(*mode_, now, t_, reached_);
    begin_series(first_look);
    changes_.push_back({t_.hi, TaylorEngine::name()});
}

RBDYN_INLINE StepStatus StiffTaylorEngine::implicit_step(double limit) {
    const StepStatus status = implicit_->step(limit);
    if (status == StepStatus::ok) {
        piece_ = implicit_->piece();
        t_ = piece_.at(piece_.length);
        implicit_->state(piece_.length, reached_);
        scales_.widen(reached_);
        has_stepped_ = true;
    }
    take_work();
    return status;
}

RBDYN_INLINE void StiffTaylorEngine::take_work() {
    work_ += implicit_->work();
    work_ -= taken_;
    taken_ = implicit_->work();
}

RBDYN_INLINE void StiffTaylorEngine::state(double tau, std::span<double> x) const {
    return is_implicit() ? implicit_->state(tau, x) : TaylorEngine::state(tau, x);
}

RBDYN_INLINE void StiffTaylorEngine::rest(double tau, std::span<const double> x, std::span<double> low) const {
    return is_implicit() ? implicit_->rest(tau, x, low) : TaylorEngine::rest(tau, x, low);
}

RBDYN_INLINE void StiffTaylorEngine::standing(std::span<double> x, std::span<double> low) const {
    return is_implicit() ? implicit_->standing(x, low) : TaylorEngine::standing(x, low);
}

RBDYN_INLINE std::vector<double> StiffTaylorEngine::memory() const {
    if (!is_implicit()) return TaylorEngine::memory();
    std::vector<double> all = scales_.numbers();
    all.push_back(reach_);
    return all;
}

RBDYN_INLINE void StiffTaylorEngine::recall(std::span<const double> memory) {
    const std::size_t count = MotionScales::count(static_cast<std::size_t>(mode_->variables()));
    if (memory.size() != count + 1) return TaylorEngine::recall(memory);
    scales_.set_numbers(memory.first(count));
    reach_ = memory.back();
    phase_ = Phase::changing;
}

RBDYN_INLINE double StiffTaylorEngine::natural_length() const {
    return is_implicit() ? implicit_->natural_length() : TaylorEngine::natural_length();
}

RBDYN_INLINE bool StiffTaylorEngine::refines() const {
    return is_implicit() ? implicit_->refines() : TaylorEngine::refines();
}

RBDYN_INLINE const double* StiffTaylorEngine::guard(int index) {
    if (!is_implicit()) return TaylorEngine::guard(index);
    const double* coefficients = implicit_->guard(index);
    take_work();
    return coefficients;
}

RBDYN_INLINE int StiffTaylorEngine::guard_order() const {
    return is_implicit() ? implicit_->guard_order() : TaylorEngine::guard_order();
}

RBDYN_INLINE void StiffTaylorEngine::guard_sizes(int index, double* sizes) {
    return is_implicit() ? implicit_->guard_sizes(index, sizes) : TaylorEngine::guard_sizes(index, sizes);
}

RBDYN_INLINE bool StiffTaylorEngine::is_rough(int guard) const {
    return is_implicit() ? implicit_->is_rough(guard) : TaylorEngine::is_rough(guard);
}

RBDYN_INLINE bool StiffTaylorEngine::fits_guards() const {
    return is_implicit() ? implicit_->fits_guards() : TaylorEngine::fits_guards();
}

}  // namespace rbdyn::inline RBDYN_FORM
