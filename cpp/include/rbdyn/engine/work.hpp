// What an engine did.
#pragma once

#include <cstdint>
#include <string>

#include "rbdyn/basics/form.hpp"

namespace rbdyn::inline RBDYN_FORM {

/// The work an engine has done.
struct Work {
    std::int64_t steps = 0;
    std::int64_t parts = 0;  // more than one of a step, handed out for its guards' sake
    std::int64_t rejected = 0;
    std::int64_t right_hand_sides = 0;  // for Taylor series: orders computed
    std::int64_t jacobians = 0;
    std::int64_t guard_evaluations = 0;

    Work& operator+=(const Work& more) {
        steps += more.steps;
        parts += more.parts;
        rejected += more.rejected;
        right_hand_sides += more.right_hand_sides;
        jacobians += more.jacobians;
        guard_evaluations += more.guard_evaluations;
        return *this;
    }
    Work& operator-=(const Work& less) {
        steps -= less.steps;
        parts -= less.parts;
        rejected -= less.rejected;
        right_hand_sides -= less.right_hand_sides;
        jacobians -= less.jacobians;
        guard_evaluations -= less.guard_evaluations;
        return *this;
    }
};

/// From a time on the steps were those of an engine.
struct EngineChange {
    double time = 0.0;  // s
    std::string engine;

    bool operator==(const EngineChange&) const = default;
};

}  // namespace rbdyn::inline RBDYN_FORM
