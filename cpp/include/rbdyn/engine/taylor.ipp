// Definitions of rbdyn/engine/taylor.hpp.
#pragma once

#include "rbdyn/engine/taylor.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "rbdyn/basics/double_double_functions.hpp"
#include "rbdyn/basics/instant.hpp"
#include "rbdyn/engine/engine.hpp"
#include "rbdyn/engine/motion_scales.hpp"
#include "rbdyn/engine/near_singular.hpp"
#include "rbdyn/expression/evaluate.hpp"
#include "rbdyn/expression/hidden_terms.hpp"
#include "rbdyn/expression/program.hpp"
#include "rbdyn/expression/series_abreast.hpp"
#include "rbdyn/expression/series_evaluator.hpp"
#include "rbdyn/expression/term_sizes.hpp"
#include "rbdyn/expression/wide_series.hpp"
#include "rbdyn/model/equations.hpp"
#include "rbdyn/series/coefficients.hpp"
#include "rbdyn/series/lanes.hpp"
#include "rbdyn/series/piece.hpp"
#include "rbdyn/series/polynomial.hpp"
#include "rbdyn/series/step_length.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE TaylorEngine::TaylorEngine(double tolerance, int order, Program::Rounding rounding)
    : log_tolerance_(std::log2(tolerance)), order_(order > 0 ? order : order_for(tolerance)), rounding_(rounding) {}

RBDYN_INLINE std::string TaylorEngine::name() const { return "taylor"; }

RBDYN_INLINE int TaylorEngine::order_for(double tolerance) {
    return std::clamp(static_cast<int>(std::lround(8.0 - 0.58 * std::log(tolerance))), min_order, max_order);
}

RBDYN_INLINE void TaylorEngine::start(const Equations& equations, std::span<const double> parameters, Instant t,
                                      std::span<const double> x) {
    if (equations_ != &equations) {
        equations_ = &equations;
        Workshop& workshop = workshop_for(equations);
        series_ = &*workshop.series;
        hidden_ = &workshop.hidden;
        workshop_ = &workshop;
        looked_at_ = &workshop.looked_at;
        scales_.resize(x.size());
        scales_.follow(equations.groups);
        roots_ = has_roots(equations.program) && equations.start_flags.empty()
                     ? std::make_unique<Evaluator<double>>(equations.program)
                     : nullptr;
    }
    parameters_.assign(parameters.begin(), parameters.end());
    t_ = t;
    x_.assign(x.begin(), x.end());
    low_.assign(x.size(), 0.0);
    scales_.widen(x_);
    is_ready_ = false;
}

RBDYN_INLINE void TaylorEngine::carry(std::span<const double> rest) { low_.assign(rest.begin(), rest.end()); }

RBDYN_INLINE StepStatus TaylorEngine::step(double limit) {
    if (const auto made = begin_step(limit)) return *made;
    for (;;) {
        expand();
        if (const auto made = end_step()) return *made;
    }
}

RBDYN_INLINE std::optional<StepStatus> TaylorEngine::begin_step(double limit) {
    if (!is_ready_) {
        mode_x_ = x_;
        mode_low_ = low_;
        projection_ = equations_->projection ? equations_->projection(x_, low_) : nullptr;
        set_parameters();
        is_ready_ = true;
    }
    limit_ = limit;
    attempts_ = 0;
    overflows_ = std::numeric_limits<double>::infinity();
    series_->let_zeros_stay(true);
    abreast_ = nullptr;
    length_.reset();
    if (!(unit_ > 0.0)) unit_ = power_of_two(limit - t_);
    return std::nullopt;
}

namespace series {

/// x, x^2, .. x^n. They are stored as dot() loads them: a processor waits for what was stored one by one.
inline void powers(double x, int n, double* out) {
    double power = x;
    int k = 0;
    for (; k + 2 <= n; k += 2) {
        const double next = power * x;
        set_pair(out + k, Pair{power, next});
        power = next * x;
    }
    if (k < n) out[k] = power;
}

/// x^n
inline double power(double x, int n) {
    double result = 1.0;
    for (; n > 0; n >>= 1, x *= x)
        if (n % 2 != 0) result *= x;
    return result;
}

}  // namespace series

RBDYN_INLINE std::optional<StepStatus> TaylorEngine::end_step() {
    const int n = equations_->variables();
    const double span = limit_ - t_;
    work_.right_hand_sides += order_;
    if (!series_->is_finite(0)) {
        // a length that begins beside zero, though its guard has seen it there, has no direction as one that begins
        // with a power of time, and has one as it is
        if (attempts_++ > 0 || !drop_start_flags(*equations_, parameters_)) return StepStatus::not_finite;
        set_parameters();
        return std::nullopt;
    }
    const bool is_finite = series_->is_finite(order_ - 1);
    double length = is_finite ? (length_ ? *length_ : step_length(span)) * unevenness() : 0.0;
    is_wide_ = false;
    if (is_finite && !workshop_->singular.none()) length = near_singular_length(length, span);
    natural_ = length;
    const bool is_unlimited = natural_ * unit_ > 0x1p32 * span;
    if (length * unit_ > span) length = span / unit_;
    bool capped = is_finite && length * unit_ >= span;
    if (is_finite && !hidden_->none())
        if (const double held = hidden_->held(*series_, length); held < length) {
            natural_ = length = held;
            capped = false;
        }
    if (is_finite && is_unlimited && may_hide(equations_->program)) {
        const double part = borne_out(length);
        capped = capped && part == 1.0;
        length *= part;
    }
    // a polynomial may be of any length, but its powers are numbers
    constexpr double far = 256.0;
    if (!is_finite || !(capped ? length <= longest : length >= 1.0 / far && length <= far)) {
        // the unit of time was far from the step: measure again in a better one
        ++work_.rejected;
        if (!is_finite) {
            // in units ever smaller powers of time are no numbers at last: then they tell of nothing that it stays
            if (std::isfinite(overflows_)) series_->let_zeros_stay(false);
            overflows_ = unit_;
        }
        double factor = is_finite ? power_of_two(length) : 0x1p-24;
        // coefficients of the step's own size are no numbers, though the step is one: it is taken in parts
        const bool is_in_parts = factor * unit_ >= overflows_;
        if (is_in_parts) factor = overflows_ / unit_ / (2.0 * far);
        if (!is_in_parts || factor > 1.0) {
            unit_ *= factor;
            if (attempts_++ > 100 || !(unit_ > 0.0)) return StepStatus::stalled;
            return std::nullopt;
        }
        natural_ = length = std::min(length, far);
    }
    length = borne_out_at_end(length);
    length = held_at_end(length);
    // a step that ends so that t + h is exact (in two doubles, where it is longer than the time so far)
    double h = length * unit_;
    Instant end{limit_, 0.0};
    if (h < span) {
        const double next = t_.hi + h;
        h = next - t_.hi;
        if (!(h > 4.0 * std::numeric_limits<double>::epsilon() * std::abs(t_.hi)) || h <= 0.0)
            return StepStatus::stalled;
        end = t_ + h;
    } else {
        h = span;
    }
    piece_ = {t_, unit_, h / unit_, n, order_, series_->coefficients(0), series_->stride()};
    ++work_.steps;
    start_low_ = low_;
    // go on from the end, the sum compensated
    add_up(piece_.length, x_, low_);
    if (is_wide_)
        for (int i = 0; i < n; ++i) {
            const DoubleDouble exact = workshop_->wide->input(i, piece_.length);
            x_[at(i)] = exact.hi;
            low_[at(i)] = exact.lo;
        }
    t_ = end;
    hold(h);
    scales_.widen(x_);
    if (drop_start_flags(*equations_, parameters_)) set_parameters();
    if (piece_.length < 0.25 || piece_.length > 4.0) unit_ = power_of_two(h);
    return StepStatus::ok;
}

RBDYN_INLINE void TaylorEngine::add_up(double tau, std::span<double> x, std::span<double> low) const {
    const int n = equations_->variables();
    const double* row = series_->rows(0, n);
    std::array<double, max_order> power;
    const bool is_there = abreast_ != nullptr && tau == probable_;
    if (!is_there) series::powers(tau, order_, power.data());
    for (int i = 0; i < n; ++i, row += series_->stride()) {
        const double increment = is_there ? abreast_->increment(lane_, i) : series::dot(row + 1, power.data(), order_);
        const Instant sum = exact_sum(x_[at(i)], increment + low_[at(i)]);
        x[at(i)] = sum.hi;
        low[at(i)] = sum.lo;
    }
}

RBDYN_INLINE void TaylorEngine::rest(double tau, std::span<const double> x, std::span<double> low) const {
    for (std::size_t i = 0; i < x.size(); ++i) {
        const double* c = piece_.variable(static_cast<int>(i));
        const Instant sum = exact_sum(c[0], tau * series::value(c + 1, order_ - 1, tau));
        low[i] = (sum.hi - x[i]) + (sum.lo + start_low_[i]);
    }
}

RBDYN_INLINE void TaylorEngine::standing(std::span<double> x, std::span<double> low) const {
    std::copy(x_.begin(), x_.end(), x.begin());
    std::copy(low_.begin(), low_.end(), low.begin());
}

RBDYN_INLINE std::vector<double> TaylorEngine::memory() const {
    std::vector<double> all = {unit_, steps_before_ + static_cast<double>(work_.steps)};
    const auto add = [&](const std::vector<double>& numbers) { all.insert(all.end(), numbers.begin(), numbers.end()); };
    add(scales_.numbers());
    if (!is_ready_) return all;
    add(mode_x_);
    add(mode_low_);
    add(parameters_);
    return all;
}

RBDYN_INLINE void TaylorEngine::recall(std::span<const double> memory) {
    const std::size_t n = x_.size(), least = 2 + MotionScales::count(n);
    const bool is_ready = memory.size() == least + 2 * n + parameters_.size();
    if (memory.size() != least && !is_ready) return;
    unit_ = memory[0];
    steps_before_ = memory[1];
    scales_.set_numbers(memory.subspan(2, least - 2));
    if (!is_ready) return;
    const auto first = memory.begin() + static_cast<std::ptrdiff_t>(least),
               second = first + static_cast<std::ptrdiff_t>(n);
    mode_x_.assign(first, second);
    mode_low_.assign(second, second + static_cast<std::ptrdiff_t>(n));
    std::copy_n(second + static_cast<std::ptrdiff_t>(n), parameters_.size(), parameters_.begin());
    projection_ = equations_->projection ? equations_->projection(mode_x_, mode_low_) : nullptr;
    set_parameters();
    is_ready_ = true;
}

RBDYN_INLINE const double* TaylorEngine::guard(int index) {
    const Guard& g = equations_->guards[static_cast<std::size_t>(index)];
    ++work_.guard_evaluations;
    return series_->output(g.output);
}

RBDYN_INLINE int TaylorEngine::guard_order() const { return order_; }

RBDYN_INLINE void TaylorEngine::guard_sizes(int index, double* sizes) {
    const Guard& g = equations_->guards[static_cast<std::size_t>(index)];
    complete();
    const int slot = equations_->program.output(g.output);
    TermSizes::Sizes s = TermSizes(*series_, order_)(slot);
    // a gap that is zero and does not change is told by its acceleration, the rounding of which comes from forces
    const auto is_nothing = [&](int k) {
        return std::abs(series_->coefficients(slot)[k]) <= 8.0 * std::numeric_limits<double>::epsilon() * s[at(k)];
    };
    if (g.kind == EventKind::land && g.contact >= 0 && order_ > 1 && is_nothing(0) && is_nothing(1))
        s = TermSizes(*series_, order_, TermSizes::many)(slot);
    std::copy_n(s.begin(), order_ + 1, sizes);
}

RBDYN_INLINE double TaylorEngine::natural_length() const { return natural_; }

RBDYN_INLINE bool TaylorEngine::is_rough(int guard) const { return !rough_.empty() && rough_[at(guard)] != 0; }

RBDYN_INLINE std::span<double> TaylorEngine::replace_state() {
    std::fill(low_.begin(), low_.end(), 0.0);
    return x_;
}

RBDYN_INLINE void TaylorEngine::hold(double time) {
    if (projection_) projection_->apply(x_, low_, time, t_.hi);
}

RBDYN_INLINE void TaylorEngine::set_parameters() {
    const bool is_made_up = projection_ && projection_->makes_up_for_rounding();
    series_->set_parameters(parameters_, is_made_up ? Program::Rounding::nearest : rounding_);
}

RBDYN_INLINE double TaylorEngine::power_of_two(double x) {
    int exponent = 0;
    const double mantissa = std::frexp(x, &exponent);
    return x > 0.0 && std::isfinite(x) ? std::ldexp(1.0, mantissa > 0.70710678 ? exponent : exponent - 1) : 1.0;
}

RBDYN_INLINE TaylorEngine::Workshop::Workshop(const Equations& equations, int order)
    : series(equations.program, order, SeriesEvaluator::Use::states),
      hidden(equations.program, order),
      singular(equations),
      looked_at(hidden.slots()) {
    for (const Guard& guard : equations.guards)
        if (guard.output >= 0) looked_at.push_back(equations.program.output(guard.output));
    std::sort(looked_at.begin(), looked_at.end());
    looked_at.erase(std::unique(looked_at.begin(), looked_at.end()), looked_at.end());
    std::erase_if(looked_at, [&](int slot) { return slot < equations.variables(); });
}

RBDYN_INLINE TaylorEngine::Workshop& TaylorEngine::workshop_for(const Equations& equations) {
    for (auto& [known, workshop] : workshops_)
        if (known == &equations) return *workshop;
    workshops_.emplace_back(&equations, std::make_unique<Workshop>(equations, order_));
    return *workshops_.back().second;
}

RBDYN_INLINE void TaylorEngine::expand() {
    length_.reset();
    abreast_ = nullptr;
    series_->begin(t_.hi, unit_);
    double* first = series_->row(0);
    for (std::size_t i = 0; i < x_.size(); ++i, first += series_->stride()) *first = x_[i];
    series_->expand(order_, !equations_->guards.empty());
}

RBDYN_INLINE void TaylorEngine::take(const SeriesAbreast& abreast, std::span<TaylorEngine* const> engines) {
    std::array<SeriesEvaluator*, SeriesAbreast::most> series{};
    std::array<double, SeriesAbreast::most> scales{}, log_tolerances{};
    const std::size_t count = engines.size();
    for (std::size_t i = 0; i < count; ++i) {
        series[i] = engines[i]->series_;
        log_tolerances[i] = engines[i]->log_tolerance_;
    }
    abreast.give_states({series.data(), count});
    const std::vector<VariableGroup>& groups = engines.front()->equations_->groups;
    for (std::size_t g = 0; g < groups.size(); ++g) {
        std::size_t i = 0;
        for (; i < count; ++i) {
            const std::vector<VariableGroup>& own = engines[i]->equations_->groups;
            if (g >= own.size() || own[g].first != groups[g].first || own[g].count != groups[g].count) break;
            scales[i] = engines[i]->scales_.scale(own[g]);
        }
        if (i == count)
            abreast.find_log_steps(groups[g].first, groups[g].count, {scales.data(), count},
                                   {log_tolerances.data(), count});
    }
    std::array<double, SeriesAbreast::most> ends{};
    for (std::size_t i = 0; i < count; ++i) {
        engines[i]->take(abreast, static_cast<int>(i));
        ends[i] = engines[i]->probable_ = engines[i]->abreast_ != nullptr ? engines[i]->probable_end() : 0.0;
    }
    abreast.find_increments({ends.data(), count});
}

RBDYN_INLINE double TaylorEngine::probable_end() const {
    const double span = limit_ - t_, h = *length_ * unevenness() * unit_;
    return (h < span ? (t_.hi + h) - t_.hi : span) / unit_;
}

RBDYN_INLINE void TaylorEngine::take(const SeriesAbreast& abreast, int motion) {
    if (!abreast.is_good(motion)) return expand();
    series_->set_unit(unit_);
    abreast.give(motion, *series_, *looked_at_, has_guards());
    abreast_ = &abreast;
    lane_ = motion;
    // each operation of it waits for the last one: here a processor goes on with the next motion meanwhile
    length_ = step_length(limit_ - t_);
}

RBDYN_INLINE void TaylorEngine::complete() {
    if (abreast_ != nullptr) abreast_->give_all(lane_, *series_, has_guards());
    abreast_ = nullptr;
}

RBDYN_INLINE void TaylorEngine::expand_widely() {
    if (!workshop_->wide) workshop_->wide = std::make_unique<WideSeries>(equations_->program, order_);
    std::vector<DoubleDouble> x(x_.size());
    for (std::size_t i = 0; i < x.size(); ++i) x[i] = DoubleDouble(exact_sum(x_[i], low_[i]));
    if (projection_) projection_->refine(x, t_.hi);
    expand_widely(x);
}

RBDYN_INLINE void TaylorEngine::expand_widely(const std::vector<DoubleDouble>& x) {
    workshop_->wide->set_parameters(parameters_);
    workshop_->wide->expand(t_.hi, unit_, x);
    workshop_->wide->give(*series_);
    abreast_ = nullptr;
    is_wide_ = true;
}

RBDYN_INLINE bool TaylorEngine::expand_beside(const std::vector<std::complex<double>>& places, double length) {
    if (!projection_ || places.empty()) return false;
    const auto near = [](const auto& a, const auto& b) { return std::abs(a) < std::abs(b); };
    // a series tells nothing of what is further away: it is found from here
    const double away = std::min_element(places.begin(), places.end(), near)->real(),
                 tau = std::abs(away) <= 1.5 * length ? away : 0.0;
    std::vector<DoubleDouble> x, there;
    for (int i = 0; i < equations_->variables(); ++i) {
        x.push_back(workshop_->wide->input(i, 0.0));
        there.push_back(workshop_->wide->input(i, tau));
    }
    if (!projection_->refine_beside(x, t_.hi, there, t_.hi + tau * unit_)) return false;
    expand_widely(x);
    return true;
}

RBDYN_INLINE double TaylorEngine::near_singular_length(double length, double span) {
    const NearSingular& singular = workshop_->singular;
    const double most = span / unit_;
    auto places = singular.places(*series_, order_, std::min(length, most));
    if (NearSingular::loses_digits(places, std::min(length, most)) && !equations_->program.has_calls()) {
        expand_widely();
        if (!series_->is_finite(order_ - 1)) return length;
        const auto look = [&] {
            length = singular.told(*series_, order_, step_length(span) * unevenness(), log_tolerance_);
            places = singular.places(*series_, order_, std::min(length, most));
        };
        look();
        if (expand_beside(places, length)) {
            if (!series_->is_finite(order_ - 1)) return length;
            look();
        }
    }
    const double clear = NearSingular::clear_of(places, std::min(length, most), length >= most);
    return clear < most ? clear : length;
}

RBDYN_INLINE double TaylorEngine::step_length(double span) {
    double log_length = std::numeric_limits<double>::infinity();
    Sizes size;
    for (const VariableGroup& group : equations_->groups) {
        if (abreast_ != nullptr) {
            if (const auto known = abreast_->log_step(lane_, group.first, group.count)) {
                log_length = std::min(log_length, *known);
                continue;
            }
        }
        if (abreast_ != nullptr)
            abreast_->sizes(lane_, group.first, group.count, size.data());
        else
            series::sizes(size.data(), series_->rows(group.first, group.count), series_->stride(), group.count, order_);
        log_length = std::min(log_length, series::log_step(size.data(), order_, scales_.scale(group), log_tolerance_));
    }
    if (!rough_.empty()) rough_.clear();
    if (equations_->guards.empty()) return std::exp2(log_length);
    // guards are cut off too, or their zeros would not be events; an error there moves one event and does not grow.
    // The rounding of a speed's series grows by the distance from its zero, which must not keep a step from passing
    // there
    const double log_tolerance = std::max(log_tolerance_ + guard_slack, rounding_counts);
    // but for a guard that is singular here or so near that steps towards it would not end: a short one passes it
    const double least =
        std::max(std::min(log_length, series::rough_log2(span / unit_)) - most_halvings,
                 series::rough_log2(64.0 * std::numeric_limits<double>::epsilon() * std::abs(t_.hi) / unit_));
    for (std::size_t g = 0; g < equations_->guards.size(); ++g) {
        const Guard& guard = equations_->guards[g];
        if (guard.output < 0 || guard.least < 0.0 || equations_->is_variable(guard)) continue;
        const double* c = series_->output(guard.output);
        if (is_polynomial(c, guard)) continue;
        series::sizes(size.data(), c, 0, 1, order_);
        double check = 0.0;
        for (int k = 0; k <= order_; ++k) check += 0.0 * size[at(k)];
        const double log_guard = series::log_step(size.data(), order_, size[0], log_tolerance);
        if (check != 0.0 || log_guard < least) {
            rough_.resize(equations_->guards.size(), 0);
            rough_[g] = 1;
        }
        // what is not finite where the step begins says nothing of its length
        if (check == 0.0) log_length = std::min(log_length, log_guard < least ? least + 4.0 : log_guard);
    }
    return std::exp2(log_length);
}

RBDYN_INLINE bool TaylorEngine::may_hide(const Program& program) {
    const auto& all = program.instructions();
    // a norm goes on past its zero with another sign, where a switch takes it up
    if (std::any_of(all.begin(), all.end(), [](const Instruction& i) { return i.code == Code::norm; })) return false;
    return std::any_of(all.begin(), all.end(), [](const Instruction& i) { return i.code != Code::combine; });
}

RBDYN_INLINE double TaylorEngine::borne_out(double length) const {
    constexpr int places = 64;
    Evaluator<double> values(equations_->program);
    values.set_parameters(parameters_, rounding_);
    std::vector<double> x(x_.size()), slope(x_.size());
    for (int k = 1; k <= places; ++k)
        if (!bears_out(values, length * k / places, length * unit_, x, slope))
            return k > 1 ? static_cast<double>(k - 1) / places : 0.5 / (places * places);
    return 1.0;
}

RBDYN_INLINE bool TaylorEngine::bears_out(Evaluator<double>& values, double tau, double duration,
                                          std::vector<double>& x, std::vector<double>& slope) const {
    for (int i = 0; i < equations_->variables(); ++i) {
        const double* c = series_->coefficients(i);
        x[at(i)] = series::value(c, order_, tau);
        double rate = 0.0;
        for (int j = order_; j >= 1; --j) rate = rate * tau + j * c[j];
        slope[at(i)] = rate / unit_;
    }
    values(t_.hi + tau * unit_, x);
    AlikeSizes sizes;
    for (const VariableGroup& group : equations_->groups) sizes.take(group, scales_.scale(group));
    const double part = std::max(1e-6, 64.0 * std::exp2(log_tolerance_));
    for (const VariableGroup& group : equations_->groups)
        for (int i = group.first; i < group.first + group.count; ++i) {
            const double rate = values.output(i), size = std::max(std::abs(rate), std::abs(slope[at(i)])),
                         scale = sizes.of(group, scales_.scale(group), duration),
                         allowed = 1e-3 * size + part * scale / duration + 1e-12 * values.magnitude(i);
            if (!(std::abs(rate - slope[at(i)]) <= allowed)) return false;
        }
    return true;
}

RBDYN_INLINE double TaylorEngine::borne_out_at_end(double length) {
    if (!roots_ || passes_guard(length)) return length;
    end_.resize(x_.size());
    end_slope_.resize(x_.size());
    roots_->set_parameters(parameters_, rounding_);
    constexpr int most_halvings_of_step = 60;
    const double least = 8.0 * std::numeric_limits<double>::epsilon() * std::abs(t_.hi);
    double shorter = length;
    for (int k = 0; k < most_halvings_of_step && shorter * unit_ > least; ++k, shorter *= 0.5)
        if (bears_out(*roots_, shorter, shorter * unit_, end_, end_slope_)) return shorter;
    return length;
}

RBDYN_INLINE double TaylorEngine::held_at_end(double length) {
    if (!projection_ || projection_->positions() == 0) return length;
    // beyond where a formula goes over to another one what is held is not what the series hold
    if (passes_guard(length, true)) return length;
    constexpr double nothing = 0x1p-58;
    const double last_power = series::power(length, order_);
    // what starts at rest is as large as it becomes
    const auto size = [&](const VariableGroup& group) {
        double largest = scales_.scale(group);
        for (int i = group.first; i < group.first + group.count; ++i) {
            const double* c = series_->coefficients(i);
            largest = std::max({largest, std::abs(c[1]) * length, std::abs(c[2]) * length * length});
        }
        return largest;
    };
    AlikeSizes sizes;
    for (const VariableGroup& group : equations_->groups) sizes.take(group, size(group));
    for (const VariableGroup& group : equations_->groups) {
        const double scale = sizes.of(group, size(group), length * unit_);
        for (int i = group.first; i < group.first + group.count; ++i)
            if (std::abs(series_->coefficients(i)[order_]) * last_power > nothing * scale) return length;
    }
    // so little that it is nothing, or the square of it
    constexpr double least = 0x1p-50, little = 0x1p-30;
    constexpr int most = 60;
    double shorter = length;
    for (int i = 0; i < most; ++i) {
        const double tau = (t_.hi + shorter * unit_ - t_.hi) / unit_;
        const Projection::Off off = off_at(tau);
        const bool is_held = !(off.rounding > 1.0);
        if (is_held && !(off.size > least)) return shorter;
        if (is_held || !(off.size > little)) {
            const std::vector<double> was = straighten(tau);
            if (is_held || !(off_at(0.5 * tau).rounding > 1.0)) return shorter;
            for (int k = 0; k < equations_->variables(); ++k)
                series_->row(k)[k < projection_->positions() ? 2 : 1] = was[at(k)];
        }
        shorter *= std::clamp(0.7 * std::sqrt(little / off.size), 0x1p-20, 0.5);
    }
    return length;
}

RBDYN_INLINE Projection::Off TaylorEngine::off_at(double tau) {
    end_.resize(x_.size());
    end_low_.resize(x_.size());
    add_up(tau, end_, end_low_);
    return projection_->off(end_, end_low_, t_.hi + tau * unit_);
}

RBDYN_INLINE std::vector<double> TaylorEngine::straighten(double tau) {
    const std::vector<double> x = end_, low = end_low_;
    std::vector<double> was(x.size());
    // the series are others from here on
    probable_ = 0.0;
    projection_->apply(end_, end_low_, tau * unit_, t_.hi + tau * unit_);
    for (int i = 0; i < equations_->variables(); ++i) {
        const double change = (end_[at(i)] - x[at(i)]) + (end_low_[at(i)] - low[at(i)]);
        const bool is_position = i < projection_->positions();
        double& coefficient = series_->row(i)[is_position ? 2 : 1];
        was[at(i)] = coefficient;
        coefficient += change / (is_position ? tau * tau : tau);
    }
    return was;
}

RBDYN_INLINE bool TaylorEngine::has_roots(const Program& program) {
    const auto& all = program.instructions();
    return std::any_of(all.begin(), all.end(), [](const Instruction& i) {
        return i.code == Code::square_root || i.code == Code::power || i.code == Code::logarithm ||
               i.code == Code::log1p || i.code == Code::artanh;
    });
}

RBDYN_INLINE bool TaylorEngine::passes_guard(double tau, bool is_silent) const {
    return std::any_of(equations_->guards.begin(), equations_->guards.end(), [&](const Guard& guard) {
        if (is_silent && !(guard.branch >= 0 && guard.name.empty())) return false;
        if (guard.output < 0) return guard.locator != nullptr;
        const double* c = series_->output(guard.output);
        const double end = series::value(c, order_, tau);
        return !(c[0] > 0.0 ? end > 0.0 : end < 0.0);
    });
}

RBDYN_INLINE bool TaylorEngine::is_polynomial(const double* c, const Guard& guard) {
    if (c[order_] != 0.0 || c[order_ - 1] != 0.0 || c[order_ - 2] != 0.0 || c[order_ - 3] != 0.0) return false;
    int k = order_ - 4;
    while (k > order_ / 2 && c[k] == 0.0) --k;
    if (k == order_ / 2) return false;
    complete();
    const TermSizes::Sizes sizes = TermSizes(*series_, order_)(equations_->program.output(guard.output));
    return std::abs(c[k]) > 64.0 * std::numeric_limits<double>::epsilon() * sizes[at(k)];
}

RBDYN_INLINE double TaylorEngine::unevenness() const {
    if (log_tolerance_ > rounding_counts) return 1.0;
    constexpr double golden_section = 0.6180339887498949;
    return 1.0 - 0x1p-4 * std::fmod(golden_section * (steps_before_ + static_cast<double>(work_.steps)), 1.0);
}

}  // namespace rbdyn::inline RBDYN_FORM
