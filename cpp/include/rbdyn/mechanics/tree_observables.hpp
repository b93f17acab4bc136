// What a watched function may ask of a tree, in numbers.
#pragma once

#include <span>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/mechanics/exert.hpp"
#include "rbdyn/mechanics/tree_state.hpp"
#include "rbdyn/scene/watch.hpp"

namespace rbdyn::inline RBDYN_FORM {

namespace mechanics {

double observed(const TreeState& now, const Exerted& exerted, const Observable& o, double t, std::span<const double> x);

}  // namespace mechanics

}  // namespace rbdyn::inline RBDYN_FORM
