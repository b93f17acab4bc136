// The equilibria of a scene: all of them where one body alone moves and has one coordinate, those of a body on a ball
// joint, and for more freedoms one (search.hpp). On rough rails that is one of the states of rest, and the others about
// it are not given.
#pragma once

#include <vector>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/scene/scene.hpp"
#include "rbdyn/statics/equilibrium.hpp"

namespace rbdyn::inline RBDYN_FORM {

/// The states of rest of a scene, velocities zero (eqs. 7.16, 7.60).
///
/// One bead on a rail, one rigid body on a hinge or a slide, with all that is fixed to it: all there are, in order of
/// the coordinate (path_equilibria.hpp); `near`, its coordinate, says where a path without ends is searched, the body's
/// start otherwise. One body on a ball joint: those found from `near`, or from its start, and from attitudes spread
/// over all, stable ones first. More freedoms: at most one, that in which a slow and damped motion from the start of
/// the scene ends, or where that leads to none, one near it; given `near`, the nearest of those, stable or not, that
/// searches from there and from places about it lead to (nearest_rest.hpp). So with bodies joined to bodies and
/// constraints, which hold there. An empty list: none was found. Coordinates are those of Equilibrium, all in order of
/// addition. Throws InvalidInput for a scene without bodies or with contacts, with forces or torques that depend on
/// time or are called back, or with rails or joints that are driven.
std::vector<Equilibrium> equilibria(const Scene& scene, const std::vector<double>& near = {});

}  // namespace rbdyn::inline RBDYN_FORM
