// Guards along the pieces of an engine whose steps know nothing of them: their coefficients, and how far these hold.
//
// Where the equations have series, a guard is the series of its function along the polynomial of the piece; else a
// polynomial through its values. A step on which these would be cut off too soon is handed out in parts. Where values
// do not become a polynomial (a corner, a jump, a function that is rough by itself) there is no end to that: a step is
// given so many fits as its polynomials have coefficients, a few times, and then the last one holds as far as it goes.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <span>
#include <vector>

#include "rbdyn/engine/guard_fit.hpp"
#include "rbdyn/expression/series_evaluator.hpp"
#include "rbdyn/expression/term_sizes.hpp"
#include "rbdyn/series/piece.hpp"
#include "rbdyn/series/step_length.hpp"

namespace rbdyn {

/// Whether every instruction of the equations has a series.
inline bool series_are_known(const Equations& equations) { return !equations.program.has_calls(); }

class PieceGuards {
public:
    /// `tolerance`: what may be cut off of a guard, relative to its size. Orders of series: 0 .. order. The series
    /// evaluator is shared with the engine; none: values are fitted.
    PieceGuards(const Equations& equations, SeriesEvaluator* series, int order, double tolerance)
        : equations_(&equations),
          series_(series),
          fit_(series == nullptr ? std::make_unique<GuardFit>(equations) : nullptr),
          order_(series == nullptr ? GuardFit::order : order),
          tolerance_(tolerance),
          log_tolerance_(std::log2(tolerance)) {
        for (const Guard& guard : equations.guards) need_more_ = need_more_ || is_computed(guard);
    }

    /// Whether values are fitted.
    bool fits() const { return fit_ != nullptr; }
    /// Of what coefficients() gives.
    int order() const { return order_; }

    void set_parameters(std::span<const double> parameters, Program::Rounding rounding = Program::Rounding::nearest) {
        if (fit_) fit_->set_parameters(parameters, rounding);
    }

    /// A mode begins, with these parameters.
    void enter(std::span<const double> parameters) {
        if (fit_) fit_->enter(parameters);
        goes_on_ = false;
    }

    /// Looks at another piece; `is_rest`: what was left of the last one. Returns its length, or less: how far the
    /// guards' coefficients hold.
    double begin(const Piece& piece, bool is_rest = false) {
        piece_ = piece;
        rough_.clear();
        if (!is_rest) {
            fits_left_ = most_fits;
            first_try_ = std::numeric_limits<double>::infinity();
            least_ = std::ldexp(piece.length, -most_halvings);
        }
        if (!need_more_) return piece.length;
        if (fit_ && goes_on_) fit_->go_on();
        goes_on_ = true;
        if (fit_) return fitted_length();
        expand();
        return std::min(piece.length, series_length());
    }

    /// Whether these say nothing of a guard all along.
    bool is_rough(int guard) const { return !rough_.empty() && rough_[static_cast<std::size_t>(guard)] != 0; }

    const double* coefficients(int guard) {
        const Guard& g = equations_->guards[static_cast<std::size_t>(guard)];
        if (equations_->is_variable(g)) {
            // the row of the piece, with zeros after it
            row_.fill(0.0);
            std::copy_n(piece_.variable(equations_->program.output(g.output)), piece_.order + 1, row_.data());
            return row_.data();
        }
        return fit_ ? fit_->coefficients(guard) : series_->output(g.output);
    }

    /// Sizes of the terms that these are made of.
    void sizes(int guard, double* s) {
        const Guard& g = equations_->guards[static_cast<std::size_t>(guard)];
        if (series_) {
            if (!need_more_) expand();
            const TermSizes::Sizes known = TermSizes(*series_, order_)(equations_->program.output(g.output));
            std::copy_n(known.begin(), order_ + 1, s);
            return;
        }
        const double* c = coefficients(guard);
        for (int k = 0; k <= order_; ++k) s[k] = std::abs(c[k]);
        fit_->widen_at_start(piece_, g.output, s);
    }

private:
    // a guard is halved at most so often: one that is not finite ahead is the driver's to judge
    static constexpr int most_halvings = 10;
    // of one step: a corner in it takes two for each halving, and there is room for some
    static constexpr int most_fits = 8 * (GuardFit::order + 1);
    // values that are this near to a polynomial and come no nearer on shorter intervals are rough by themselves
    static constexpr double rough = 1e-6;

    /// Not a variable itself, nor found otherwise than by its value.
    bool is_computed(const Guard& guard) const { return guard.output >= 0 && !equations_->is_variable(guard); }

    void expand() {
        series_->begin(piece_.start.hi, piece_.unit);
        for (int i = 0; i < piece_.variables; ++i)
            for (int k = 0; k <= order_; ++k) series_->set_input(i, k, k <= piece_.order ? piece_.variable(i)[k] : 0.0);
        for (int k = 0; k <= order_; ++k) series_->advance(k);
    }

    double series_length() {
        double log_length = 0.0;
        for (std::size_t g = 0; g < equations_->guards.size(); ++g) {
            const Guard& guard = equations_->guards[g];
            if (!is_computed(guard)) continue;
            const double* c = series_->output(guard.output);
            std::array<double, 32> size{};
            double check = 0.0;
            for (int k = 0; k <= order_; ++k) {
                size[static_cast<std::size_t>(k)] = std::abs(c[k]);
                check += 0.0 * c[k];
            }
            if (check != 0.0) {
                mark_rough(g);
                continue;
            }
            double log_guard = series::log_step(size.data(), order_, size[0], log_tolerance_);
            if (log_guard < -most_halvings) {
                mark_rough(g);
                log_guard = -most_halvings;
            }
            log_length = std::min(log_length, log_guard);
        }
        return std::exp2(log_length);
    }

    void mark_rough(std::size_t guard) {
        rough_.resize(equations_->guards.size(), 0);
        rough_[guard] = 1;
    }

    /// From a length on that may hold, halves until the fit does. What follows a part may be twice as long.
    double fitted_length() {
        double length = std::min(piece_.length, first_try_), longest = length;
        GuardFit::Miss last = (*fit_)(piece_, length, tolerance_);
        int no_better = 0;
        for (--fits_left_; !last.holds() && 0.5 * length >= least_ && fits_left_ > 0; --fits_left_) {
            length *= 0.5;
            const GuardFit::Miss now = (*fit_)(piece_, length, tolerance_);
            no_better += now.value > 0.5 * last.value ? 1 : 0;
            if (no_better == 0) longest = length;
            last = now;
            if (no_better == 2 && last.value <= rough) {
                length = longest;
                last = (*fit_)(piece_, length, tolerance_);
                break;
            }
        }
        if (fits_left_ <= 0 && length < piece_.length) last = (*fit_)(piece_, length = piece_.length, tolerance_);
        if (!last.holds() && last.value > rough)
            for (std::size_t g = 0; g < equations_->guards.size(); ++g)
                if (is_computed(equations_->guards[g])) mark_rough(g);
        first_try_ = 2.0 * length;
        return length;
    }

    const Equations* equations_;
    SeriesEvaluator* series_;
    std::unique_ptr<GuardFit> fit_;
    int order_;
    double tolerance_, log_tolerance_;
    std::vector<signed char> rough_;        // by guard; empty: none is
    int fits_left_ = 0;                     // on this step
    double first_try_ = 0.0, least_ = 0.0;  // lengths of its parts
    bool goes_on_ = false;                  // there was a piece of this mode
    bool need_more_ = false;                // than the variables themselves
    Piece piece_;
    std::array<double, 32> row_{};
};

}  // namespace rbdyn
