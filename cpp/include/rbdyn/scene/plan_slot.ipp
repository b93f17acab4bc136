// Definitions of rbdyn/scene/plan_slot.hpp.
#pragma once

#include "rbdyn/scene/plan_slot.hpp"

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <iterator>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

#include "rbdyn/plan/kept_plan.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE std::shared_ptr<const KeptPlan> PlanSlot::get() const {
    const std::lock_guard lock(held_->mutex);
    for (const Entry& e : held_->plans)
        if (e.start == start_) return e.plan;
    return nullptr;
}

RBDYN_INLINE std::vector<PlanSlot::Other> PlanSlot::others() const {
    const std::lock_guard lock(held_->mutex);
    std::vector<Other> result;
    bool is_first = true;
    for (const Entry& e : held_->plans) {
        const bool is_mine = e.start == start_;
        if (!is_mine || !is_first) result.push_back({e.plan, !is_mine});
        is_first = is_first && !is_mine;
    }
    return result;
}

RBDYN_INLINE void PlanSlot::set(std::shared_ptr<const KeptPlan> plan) const {
    const std::lock_guard lock(held_->mutex);
    std::vector<Entry>& plans = held_->plans;
    plans.insert(plans.begin(), {start_, std::move(plan)});
    if (plans.size() <= most) return;
    // the scene as it was built keeps its own
    const auto oldest = std::find_if(plans.rbegin(), plans.rend() - 1, [](const Entry& e) { return e.start != 0; });
    plans.erase(oldest == plans.rend() - 1 ? plans.end() - 1 : std::prev(oldest.base()));
}

RBDYN_INLINE void PlanSlot::forget() {
    held_ = std::make_shared<Held>();
    start_ = 0;
}

RBDYN_INLINE void PlanSlot::start_elsewhere() {
    static std::atomic<std::uint64_t> last{0};
    start_ = ++last;
}

}  // namespace rbdyn::inline RBDYN_FORM
