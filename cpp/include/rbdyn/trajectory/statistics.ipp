// Definitions of rbdyn/trajectory/statistics.hpp.
#pragma once

#include "rbdyn/trajectory/statistics.hpp"

#include <ostream>

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE std::ostream& operator<<(std::ostream& out, const Statistics& s) {
    out << "seconds " << s.seconds << ", planning " << s.planning_seconds << ", integration " << s.integration_seconds
        << ", judging " << s.judging_seconds << ", steps " << s.steps << ", rejected " << s.rejected
        << ", right-hand sides " << s.right_hand_sides << ", Jacobians " << s.jacobians << ", guard evaluations "
        << s.guard_evaluations << ", events " << s.events << ", Python calls " << s.python_calls << ", runs " << s.runs
        << ", " << s.size << (s.planned ? "" : ", planned before");
    for (const EngineChange& change : s.changes) out << ", " << change.engine << " from t = " << change.time << " s";
    return out;
}

}  // namespace rbdyn::inline RBDYN_FORM
