// Where a scene keeps the plans that were made of it, for the runs to come.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <vector>

#include "rbdyn/basics/form.hpp"

namespace rbdyn::inline RBDYN_FORM {

struct KeptPlan;  // plan/kept_plan.hpp

/// Holds the last few plans. Copies share them, until one of them forgets them; copies that start elsewhere do, too. No
/// part of what a scene is: any two are equal.
class PlanSlot {
public:
    /// A plan, and whether it was made for another start.
    struct Other {
        std::shared_ptr<const KeptPlan> plan;
        bool is_of_another_start;
    };

    PlanSlot() = default;
    // a move copies: what was moved from can be given bodies anew
    PlanSlot(const PlanSlot&) = default;
    PlanSlot& operator=(const PlanSlot&) = default;

    /// The last that was made for this start, if any.
    std::shared_ptr<const KeptPlan> get() const;
    /// All but that one, the last first.
    std::vector<Other> others() const;
    /// Keeps a plan for this start.
    void set(std::shared_ptr<const KeptPlan> plan) const;
    /// Leaves all to the copies.
    void forget();
    /// From here on it is of the same scene with another start.
    void start_elsewhere();

    bool operator==(const PlanSlot&) const { return true; }

private:
    // a sweep meets a few: starts at rest among others, numbers that change their sign
    static constexpr std::size_t most = 4;

    struct Entry {
        std::uint64_t start;
        std::shared_ptr<const KeptPlan> plan;
    };
    struct Held {
        std::mutex mutex;
        std::vector<Entry> plans;  // the last first
    };
    std::shared_ptr<Held> held_ = std::make_shared<Held>();
    std::uint64_t start_ = 0;  // starts have numbers of their own
};

}  // namespace rbdyn::inline RBDYN_FORM
