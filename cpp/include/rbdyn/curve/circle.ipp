// Definitions of rbdyn/curve/circle.hpp.
#pragma once

#include "rbdyn/curve/circle.hpp"

#include "rbdyn/curve/checks.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE void Circle::validate() const {
    curves::require_positive("circle", "radius", radius, "m");
    curves::require_plane("circle", start, toward);
    curves::require_finite("circle", "center", center);
}

}  // namespace rbdyn::inline RBDYN_FORM
