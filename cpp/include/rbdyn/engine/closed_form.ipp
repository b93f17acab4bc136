// Definitions of rbdyn/engine/closed_form.hpp.
#pragma once

#include "rbdyn/engine/closed_form.hpp"

#include <memory>
#include <span>
#include <string>
#include <utility>

#include "rbdyn/basics/double_double_functions.hpp"
#include "rbdyn/basics/instant.hpp"
#include "rbdyn/closed_form/closed_form.hpp"
#include "rbdyn/engine/engine.hpp"
#include "rbdyn/engine/taylor.hpp"
#include "rbdyn/series/piece.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE ClosedFormEngine::ClosedFormEngine(std::shared_ptr<const ClosedForm> form, Instant start, double tolerance,
                                                int order)
    : TaylorEngine(tolerance, order), form_(std::move(form)), start_(start) {}

RBDYN_INLINE std::string ClosedFormEngine::name() const { return "closed form"; }

RBDYN_INLINE StepStatus ClosedFormEngine::step(double limit) {
    const StepStatus status = TaylorEngine::step(limit);
    if (status == StepStatus::ok) form_->state(exact_difference(t_, start_), replace_state());
    return status;
}

RBDYN_INLINE void ClosedFormEngine::state(double tau, std::span<double> x) const {
    form_->state(exact_difference(piece_.at(tau), start_), x);
}

RBDYN_INLINE void ClosedFormEngine::rest(double tau, std::span<const double> x, std::span<double> low) const {
    Engine::rest(tau, x, low);
}

RBDYN_INLINE bool ClosedFormEngine::refines() const { return true; }

}  // namespace rbdyn::inline RBDYN_FORM
