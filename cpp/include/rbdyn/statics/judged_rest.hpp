// What a scene does about a state of rest.
//
// Where the forces have a potential the zero is pinned down in 32 digits (pinned_rest.hpp): stable if no mode's square
// is negative and none is open, and what open ones do is looked at further (multiple_rest.hpp, null_direction.hpp).
// Else stable if the symmetric part of the stiffness -dQ/dq is positive definite.
//
// A body that may be turned about an axis so that all stay at rest, a heavy one on a ball joint about the vertical, is
// in a family of such states: that turn is found as a null direction of the stiffness, proved by turning the body, and
// left aside when stability is judged.
#pragma once

#include <optional>
#include <vector>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/statics/equilibrium.hpp"
#include "rbdyn/statics/forces.hpp"
#include "rbdyn/statics/search.hpp"
#include "rbdyn/statics/tree_forces.hpp"

namespace rbdyn::inline RBDYN_FORM::statics {

/// A turn of one body about an axis of the world through a point.
struct FreeTurn {
    Vector3 axis, point = Vector3::Zero();
};

/// The axis about which a body that turns freely may be turned from a zero of the forces and leave them
/// zero, if there is one and no more.
std::optional<FreeTurn> free_turn(Forces& forces, const std::vector<double>& q, const Forces::State& s,
                                  const Stiffness& stiffness, int body);

/// What a scene does about a zero of its forces, and whether its stiffness says so of all freedoms but free turns.
/// Of a family the member is taken that is reached from `start` by the least turn.
struct Judgement {
    Equilibrium equilibrium;
    std::vector<double> place;
    bool is_decided = false;
};
Judgement judged(TreeForces& forces, std::vector<double> q, const std::vector<double>& start);

}  // namespace rbdyn::inline RBDYN_FORM::statics
