// Definitions of rbdyn/engine/guard_fit.hpp.
#pragma once

#include "rbdyn/engine/guard_fit.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>

#include "rbdyn/basics/instant.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/expression/evaluate.hpp"
#include "rbdyn/expression/program.hpp"
#include "rbdyn/expression/recorder.hpp"
#include "rbdyn/model/equations.hpp"
#include "rbdyn/series/fit.hpp"
#include "rbdyn/series/piece.hpp"
#include "rbdyn/series/polynomial.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE GuardFit::GuardFit(const Equations& equations)
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
    for (const std::size_t g : fitted_) {
        const Switch* s = equations.switch_of(equations.guards[g]);
        if (s == nullptr || !s->is_norm) continue;
        const Instruction* norm = equations.program.norm(equations.guards[g].output);
        if (norm != nullptr) lengths_.push_back({g, s->parameter, {norm->a, norm->b, norm->c}});
    }
}

RBDYN_INLINE void GuardFit::enter(std::span<const double> parameters) {
    for (Length& l : lengths_) {
        l.is_known = false;
        l.starts_at_zero = parameters[static_cast<std::size_t>(l.flag)] != 0.0;
    }
}

RBDYN_INLINE void GuardFit::go_on() {
    for (Length& l : lengths_) {
        const Vector3& last = l.at[Fit::points - 1];
        if (!(last.norm() > rounding * l.size)) continue;
        l.before = last;
        l.is_known = true;
    }
}

RBDYN_INLINE void GuardFit::set_parameters(std::span<const double> parameters, Program::Rounding constants) {
    evaluator_.set_parameters(parameters, constants);
}

RBDYN_INLINE GuardFit::Miss GuardFit::operator()(const Piece& piece, double length, double tolerance) {
    std::fill(largest_.begin(), largest_.end(), 0.0);
    for (int j = 0; j < Fit::points; ++j) {
        evaluate(piece, Fit::place(j) * length);
        for (const std::size_t g : fitted_) {
            const int output = equations_->guards[g].output;
            const double value = evaluator_.output(output);
            values_[g * Fit::points + static_cast<std::size_t>(j)] = value;
            largest_[g] = std::max(largest_[g], std::abs(value));
            if (j == 0) rounding_[g] = rounding * evaluator_.magnitude(output);
        }
        for (Length& l : lengths_) l.at[static_cast<std::size_t>(j)] = vector(l);
    }
    bool is_followed = true;
    for (Length& l : lengths_) is_followed = follow(l, piece, length, tolerance) && is_followed;
    for (const std::size_t g : fitted_) {
        double* c = coefficients_.data() + g * Fit::points;
        allowed_[g] = std::max(tolerance * largest_[g], rounding_[g]);
        Fit::coefficients(values_.data() + g * Fit::points, std::max(1e-3 * allowed_[g], 0.25 * rounding_[g]), c);
        double power = 1.0;
        for (int k = 1; k < Fit::points; ++k) c[k] /= (power *= length);
    }
    if (!is_followed) return {std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
    return miss(piece, length);
}

RBDYN_INLINE const double* GuardFit::coefficients(int guard) const {
    return coefficients_.data() + static_cast<std::ptrdiff_t>(guard) * Fit::points;
}

RBDYN_INLINE void GuardFit::widen_at_start(const Piece& piece, int output, double* sizes) {
    evaluate(piece, 0.0);
    const int slot = equations_->program.output(output);
    if (slot >= equations_->program.inputs())
        sizes[0] = std::max(sizes[0], evaluator_.magnitude(output));
    else
        sizes[1] = std::max(sizes[1], evaluator_.magnitude(slot) * piece.unit);
}

RBDYN_INLINE Vector3 GuardFit::vector(const Length& l) const {
    return {evaluator_.slot(l.parts[0]), evaluator_.slot(l.parts[1]), evaluator_.slot(l.parts[2])};
}

RBDYN_INLINE bool GuardFit::follow(Length& l, const Piece& piece, double length, double tolerance) {
    double* values = values_.data() + l.guard * Fit::points;
    const double largest = largest_[l.guard];
    if (!std::isfinite(largest)) return true;
    l.size = std::max(l.size, largest);
    const double noise = rounding * l.size;
    // where it begins at zero, the first that is more than an error of the place
    const double least = l.is_known ? 0.0 : l.starts_at_zero ? std::max(1e-3 * largest, noise) : noise;
    std::size_t first = 0;
    while (first + 1 < Fit::points && !(l.at[first].norm() > least)) ++first;
    Vector3 last = l.is_known ? l.before : l.at[first];
    double sign = 1.0, from = 0.0;
    for (std::size_t j = 0; j < Fit::points; ++j) {
        const double place = Fit::place(static_cast<int>(j)) * length;
        if (last.dot(l.at[j]) < 0.0 && l.at[j].norm() > noise) {
            if (j < first) {
                values[j] = -values[j];
                continue;
            }
            if (j > first && !passes_zero(l, piece, last, from, place, std::max(tolerance * largest, noise)))
                return false;
            sign = -sign;
        }
        values[j] *= sign;
        if (j < first || !(l.at[j].norm() > noise)) continue;
        last = l.at[j];
        from = place;
    }
    return true;
}

RBDYN_INLINE bool GuardFit::passes_zero(const Length& l, const Piece& piece, const Vector3& last, double from,
                                        double to, double allowed) {
    const Vector3 along = last.normalized();
    Vector3 there = last;
    for (int k = 0; k < 60 && to - from > epsilon * to; ++k) {
        const double middle = 0.5 * (from + to);
        evaluate(piece, middle);
        there = vector(l);
        (there.dot(along) > 0.0 ? from : to) = middle;
    }
    return (there - there.dot(along) * along).norm() <= allowed;
}

RBDYN_INLINE void GuardFit::evaluate(const Piece& piece, double tau) {
    piece.state(tau, state_);
    evaluator_(piece.at(tau).hi, state_);
}

RBDYN_INLINE GuardFit::Miss GuardFit::miss(const Piece& piece, double length) {
    Miss worst;
    for (int j = 0; j < Fit::checks; ++j) {
        const double tau = Fit::check(j) * length;
        evaluate(piece, tau);
        for (const std::size_t g : fitted_) {
            if (!std::isfinite(values_[g * Fit::points])) continue;
            const double* c = coefficients_.data() + g * Fit::points;
            double fit = series::value(c, order, tau);
            const Switch* s = equations_->switch_of(equations_->guards[g]);
            if (s != nullptr && s->is_norm) fit = std::abs(fit);
            const double error = std::abs(evaluator_.output(equations_->guards[g].output) - fit);
            if (error <= allowed_[g]) continue;
            const double infinity = std::numeric_limits<double>::infinity();
            worst.allowed = std::isnan(error) ? infinity : std::max(worst.allowed, error / allowed_[g]);
            worst.value = std::isnan(error) ? infinity : std::max(worst.value, error / largest_[g]);
        }
    }
    return worst;
}

}  // namespace rbdyn::inline RBDYN_FORM
