// Definitions of rbdyn/engine/cvode.hpp.
#pragma once

#include "rbdyn/engine/cvode.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <exception>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <utility>

#include "rbdyn/basics/instant.hpp"
#include "rbdyn/engine/cvode_integrator.hpp"
#include "rbdyn/engine/cvode_vector.hpp"
#include "rbdyn/engine/dop853.hpp"
#include "rbdyn/engine/engine.hpp"
#include "rbdyn/engine/motion_scales.hpp"
#include "rbdyn/engine/piece_guards.hpp"
#include "rbdyn/engine/taylor.hpp"
#include "rbdyn/expression/evaluate.hpp"
#include "rbdyn/expression/series_evaluator.hpp"
#include "rbdyn/model/equations.hpp"
#include "rbdyn/series/piece.hpp"
#include "rbdyn/series/polynomial.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE std::string CvodeEngine::name() const { return method_ == Method::adams ? "cvode-adams" : "cvode-bdf"; }

RBDYN_INLINE void CvodeEngine::start(const Equations& equations, std::span<const double> parameters, Instant t,
                                     std::span<const double> x) {
    if (equations_ != &equations) {
        equations_ = &equations;
        integrator_ = &integrator_for(equations);
        scales_.resize(x.size());
        scales_.follow(equations.groups);
        estimates_.resize(equations.groups.size());
    }
    parameters_.assign(parameters.begin(), parameters.end());
    integrator_->set_parameters(parameters_, rounding_);
    integrator_->guards.enter(parameters_);
    t_ = t;
    x_.assign(x.begin(), x.end());
    running_ = false;
    pending_ = false;
    offset_ = 0.0;
    is_restart_ = has_started_;
    has_started_ = true;
    is_first_ = true;
    starter_ = nullptr;
    std::fill(estimates_.begin(), estimates_.end(), 0.0);
    widen();
}

RBDYN_INLINE void CvodeEngine::recall(std::span<const double> memory) {
    if (memory.size() != MotionScales::count(x_.size())) return;
    scales_.set_numbers(memory);
    widen();
}

RBDYN_INLINE StepStatus CvodeEngine::step(double limit) {
    if (pending_ && offset_ + piece_.length < 1.0 - 1e-12) return next_part();
    if (!(limit - t_ > 0.0)) return StepStatus::stalled;
    if (is_first_ && is_restart_ && set_off(limit)) return StepStatus::ok;
    starter_ = nullptr;
    if (!is_first_ && drop_start_flags(*equations_, parameters_)) integrator_->set_parameters(parameters_, rounding_);
    if (!running_ && !begin(limit)) return StepStatus::not_finite;
    void* memory = integrator_->memory.get();
    double stop = limit - integrator_->origin;
    if (!(stop > clock_)) return StepStatus::stalled;
    const double seen = integrator_->ahead.held(t_, x_, stop - clock_);
    const bool is_seen = seen >= stop - clock_ || seen <= 0x1p-40 * std::abs(t_.hi);
    if (!is_seen) stop = clock_ + seen;
    CVodeSetStopTime(memory, stop);
    double clock = clock_;
    const int outcome = CVode(memory, stop, integrator_->y.get(), &clock, CV_ONE_STEP);
    count_rejected();
    if (integrator_->thrown) std::rethrow_exception(std::exchange(integrator_->thrown, nullptr));
    if (outcome < 0) {
        running_ = false;
        return slope_is_finite() ? StepStatus::stalled : StepStatus::not_finite;
    }
    const bool at_limit = outcome == CV_TSTOP_RETURN && is_seen;
    long taken = 0;
    CVodeGetNumSteps(memory, &taken);
    if (taken == steps_) {
        // so near that CVODE takes the limit for reached
        if (!slope_is_finite()) return StepStatus::not_finite;
        straight_line(stop - clock_);
        running_ = false;
    } else {
        steps_ = taken;
        const bool advanced = clock - clock_ > (at_limit ? 0.0 : 4.0 * epsilon * clock);
        running_ = advanced && take_polynomial();
        if (!running_) return StepStatus::stalled;
        if (found_scale()) {
            ++work_.rejected;
            running_ = false;
            return step(limit);
        }
    }
    ++work_.steps;
    pending_ = false;
    const Instant end = at_limit ? Instant{limit, 0.0} : integrator_->origin + clock;
    fill_piece(end);
    is_first_ = false;
    t_ = end;
    clock_ = clock;
    widen();
    whole_ = piece_;
    pending_ = true;
    shorten(false);
    return StepStatus::ok;
}

RBDYN_INLINE void CvodeEngine::state(double tau, std::span<double> x) const {
    if (starter_ != nullptr) return starter_->state(tau * starter_->piece().length, x);
    if (tau == 0.0) return piece_.state(tau, x);
    const int row = piece_.order + 1;
    for (int i = 0; i < piece_.variables; ++i)
        x[at(i)] = series::value(from_end_.data() + i * row, piece_.order, offset_ + tau - 1.0);
}

RBDYN_INLINE double CvodeEngine::natural_length() const {
    return starter_ != nullptr ? starter_->natural_length() / starter_->piece().length : piece_.length;
}

RBDYN_INLINE bool CvodeEngine::refines() const { return starter_ != nullptr && starter_->refines(); }

RBDYN_INLINE const double* CvodeEngine::guard(int index) {
    ++work_.guard_evaluations;
    if (starter_ == nullptr) return integrator_->guards.coefficients(index);
    const double* c = starter_->guard(index);
    double power = 1.0;
    guard_row_.resize(at(starter_->guard_order() + 1));
    for (std::size_t k = 0; k < guard_row_.size(); ++k, power *= starter_->piece().length) guard_row_[k] = c[k] * power;
    return guard_row_.data();
}

RBDYN_INLINE int CvodeEngine::guard_order() const {
    return starter_ != nullptr ? starter_->guard_order() : integrator_->guards.order();
}

RBDYN_INLINE bool CvodeEngine::fits_guards() const {
    return starter_ != nullptr ? starter_->fits_guards() : integrator_->guards.fits();
}

RBDYN_INLINE bool CvodeEngine::is_rough(int guard) const {
    return starter_ != nullptr ? starter_->is_rough(guard) : integrator_->guards.is_rough(guard);
}

RBDYN_INLINE bool CvodeEngine::is_far(int guard) const {
    return starter_ != nullptr ? starter_->is_far(guard) : integrator_->guards.is_far(guard);
}

RBDYN_INLINE void CvodeEngine::guard_sizes(int index, double* sizes) {
    if (starter_ == nullptr) return integrator_->guards.sizes(index, sizes);
    starter_->guard_sizes(index, sizes);
    double power = 1.0;
    for (int k = 0; k <= starter_->guard_order(); ++k, power *= starter_->piece().length) sizes[k] *= power;
}

RBDYN_INLINE void CvodeEngine::rest(double tau, std::span<const double> x, std::span<double> low) const {
    if (starter_ == nullptr) return Engine::rest(tau, x, low);
    starter_->rest(tau * starter_->piece().length, x, low);
}

RBDYN_INLINE bool CvodeEngine::set_off(double limit) {
    const bool has_series = series_are_known(*equations_);
    std::unique_ptr<Engine>& engine = has_series ? by_series_ : by_values_;
    if (!engine && has_series) engine = std::make_unique<TaylorEngine>(rtol_);
    if (!engine) engine = std::make_unique<Dop853Engine>(rtol_);
    const Work before = engine->work();
    engine->start(*equations_, parameters_, t_, x_);
    const StepStatus status = engine->step(limit);
    const Work& after = engine->work();
    work_.rejected += after.rejected - before.rejected;
    work_.right_hand_sides += after.right_hand_sides - before.right_hand_sides;
    if (status != StepStatus::ok) return false;
    ++work_.steps;
    starter_ = engine.get();
    // as every piece here, of length 1
    const Piece& made = engine->piece();
    const int row = made.order + 1;
    part_.resize(at(made.variables * row));
    for (int i = 0; i < made.variables; ++i) {
        double power = 1.0;
        for (int k = 0; k < row; ++k, power *= made.length) part_[at(i * row + k)] = made.variable(i)[k] * power;
    }
    const Instant end = made.at(made.length);
    piece_ = {made.start, end - made.start, 1.0, made.variables, made.order, part_.data()};
    while (end - piece_.at(1.0) > 0.0) piece_.unit = std::nextafter(piece_.unit, 2.0 * piece_.unit);
    engine->state(made.length, x_);
    t_ = end;
    is_first_ = false;
    widen();
    return true;
}

RBDYN_INLINE cvode::Integrator& CvodeEngine::integrator_for(const Equations& equations) {
    for (auto& [known, integrator] : integrators_)
        if (known == &equations) return *integrator;
    integrators_.emplace_back(
        &equations, std::make_unique<cvode::Integrator>(equations, method_ == Method::bdf, series_order(),
                                                        rtol_ * std::exp2(guard_slack), context_.get(), work_));
    return *integrators_.back().second;
}

RBDYN_INLINE bool CvodeEngine::begin(double limit) {
    double unit = 0.0;
    const int orders = expand(limit - t_, unit);
    if (orders == 0) return false;
    const double first_step = unit * measure(orders, (limit - t_) / unit);
    weigh();
    std::copy(x_.begin(), x_.end(), integrator_->state());
    integrator_->restart(t_, first_step);
    clock_ = 0.0;
    steps_ = rejected_ = 0;
    running_ = true;
    return true;
}

RBDYN_INLINE int CvodeEngine::expand(double span, double& unit) {
    SeriesEvaluator& series = integrator_->series;
    // a slope that is rounding of its terms is none: a block breaks away from rest under forces in balance
    integrator_->evaluator(t_.hi, x_);
    const auto is_rounding = [&](int i) {
        return std::abs(integrator_->evaluator.output(i)) <= 64.0 * epsilon * integrator_->evaluator.magnitude(i);
    };
    int exponent = 0;
    std::frexp(std::isfinite(span) ? span : 1.0, &exponent);
    int orders = 0;
    // the span may be far longer than the motion's own time: shorter units until the coefficients are in range
    for (int attempt = 0; attempt < 6; ++attempt) {
        unit = std::ldexp(1.0, exponent - 32 * attempt);
        series.begin(t_.hi, unit);
        for (int i = 0; i < integrator_->n; ++i) series.set_input(i, 0, x_[at(i)]);
        for (orders = 0; orders < start_order; ++orders) {
            series.advance(orders);
            bool is_finite = true;
            for (int i = 0; i < integrator_->n; ++i) {
                double c = series.output(i)[orders] * (unit / (orders + 1));
                if (orders == 0 && is_rounding(i)) c = 0.0;
                is_finite = is_finite && std::isfinite(c);
                series.set_input(i, orders + 1, c);
            }
            ++work_.right_hand_sides;
            if (!is_finite) break;
        }
        if (orders == start_order) break;
    }
    return orders;
}

RBDYN_INLINE double CvodeEngine::measure(int orders, double span) {
    double first_step = span;
    const double passage = first_passage(orders, span);
    std::vector<std::array<double, start_order + 1>> sizes(estimates_.size());
    for (std::size_t g = 0; g < estimates_.size(); ++g) {
        const VariableGroup& group = equations_->groups[g];
        auto& size = sizes[g];
        for (int i = group.first; i < group.first + group.count; ++i)
            for (int k = 1; k <= orders; ++k)
                size[at(k)] = std::max(size[at(k)], std::abs(integrator_->series.coefficients(i)[k]));
        int lead = 1;
        while (lead < orders && size[at(lead)] == 0.0) ++lead;
        // the leading term rules for a while; a third of that is typical of a step
        double reach = std::numeric_limits<double>::infinity();
        for (int k = lead + 1; k <= orders; ++k)
            if (size[at(k)] > 0.0)
                reach = std::min(reach, 0.3 * std::pow(size[at(lead)] / size[at(k)], 1.0 / (k - lead)));
        // no scale beyond the span: terms after the leading one may be next to nothing
        if (!std::isfinite(reach) && !std::isfinite(span)) reach = 1.0;
        reach = std::min({reach, span, passage});
        estimates_[g] = std::max(estimates_[g], size[at(lead)] * std::pow(reach, lead));
    }
    tie();
    for (std::size_t g = 0; g < estimates_.size(); ++g) {
        const auto& size = sizes[g];
        const double tolerance = absolute_tolerance(g);
        for (int k = 2; k <= orders; ++k)
            if (size[at(k)] > 0.0) first_step = std::min(first_step, 0.5 * std::pow(tolerance / size[at(k)], 1.0 / k));
    }
    return std::isfinite(first_step) ? first_step : 1.0;
}

RBDYN_INLINE double CvodeEngine::first_passage(int orders, double span) const {
    double first = std::numeric_limits<double>::infinity();
    for (const Guard& guard : equations_->guards) {
        if (guard.output < 0) continue;
        const double* c = integrator_->series.output(guard.output);
        int lead = 0;
        while (lead < orders && c[lead] == 0.0) ++lead;
        for (int k = lead + 1; k < orders; ++k)
            if (c[k] != 0.0) first = std::min(first, std::pow(std::abs(c[lead] / c[k]), 1.0 / (k - lead)));
    }
    return std::max(first, 0x1p-60 * span);
}

RBDYN_INLINE double CvodeEngine::scale(std::size_t g) const {
    return std::max(estimates_[g], scales_.scale(equations_->groups[g]));
}

/// Where the scale of what is tied stands.
RBDYN_INLINE std::size_t place_of_tied(const VariableGroup& group) {
    return 2 * static_cast<std::size_t>(group.tied) + (group.is_position ? 1 : 0);
}

RBDYN_INLINE void CvodeEngine::tie() {
    tied_.fill(0.0);
    for (std::size_t g = 0; g < estimates_.size(); ++g) {
        const VariableGroup& group = equations_->groups[g];
        if (group.tied == VariableGroup::Tied::none) continue;
        double& largest = tied_[place_of_tied(group)];
        largest = std::max(largest, scale(g));
    }
}

RBDYN_INLINE double CvodeEngine::absolute_tolerance(std::size_t g) const {
    const VariableGroup& group = equations_->groups[g];
    // nothing where nothing is tied
    return std::max(rtol_ * std::max(scale(g), tied_[place_of_tied(group)]), 8.0 * epsilon * scales_.magnitude(group));
}

RBDYN_INLINE void CvodeEngine::weigh() {
    tie();
    for (std::size_t g = 0; g < estimates_.size(); ++g) {
        const VariableGroup& group = equations_->groups[g];
        const double weight = 1.0 / absolute_tolerance(g);
        std::fill_n(integrator_->weights.begin() + group.first, group.count, std::isfinite(weight) ? weight : 0.0);
    }
}

RBDYN_INLINE void CvodeEngine::widen() {
    scales_.widen(x_);
    weigh();
}

RBDYN_INLINE bool CvodeEngine::found_scale() {
    bool found = false;
    const int row = order_ + 1;
    for (std::size_t g = 0; g < estimates_.size(); ++g) {
        const VariableGroup& group = equations_->groups[g];
        if (integrator_->weights[at(group.first)] > 0.0 || estimates_[g] > 0.0) continue;
        for (int i = group.first; i < group.first + group.count; ++i)
            estimates_[g] = std::max(estimates_[g], std::abs(from_end_[at(i * row)]));
        found = found || estimates_[g] > 0.0;
    }
    return found;
}

RBDYN_INLINE bool CvodeEngine::slope_is_finite() {
    integrator_->evaluator(t_.hi, x_);
    for (int i = 0; i < integrator_->n; ++i)
        if (!std::isfinite(integrator_->evaluator.output(i))) return false;
    return true;
}

RBDYN_INLINE void CvodeEngine::count_rejected() {
    long errors = 0, failures = 0;
    CVodeGetNumErrTestFails(integrator_->memory.get(), &errors);
    CVodeGetNumStepSolveFails(integrator_->memory.get(), &failures);
    work_.rejected += errors + failures - rejected_;
    rejected_ = errors + failures;
}

RBDYN_INLINE bool CvodeEngine::take_polynomial() {
    void* memory = integrator_->memory.get();
    double h = 0.0, t = 0.0;
    CVodeGetLastOrder(memory, &order_);
    CVodeGetLastStep(memory, &h);
    CVodeGetCurrentTime(memory, &t);
    const int n = integrator_->n, row = order_ + 1;
    from_end_.resize(at(n * row));
    double factor = 1.0, check = 0.0;
    for (int k = 0; k <= order_; ++k) {
        if (k > 0) factor *= h / k;
        if (CVodeGetDky(memory, t, k, integrator_->derivative.get()) != CV_SUCCESS) return false;
        const double* d = cvode::values(integrator_->derivative.get());
        for (int i = 0; i < n; ++i) {
            from_end_[at(i * row + k)] = d[i] * factor;
            check += 0.0 * from_end_[at(i * row + k)];
        }
    }
    return check == 0.0;
}

RBDYN_INLINE void CvodeEngine::straight_line(double h) {
    order_ = 1;
    from_end_.resize(at(2 * integrator_->n));
    for (int i = 0; i < integrator_->n; ++i) {
        from_end_[at(2 * i + 1)] = integrator_->evaluator.output(i) * h;
        from_end_[at(2 * i)] = x_[at(i)] + from_end_[at(2 * i + 1)];
    }
}

RBDYN_INLINE StepStatus CvodeEngine::next_part() {
    ++work_.parts;
    offset_ += piece_.length;
    if (drop_start_flags(*equations_, parameters_)) integrator_->set_parameters(parameters_, rounding_);
    const int n = piece_.variables, row = piece_.order + 1;
    part_.resize(at(n * row));
    for (int i = 0; i < n; ++i) {
        double* c = part_.data() + i * row;
        std::copy_n(coefficients_.data() + i * row, row, c);
        series::shift(c, row - 1, offset_);
        c[0] = series::value(from_end_.data() + i * row, row - 1, offset_ - 1.0);
    }
    piece_ = {whole_.at(offset_), whole_.unit, 1.0 - offset_, n, row - 1, part_.data()};
    while (whole_.at(1.0) - piece_.at(piece_.length) > 0.0) piece_.length = std::nextafter(piece_.length, 2.0);
    shorten(true);
    return StepStatus::ok;
}

RBDYN_INLINE void CvodeEngine::fill_piece(Instant end) {
    offset_ = 0.0;
    const int n = integrator_->n, row = order_ + 1;
    coefficients_ = from_end_;
    for (int i = 0; i < n; ++i) {
        double* c = coefficients_.data() + i * row;
        series::shift(c, order_, -1.0);
        // the polynomial passes through x_ but for rounding
        c[0] = x_[at(i)];
        x_[at(i)] = from_end_[at(i * row)];
    }
    piece_ = {t_, end - t_, 1.0, n, order_, coefficients_.data()};
    // who adds start and length must not find the end still ahead
    if (end - piece_.at(1.0) > 0.0) piece_.unit = std::nextafter(piece_.unit, 2.0 * piece_.unit);
}

}  // namespace rbdyn::inline RBDYN_FORM
