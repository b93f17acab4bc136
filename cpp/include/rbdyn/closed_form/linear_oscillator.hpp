// The linear oscillator with damping and a constant force in closed form, x'' = force - damping x' - stiffness x:
// torsion pendulum (7.60 with a torsion spring), body on a spring along a line.
//
// With S'' + damping S' + stiffness S = 0, S(0) = 0, S'(0) = 1, Q = integral of S and D = 1 - stiffness Q:
//   x = D x0 + S v0 + Q force,   v = S' v0 + S (force - stiffness x0).
// S, S', D and Q are continuous through critical damping and through stiffness or damping zero: each is taken from a
// form without cancellation. What grows is taken by its exponentials. Coefficients per unit of inertia; x from where
// the spring is at rest.
#pragma once

#include <cmath>

#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/instant.hpp"
#include "rbdyn/closed_form/phase.hpp"

namespace rbdyn::inline RBDYN_FORM {

class LinearOscillator {
public:
    struct State {
        double position, velocity;
    };
    struct Coefficients {
        DoubleDouble stiffness, damping, force;  // [1/s^2], [1/s], [x/s^2]; of any sign
    };

    /// Position from the spring's rest and velocity at t = 0.
    LinearOscillator(const Coefficients& c, const DoubleDouble& position, const DoubleDouble& velocity);

    /// Position and velocity at a time [s] of either sign; at 0 the start itself.
    State at(Instant t) const;

    /// Estimated error at a time [s], relative to the largest position and velocity.
    double error(double t) const { return rounding + 1e-31 * fastest_ * std::abs(t); }

    /// Estimated errors of position and velocity at a time: what their terms are large, they are rounded by.
    State errors(double t) const;

    /// Of what changes fastest in it [1/s].
    double fastest() const { return fastest_; }

    /// Of a damped swing to and fro [s]; infinite without one.
    double period() const { return oscillates_ ? 2.0 * double_double::pi.hi / turn_ : INFINITY; }

private:
    static constexpr double rounding = 3e-16;  // of some five operations in doubles

    struct Kernels {
        double s, rise, d, q;
    };

    Kernels turning(Instant t) const;

    Kernels creeping(Instant t) const;

    // Where one of the exponentials has outgrown what it began with, its share of the start is taken with 32 digits:
    // the start may have almost nothing of it. Not beside a rate near zero, whose share would be large
    bool grows(Instant t) const;

    /// Of e^{rate t} from 0.
    static double integral(const DoubleDouble& rate, double t);

    // where 1 - D would cancel: the series of Q'' + damping Q' + stiffness Q = 1, below 1e-18 after 16 terms
    bool small(Instant t) const { return fastest_ * std::abs(t.hi) < 0.5; }
    double series(double t) const;

    State start_;
    DoubleDouble half_damping_, upper_, lower_, gap_;  // exponents, and their distance
    DoubleDouble grown_, shrunk_, level_;              // x = grown e^{upper t} - shrunk e^{lower t} + level
    Phase phase_;
    double stiffness_, force_, pull_, fastest_, turn_ = 0.0;
    bool oscillates_, apart_ = false;
};

}  // namespace rbdyn::inline RBDYN_FORM
