// Definitions of rbdyn/closed_form/closed_form.hpp.
#pragma once

#include "rbdyn/closed_form/closed_form.hpp"

#include <limits>
#include <optional>

#include "rbdyn/rotation/euler_turns.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE double ClosedForm::pace() const { return std::numeric_limits<double>::infinity(); }

RBDYN_INLINE std::optional<Recurrence> ClosedForm::recurrence(int /*body*/) const { return std::nullopt; }

}  // namespace rbdyn::inline RBDYN_FORM
