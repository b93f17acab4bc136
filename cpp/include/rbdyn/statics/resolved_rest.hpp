// Whether doubles tell the places about a zero of the forces apart, so that it is one.
//
// Forces are zero to rounding where they are rounding of their own terms, or where the place's own rounding makes them
// up; nowhere else, however small they are beside those on the way there. Of places far beyond the lengths in which
// forces change, that rounding takes everything along: a valley y = x^2 at y = 1e36 is narrower than the last digit of
// y, and any force there passes for none. So a zero up to the rounding of its place counts only where forces go as
// their slopes say as far as that; or where Newton's method in 32 digits leads to a zero from there at once, as to one
// that is flat all around. Beyond 1e15 lengths of the scene only forces that hold all freedoms and are linear, as far
// as rounding of the place, have a zero.
#pragma once

#include <vector>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/statics/tree_forces.hpp"

namespace rbdyn::inline RBDYN_FORM::statics {

/// `s`: what the place says, at_rest(q).
bool is_resolved(TreeForces& forces, const std::vector<double>& q, const Forces::State& s);

}  // namespace rbdyn::inline RBDYN_FORM::statics
