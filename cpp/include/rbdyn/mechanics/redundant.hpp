// Whether rows of constraints that are not used are redundant for good, and along which axes rows are told so that
// those that are used stay independent.
//
// Rows that depend on the others where a scene starts may do so only there: bars in one line, a rod across a rail. They
// are redundant for good if their gaps stay as they are along every motion that the used rows allow. Those allow a
// smooth surface of configurations, for they are independent; what vanishes at a place of it that is in no way special,
// at some distance, vanishes all over it.
#pragma once

#include <optional>
#include <vector>

#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/form.hpp"
#include "rbdyn/mechanics/constraint.hpp"
#include "rbdyn/mechanics/tree.hpp"

namespace rbdyn::inline RBDYN_FORM::mechanics {

/// How far each constraint is open [m], angles at the arm of the conditions.
std::vector<double> open_by(const Tree& tree, const Conditions& conditions, const std::vector<Moving<double>>& all);
/// How fast each constraint opens [m/s], angles as above.
std::vector<double> opening_rates(const Tree& tree, const Conditions& conditions,
                                  const std::vector<Moving<double>>& all);

/// How fast anything moves at most [m/s], what turns with the size of the scene [m] for an arm.
double fastest(const std::vector<Moving<double>>& all, double size);

/// A constraint with rows that are not used though motion opens them.
struct Opening {
    int constraint;
    double gap, moved;  // how far it opens, and how far the bodies have moved for that [m]
};

/// The constraint that opens first, if any does by more than `tolerance`; `rows`: those used, at x, closed. `size`: of
/// the scene [m].
[[gnu::cold]] std::optional<Opening> opening(const Tree& tree, const Conditions& conditions,
                                             const std::vector<int>& rows, double t, const std::vector<DoubleDouble>& x,
                                             double size, double tolerance);

/// What the rows that are used leave no motion, here and where else they can be followed to: of each velocity of a
/// joint, then of each body whether it turns in the world, then whether its centre of mass moves.
[[gnu::cold]] std::vector<bool> held_still(const Tree& tree, const Conditions& conditions, const std::vector<int>& rows,
                                           double t, const std::vector<DoubleDouble>& x, double size, double tolerance);

/// The same conditions with the points of those of which some rows depend on others told in axes in which what depends
/// on what stays the same when the scene moves, if there are such: where all of them have a direction that nothing
/// holds, as across the plane of a linkage however it is turned, along it, where a row is none by itself; else the
/// world's, those of b, those of a; else those in which it changes least. Two ball joints of a lid depend on each other
/// along its axis, which turns with what carries it. `rows`: those used, at x, closed; `size`: of the scene [m].
[[gnu::cold]] Conditions steadiest(const Tree& tree, const Conditions& conditions, const std::vector<int>& rows,
                                   double t, const std::vector<DoubleDouble>& x, double size, double tolerance);

}  // namespace rbdyn::inline RBDYN_FORM::mechanics
