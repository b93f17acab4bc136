// Definitions of rbdyn/curve/line.hpp.
#pragma once

#include "rbdyn/curve/line.hpp"

#include "rbdyn/curve/checks.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE void Line::validate() const {
    curves::require_direction("line", "direction", direction);
    curves::require_finite("line", "point", point);
}

}  // namespace rbdyn::inline RBDYN_FORM
