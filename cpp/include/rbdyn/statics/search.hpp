// The state of rest near a place, and what a scene does about it.
//
// The zero of the generalized forces (forces.hpp) at rest, by Newton's method with their exact Jacobian, damped after
// Levenberg and Marquardt (Nocedal and Wright, "Numerical Optimization", 2nd ed., sec. 10.3) in the metric M of the
// kinetic energy; a freedom that no force depends on is left as it is. That finds states of rest of any kind; a search
// downhill comes before where a stable one is wanted. Where the forces have a potential the zero is then pinned down
// in 32 digits (pinned_rest.hpp): stable if no mode's square is negative and none is open, and what open ones do is
// looked at further (multiple_rest.hpp, null_direction.hpp). Else stable if the symmetric part of the stiffness -dQ/dq
// is positive definite.
//
// A body that may be turned about an axis so that all stay at rest, a heavy one on a ball joint about the vertical, is
// in a family of such states: that turn is found as a null direction of the stiffness, proved by turning the body, and
// left aside when stability is judged.
#pragma once

#include <optional>
#include <vector>

#include "rbdyn/basics/dense.hpp"
#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/statics/equilibrium.hpp"
#include "rbdyn/statics/forces.hpp"
#include "rbdyn/statics/tree_forces.hpp"

namespace rbdyn::inline RBDYN_FORM::statics {

/// -(J^T M^-1 J + damping M)^-1 J^T M^-1 Q, damping in units of the largest eigenvalue.
std::vector<double> newton_step(const Forces::State& s, double damping);

/// -dQ/dq at a place in units in which the metric is one: its symmetric part, and how far it is from that.
struct Stiffness {
    SquareMatrix symmetric;
    double twist = 0.0, rounding = 0.0;

    explicit Stiffness(const Forces::State& s);
};

/// Downhill from q, in place, as a slow and damped motion goes: steps (|K| + damping)^-1 Q with the absolute values of
/// the eigenvalues of the stiffness K, taken if the forces do work on the way. Whether that came to an end.
bool settle(TreeForces& forces, std::vector<double>& q);

/// The zero of the forces near q, in place; whether there is one.
bool relax(TreeForces& forces, std::vector<double>& q);

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
