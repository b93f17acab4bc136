// Small oscillations about a state of rest: the modes of M x'' + K x = 0.
//
// Notation: x small displacements of the freedoms from rest, T = x'.M x'/2 the kinetic energy there, K = -dQ/dx of the
// generalized forces Q. A mode is a shape s and a square: K s = square M s, s.M s = 1, and different modes have
// s.M r = 0. Damping and all that depends on velocity is left aside: modes are undamped, at rest.
// M and K are of 32 digits, so that slow modes beside fast ones keep theirs.
// Source: Golub and Van Loan, "Matrix Computations", 4th ed., sec. 8.7.2: M = L L^T, L^-1 K L^-T y = square y.
#pragma once

#include <optional>
#include <ostream>
#include <vector>

#include "rbdyn/basics/dense.hpp"
#include "rbdyn/basics/form.hpp"
#include "rbdyn/closed_form/symmetric_modes.hpp"
#include "rbdyn/scene/scene.hpp"
#include "rbdyn/statics/equilibrium.hpp"

namespace rbdyn::inline RBDYN_FORM {

/// What a model says of a state of rest, in any coordinates that are good there: all that normal modes are made of.
struct SmallMotion {
    WideMatrix mass;       // M, symmetric and positive
    WideMatrix stiffness;  // K
    bool is_even = false;  // K is the same all around, and does not know the rounding of where the rest is said to be
    std::optional<SquareMatrix> sizes = std::nullopt;  // what the entries of K are sums of, where that is known
};

/// Modes as they come out of M and K.
struct SmallModes {
    std::vector<double> squares, rounding;  // in ascending order, and below which size each of them is none
    SquareMatrix shapes;                    // columns s, s.M s = 1
};

/// Throws InvalidInput where the stiffness is not symmetric: the forces have no potential, and no such modes.
SmallModes small_modes(const SmallMotion& motion);

struct NormalModes {
    /// omega^2 in ascending order [1/s^2]; negative: the rest is unstable, x grows as exp(sqrt(-square) t). What is
    /// zero within the rounding of what it is made of is zero: nothing pushes back there.
    std::vector<double> squares;
    /// omega, in the same order [rad/s]; not a number where the square is negative.
    std::vector<double> frequencies;
    /// One a column, s.M s = 1, the component of largest size positive. Rows in order of addition: the parameter of a
    /// bead; x, y, z of a free particle; the angle of a hinge; the displacement of a slide; the coordinates of a joint
    /// that has more; of a body that turns freely the place of its centre of mass, if it is free, and small turns about
    /// the body's axes [rad]. Where constraints hold there are more rows than modes.
    Matrix shapes;
};

/// Throws InvalidInput where the stiffness is not symmetric: the forces have no potential, and no such modes.
NormalModes normal_modes(const SmallMotion& motion);

/// Of a scene about one of its equilibria(). Throws InvalidInput where that is none, where friction holds a bead, and
/// where forces depend on time, are called back, or have no potential.
NormalModes normal_modes(const Scene& scene, const Equilibrium& at);

std::ostream& operator<<(std::ostream& out, const NormalModes& modes);

}  // namespace rbdyn::inline RBDYN_FORM
