// How far the forces about a place go as their slopes say: the length that a potential has of its own.
//
// f(z + s d) is f(z) + s J d up to a bend, the smallest s at which what is left over is half as much as the stiffest
// freedom would leave, s |J| |d|, in the metric of the kinetic energy. Forces that are linear have none.
#pragma once

#include <vector>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/statics/tree_forces.hpp"

namespace rbdyn::inline RBDYN_FORM::statics {

/// The bend from a place along a direction in the freedoms; infinity where there is none, or no slope at the place. The
/// place becomes the one that `forces` looks at.
double bend(TreeForces& forces, const TreeForces::Wide& place, const std::vector<double>& direction);

/// The least by which a body moves up to the bend of a freedom that moves it and turns none [m]; infinity where there
/// is no such bend.
double natural_length(TreeForces& forces, const TreeForces::Wide& place);

/// How far a direction is to be followed from a place: until a body turns by half a radian, or an eighth of the way to
/// the bend, if there is one, or by half of the scene's size, or half of `least` units of the direction. Infinity if
/// nothing moves.
double reach_along(TreeForces& forces, const TreeForces::Wide& place, const std::vector<double>& direction,
                   double least = 0.0);

}  // namespace rbdyn::inline RBDYN_FORM::statics
