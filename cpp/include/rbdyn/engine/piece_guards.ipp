// Definitions of rbdyn/engine/piece_guards.hpp.
#pragma once

#include "rbdyn/engine/piece_guards.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <memory>
#include <span>
#include <vector>

#include "rbdyn/basics/instant.hpp"
#include "rbdyn/engine/far_norms.hpp"
#include "rbdyn/engine/guard_fit.hpp"
#include "rbdyn/expression/hidden_terms.hpp"
#include "rbdyn/expression/program.hpp"
#include "rbdyn/expression/series_evaluator.hpp"
#include "rbdyn/expression/term_sizes.hpp"
#include "rbdyn/model/equations.hpp"
#include "rbdyn/series/piece.hpp"
#include "rbdyn/series/step_length.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE PieceGuards::PieceGuards(const Equations& equations, SeriesEvaluator* series, int order, double tolerance)
    : equations_(&equations),
      series_(series),
      fit_(series == nullptr ? std::make_unique<GuardFit>(equations) : nullptr),
      hidden_(equations.program, order, outputs(equations)),
      far_(equations, series == nullptr ? std::vector<int>() : computed_guards(equations)),
      order_(series == nullptr ? GuardFit::order : order),
      tolerance_(tolerance),
      log_tolerance_(std::log2(tolerance)),
      need_more_(!computed_guards(equations).empty()) {}

RBDYN_INLINE std::vector<int> PieceGuards::computed_guards(const Equations& equations) {
    std::vector<int> guards;
    for (std::size_t g = 0; g < equations.guards.size(); ++g)
        if (is_computed(equations, equations.guards[g])) guards.push_back(static_cast<int>(g));
    return guards;
}

RBDYN_INLINE std::vector<int> PieceGuards::outputs(const Equations& equations) {
    std::vector<int> result = computed_guards(equations);
    for (int& guard : result) guard = equations.guards[static_cast<std::size_t>(guard)].output;
    return result;
}

RBDYN_INLINE void PieceGuards::set_parameters(std::span<const double> parameters, Program::Rounding rounding) {
    if (fit_) fit_->set_parameters(parameters, rounding);
}

RBDYN_INLINE void PieceGuards::enter(std::span<const double> parameters) {
    if (fit_) fit_->enter(parameters);
    goes_on_ = false;
}

RBDYN_INLINE double PieceGuards::begin(const Piece& piece, bool is_rest) {
    piece_ = piece;
    is_expanded_ = false;
    rough_.clear();
    if (!is_rest) {
        fits_left_ = most_fits;
        first_try_ = std::numeric_limits<double>::infinity();
        least_ = std::ldexp(piece.length, -most_halvings);
    }
    if (!need_more_) return piece.length;
    if (fit_) {
        if (goes_on_) fit_->go_on();
        goes_on_ = true;
        return fitted_length();
    }
    if (far_.look(piece, *series_)) return piece.length;
    expand();
    return std::min(piece.length, series_length());
}

RBDYN_INLINE const double* PieceGuards::coefficients(int guard) {
    const Guard& g = equations_->guards[static_cast<std::size_t>(guard)];
    if (equations_->is_variable(g)) {
        // the row of the piece, with zeros after it
        row_.fill(0.0);
        std::copy_n(piece_.variable(equations_->program.output(g.output)), piece_.order + 1, row_.data());
        return row_.data();
    }
    if (fit_) return fit_->coefficients(guard);
    if (!is_expanded_) expand();
    return series_->output(g.output);
}

RBDYN_INLINE void PieceGuards::sizes(int guard, double* s) {
    const Guard& g = equations_->guards[static_cast<std::size_t>(guard)];
    if (series_) {
        if (!is_expanded_) expand();
        const TermSizes::Sizes known = TermSizes(*series_, order_)(equations_->program.output(g.output));
        std::copy_n(known.begin(), order_ + 1, s);
        return;
    }
    const double* c = coefficients(guard);
    for (int k = 0; k <= order_; ++k) s[k] = std::abs(c[k]);
    fit_->widen_at_start(piece_, g.output, s);
}

RBDYN_INLINE void PieceGuards::expand() {
    series_->begin(piece_.start.hi, piece_.unit);
    for (int i = 0; i < piece_.variables; ++i)
        for (int k = 0; k <= order_; ++k) series_->set_input(i, k, k <= piece_.order ? piece_.variable(i)[k] : 0.0);
    for (int k = 0; k <= order_; ++k) series_->advance(k);
    is_expanded_ = true;
}

RBDYN_INLINE double PieceGuards::series_length() {
    double log_length = 0.0;
    for (std::size_t g = 0; g < equations_->guards.size(); ++g) {
        const Guard& guard = equations_->guards[g];
        if (!is_computed(*equations_, guard)) continue;
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
    return hidden_.held(*series_, std::exp2(log_length));
}

RBDYN_INLINE void PieceGuards::mark_rough(std::size_t guard) {
    rough_.resize(equations_->guards.size(), 0);
    rough_[guard] = 1;
}

RBDYN_INLINE double PieceGuards::fitted_length() {
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
            if (is_computed(*equations_, equations_->guards[g])) mark_rough(g);
    first_try_ = 2.0 * length;
    return length;
}

}  // namespace rbdyn::inline RBDYN_FORM
