// Strikes of several contacts that follow each other so closely that their order is not known.
//
// Legs of a plate that comes down flat strike at one instant. Rounding of how it lies puts one before the other, and
// what comes of that is far from what comes of all at once; two runs may have the same order by chance, or by the same
// rounding. What is known of the time between two strikes is how far two runs are apart in it.
#pragma once

#include <optional>
#include <vector>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/event/event.hpp"
#include "rbdyn/event/record.hpp"
#include "rbdyn/model/hybrid.hpp"

namespace rbdyn::inline RBDYN_FORM {

/// A strike of a contact in two runs.
struct StrikeOfTwo {
    const Event *here, *there;

    static bool is_one(const Event& event) {
        return event.contact >= 0 && (event.kind == EventKind::impact || event.kind == EventKind::land);
    }
};

/// The time [s] of the first strike of a run from which on nothing is known, for another one follows or goes before it
/// by less than can be told, after a flight that is far longer, and either changes what the other finds; none if there
/// is none. `strikes`: of all the motion, nearly in order of time; `start`: of it; `wanted`: the error asked for.
std::optional<double> unknown_order(const HybridModel& model, const Record& run,
                                    const std::vector<StrikeOfTwo>& strikes, double start, double wanted);

}  // namespace rbdyn::inline RBDYN_FORM
