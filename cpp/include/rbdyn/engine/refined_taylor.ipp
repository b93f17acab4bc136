// Definitions of rbdyn/engine/refined_taylor.hpp.
#pragma once

#include "rbdyn/engine/refined_taylor.hpp"

#include <array>
#include <cmath>
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include "rbdyn/basics/double_double_functions.hpp"
#include "rbdyn/basics/instant.hpp"
#include "rbdyn/engine/engine.hpp"
#include "rbdyn/engine/taylor.hpp"
#include "rbdyn/expression/evaluate.hpp"
#include "rbdyn/model/equations.hpp"
#include "rbdyn/series/piece.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE void RefinedTaylorEngine::start(const Equations& equations, std::span<const double> parameters, Instant t,
                                             std::span<const double> x) {
    TaylorEngine::start(equations, parameters, t, x);
    if (equations_ != &equations) evaluator_.emplace(equations.program);
    equations_ = &equations;
    set_parameters();
}

RBDYN_INLINE StepStatus RefinedTaylorEngine::step(double limit) {
    const StepStatus status = TaylorEngine::step(limit);
    // what was expanded with 32 digits is as good
    is_refined_ = status == StepStatus::ok && !is_wide() && find_missing(low_before());
    if (is_refined_) {
        const std::span<double> x = replace_state();
        for (std::size_t i = 0; i < x.size(); ++i) {
            const Real change = increment(i, piece_.length) + end_[i];
            const auto high = static_cast<double>(change);
            const Instant sum = exact_sum(piece_.variable(static_cast<int>(i))[0], high);
            const Instant whole = exact_sum(sum.hi, sum.lo + static_cast<double>(change - static_cast<Real>(high)));
            x[i] = whole.hi;
            low()[i] = whole.lo;
        }
        // no rounded coefficient left anything out
        hold(0.0);
    }
    if (!equations_->start_flags.empty()) set_parameters();
    return status;
}

RBDYN_INLINE void RefinedTaylorEngine::rest(double tau, std::span<const double> x, std::span<double> low) const {
    if (!is_refined_) return TaylorEngine::rest(tau, x, low);
    for (std::size_t i = 0; i < x.size(); ++i) {
        const Real start = piece_.variable(static_cast<int>(i))[0];
        low[i] = static_cast<double>((start - x[i]) + increment(i, tau) +
                                     missing(i, static_cast<Real>(tau) / static_cast<Real>(piece_.length)));
    }
}

RBDYN_INLINE void RefinedTaylorEngine::recall(std::span<const double> memory) {
    TaylorEngine::recall(memory);
    set_parameters();
}

RBDYN_INLINE RefinedTaylorEngine::Rule::Rule() {
    constexpr Real pi = 3.14159265358979323846264338327950288L;
    std::array<Real, points> whole;
    for (std::size_t i = 0; i < points; ++i) {
        // zeros of Legendre's polynomial, by Newton's steps
        Real x = -std::cos(pi * (static_cast<Real>(i) + 0.75L) / (points + 0.5L));
        for (int k = 0; k < 8; ++k) {
            const auto [value, slope] = legendre(x);
            x -= value / slope;
        }
        const Real slope = legendre(x).second;
        at[i] = 0.5L * (1.0L + x);
        whole[i] = 1.0L / ((1.0L - x * x) * slope * slope);
    }
    // integrals of Lagrange's polynomials, by the same rule on each part
    for (std::size_t row = 0; row <= points; ++row) {
        const Real end = row < points ? at[row] : 1.0L;
        for (std::size_t j = 0; j < points; ++j) {
            weight[row][j] = 0.0L;
            for (std::size_t k = 0; k < points; ++k) {
                Real product = end * whole[k];
                for (std::size_t m = 0; m < points; ++m)
                    if (m != j) product *= (end * at[k] - at[m]) / (at[j] - at[m]);
                weight[row][j] += product;
            }
        }
    }
}

RBDYN_INLINE std::pair<RefinedTaylorEngine::Real, RefinedTaylorEngine::Real> RefinedTaylorEngine::Rule::legendre(
    Real x) {
    Real before = 1.0L, now = x;
    for (std::size_t n = 2; n <= points; ++n) {
        const auto order = static_cast<Real>(n);
        const Real next = ((2.0L * order - 1.0L) * x * now - (order - 1.0L) * before) / order;
        before = now;
        now = next;
    }
    return {now, points * (x * now - before) / (x * x - 1.0L)};
}

RBDYN_INLINE const RefinedTaylorEngine::Rule& RefinedTaylorEngine::rule() {
    static const Rule one;
    return one;
}

RBDYN_INLINE void RefinedTaylorEngine::set_parameters() {
    const std::span<const double> p = parameters();
    evaluator_->set_parameters(std::vector<Real>(p.begin(), p.end()), rounding());
}

RBDYN_INLINE RefinedTaylorEngine::Real RefinedTaylorEngine::increment(std::size_t i, double tau) const {
    const double* c = piece_.variable(static_cast<int>(i));
    Real sum = 0.0L;
    for (int k = piece_.order; k > 0; --k) sum = (sum + c[k]) * static_cast<Real>(tau);
    return sum;
}

RBDYN_INLINE RefinedTaylorEngine::Real RefinedTaylorEngine::missing(std::size_t i, Real part) const {
    const Rule& r = rule();
    const std::size_t n = low_before().size();
    const auto place = [&](std::size_t j) { return j == 0 ? 0.0L : r.at[j - 1]; };
    Real sum = 0.0L;
    for (std::size_t j = 0; j <= points; ++j) {
        Real product = j == 0 ? static_cast<Real>(low_before()[i]) : missing_[(j - 1) * n + i];
        for (std::size_t m = 0; m <= points; ++m)
            if (m != j) product *= (part - place(m)) / (place(j) - place(m));
        sum += product;
    }
    return sum;
}

RBDYN_INLINE bool RefinedTaylorEngine::find_missing(std::span<const double> before) {
    const Rule& r = rule();
    const std::size_t n = before.size();
    const Real length = piece_.length, unit = piece_.unit;
    // of point j from j n on
    for (std::vector<Real>* v : {&value_, &slope_, &missing_, &residual_}) v->resize(points * n);
    for (std::size_t j = 0; j < points; ++j)
        for (std::size_t i = 0; i < n; ++i) {
            const double* c = piece_.variable(static_cast<int>(i));
            const Real tau = length * r.at[j];
            Real p = 0.0L, slope = 0.0L;
            for (int k = piece_.order; k >= 0; --k) {
                slope = slope * tau + p;
                p = p * tau + c[k];
            }
            value_[j * n + i] = p;
            slope_[j * n + i] = slope;
            missing_[j * n + i] = before[i];
        }
    end_.assign(n, 0.0L);
    state_.resize(n);
    for (int iteration = 0; iteration < most_iterations; ++iteration) {
        for (std::size_t j = 0; j < points; ++j) {
            for (std::size_t i = 0; i < n; ++i) state_[i] = value_[j * n + i] + missing_[j * n + i];
            (*evaluator_)(static_cast<Real>(piece_.start.hi) + piece_.start.lo + unit * length * r.at[j], state_);
            for (std::size_t i = 0; i < n; ++i)
                residual_[j * n + i] = length * (unit * evaluator_->output(static_cast<int>(i)) - slope_[j * n + i]);
        }
        const auto integral = [&](std::size_t row, std::size_t i) {
            Real sum = before[i];
            for (std::size_t j = 0; j < points; ++j) sum += r.weight[row][j] * residual_[j * n + i];
            return sum;
        };
        Real change = 0.0L, size = 0.0L;
        for (std::size_t i = 0; i < n; ++i) {
            for (std::size_t j = 0; j < points; ++j) missing_[j * n + i] = integral(j, i);
            const Real last = std::exchange(end_[i], integral(points, i));
            change += std::abs(end_[i] - last);
            size += std::abs(end_[i]);
        }
        // three digits
        if (iteration > 1 && change <= 1e-3L * size) return is_rounding();
    }
    return false;
}

RBDYN_INLINE bool RefinedTaylorEngine::is_rounding() const {
    for (const VariableGroup& group : equations_->groups) {
        Real missing = 0.0L, size = 0.0L;
        for (int i = group.first; i < group.first + group.count; ++i) {
            missing += std::abs(end_[index(i)]);
            size += std::abs(state_[index(i)]) + std::abs(increment(index(i), piece_.length));
        }
        if (!(missing <= 1e-8L * size)) return false;
    }
    return true;
}

}  // namespace rbdyn::inline RBDYN_FORM
