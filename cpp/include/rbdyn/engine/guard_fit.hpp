// Guards along a piece as polynomials through their values (series/fit.hpp): for equations without a series.
//
// The piece's polynomial stands for the motion; the fit is held against the guards themselves between the points.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>
#include <vector>

#include "rbdyn/expression/evaluate.hpp"
#include "rbdyn/model/equations.hpp"
#include "rbdyn/series/fit.hpp"
#include "rbdyn/series/piece.hpp"

namespace rbdyn {

class GuardFit {
public:
    using Fit = series::Fit;
    static constexpr int order = Fit::degree;

    explicit GuardFit(const Equations& equations)
        : equations_(&equations),
          evaluator_(equations.program),
          state_(static_cast<std::size_t>(equations.variables())),
          values_(equations.guards.size() * Fit::points),
          coefficients_(equations.guards.size() * Fit::points),
          allowed_(equations.guards.size()),
          largest_(equations.guards.size()),
          rounding_(equations.guards.size()) {
        for (std::size_t g = 0; g < equations.guards.size(); ++g)
            if (equations.guards[g].output >= 0 && !equations.is_variable(equations.guards[g])) fitted_.push_back(g);
    }

    void set_parameters(std::span<const double> parameters, Program::Rounding rounding) {
        evaluator_.set_parameters(parameters, rounding);
    }

    /// How far a fit is from the guards: by the largest error over what is allowed, and over the guard's largest value.
    /// What is not a number anywhere is as far as can be.
    struct Miss {
        double allowed = 0.0, value = 0.0;
        bool holds() const { return allowed <= 1.0; }
    };

    /// Fits all guards but those that are variables on [0, length] of the piece, in its unit of time. Allowed is
    /// `tolerance` times the largest value there, or the rounding of its terms; one that is not finite at the start is
    /// not weighed.
    Miss operator()(const Piece& piece, double length, double tolerance) {
        std::fill(largest_.begin(), largest_.end(), 0.0);
        for (int j = 0; j < Fit::points; ++j) {
            evaluate(piece, Fit::place(j) * length);
            for (const std::size_t g : fitted_) {
                const int output = equations_->guards[g].output;
                const double value = evaluator_.output(output);
                values_[g * Fit::points + static_cast<std::size_t>(j)] = value;
                largest_[g] = std::max(largest_[g], std::abs(value));
                if (j == 0) rounding_[g] = 64.0 * epsilon * evaluator_.magnitude(output);
            }
        }
        for (const std::size_t g : fitted_) {
            double* c = coefficients_.data() + g * Fit::points;
            allowed_[g] = std::max(tolerance * largest_[g], rounding_[g]);
            Fit::coefficients(values_.data() + g * Fit::points, std::max(1e-3 * allowed_[g], 0.25 * rounding_[g]), c);
            double power = 1.0;
            for (int k = 1; k < Fit::points; ++k) c[k] /= (power *= length);
        }
        return miss(piece, length);
    }

    /// Coefficients 0 .. order of a guard.
    const double* coefficients(int guard) const {
        return coefficients_.data() + static_cast<std::ptrdiff_t>(guard) * Fit::points;
    }

    /// Makes the sizes of a guard's coefficients those of the terms they are made of, as far as values tell: where the
    /// piece begins, and for a variable the first of its rate.
    void widen_at_start(const Piece& piece, int output, double* sizes) {
        evaluate(piece, 0.0);
        const int slot = equations_->program.output(output);
        if (slot >= equations_->program.inputs())
            sizes[0] = std::max(sizes[0], evaluator_.magnitude(output));
        else
            sizes[1] = std::max(sizes[1], evaluator_.magnitude(slot) * piece.unit);
    }

private:
    static constexpr double epsilon = std::numeric_limits<double>::epsilon();

    void evaluate(const Piece& piece, double tau) {
        piece.state(tau, state_);
        evaluator_(piece.at(tau).hi, state_);
    }

    Miss miss(const Piece& piece, double length) {
        Miss worst;
        for (int j = 0; j < Fit::checks; ++j) {
            const double tau = Fit::check(j) * length;
            evaluate(piece, tau);
            for (const std::size_t g : fitted_) {
                if (!std::isfinite(values_[g * Fit::points])) continue;
                const double* c = coefficients_.data() + g * Fit::points;
                const double error =
                    std::abs(evaluator_.output(equations_->guards[g].output) - series::value(c, order, tau));
                if (error <= allowed_[g]) continue;
                const double infinity = std::numeric_limits<double>::infinity();
                worst.allowed = std::isnan(error) ? infinity : std::max(worst.allowed, error / allowed_[g]);
                worst.value = std::isnan(error) ? infinity : std::max(worst.value, error / largest_[g]);
            }
        }
        return worst;
    }

    const Equations* equations_;
    Evaluator<double> evaluator_;
    std::vector<double> state_, values_, coefficients_, allowed_, largest_, rounding_;
    std::vector<std::size_t> fitted_;
};

}  // namespace rbdyn
