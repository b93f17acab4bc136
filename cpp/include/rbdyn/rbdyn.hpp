// Everything of rbdyn in one include.
#pragma once

#include "rbdyn/basics/form.hpp"
#include "rbdyn/body/momentum.hpp"
#include "rbdyn/body/shapes.hpp"
#include "rbdyn/cost.hpp"
#include "rbdyn/effects.hpp"
#include "rbdyn/model/euler_top.hpp"
#include "rbdyn/simulate.hpp"
#include "rbdyn/statics/equilibria.hpp"

namespace rbdyn::inline RBDYN_FORM {

inline constexpr const char* version = "0.1.0";

}  // namespace rbdyn::inline RBDYN_FORM
