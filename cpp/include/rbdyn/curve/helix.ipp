// Definitions of rbdyn/curve/helix.hpp.
#pragma once

#include "rbdyn/curve/helix.hpp"

#include "rbdyn/basics/error.hpp"
#include "rbdyn/curve/checks.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE void Helix::validate() const {
    curves::require_positive("helix", "radius", radius, "m");
    curves::require_finite("helix", "pitch", pitch);
    require(pitch != 0.0, "helix", "pitch", pitch, "it must not be zero: use Circle for a curve that stays level");
    curves::require_plane("helix", start, toward);
    curves::require_finite("helix", "center", center);
}

}  // namespace rbdyn::inline RBDYN_FORM
