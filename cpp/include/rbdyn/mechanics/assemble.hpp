// A start that satisfies the constraints of a scene, from rough guesses: Newton's method on the coordinates, then one
// linear system for their rates, each with the smallest change there is.
#pragma once

#include <vector>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/mechanics/constraint.hpp"
#include "rbdyn/mechanics/moving.hpp"
#include "rbdyn/mechanics/tree.hpp"
#include "rbdyn/scene/scene.hpp"

namespace rbdyn::inline RBDYN_FORM {

namespace mechanics {

/// How the rates of rows follow from the velocities of joints, row by row.
std::vector<std::vector<double>> jacobian(const Tree& tree, const std::vector<Row<double>>& rows,
                                          const std::vector<Moving<double>>& all);

/// The smallest x with m x = b, as far as there is one: rows may depend on each other.
std::vector<double> smallest_solution(const std::vector<std::vector<double>>& m, const std::vector<double>& b);

}  // namespace mechanics

}  // namespace rbdyn::inline RBDYN_FORM
