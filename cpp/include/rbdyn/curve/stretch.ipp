// Definitions of rbdyn/curve/stretch.hpp.
#pragma once

#include "rbdyn/curve/stretch.hpp"

namespace rbdyn::inline RBDYN_FORM::curves {

RBDYN_INLINE long stretch(long double u, long lowest, long highest) {
    return stretch(static_cast<double>(u), lowest, highest);
}

}  // namespace rbdyn::inline RBDYN_FORM::curves
