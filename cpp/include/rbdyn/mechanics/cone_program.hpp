// Coulomb's cones by convex programs.
//
// With A symmetric and without negative directions, contacts that obey
//     u = A z + b,   z in its cone N >= |T|,   u + |u_t| e_n in the same cone,   both at right angles
// (T over mu and u_t times mu, so that all cones are alike) are where z.A z/2 + (b + s e_n).z is least in all cones
// and s = |u_t|: G. De Saxce and Z.-Q. Feng, The bipotential method, 1998; F. Cadoux, Analyse convexe et optimisation
// pour la dynamique non-reguliere, 2009. Each program has one u, whatever order its contacts are written in; s is
// found by putting |u_t| in its place. What is found so is made exact by Newton's method, once it is known what each
// contact does.
#pragma once

#include <optional>
#include <vector>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/mechanics/friction_cones.hpp"

namespace rbdyn::inline RBDYN_FORM::mechanics {

/// solve_cones() where A is symmetric. None if there is no solution, or none was found.
std::optional<ConeForces> solve_convex(const Square& a, const std::vector<double>& b, const std::vector<double>& noise,
                                       const std::vector<Cone>& cones);

/// The solution near one that is not exact, A of any kind; what its contacts do may change by a few of them. None if
/// there is none.
std::optional<ConeForces> made_exact(const Square& a, const std::vector<double>& b, const std::vector<double>& noise,
                                     const std::vector<Cone>& cones, const ConeForces& near);

}  // namespace rbdyn::inline RBDYN_FORM::mechanics
