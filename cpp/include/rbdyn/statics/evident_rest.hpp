// What shows that forces vanish at a place, where they are small there.
//
// A force that dies away, as exp(-x) does, is rounding of the others far out and vanishes nowhere; one that is small
// beside another that was met on the way may be of any size. Mode by mode, with the force along it: Newton's step ends
// within the rounding of the place; or as far as that the force changes its sign, or grows to both sides, as at a zero
// of higher order; or secants come to a zero that is a few of their first steps away, as in a bent valley; or the force
// is rounding of its terms and becomes clear on both sides, or on none as far as the scene is large. Where it becomes
// clear on one side alone, nothing shows a zero; nor where that rounding is as large as all forces where the search
// began.
#pragma once

#include <vector>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/statics/tree_forces.hpp"

namespace rbdyn::inline RBDYN_FORM::statics {

/// Where a search began, and the sizes of all forces there.
struct Beginning {
    std::vector<double> place, effort;
};

/// `s`: what the place says, at_rest(q).
bool is_evident(TreeForces& forces, const std::vector<double>& q, const Forces::State& s, const Beginning& beginning);

}  // namespace rbdyn::inline RBDYN_FORM::statics
