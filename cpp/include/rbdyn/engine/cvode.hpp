// SUNDIALS CVODE as an engine: variable-order Adams, and BDF with the exact Jacobian for stiff motion.
//
// Source: Hindmarsh and others, "SUNDIALS: suite of nonlinear and differential/algebraic equation solvers", ACM
// Transactions on Mathematical Software 31 (2005) 363-396. Both methods carry a polynomial of their order q that
// passes through both ends of a step (Byrne and Hindmarsh, ACM TOMS 1 (1975) 71-96): a step is a piece, and pieces
// join to rounding.
//
// Conventions: CVODE's clock is zero where smooth motion starts, so that short steps late in a run keep their digits.
// Error weights follow the scales of the motion itself (extent of positions, largest velocities); nothing here has a
// unit, and the same motion in units that differ by powers of two takes the same steps to the last bit.
// CVODE's root finder is not used: guards are series on the pieces, as for every engine. What begins at a zero of its
// guards (a bead that leaves its rail leaves it with the third power of time) tells them apart by more orders than
// CVODE's first steps have: the first piece after an event is a step of a Taylor series, of dop853 where functions are
// called back, and CVODE goes on from its end.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <new>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "rbdyn/engine/cvode_integrator.hpp"
#include "rbdyn/engine/dop853.hpp"
#include "rbdyn/engine/engine.hpp"
#include "rbdyn/engine/motion_scales.hpp"
#include "rbdyn/engine/taylor.hpp"
#include "rbdyn/expression/evaluate.hpp"

namespace rbdyn {

/// CVODE, one internal step a piece. Adams for smooth motion, BDF for stiff motion.
class CvodeEngine : public Engine {
public:
    enum class Method { adams, bdf };

    /// Local error per step relative to the motion's scales.
    CvodeEngine(Method method, double rtol) : method_(method), rtol_(rtol), context_(cvode::make_context()) {}
    CvodeEngine(const CvodeEngine&) = delete;
    CvodeEngine& operator=(const CvodeEngine&) = delete;

    std::string name() const override { return method_ == Method::adams ? "cvode-adams" : "cvode-bdf"; }

    void start(const Equations& equations, std::span<const double> parameters, Instant t,
               std::span<const double> x) override {
        if (equations_ != &equations) {
            equations_ = &equations;
            integrator_ = &integrator_for(equations);
            scales_.resize(x.size());
            scales_.follow(equations.groups);
            estimates_.resize(equations.groups.size());
        }
        parameters_.assign(parameters.begin(), parameters.end());
        integrator_->set_parameters(parameters_);
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

    StepStatus step(double limit) override {
        if (pending_ && offset_ + piece_.length < 1.0 - 1e-12) return next_part();
        if (!(limit - t_ > 0.0)) return StepStatus::stalled;
        if (is_first_ && is_restart_ && set_off(limit)) return StepStatus::ok;
        starter_ = nullptr;
        if (!is_first_ && drop_start_flags(*equations_, parameters_)) integrator_->set_parameters(parameters_);
        if (!running_ && !begin(limit)) return StepStatus::not_finite;
        void* memory = integrator_->memory.get();
        const double stop = limit - integrator_->origin;
        if (!(stop > clock_)) return StepStatus::stalled;
        CVodeSetStopTime(memory, stop);
        double clock = clock_;
        const int outcome = CVode(memory, stop, integrator_->y.get(), &clock, CV_ONE_STEP);
        count_rejected();
        if (integrator_->thrown) std::rethrow_exception(std::exchange(integrator_->thrown, nullptr));
        if (outcome < 0) {
            running_ = false;
            return slope_is_finite() ? StepStatus::stalled : StepStatus::not_finite;
        }
        const bool at_limit = outcome == CV_TSTOP_RETURN;
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

    void state(double tau, std::span<double> x) const override {
        if (starter_ != nullptr) return starter_->state(tau * starter_->piece().length, x);
        if (tau == 0.0) return piece_.state(tau, x);
        const int row = piece_.order + 1;
        for (int i = 0; i < piece_.variables; ++i)
            x[at(i)] = series::value(from_end_.data() + i * row, piece_.order, offset_ + tau - 1.0);
    }

    double natural_length() const override {
        return starter_ != nullptr ? starter_->natural_length() / starter_->piece().length : piece_.length;
    }
    bool refines() const override { return starter_ != nullptr && starter_->refines(); }

    const double* guard(int index) override {
        ++work_.guard_evaluations;
        if (starter_ == nullptr) return integrator_->guards.coefficients(index);
        const double* c = starter_->guard(index);
        double power = 1.0;
        guard_row_.resize(at(starter_->guard_order() + 1));
        for (std::size_t k = 0; k < guard_row_.size(); ++k, power *= starter_->piece().length)
            guard_row_[k] = c[k] * power;
        return guard_row_.data();
    }
    int guard_order() const override {
        return starter_ != nullptr ? starter_->guard_order() : integrator_->guards.order();
    }
    bool fits_guards() const override {
        return starter_ != nullptr ? starter_->fits_guards() : integrator_->guards.fits();
    }
    bool is_rough(int guard) const override {
        return starter_ != nullptr ? starter_->is_rough(guard) : integrator_->guards.is_rough(guard);
    }
    void guard_sizes(int index, double* sizes) override {
        if (starter_ == nullptr) return integrator_->guards.sizes(index, sizes);
        starter_->guard_sizes(index, sizes);
        double power = 1.0;
        for (int k = 0; k <= starter_->guard_order(); ++k, power *= starter_->piece().length) sizes[k] *= power;
    }
    void rest(double tau, std::span<const double> x, std::span<double> low) const override {
        if (starter_ == nullptr) return Engine::rest(tau, x, low);
        starter_->rest(tau * starter_->piece().length, x, low);
    }

private:
    /// The first piece of a mode, by the engine for that. Returns whether there is one.
    bool set_off(double limit) {
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

    /// Guards with a singularity near the motion, 1 / (1.1 + sin u) on a pendulum through sin u = -1, are then cut off
    /// below the error of the method for tolerances from 1e-6 on, smooth ones at rounding.
    int series_order() const { return rtol_ > 1e-8 ? 18 : 14; }

    static constexpr int start_order = 12;  // of the Taylor series that tells scales and the first step
    static constexpr double epsilon = std::numeric_limits<double>::epsilon();
    static std::size_t at(int index) { return static_cast<std::size_t>(index); }

    cvode::Integrator& integrator_for(const Equations& equations) {
        for (auto& [known, integrator] : integrators_)
            if (known == &equations) return *integrator;
        integrators_.emplace_back(
            &equations, std::make_unique<cvode::Integrator>(equations, method_ == Method::bdf, series_order(),
                                                            rtol_ * std::exp2(guard_slack), context_.get(), work_));
        return *integrators_.back().second;
    }

    /// Sets CVODE off from the present state; false if the derivative there is not finite.
    bool begin(double limit) {
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

    /// Taylor coefficients of the motion from here, in `unit`; how many orders of them are finite.
    int expand(double span, double& unit) {
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

    /// Estimates how far each group is about to move; returns a first step, in units, for a method of order one.
    double measure(int orders, double span) {
        std::array<double, start_order + 1> size;
        double first_step = span;
        for (std::size_t g = 0; g < estimates_.size(); ++g) {
            const VariableGroup& group = equations_->groups[g];
            size.fill(0.0);
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
            if (!std::isfinite(reach)) reach = std::isfinite(span) ? span : 1.0;
            estimates_[g] = std::max(estimates_[g], size[at(lead)] * std::pow(reach, lead));
            const double tolerance = absolute_tolerance(g);
            for (int k = 2; k <= orders; ++k)
                if (size[at(k)] > 0.0)
                    first_step = std::min(first_step, 0.5 * std::pow(tolerance / size[at(k)], 1.0 / k));
        }
        return std::isfinite(first_step) ? first_step : 1.0;
    }

    /// Error allowed in the variables of a group. Never less than rounding of the numbers themselves can give.
    double absolute_tolerance(std::size_t g) const {
        const VariableGroup& group = equations_->groups[g];
        const double scale = std::max(estimates_[g], scales_.scale(group));
        return std::max(rtol_ * scale, 8.0 * epsilon * scales_.magnitude(group));
    }

    void weigh() {
        for (std::size_t g = 0; g < estimates_.size(); ++g) {
            const VariableGroup& group = equations_->groups[g];
            const double weight = 1.0 / absolute_tolerance(g);
            std::fill_n(integrator_->weights.begin() + group.first, group.count, std::isfinite(weight) ? weight : 0.0);
        }
    }

    /// Takes the present state into the scales of the motion.
    void widen() {
        scales_.widen(x_);
        weigh();
    }

    /// True if a group that had no scale has moved: nothing watched over its error, so the step is taken again.
    bool found_scale() {
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

    bool slope_is_finite() {
        integrator_->evaluator(t_.hi, x_);
        for (int i = 0; i < integrator_->n; ++i)
            if (!std::isfinite(integrator_->evaluator.output(i))) return false;
        return true;
    }

    void count_rejected() {
        long errors = 0, failures = 0;
        CVodeGetNumErrTestFails(integrator_->memory.get(), &errors);
        CVodeGetNumStepSolveFails(integrator_->memory.get(), &failures);
        work_.rejected += errors + failures - rejected_;
        rejected_ = errors + failures;
    }

    /// CVODE's polynomial about the end of its step, in steps; false if it is not finite.
    bool take_polynomial() {
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

    /// x + x' h, with the slope that was evaluated last.
    void straight_line(double h) {
        order_ = 1;
        from_end_.resize(at(2 * integrator_->n));
        for (int i = 0; i < integrator_->n; ++i) {
            from_end_[at(2 * i + 1)] = integrator_->evaluator.output(i) * h;
            from_end_[at(2 * i)] = x_[at(i)] + from_end_[at(2 * i + 1)];
        }
    }

    /// Cuts the piece where the coefficients of its guards hold no longer: CVODE's steps know nothing of guards, and a
    /// bead that is carried at a constant speed takes very long ones.
    void shorten(bool is_rest) { piece_.length = integrator_->guards.begin(piece_, is_rest); }

    /// The next part of a step that was cut; it counts for max_steps, for its guards cost as much.
    StepStatus next_part() {
        ++work_.parts;
        offset_ += piece_.length;
        if (drop_start_flags(*equations_, parameters_)) integrator_->set_parameters(parameters_);
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

    /// The piece from t_, x_ to the end: the same polynomial about its start.
    void fill_piece(Instant end) {
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

    Method method_;
    double rtol_;
    Piece whole_;           // the whole step, where guards cut it
    bool pending_ = false;  // parts of it may be left
    double offset_ = 0.0;   // where the piece begins on it
    std::vector<double> part_;
    cvode::Owned<SUNContext> context_;
    std::vector<std::pair<const Equations*, std::unique_ptr<cvode::Integrator>>> integrators_;
    const Equations* equations_ = nullptr;
    cvode::Integrator* integrator_ = nullptr;

    Instant t_;             // where the motion has come to
    double clock_ = 0.0;    // the same on CVODE's clock
    bool running_ = false;  // CVODE goes on from there
    bool is_first_ = true;  // no step since start()
    bool has_started_ = false, is_restart_ = false;
    std::unique_ptr<Engine> by_series_, by_values_;
    std::vector<double> guard_row_;
    Engine* starter_ = nullptr;  // made the piece; none: CVODE did
    int order_ = 0;
    long steps_ = 0, rejected_ = 0;  // CVODE's counts since it was set off
    std::vector<double> x_, from_end_, coefficients_, parameters_;
    MotionScales scales_;
    std::vector<double> estimates_;  // per group, where the past tells less
};

}  // namespace rbdyn
