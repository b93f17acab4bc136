// Definitions of rbdyn/closed_form/phase.hpp.
#pragma once

#include "rbdyn/closed_form/phase.hpp"

#include <cmath>

#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/double_double_functions.hpp"
#include "rbdyn/basics/instant.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE Phase::Phase(const DoubleDouble& rate, const DoubleDouble& start, const DoubleDouble& step)
    : rate_(rate), start_(start), step_(step), per_step_(1.0 / step.hi) {}

RBDYN_INLINE Phase::Reduced Phase::at(Instant t, const DoubleDouble& more) const {
    const DoubleDouble x = rate_ * DoubleDouble(t) + start_ + more;
    const double steps = std::nearbyint(x.hi * per_step_);
    if (steps == 0.0) return {x, 0.0};
    const Reduced once{x - step_ * steps, steps};
    // of more than 2^52 steps their number is rounded, too
    const double more_steps = std::abs(steps) < 0x1p52 ? 0.0 : std::nearbyint(once.rest.hi * per_step_);
    if (more_steps == 0.0) return once;
    return {once.rest - step_ * more_steps, once.steps + more_steps};
}

}  // namespace rbdyn::inline RBDYN_FORM
