// The state of rest near a place.
//
// The zero of the generalized forces (forces.hpp) at rest, by Newton's method with their exact Jacobian, damped after
// Levenberg and Marquardt (Nocedal and Wright, "Numerical Optimization", 2nd ed., sec. 10.3) in the metric M of the
// kinetic energy; a freedom that no force depends on is left as it is. That finds states of rest of any kind; a search
// downhill comes before where a stable one is wanted. What a scene does about it: judged_rest.hpp.
#pragma once

#include <optional>
#include <vector>

#include "rbdyn/basics/dense.hpp"
#include "rbdyn/basics/form.hpp"
#include "rbdyn/statics/forces.hpp"
#include "rbdyn/statics/pinned_rest.hpp"
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

/// The small motions near q, the zero pinned down, if the forces have a potential.
std::optional<PinnedRest> pinned_if_even(TreeForces& forces, const std::vector<double>& q, const Stiffness& stiffness);

}  // namespace rbdyn::inline RBDYN_FORM::statics
