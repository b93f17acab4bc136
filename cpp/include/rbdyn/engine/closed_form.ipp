// Definitions of rbdyn/engine/closed_form.hpp.
#pragma once

#include "rbdyn/engine/closed_form.hpp"

#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "rbdyn/basics/double_double_functions.hpp"
#include "rbdyn/basics/instant.hpp"
#include "rbdyn/closed_form/closed_form.hpp"
#include "rbdyn/engine/engine.hpp"
#include "rbdyn/engine/taylor.hpp"
#include "rbdyn/model/equations.hpp"
#include "rbdyn/series/piece.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE ClosedFormEngine::ClosedFormEngine(std::shared_ptr<const ClosedForm> form, Instant start, double tolerance,
                                                int order)
    : TaylorEngine(tolerance, order), form_(std::move(form)), start_(start) {}

RBDYN_INLINE ClosedFormEngine::ClosedFormEngine(std::shared_ptr<const FormsByMode> forms, double tolerance, int order)
    : TaylorEngine(tolerance, order), by_mode_(std::move(forms)) {}

RBDYN_INLINE std::string ClosedFormEngine::name() const { return "closed form"; }

RBDYN_INLINE void ClosedFormEngine::start(const Equations& equations, std::span<const double> parameters, Instant t,
                                          std::span<const double> x) {
    TaylorEngine::start(equations, parameters, t, x);
    if (!by_mode_) return;
    form_ = nullptr;
    // what the state is short of is told later
    mode_ = &equations;
    start_ = t;
}

RBDYN_INLINE StepStatus ClosedFormEngine::step(double limit) {
    if (mode_ != nullptr) {
        std::vector<double> x(low().size()), rest(x.size());
        TaylorEngine::standing(x, rest);
        form_ = by_mode_->in_mode(*std::exchange(mode_, nullptr), parameters(), start_, x, rest);
        so_far_.push_back({form_, start_});
    }
    const StepStatus status = TaylorEngine::step(limit);
    if (status == StepStatus::ok && form_) form_->state(exact_difference(t_, start_), replace_state());
    return status;
}

RBDYN_INLINE void ClosedFormEngine::state(double tau, std::span<double> x) const {
    if (!form_) return TaylorEngine::state(tau, x);
    form_->state(exact_difference(piece_.at(tau), start_), x);
}

RBDYN_INLINE void ClosedFormEngine::rest(double tau, std::span<const double> x, std::span<double> low) const {
    if (!form_) return TaylorEngine::rest(tau, x, low);
    Engine::rest(tau, x, low);
}

RBDYN_INLINE bool ClosedFormEngine::refines() const { return form_ != nullptr; }

}  // namespace rbdyn::inline RBDYN_FORM
