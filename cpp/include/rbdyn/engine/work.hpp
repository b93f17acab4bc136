// What an engine did.
#pragma once

#include <cstdint>

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
};

}  // namespace rbdyn::inline RBDYN_FORM
