// What a run cost.
#pragma once

#include <cstdint>
#include <ostream>
#include <vector>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/engine/work.hpp"
#include "rbdyn/model/size.hpp"

namespace rbdyn::inline RBDYN_FORM {

/// The price of a run.
struct Statistics {
    double seconds = 0.0;              // the whole call, by the clock
    double planning_seconds = 0.0;     // of it: reading the scene, or finding that its plan holds
    double integration_seconds = 0.0;  // of it: the returned motion alone
    double judging_seconds = 0.0;      // of it: all that tells the error, so the runs compared; 0 with rtol=
    std::int64_t steps = 0, rejected = 0, right_hand_sides = 0, jacobians = 0, guard_evaluations = 0, events = 0;
    std::int64_t python_calls = 0;
    int runs = 1;                            // integrations, those for the estimate counted
    Size size;                               // of the equations the motion began with; of several parts the sum
    bool planned = true;                     // anew, and not as an earlier run was
    std::vector<EngineChange> changes = {};  // of the engine, of itself, in the returned motion
};

std::ostream& operator<<(std::ostream& out, const Statistics& s);

}  // namespace rbdyn::inline RBDYN_FORM
