// Definitions of rbdyn/engine/dop853.hpp.
#pragma once

#include "rbdyn/engine/dop853.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "rbdyn/basics/double_double_functions.hpp"
#include "rbdyn/basics/instant.hpp"
#include "rbdyn/engine/dop853_step.hpp"
#include "rbdyn/engine/engine.hpp"
#include "rbdyn/engine/motion_scales.hpp"
#include "rbdyn/engine/piece_guards.hpp"
#include "rbdyn/expression/borrowed_series.hpp"
#include "rbdyn/expression/evaluate.hpp"
#include "rbdyn/expression/hidden_terms.hpp"
#include "rbdyn/expression/program.hpp"
#include "rbdyn/model/equations.hpp"
#include "rbdyn/series/piece.hpp"
#include "rbdyn/series/polynomial.hpp"
#include "rbdyn/series/step_length.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE Dop853Engine::Dop853Engine(double tolerance, bool fits_guards, double stride, Program::Rounding rounding)
    : tolerance_(tolerance), fits_guards_(fits_guards), stride_(stride), constants_(rounding) {}

RBDYN_INLINE std::string Dop853Engine::name() const { return "dop853"; }

RBDYN_INLINE void Dop853Engine::carry(std::span<const double> rest) {
    std::copy(rest.begin(), rest.end(), low_.begin());
}

RBDYN_INLINE void Dop853Engine::start(const Equations& equations, std::span<const double> parameters, Instant t,
                                      std::span<const double> x) {
    if (equations_ != &equations) {
        equations_ = &equations;
        workshop_ = &workshop_for(equations);
        resize(x.size());
        scales_.follow(equations.groups);
    }
    parameters_.assign(parameters.begin(), parameters.end());
    set_parameters();
    workshop_->guards.enter(parameters_);
    t_ = t;
    std::copy(x.begin(), x.end(), x_.begin());
    std::fill(low_.begin(), low_.end(), 0.0);
    estimates_.assign(equations.groups.size(), 0.0);
    next_estimates_ = rounding_ = spread_ = estimates_;
    rejections_ = 0;
    has_slope_ = false;
    is_first_ = true;
    is_cut_ = false;
    scales_.widen(now());
}

RBDYN_INLINE StepStatus Dop853Engine::step(double limit) {
    if (!is_first_ && drop_start_flags(*equations_, parameters_)) set_parameters();
    if (is_cut_) return next_part();
    if (!(limit - t_ > 0.0)) return StepStatus::stalled;
    if (!has_slope_ && !evaluate(t_, now(), slope_.data())) return StepStatus::not_finite;
    has_slope_ = true;
    const double span = limit - t_;
    double& wanted = workshop_->step;
    if (!(wanted > 0.0)) wanted = first_step(span);
    double h = 0.0, error = 0.0;
    bool rejected = false, capped = false;
    Instant end;
    const double seen = workshop_->ahead.held(t_, now(), std::min(stride_ * wanted, span));
    for (;; rejected = true) {
        // a step that ends so that t + h is exact
        h = std::min(stride_ * (is_first_ ? std::min(wanted, span) : wanted), seen);
        capped = h >= span;
        if (!capped) {
            const double next = t_.hi + h;
            h = next - t_.hi;
            capped = h >= span;
            end = {next, t_.lo};
            if (!(h > 4.0 * epsilon * std::abs(t_.hi)) || h <= 0.0) {
                wanted = 0.0;
                return StepStatus::stalled;
            }
        }
        if (capped) {
            h = span;
            end = {limit, 0.0};
        }
        error = attempt(h);
        if (error <= 1.0) error = std::max(error, interpolate(h));
        if (error <= 1.0) break;
        ++work_.rejected;
        const bool are_few = rejections_ < many_rejections;
        rejections_ += 2;
        if (const bool now_many = are_few && rejections_ >= many_rejections; !rejected || now_many)
            find_rounding(h, rejections_ >= many_rejections);
        wanted = h * factor(error);
        estimates_ = next_estimates_;
    }
    if (!rejected && rejections_ > 0) --rejections_;
    // not longer at once after a step that was too long; not shorter because the end of the run was near
    const double next = h * (rejected ? std::min(1.0, factor(error)) : factor(error));
    wanted = capped ? std::max(wanted, next) : next;
    finish(h, end, capped ? std::max(1.0, next / h) : 1.0);
    return StepStatus::ok;
}

RBDYN_INLINE double Dop853Engine::natural_length() const { return natural_; }

RBDYN_INLINE void Dop853Engine::state(double tau, std::span<double> x) const {
    const double place = offset_ + tau;
    if (tau == 0.0) return piece_.state(tau, x);
    if (place >= 1.0 || (!is_cut_ && tau >= piece_.length)) {
        std::ranges::copy(now(), x.begin());
        return;
    }
    if (!(std::abs(place - anchor_) <= 0x1p-10) && !anchor_at(place)) return piece_.state(tau, x);
    for (int i = 0; i < n(); ++i) {
        const double* c = whole_.variable(i);
        x[at(i)] = anchor_state_[at(i)] + (series::value(c + 1, order - 1, place) * place -
                                           series::value(c + 1, order - 1, anchor_) * anchor_);
    }
}

RBDYN_INLINE bool Dop853Engine::refines() const { return true; }

RBDYN_INLINE const double* Dop853Engine::guard(int index) {
    ++work_.guard_evaluations;
    return workshop_->guards.coefficients(index);
}

RBDYN_INLINE int Dop853Engine::guard_order() const { return workshop_->guards.order(); }

RBDYN_INLINE void Dop853Engine::guard_sizes(int index, double* sizes) { workshop_->guards.sizes(index, sizes); }

RBDYN_INLINE bool Dop853Engine::is_rough(int guard) const { return workshop_->guards.is_rough(guard); }

RBDYN_INLINE bool Dop853Engine::is_far(int guard) const { return workshop_->guards.is_far(guard); }

RBDYN_INLINE bool Dop853Engine::fits_guards() const { return workshop_->guards.fits(); }

RBDYN_INLINE Dop853Engine::Workshop::Workshop(const Equations& equations, bool fits_guards, double tolerance)
    : evaluator(equations.program),
      series(fits_guards || !series_are_known(equations)
                 ? nullptr
                 : std::make_unique<const BorrowedSeries>(equations.program, series_order)),
      ahead(equations.program),
      guards(equations, series ? &**series : nullptr, series_order, tolerance * std::exp2(guard_slack)) {}

RBDYN_INLINE Dop853Engine::Workshop& Dop853Engine::workshop_for(const Equations& equations) {
    for (auto& [known, workshop] : workshops_)
        if (known == &equations) return *workshop;
    workshops_.emplace_back(&equations, std::make_unique<Workshop>(equations, fits_guards_, tolerance_));
    return *workshops_.back().second;
}

RBDYN_INLINE void Dop853Engine::resize(std::size_t variables) {
    n_ = static_cast<int>(variables);
    const std::size_t padded = Dop853Step::padded(variables);
    x_.resize(padded);
    std::fill(x_.begin() + n_, x_.end(), 0.0);
    for (Dop853Step::Doubles* v : {&low_, &slope_, &start_, &start_low_, &start_slope_}) v->assign(padded, 0.0);
    for (std::vector<double>* v : {&y_, &defect_, &anchor_state_}) v->assign(variables, 0.0);
    coefficients_.assign(padded * (order + 1), 0.0);
    part_.assign(variables * (order + 1), 0.0);
    allowed_.assign(equations_->groups.size(), 0.0);
    step_.follow(workshop_->evaluator, equations_->program.has_calls(), n_);
    scales_.resize(variables);
}

RBDYN_INLINE void Dop853Engine::set_parameters() {
    workshop_->evaluator.set_parameters(parameters_, constants_);
    if (workshop_->series) (*workshop_->series)->set_parameters(parameters_, constants_);
    workshop_->ahead.set_parameters(parameters_, constants_);
    workshop_->guards.set_parameters(parameters_, constants_);
}

RBDYN_INLINE bool Dop853Engine::evaluate(Instant t, std::span<const double> x, double* slope) const {
    double check = 0.0;
    for (const double value : x) check += 0.0 * value;
    if (check != 0.0) return false;
    Evaluator<double>& evaluator = workshop_->evaluator;
    ++work_.right_hand_sides;
    evaluator(t.hi, x);
    for (int i = 0; i < n(); ++i) {
        slope[i] = evaluator.output(i);
        check += 0.0 * slope[i];
    }
    return check == 0.0;
}

RBDYN_INLINE double Dop853Engine::first_step(double span) {
    const auto size = [&](const VariableGroup& group, const std::vector<double>& slope) {
        double largest = 0.0;
        for (int i = group.first; i < group.first + group.count; ++i)
            largest = std::max(largest, std::abs(slope[at(i)]));
        return largest;
    };
    // a slope that is rounding of its terms, or of the time, is none: a block breaks away from rest under forces in
    // balance
    std::vector<double> before, first(at(n())), later(at(n()));
    const Instant next{t_.hi + epsilon * std::abs(t_.hi), 0.0};
    const bool moves = next.hi != t_.hi && evaluate(next, now(), later.data());
    (void)evaluate(t_, now(), first.data());
    for (int i = 0; i < n(); ++i) {
        const double rounding = 64.0 * epsilon * workshop_->evaluator.magnitude(i),
                     of_time = moves ? 16.0 * std::abs(later[at(i)] - first[at(i)]) : 0.0;
        if (std::abs(first[at(i)]) <= std::max(rounding, of_time)) first[at(i)] = 0.0;
    }
    const auto runs_away = [&](double h) {
        defect_ = first;
        before.assign(equations_->groups.size(), 0.0);
        for (int pass = 0; pass < 3; ++pass) {
            for (std::size_t g = 0; g < before.size(); ++g) {
                const VariableGroup& group = equations_->groups[g];
                // a velocity may be small at the start for no reason
                if (group.is_position && before.size() > 1) continue;
                const double now = size(group, defect_);
                if (before[g] > 0.0 && now > 16.0 * before[g]) return true;
                if (before[g] == 0.0) before[g] = now;
            }
            if (pass == 2) break;
            for (int i = 0; i < n(); ++i) y_[at(i)] = x_[at(i)] + h * defect_[at(i)];
            if (!evaluate(t_ + h, y_, defect_.data())) return true;
        }
        return false;
    };
    double h = span;
    while (h > 0x1p-60 * span && runs_away(h)) h *= 0.125;
    return h;
}

RBDYN_INLINE double Dop853Engine::attempt(double h) {
    const bool is_there = step_.attempt(here(), h);
    work_.right_hand_sides += step_.evaluations();
    if (!is_there) return std::numeric_limits<double>::infinity();
    const double* y = step_.end();
    double fifth = 0.0, third = 0.0;
    for (std::size_t g = 0; g < equations_->groups.size(); ++g) {
        const VariableGroup& group = equations_->groups[g];
        double size5 = 0.0, size3 = 0.0, reach = 0.0;
        for (int i = group.first; i < group.first + group.count; ++i) {
            size5 = std::max(size5, std::abs(step_.fifth(i)));
            size3 = std::max(size3, std::abs(step_.third(i)));
            reach = std::max(reach, std::abs(group.is_position ? y[i] - x_[at(i)] : y[i]));
        }
        const double moved = scales_.scale(group);
        const double scale = std::max({moved, reach, estimates_[g]});
        allowed_[g] = std::max({tolerance_ * scale, 2.0 * epsilon * scales_.magnitude(group), tiny});
        if (size5 == 0.0 && size3 == 0.0) continue;
        fifth = std::max(fifth, blamed(h * size5, h, g));
        third = std::max(third, blamed(h * size3, h, g));
        // a trial that is too long but roughly right tells the scale of motion that has hardly begun
        if (moved == 0.0) next_estimates_[g] = h * size5 < 0.5 * reach ? reach : 0.0;
    }
    // its square may be no number any more
    if (fifth < 0x1p-400) return fifth;
    return fifth * fifth / std::sqrt(fifth * fifth + 0.01 * third * third);
}

RBDYN_INLINE double Dop853Engine::blamed(double error, double h, std::size_t g) const {
    const double rounding = h * (rounding_[g] + h * spread_[g]);
    if (rounding > 0x1p-8 * allowed_[g]) error -= rounding;
    return error > 0.0 ? error / allowed_[g] : 0.0;
}

RBDYN_INLINE void Dop853Engine::find_rounding(double h, bool by_sizes) {
    const auto largest_change = [&](const VariableGroup& group) {
        double change = 0.0;
        for (int i = group.first; i < group.first + group.count; ++i)
            change = std::max(change, std::abs(defect_[at(i)] - slope_[at(i)]));
        return change;
    };
    for (int i = 0; i < n(); ++i) y_[at(i)] = x_[at(i)] * (i % 2 == 0 ? 1.0 + epsilon : 1.0 - epsilon);
    if (!evaluate({t_.hi + epsilon * std::abs(t_.hi), 0.0}, y_, defect_.data())) return;
    std::optional<RoundingSizes>& sizes = workshop_->sizes;
    // functions of the user's are not asked for that; what is near a singularity has terms that are no rounding of
    // slopes
    by_sizes = by_sizes && !equations_->program.has_calls();
    double most = 0.0;
    for (int i = 0; i < n(); ++i) most = std::max(most, 0x1p-34 * std::abs(slope_[at(i)]));
    if (by_sizes) {
        if (!sizes) sizes.emplace(equations_->program);
        sizes->set_parameters(parameters_);
        (*sizes)(t_.hi, now());
    }
    for (std::size_t g = 0; g < rounding_.size(); ++g) {
        const VariableGroup& group = equations_->groups[g];
        rounding_[g] = 32.0 * largest_change(group);
        for (int i = group.first; i < group.first + group.count; ++i)
            rounding_[g] = std::max({rounding_[g], 16.0 * epsilon * workshop_->evaluator.magnitude(i),
                                     by_sizes ? std::min(8.0 * epsilon * sizes->size(i), most) : 0.0});
        for (int i = group.first; i < group.first + group.count; ++i) y_[at(i)] = x_[at(i)] + h * rounding_[g];
    }
    if (!evaluate(t_, y_, defect_.data())) return;
    for (std::size_t g = 0; g < rounding_.size(); ++g) spread_[g] = largest_change(equations_->groups[g]) / h;
}

RBDYN_INLINE double Dop853Engine::factor(double error) {
    if (!(error < std::numeric_limits<double>::infinity())) return 0.125;
    if (error == 0.0) return 6.0;
    return std::clamp(0.75 * std::exp2(-0.125 * series::rough_log2(error)), 0.125, 6.0);
}

RBDYN_INLINE double Dop853Engine::interpolate(double h) {
    const bool is_there = step_.interpolate(here(), h);
    work_.right_hand_sides += step_.evaluations();
    if (!is_there) return std::numeric_limits<double>::infinity();
    double error = 0.0;
    for (std::size_t g = 0; g < equations_->groups.size(); ++g) {
        const VariableGroup& group = equations_->groups[g];
        double size = 0.0;
        for (int i = group.first; i < group.first + group.count; ++i) size = std::max(size, std::abs(step_.defect(i)));
        error = std::max(error, defect_weight * blamed(size, h, g));
    }
    return error;
}

RBDYN_INLINE void Dop853Engine::finish(double h, Instant end, double natural) {
    start_t_ = t_;
    start_.swap(x_);
    start_low_.swap(low_);
    start_slope_.swap(slope_);
    coefficients_.swap(step_.coefficients());
    anchor_ = std::numeric_limits<double>::infinity();
    step_.finish({start_t_, start_.data(), start_low_.data(), start_slope_.data()}, h, x_.data(), low_.data(),
                 slope_.data());
    t_ = end;
    ++work_.steps;
    is_first_ = false;
    scales_.widen(now());
    whole_ = {start_t_, end - start_t_, 1.0, n(), order, coefficients_.data()};
    // who adds start and length must not find the end still ahead
    if (end - whole_.at(1.0) > 0.0) whole_.unit = std::nextafter(whole_.unit, 2.0 * whole_.unit);
    piece_ = whole_;
    offset_ = 0.0;
    natural_ = natural;
    cut(false);
}

RBDYN_INLINE void Dop853Engine::cut(bool is_rest) {
    PieceGuards& guards = workshop_->guards;
    const double holds = guards.begin(piece_, is_rest);
    is_cut_ = holds < piece_.length;
    // the rest of a series in equal parts
    if (is_cut_) natural_ = piece_.length = guards.fits() ? holds : piece_.length / std::ceil(piece_.length / holds);
}

RBDYN_INLINE StepStatus Dop853Engine::next_part() {
    ++work_.parts;
    const Instant start = piece_.at(piece_.length);
    offset_ += piece_.length;
    for (int i = 0; i < n(); ++i) {
        double* c = part_.data() + i * (order + 1);
        std::copy_n(whole_.variable(i), order + 1, c);
        series::shift(c, order, offset_);
    }
    const Instant end = whole_.at(1.0);
    piece_ = {start, whole_.unit, (end - start) / whole_.unit, n(), order, part_.data()};
    while (end - piece_.at(piece_.length) > 0.0) piece_.length = std::nextafter(piece_.length, 2.0);
    natural_ = piece_.length;
    cut(true);
    return StepStatus::ok;
}

RBDYN_INLINE bool Dop853Engine::anchor_at(double place) const {
    const double h = place * whole_.unit;
    anchor_ = std::numeric_limits<double>::infinity();
    const bool is_there = step_.go({start_t_, start_.data(), start_low_.data(), start_slope_.data()}, h);
    work_.right_hand_sides += step_.evaluations();
    if (!is_there) return false;
    std::copy_n(step_.end(), n(), anchor_state_.begin());
    anchor_ = place;
    return true;
}

}  // namespace rbdyn::inline RBDYN_FORM
