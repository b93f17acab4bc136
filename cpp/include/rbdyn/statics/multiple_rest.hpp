// A state of rest at which forces vanish to higher order along one direction: where it is, and what it does.
//
// Close to such a place second derivatives say anything: a place off by d across a bent valley y = b x^2 has a square
// of about 2 b d beside nothing. So modes count only where they are the same as far as the place is uncertain, by what
// is left of the forces and by what doubles make of their terms. If one is not, the force g(s) that its direction
// leaves (reduced_force.hpp) is asked: the zero is of order m at the root of the derivative of order m - 1, if all
// powers before are nothing there, to 32 digits; the highest such m. It is decided if from there g has the sign of that
// power on both sides as far as where it is more than what doubles make of its terms; or if m > 1 and it has not, if
// that is so of the highest power before which all are nothing in doubles.
#pragma once

#include <optional>
#include <vector>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/statics/null_direction.hpp"
#include "rbdyn/statics/pinned_rest.hpp"
#include "rbdyn/statics/tree_forces.hpp"

namespace rbdyn::inline RBDYN_FORM::statics {

/// The modes of which the second derivatives do not tell, flat ones among them; of a place that was not pinned down the
/// softest.
std::vector<bool> open_modes(TreeForces& forces, const PinnedRest& rest);

struct MultipleRest {
    TreeForces::Wide place;
    int order = 0;
    AlongNull along = AlongNull::not_decided;
};

/// Along one mode; none where no zero is found.
std::optional<MultipleRest> multiple_rest(TreeForces& forces, const PinnedRest& rest, int mode);

}  // namespace rbdyn::inline RBDYN_FORM::statics
