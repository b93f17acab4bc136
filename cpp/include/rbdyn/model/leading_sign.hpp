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

/// The first coefficient of an output's series in time that is more than rounding.
struct Leading {
    int order = 0;
    int sign = 0;  // 0: there is none, it stays zero
};

/// That of an output of a mode's equations at t, by the rounding of its own terms. `known_zeros`: how many of the first
/// are zero but for rounding. `doubt`: the part of its terms up to which the next one is zero, too. Of equations that
/// call back the order is the number of those known.
Leading leading_term(const Mode& mode, double t, std::span<const double> x, int output, int known_zeros = 0,
                     double doubt = 0.0);

/// The sign an output of a mode's equations takes just after t: that of its leading term. 0: it stays zero.
int leading_sign(const Mode& mode, double t, std::span<const double> x, int output, int known_zeros = 0);

/// How far below zero, in units of the rounding of its terms, that of the motion so far may have what touches it.
inline constexpr double deepest_dip = 32.0;

/// Whether an output that is zero at t sinks no further below it than that, and rises again: it touches zero. `size`:
/// of its terms elsewhere on its way. Not told of equations that call back.
bool only_dips(const Mode& mode, double t, std::span<const double> x, int output, double size = 0.0);

/// Whether all rates of a mode at (t, x) are zero but for rounding. `known`: the sizes to whose rounding the variables
/// are known, where these are larger than themselves. Not told of equations that call back.
bool has_no_rates(const Mode& mode, double t, std::span<const double> x, std::span<const double> known);

/// Whether neither rates nor guards of a mode depend on time where the state is x. Not told of equations that call
/// back.
bool is_timeless(const Mode& mode, double t, std::span<const double> x);

/// Sets what tells of each norm that is zero at t how many of its first coefficients are rounding (Switch::parameter):
/// |v| is t^m |d(t)| for v = t^m d(t), and what is left of coefficients before m, where forces balance, is no
/// direction.
void find_leading_powers(Mode& mode, double t, std::span<const double> x);

}  // namespace rbdyn::inline RBDYN_FORM
