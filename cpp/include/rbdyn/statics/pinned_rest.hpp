// A zero of the generalized forces to 32 digits, and the small motions about it.
//
// Newton's method in the modes of M and K: the force f along a mode of square l leaves the step f/l. Where f goes as
// y^p with the distance y from its zero, p > 1, one such step is y/p and leaves f (1 - 1/p)^p, which tells p; p steps
// are then taken at once (E. Schroeder, Math. Ann. 2, 1870), and the mode has no stiffness at the zero: such modes are
// flat, as those are whose square is within its own rounding.
#pragma once

#include <vector>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/statics/normal_modes.hpp"
#include "rbdyn/statics/tree_forces.hpp"

namespace rbdyn::inline RBDYN_FORM::statics {

/// What a scene says of a place of rest, the one that it was asked for last.
SmallMotion small_motion(const TreeForces& forces);

struct PinnedRest {
    bool is_found = false;  // the steps came to an end
    TreeForces::Wide place;
    SmallModes modes;
    std::vector<bool> flat;
};

/// Whether the forces at a place are rounding, in doubles, of what they are sums of and of the place itself.
bool is_zero(TreeForces& forces, const TreeForces::Wide& place);

/// Steps to a zero of all coordinates leave some of them beside nothing: those that may as well be zero are.
TreeForces::Wide without_dust(TreeForces& forces, const SmallModes& modes, TreeForces::Wide place);

/// From a place near the zero. Throws InvalidInput where the forces have no potential.
PinnedRest pinned(TreeForces& forces, const std::vector<double>& q);

}  // namespace rbdyn::inline RBDYN_FORM::statics
