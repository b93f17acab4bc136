// Where constraints lose rank near a state, and what rounding of the numbers they are made of leaves open there.
//
// With gaps F(q, t) such a place is a critical one: l . F' = 0 for some l that is not zero, t among the variables. What
// is open there, l . F, is zero for a linkage with two branches that cross, as a parallelogram laid flat. Numbers that
// are rounded, among them the coordinates of its pivots, leave 1e-16 of the largest of them: the two branches then miss
// each other by the root of that, 1e-8 rad, and a motion on one of them turns into the other. So bars alike but for
// rounding are followed, near such a place, with gaps held as they are there: along the level set of F through it, of
// which the branches cross.
#pragma once

#include <optional>
#include <vector>

#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/form.hpp"
#include "rbdyn/mechanics/constraint.hpp"
#include "rbdyn/mechanics/tree.hpp"

namespace rbdyn::inline RBDYN_FORM::mechanics {

/// A place where constraints lose rank.
struct Critical {
    std::vector<double> open;  // of each row of constraints what no motion closes there
    double most;               // the largest of them, in parts of what they are differences of
};

/// The one near a state, found from there by Newton's method; none if there is none within about half a radian. `rank`:
/// how many rows are independent elsewhere.
[[gnu::cold]] std::optional<Critical> critical_near(const Tree& tree, const Conditions& conditions, std::size_t rank,
                                                    double t, std::vector<DoubleDouble> x);

namespace critical {

/// What passes for the rounding of coordinates: the sum of a few.
inline constexpr double rounding = 8.0 * 0x1p-52;

}  // namespace critical

}  // namespace rbdyn::inline RBDYN_FORM::mechanics
