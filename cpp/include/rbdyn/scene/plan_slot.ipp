// Definitions of rbdyn/scene/plan_slot.hpp.
#pragma once

#include "rbdyn/scene/plan_slot.hpp"

#include <memory>
#include <mutex>
#include <utility>

#include "rbdyn/plan/kept_plan.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE std::shared_ptr<const KeptPlan> PlanSlot::get() const {
    const std::lock_guard lock(held_->mutex);
    return held_->plan;
}

RBDYN_INLINE void PlanSlot::set(std::shared_ptr<const KeptPlan> plan) const {
    const std::lock_guard lock(held_->mutex);
    held_->plan = std::move(plan);
}

}  // namespace rbdyn::inline RBDYN_FORM
