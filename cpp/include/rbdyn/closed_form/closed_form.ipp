// Definitions of rbdyn/closed_form/closed_form.hpp.
#pragma once

#include "rbdyn/closed_form/closed_form.hpp"

#include <limits>
#include <memory>
#include <optional>

#include "rbdyn/rotation/euler_turns.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE double ClosedForm::pace() const { return std::numeric_limits<double>::infinity(); }

RBDYN_INLINE std::optional<Recurrence> ClosedForm::recurrence(int /*body*/) const { return std::nullopt; }

RBDYN_INLINE std::shared_ptr<const ClosedForm> ClosedForm::begun(double /*time*/) const { return nullptr; }

RBDYN_INLINE std::shared_ptr<const ClosedForm> begun(const std::shared_ptr<const ClosedForm>& form, double time) {
    std::shared_ptr<const ClosedForm> other = form ? form->begun(time) : nullptr;
    return other ? other : form;
}

}  // namespace rbdyn::inline RBDYN_FORM
