// The sign that a function of the motion takes just after a time at which it is zero, and the power of time that a norm
// begins with there.
#pragma once

#include <span>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/model/hybrid.hpp"

namespace rbdyn::inline RBDYN_FORM {

namespace leading {

/// By values alone, for equations that call back: the first sign that is more than rounding, along steps of Runge and
/// Kutta's method from the present state, each four times as long as the one before. What Heun's method would have
/// made of it tells their error. `is_zero`: what it begins with is known to be zero.
int by_values(const Mode& mode, double t, std::span<const double> x, int output, bool is_zero);

}  // namespace leading

/// The sign an output of a mode's equations takes just after t: that of its first coefficient that is more than the
/// rounding of its own terms. 0: it stays zero.
/// `known_zeros`: how many of the first are zero but for rounding.
int leading_sign(const Mode& mode, double t, std::span<const double> x, int output, int known_zeros = 0);

/// Sets what tells of each norm that is zero at t how many of its first coefficients are rounding (Switch::parameter):
/// |v| is t^m |d(t)| for v = t^m d(t), and what is left of coefficients before m, where forces balance, is no
/// direction.
void find_leading_powers(Mode& mode, double t, std::span<const double> x);

}  // namespace rbdyn::inline RBDYN_FORM
