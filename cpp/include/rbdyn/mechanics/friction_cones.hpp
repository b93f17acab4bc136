// Contacts with Coulomb's friction that push, hold, slide or open, together.
//
// Unknown are forces (or impulses) z of each contact, what follows is linear in them, w = A z + b: accelerations (or
// velocities) along the normal and two directions across it. Of each contact (J. J. Moreau, Unilateral contact and dry
// friction in finite freedom dynamics, 1988):
//     open     N = 0, w_n >= 0
//     held     w = 0, |T| <= mu N
//     slides   w_n = 0, T = -mu N w_t / |w_t|
// A contact that slides already has one unknown, N, in a direction that is not that of its row, n - mu d.
#pragma once

#include <cstddef>
#include <vector>

#include "rbdyn/basics/form.hpp"

namespace rbdyn::inline RBDYN_FORM {

namespace mechanics {

using Square = std::vector<std::vector<double>>;

/// One contact among the unknowns.
struct Cone {
    int first = 0;         // of its unknowns: normal, and two across it; or the normal alone
    bool is_line = false;  // smooth, or sliding in a known direction
    double mu = 0.0;
    double widest = 0x1p46;  // with what it slides where mu is infinite
};

enum class ConeState { open, held, slides };

struct ConeForces {
    std::vector<double> force, rate;  // z, w
    std::vector<ConeState> states;    // of each contact
    bool is_solved = true;            // no: none was found
};

/// `noise`: of b, the sizes of its rounding.
ConeForces solve_cones(const Square& a, const std::vector<double>& b, const std::vector<double>& noise,
                       const std::vector<Cone>& cones);

/// The same, where cones may be all of a half space: if what these hold would have to be pulled, the limit of ever
/// wider ones, in which it slides.
ConeForces solve_any_cones(const Square& a, const std::vector<double>& b, const std::vector<double>& noise,
                           std::vector<Cone> cones);

/// Forces that hold all contacts at rest while those that slide do; not solved if there are none, whatever their cones.
ConeForces held_by(const Square& a, const std::vector<double>& b, const std::vector<double>& noise,
                   const std::vector<Cone>& cones);

/// Whether all forces are in their cones, edges included.
bool are_inside(const std::vector<double>& force, const std::vector<Cone>& cones);

/// Of forces z = z0 + sum of c_i directions_i those well inside of all cones and small: c. Empty if there are none
/// inside, and `nearest` is then where least is lacking. `size`: how large forces are here.
std::vector<double> forces_inside(const std::vector<double>& z0, const Square& directions,
                                  const std::vector<Cone>& cones, double size, std::vector<double>* nearest = nullptr);

/// x of A x = b, zero along what A leaves free: where pivots are that part of the largest at most.
std::vector<double> solve_any(const Square& a, const std::vector<double>& b, double nothing = 1e-12);

}  // namespace mechanics

}  // namespace rbdyn::inline RBDYN_FORM
