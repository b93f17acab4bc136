// Dormand and Prince's explicit Runge-Kutta method of order 8, as an engine.
//
// Source: Hairer, Norsett and Wanner, "Solving Ordinary Differential Equations I", 2nd edition, Springer 1993: the
// method and its error estimate from embedded ones of order 5 and 3 (sec. II.5), step control (II.4), and the
// interpolant of order 7, a polynomial of degree 7 with the states and slopes of both ends (II.6).
//
// Conventions: errors are measured against the scales of the motion itself (extent of positions, largest velocities) or
// of the step where there is none yet; nothing here has a unit, and the same motion in units that differ by powers of
// two takes the same steps to the last bit. Slopes are kept as differences from the one at the start of the step, for
// the weights of the method are far larger than their sum. Sums are compensated and step lengths exact (see
// taylor.hpp). Invariant: a piece is the whole step or, where guards ask for shorter ones, a part of it; pieces join to
// rounding.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "rbdyn/engine/dop853_coefficients.hpp"
#include "rbdyn/engine/engine.hpp"
#include "rbdyn/engine/motion_scales.hpp"
#include "rbdyn/engine/piece_guards.hpp"
#include "rbdyn/expression/evaluate.hpp"
#include "rbdyn/series/step_length.hpp"

namespace rbdyn {

class Dop853Engine : public Engine {
public:
    /// Local error per step relative to the motion's scales. `fits_guards`: through values even where series are known.
    /// `stride`: how much of the steps that the tolerance allows, and of a mode in its first one, is taken.
    /// `rounding`: of constants.
    explicit Dop853Engine(double tolerance, bool fits_guards = false, double stride = 1.0,
                          Program::Rounding rounding = Program::Rounding::nearest)
        : tolerance_(tolerance), fits_guards_(fits_guards), stride_(stride), constants_(rounding) {}

    std::string name() const override { return "dop853"; }

    void carry(std::span<const double> rest) override { low_.assign(rest.begin(), rest.end()); }

    void start(const Equations& equations, std::span<const double> parameters, Instant t,
               std::span<const double> x) override {
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

    StepStatus step(double limit) override {
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
        for (;; rejected = true) {
            // a step that ends so that t + h is exact
            h = stride_ * (is_first_ ? std::min(wanted, span) : wanted);
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

    double natural_length() const override { return natural_; }

    /// A step of the method itself to where the state is asked for; from there on, within a thousandth of the piece,
    /// differences of the polynomial: whoever looks for a root asks for many states close to each other.
    void state(double tau, std::span<double> x) const override {
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

    bool refines() const override { return true; }

    const double* guard(int index) override {
        ++work_.guard_evaluations;
        return workshop_->guards.coefficients(index);
    }
    int guard_order() const override { return workshop_->guards.order(); }
    void guard_sizes(int index, double* sizes) override { workshop_->guards.sizes(index, sizes); }
    bool is_rough(int guard) const override { return workshop_->guards.is_rough(guard); }
    bool fits_guards() const override { return workshop_->guards.fits(); }

private:
    static constexpr double epsilon = std::numeric_limits<double>::epsilon();
    static constexpr int order = 7;  // of the interpolant
    static constexpr int series_order = 12;
    // the interpolant's error is steepest near here, and its slope there two to four times its largest value
    static constexpr double defect_place = 0.65625;
    static constexpr double defect_weight = 0.25;
    static std::size_t at(int index) { return static_cast<std::size_t>(index); }

    /// What one set of equations needs.
    struct Workshop {
        Workshop(const Equations& equations, bool fits_guards, double tolerance)
            : evaluator(equations.program),
              series(fits_guards || !series_are_known(equations)
                         ? nullptr
                         : std::make_unique<SeriesEvaluator>(equations.program, series_order)),
              guards(equations, series.get(), series_order, tolerance * std::exp2(guard_slack)) {}
        Evaluator<double> evaluator;
        std::unique_ptr<SeriesEvaluator> series;
        PieceGuards guards;
        double step = 0.0;  // the length of the next one; 0: not known yet
    };

    Workshop& workshop_for(const Equations& equations) {
        for (auto& [known, workshop] : workshops_)
            if (known == &equations) return *workshop;
        workshops_.emplace_back(&equations, std::make_unique<Workshop>(equations, fits_guards_, tolerance_));
        return *workshops_.back().second;
    }

    int n() const { return n_; }

    void resize(std::size_t variables) {
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

    void set_parameters() {
        workshop_->evaluator.set_parameters(parameters_, constants_);
        if (workshop_->series) workshop_->series->set_parameters(parameters_, constants_);
        workshop_->guards.set_parameters(parameters_, constants_);
    }

    /// x' at (t, x); false if it is not finite, or not asked for since x is not.
    bool evaluate(Instant t, std::span<const double> x, double* slope) const {
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

    /// sum_j w_j k[j stride] with the weights of a row, j = lo .. hi - 1, in pairs of pairs: the same sum everywhere,
    /// and a short way through it.
    template <int row, int lo, int hi>
    static double weighted(const double* k, std::ptrdiff_t stride) {
        if constexpr (hi - lo == 1) {
            constexpr double weight = dop853::weight(row, lo);
            return weight * k[lo * stride];
        } else {
            constexpr int middle = (lo + hi) / 2;
            return weighted<row, lo, middle>(k, stride) + weighted<row, middle, hi>(k, stride);
        }
    }
    /// Where the weights of a stage begin, that of stage 0 left out.
    static constexpr int first_of(int s) {
        int first = 1;
        while (first < s - 1 && dop853::a[s][first] == 0.0) ++first;
        return first;
    }

    /// h^-1 times the change of variable i up to stage s.
    template <int s>
    double advance(const double* slope, int i) const {
        if constexpr (s == 1)
            return dop853::c[1] * slope[i];
        else
            return dop853::c[s] * slope[i] +
                   weighted<s, first_of(s), s>(differences_.data() + i, static_cast<std::ptrdiff_t>(n()));
    }

    /// The slope at stage s of a step of length h from (t, x + low); false if it is not finite.
    template <int s>
    bool stage(Instant t, const double* x, const double* low, const double* slope, double h) const {
        for (int i = 0; i < n(); ++i) y_[at(i)] = x[i] + (low[i] + h * advance<s>(slope, i));
        double* k = differences_.data() + s * n();
        if (!evaluate(t + dop853::c[s] * h, y_, k)) return false;
        for (int i = 0; i < n(); ++i) k[i] -= slope[i];
        return true;
    }
    template <int... s>
    bool stages(std::integer_sequence<int, s...>, Instant t, const double* x, const double* low, const double* slope,
                double h) const {
        return (stage<s + 1>(t, x, low, slope, h) && ...);
    }

    /// The span, or as much of it that Euler's method over it, twice, does not make a slope sixteen times as large.
    ///
    /// The stages of a step that is much too long run away; functions of the user's are not to be asked about that.
    double first_step(double span) {
        const auto size = [&](const VariableGroup& group, const std::vector<double>& slope) {
            double largest = 0.0;
            for (int i = group.first; i < group.first + group.count; ++i)
                largest = std::max(largest, std::abs(slope[at(i)]));
            return largest;
        };
        // a slope that is rounding of its terms is none: a block breaks away from rest under forces in balance
        std::vector<double> before, first(x_.size());
        (void)evaluate(t_, x_, first.data());
        for (int i = 0; i < n(); ++i)
            if (std::abs(first[at(i)]) <= 64.0 * epsilon * workshop_->evaluator.magnitude(i)) first[at(i)] = 0.0;
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

    /// Tries a step of length h; returns its error over the one allowed.
    double attempt(double h) {
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
            allowed_[g] = std::max(tolerance_ * scale, 2.0 * epsilon * scales_.magnitude(group));
            if (size5 == 0.0 && size3 == 0.0) continue;
            fifth = std::max(fifth, blamed(h * size5, h, g));
            third = std::max(third, blamed(h * size3, h, g));
            // a trial that is too long but roughly right tells the scale of motion that has hardly begun
            if (moved == 0.0) next_estimates_[g] = h * size5 < 0.5 * reach ? reach : 0.0;
        }
        if (fifth == 0.0) return 0.0;
        return fifth * fifth / std::sqrt(fifth * fifth + 0.01 * third * third);
    }

    /// An error of a step over the one allowed, without what rounding makes of it where that counts.
    double blamed(double error, double h, std::size_t g) const {
        const double rounding = h * (rounding_[g] + h * spread_[g]);
        if (rounding > 0x1p-8 * allowed_[g]) error -= rounding;
        return error > 0.0 ? error / allowed_[g] : 0.0;
    }

    /// What rounding does to the slopes: that of time and state, for a motion far from their origin, that of the terms
    /// which slopes are made of, where forces in balance let go, and what this does to other slopes within a step, in
    /// proportion to its length. No shorter step has less of it; so it is taken off what a step is blamed for, for one
    /// that is only forgiven would never grow again.
    void find_rounding(double h) {
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

    /// How much longer the next step may be; the error goes as its eighth power. Estimates of what swings pass through
    /// zero, so that at nine tenths, not three quarters, of the length that they promise a fourth of the steps is
    /// rejected.
    static double factor(double error) {
        if (!(error < std::numeric_limits<double>::infinity())) return 0.125;
        if (error == 0.0) return 6.0;
        return std::clamp(0.75 * std::exp2(-0.125 * series::rough_log2(error)), 0.125, 6.0);
    }

    /// The polynomial through the step that was tried last; returns its error over the one allowed.
    double interpolate(double h) {
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
            for (int i = group.first; i < group.first + group.count; ++i)
                size = std::max(size, std::abs(defect_[at(i)]));
            error = std::max(error, defect_weight * blamed(size, h, g));
        }
        return error;
    }

    /// Takes the step that was tried last: its piece, and where it goes on from.
    void finish(double h, Instant end, double natural) {
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

    /// Shortens the piece to where the coefficients of its guards hold.
    void cut(bool is_rest) {
        PieceGuards& guards = workshop_->guards;
        const double holds = guards.begin(piece_, is_rest);
        is_cut_ = holds < piece_.length;
        // the rest of a series in equal parts
        if (is_cut_)
            natural_ = piece_.length = guards.fits() ? holds : piece_.length / std::ceil(piece_.length / holds);
    }

    /// The next part of a step that was cut; it counts for max_steps, for its guards cost as much.
    StepStatus next_part() {
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

    /// The state at a place of the whole step by a step of its own; false if a slope on the way is not finite.
    bool anchor_at(double place) const {
        const double h = place * whole_.unit;
        anchor_ = std::numeric_limits<double>::infinity();
        if (!stages(std::make_integer_sequence<int, 11>{}, start_t_, start_.data(), start_low_.data(),
                    start_slope_.data(), h))
            return false;
        for (int i = 0; i < n(); ++i)
            anchor_state_[at(i)] = start_[at(i)] + (start_low_[at(i)] + h * advance<12>(start_slope_.data(), i));
        anchor_ = place;
        return true;
    }

    double tolerance_;
    bool fits_guards_;
    double stride_;
    Program::Rounding constants_;
    const Equations* equations_ = nullptr;
    Workshop* workshop_ = nullptr;
    int n_ = 0;  // variables
    std::vector<std::pair<const Equations*, std::unique_ptr<Workshop>>> workshops_;
    std::vector<double> parameters_;

    Instant t_;                            // where the motion has come to
    std::vector<double> x_, low_, slope_;  // the state there, what rounding left out of it, and its slope
    Instant start_t_;                      // the same at the start of the last step
    std::vector<double> start_, start_low_, start_slope_;
    mutable std::vector<double> y_, differences_;  // of the stage; slopes of the stages less that at the start
    bool has_slope_ = false, is_first_ = true, is_cut_ = false;
    Piece whole_;                                     // the whole step, where guards cut it
    double offset_ = 0.0, natural_ = 1.0;             // where the piece begins on it
    std::vector<double> coefficients_, part_;         // of the whole step; of a part of it
    std::vector<double> next_coefficients_, defect_;  // of the step that is tried; of its polynomial
    std::vector<double> allowed_;                     // per group, error of the step that is tried
    std::vector<double> rounding_, spread_;     // per group, what rounding does to slopes, and more of it in unit time
    mutable double anchor_ = 0.0;               // a place on the whole step
    mutable std::vector<double> anchor_state_;  // and the state there
    MotionScales scales_;
    std::vector<double> estimates_, next_estimates_;  // per group, its scale where there has been no motion yet
};

}  // namespace rbdyn
