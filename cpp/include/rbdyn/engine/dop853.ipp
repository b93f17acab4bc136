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
#include "rbdyn/engine/dop853_coefficients.hpp"
#include "rbdyn/engine/engine.hpp"
#include "rbdyn/engine/motion_scales.hpp"
#include "rbdyn/engine/piece_guards.hpp"
#include "rbdyn/expression/evaluate.hpp"
#include "rbdyn/expression/hidden_terms.hpp"
#include "rbdyn/expression/program.hpp"
#include "rbdyn/expression/series_evaluator.hpp"
#include "rbdyn/model/equations.hpp"
#include "rbdyn/series/piece.hpp"
#include "rbdyn/series/polynomial.hpp"
#include "rbdyn/series/step_length.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE Dop853Engine::Dop853Engine(double tolerance, bool fits_guards, double stride, Program::Rounding rounding)
    : tolerance_(tolerance), fits_guards_(fits_guards), stride_(stride), constants_(rounding) {}

RBDYN_INLINE std::string Dop853Engine::name() const { return "dop853"; }

RBDYN_INLINE void Dop853Engine::carry(std::span<const double> rest) { low_.assign(rest.begin(), rest.end()); }

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
    x_.assign(x.begin(), x.end());
    std::fill(low_.begin(), low_.end(), 0.0);
    estimates_.assign(equations.groups.size(), 0.0);
    next_estimates_ = rounding_ = spread_ = estimates_;
    has_slope_ = false;
    is_first_ = true;
    is_cut_ = false;
    scales_.widen(x_);
}

RBDYN_INLINE StepStatus Dop853Engine::step(double limit) {
    if (!is_first_ && drop_start_flags(*equations_, parameters_)) set_parameters();
    if (is_cut_) return next_part();
    if (!(limit - t_ > 0.0)) return StepStatus::stalled;
    if (!has_slope_ && !evaluate(t_, x_, slope_.data())) return StepStatus::not_finite;
    has_slope_ = true;
    const double span = limit - t_;
    double& wanted = workshop_->step;
    if (!(wanted > 0.0)) wanted = first_step(span);
    double h = 0.0, error = 0.0;
    bool rejected = false, capped = false;
    Instant end;
    const double seen = workshop_->ahead.held(t_, x_, std::min(stride_ * wanted, span));
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
        if (!rejected) find_rounding(h);
        wanted = h * factor(error);
        estimates_ = next_estimates_;
    }
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
        std::copy(x_.begin(), x_.end(), x.begin());
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

RBDYN_INLINE bool Dop853Engine::fits_guards() const { return workshop_->guards.fits(); }

RBDYN_INLINE Dop853Engine::Workshop::Workshop(const Equations& equations, bool fits_guards, double tolerance)
    : evaluator(equations.program),
      series(fits_guards || !series_are_known(equations)
                 ? nullptr
                 : std::make_unique<SeriesEvaluator>(equations.program, series_order)),
      ahead(equations.program),
      guards(equations, series.get(), series_order, tolerance * std::exp2(guard_slack)) {}

RBDYN_INLINE Dop853Engine::Workshop& Dop853Engine::workshop_for(const Equations& equations) {
    for (auto& [known, workshop] : workshops_)
        if (known == &equations) return *workshop;
    workshops_.emplace_back(&equations, std::make_unique<Workshop>(equations, fits_guards_, tolerance_));
    return *workshops_.back().second;
}

RBDYN_INLINE void Dop853Engine::resize(std::size_t variables) {
    n_ = static_cast<int>(variables);
    x_.resize(variables);
    for (std::vector<double>* v : {&low_, &slope_, &start_, &start_low_, &start_slope_, &y_, &anchor_state_})
        v->assign(variables, 0.0);
    differences_.assign(variables * dop853::stages, 0.0);
    coefficients_.assign(variables * (order + 1), 0.0);
    part_.assign(variables * (order + 1), 0.0);
    defect_.assign(variables, 0.0);
    allowed_.assign(equations_->groups.size(), 0.0);
    scales_.resize(variables);
}

RBDYN_INLINE void Dop853Engine::set_parameters() {
    workshop_->evaluator.set_parameters(parameters_, constants_);
    if (workshop_->series) workshop_->series->set_parameters(parameters_, constants_);
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
    std::vector<double> before, first(x_.size()), later(x_.size());
    const Instant next{t_.hi + epsilon * std::abs(t_.hi), 0.0};
    const bool moves = next.hi != t_.hi && evaluate(next, x_, later.data());
    (void)evaluate(t_, x_, first.data());
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
    if (!stages(std::make_integer_sequence<int, 12>{}, t_, x_.data(), low_.data(), slope_.data(), h))
        return std::numeric_limits<double>::infinity();
    double fifth = 0.0, third = 0.0;
    for (std::size_t g = 0; g < equations_->groups.size(); ++g) {
        const VariableGroup& group = equations_->groups[g];
        double size5 = 0.0, size3 = 0.0, reach = 0.0;
        for (int i = group.first; i < group.first + group.count; ++i) {
            const double* k = differences_.data() + i;
            const std::ptrdiff_t stride = n();
            size5 = std::max(size5, std::abs(weighted<dop853::fifth, 5, 12>(k, stride)));
            size3 = std::max(size3, std::abs(weighted<dop853::third, 5, 12>(k, stride)));
            reach = std::max(reach, std::abs(group.is_position ? y_[at(i)] - x_[at(i)] : y_[at(i)]));
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

RBDYN_INLINE void Dop853Engine::find_rounding(double h) {
    const auto largest_change = [&](const VariableGroup& group) {
        double change = 0.0;
        for (int i = group.first; i < group.first + group.count; ++i)
            change = std::max(change, std::abs(defect_[at(i)] - slope_[at(i)]));
        return change;
    };
    for (int i = 0; i < n(); ++i) y_[at(i)] = x_[at(i)] * (i % 2 == 0 ? 1.0 + epsilon : 1.0 - epsilon);
    if (!evaluate({t_.hi + epsilon * std::abs(t_.hi), 0.0}, y_, defect_.data())) return;
    for (std::size_t g = 0; g < rounding_.size(); ++g) {
        const VariableGroup& group = equations_->groups[g];
        rounding_[g] = 32.0 * largest_change(group);
        for (int i = group.first; i < group.first + group.count; ++i)
            rounding_[g] = std::max(rounding_[g], 16.0 * epsilon * workshop_->evaluator.magnitude(i));
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
    const double *x = x_.data(), *low = low_.data(), *slope = slope_.data();
    if (!(stage<13>(t_, x, low, slope, h) && stage<14>(t_, x, low, slope, h) && stage<15>(t_, x, low, slope, h)))
        return std::numeric_limits<double>::infinity();
    const std::ptrdiff_t stride = n();
    next_coefficients_.resize(coefficients_.size());
    for (int i = 0; i < n(); ++i) {
        const double* k = differences_.data() + i;
        const double beyond = weighted<12, 5, 12>(k, stride);  // what the slope at the start does not do
        const double bend = k[12 * stride];
        // y = x + s (dx + (1-s) (f1 + s (f2 + (1-s) (f3 + s (f4 + (1-s) (f5 + s f6)))))) in powers of s
        const double f1 = -h * beyond, f2 = h * (2.0 * beyond - bend);
        const double f3 = h * weighted<dop853::dense, 5, 16>(k, stride);
        const double f4 = h * weighted<dop853::dense + 1, 5, 16>(k, stride);
        const double f5 = h * weighted<dop853::dense + 2, 5, 16>(k, stride);
        const double f6 = h * weighted<dop853::dense + 3, 5, 16>(k, stride);
        double* c = next_coefficients_.data() + i * (order + 1);
        c[0] = x[i];
        c[1] = h * slope[i];
        c[2] = f3 + (f2 - f1);
        c[3] = f5 + (f4 - 2.0 * f3) - f2;
        c[4] = f6 - 3.0 * f5 - 2.0 * f4 + f3;
        c[5] = 3.0 * (f5 - f6) + f4;
        c[6] = 3.0 * f6 - f5;
        c[7] = -f6;
        y_[at(i)] = series::value(c, order, defect_place);
    }
    if (!evaluate(t_ + defect_place * h, y_, defect_.data())) return std::numeric_limits<double>::infinity();
    for (int i = 0; i < n(); ++i) {
        const double* c = next_coefficients_.data() + i * (order + 1);
        double change = order * c[order];
        for (int k = order - 1; k > 0; --k) change = change * defect_place + k * c[k];
        defect_[at(i)] = h * defect_[at(i)] - change;
    }
    double error = 0.0;
    for (std::size_t g = 0; g < equations_->groups.size(); ++g) {
        const VariableGroup& group = equations_->groups[g];
        double size = 0.0;
        for (int i = group.first; i < group.first + group.count; ++i) size = std::max(size, std::abs(defect_[at(i)]));
        error = std::max(error, defect_weight * blamed(size, h, g));
    }
    return error;
}

RBDYN_INLINE void Dop853Engine::finish(double h, Instant end, double natural) {
    start_t_ = t_;
    start_.swap(x_);
    start_low_.swap(low_);
    start_slope_.swap(slope_);
    coefficients_.swap(next_coefficients_);
    anchor_ = std::numeric_limits<double>::infinity();
    const std::ptrdiff_t stride = n();
    for (int i = 0; i < n(); ++i) {
        const double* k = differences_.data() + i;
        const double change = h * advance<12>(start_slope_.data(), i);
        const Instant sum = exact_sum(start_[at(i)], start_low_[at(i)] + change);
        x_[at(i)] = sum.hi;
        low_[at(i)] = sum.lo;
        slope_[at(i)] = start_slope_[at(i)] + k[12 * stride];
    }
    t_ = end;
    ++work_.steps;
    is_first_ = false;
    scales_.widen(x_);
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
    if (!stages(std::make_integer_sequence<int, 11>{}, start_t_, start_.data(), start_low_.data(), start_slope_.data(),
                h))
        return false;
    for (int i = 0; i < n(); ++i)
        anchor_state_[at(i)] = start_[at(i)] + (start_low_[at(i)] + h * advance<12>(start_slope_.data(), i));
    anchor_ = place;
    return true;
}

}  // namespace rbdyn::inline RBDYN_FORM
