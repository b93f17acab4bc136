// What rounding of speeds makes of accelerations where no force acts.
//
// Bodies that go on together have a relative speed of rounding, epsilon v, and on a surface of size r an acceleration
// toward each other of (epsilon v)^2 / r: all there is of it where nothing else pushes them, and none.
#pragma once

#include <limits>

#include "rbdyn/basics/form.hpp"

namespace rbdyn::inline RBDYN_FORM::mechanics {

/// Of speeds v at a surface of size r the acceleration [m/s^2] of which epsilon is (epsilon v)^2 / r.
inline double speed_rounding(double speed, double size) {
    return size > 0.0 ? std::numeric_limits<double>::epsilon() * speed * speed / size : 0.0;
}

}  // namespace rbdyn::inline RBDYN_FORM::mechanics
