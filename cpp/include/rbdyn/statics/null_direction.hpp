// What the forces of a scene do along a direction in which its stiffness says nothing.
//
// A step s along the direction, all stiff modes relaxed (the reduction of Lyapunov and Schmidt; Golubitsky and
// Schaeffer, "Singularities and Groups in Bifurcation Theory I", Springer 1985, ch. VII), leaves a force g(s) along it,
// the slope of U on the way. It is taken in 32 digits, and goes as s^m from the smallest steps on at which it is more
// than what doubles make of its terms: stable if m is odd and g against s, as for a path (path_zero.hpp). Other flat
// directions stay as they are: what goes down on one way is not stable, whatever others do; what goes up on all that
// are tried need not be. Along one alone that is asked with more care (multiple_rest.hpp), and this of whether it is
// indifferent.
#pragma once

#include <vector>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/statics/pinned_rest.hpp"
#include "rbdyn/statics/tree_forces.hpp"

namespace rbdyn::inline RBDYN_FORM::statics {

enum class AlongNull { indifferent, stable, unstable, not_decided };

/// `direction`: in terms of the modes.
AlongNull along_null(TreeForces& forces, const PinnedRest& rest, const std::vector<double>& direction);

/// In all modes together that are open.
AlongNull along_flat(TreeForces& forces, const PinnedRest& rest, const std::vector<bool>& open);

}  // namespace rbdyn::inline RBDYN_FORM::statics
