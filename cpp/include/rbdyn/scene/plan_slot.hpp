// Where a scene keeps the plan that was made of it, for the runs to come.
#pragma once

#include <memory>
#include <mutex>

#include "rbdyn/basics/form.hpp"

namespace rbdyn::inline RBDYN_FORM {

struct KeptPlan;  // plan/kept_plan.hpp

/// Holds a plan, or none. Copies share it, until one of them forgets it. No part of what a scene is: any two are equal.
class PlanSlot {
public:
    std::shared_ptr<const KeptPlan> get() const;
    void set(std::shared_ptr<const KeptPlan> plan) const;
    /// Leaves it to the copies.
    void forget() { held_ = std::make_shared<Held>(); }

    bool operator==(const PlanSlot&) const { return true; }

private:
    struct Held {
        std::mutex mutex;
        std::shared_ptr<const KeptPlan> plan;
    };
    std::shared_ptr<Held> held_ = std::make_shared<Held>();
};

}  // namespace rbdyn::inline RBDYN_FORM
