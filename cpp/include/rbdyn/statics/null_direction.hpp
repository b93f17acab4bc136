// What the forces of a scene do along the one direction in which its stiffness says nothing.
//
// A step s along the direction, all other freedoms relaxed by the stiffness at the zero (the reduction of Lyapunov and
// Schmidt; Golubitsky and Schaeffer, "Singularities and Groups in Bifurcation Theory I", Springer 1985, ch. VII),
// leaves a force g(s) along it. It goes as s^m from the smallest steps on at which it is more than rounding: stable if
// m is odd and g against s, as for a path (path_zero.hpp).
#pragma once

#include <vector>

#include "rbdyn/basics/dense.hpp"
#include "rbdyn/basics/form.hpp"
#include "rbdyn/statics/forces.hpp"

namespace rbdyn::inline RBDYN_FORM::statics {

enum class AlongNull { indifferent, stable, unstable, not_decided };

/// `e`: of the stiffness, metric one; `null`: the direction's index; `stiff`: which of the others there are.
AlongNull along_null(Forces& forces, const std::vector<double>& q, const SymmetricEigen& e, int null,
                     const std::vector<bool>& stiff);

}  // namespace rbdyn::inline RBDYN_FORM::statics
