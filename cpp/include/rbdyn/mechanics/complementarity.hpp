// Linear complementarity: z >= 0, w = A z + b >= 0, one of each pair zero.
//
// A is symmetric and has no negative directions, so this is where z.A z/2 + b.z is least: solved by active sets
// (C. L. Lawson and R. J. Hanson, Solving Least Squares Problems, 1974, chapter 23), for a handful of unknowns. Where A
// has directions of none, as for a table on four legs, w is the only one there is, z is one of many.
#pragma once

#include <vector>

#include "rbdyn/basics/form.hpp"

namespace rbdyn::inline RBDYN_FORM {

namespace mechanics {

struct Complementary {
    std::vector<double> z, w;
};

/// `noise`: sizes of the rounding in b.
Complementary solve_complementary(const std::vector<std::vector<double>>& a, const std::vector<double>& b,
                                  const std::vector<double>& noise);

/// The same. Where z is one of many, the least of them among what is zero in w, if that is positive: what comes alike
/// bears alike.
Complementary solve_evenly(const std::vector<std::vector<double>>& a, const std::vector<double>& b,
                           const std::vector<double>& noise);

}  // namespace mechanics

}  // namespace rbdyn::inline RBDYN_FORM
