// Forces of contacts that are one choice of many, and whether the motion is the same with all of them; and what else
// contacts may do.
#pragma once

#include <vector>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/mechanics/friction_cones.hpp"

namespace rbdyn::inline RBDYN_FORM {

namespace mechanics {

/// A change of forces that are one choice of many, of the size of the largest of them, and how much of the rates after
/// it is rounding.
struct OtherForces {
    std::vector<double> change;
    double rounding = 0.0;

    /// Whether rates, of the size of `fastest`, are others with it.
    bool makes_difference(const Square& a, double fastest) const;
    /// Whether normal forces are others. Where they stay what they are friction does, or does no work, for it is
    /// monotone, and the motion is the same.
    bool changes_normals(const std::vector<Cone>& cones) const;
};

/// Changes of the forces found with which each contact goes on with what it does, to first order: a basis of those of
/// what pushes, then with each contact besides that touches and does not push yet.
std::vector<OtherForces> other_forces(const Square& a, const std::vector<double>& noise, const std::vector<Cone>& cones,
                                      const ConeForces& found);

/// Of contacts whose friction has one line each, as of what moves in a plane: all forces with which each of them is
/// open, is held, or slides one way or the other, that satisfy its laws. None are looked for where a contact has
/// friction along a surface, or without bound, where there are more than four, and where one alone has one answer.
std::vector<ConeForces> every_choice(const Square& a, const std::vector<double>& b, const std::vector<Cone>& cones);

}  // namespace mechanics

}  // namespace rbdyn::inline RBDYN_FORM
