// A relative position d under d'' = -mu d / |d|^3: Kepler's motion, for every conic and either sign of mu, in closed
// form.
//
// With dt = r ds and b = 2 mu / r0 - v0^2 (mu over the semi-major axis), e0 = d0.v0, and the functions G0 = cos(sqrt(b)
// s), G1 = sin(sqrt(b) s) / sqrt(b), G2 = (1 - G0) / b, G3 = (s - G1) / b (hyperbolic for b < 0, powers of s for b =
// 0):
//
//   t = r0 G1 + e0 G2 + mu G3 (Kepler's equation),  r = dt/ds = r0 G0 + e0 G1 + mu G2,
//   d = (1 - mu G2 / r0) d0 + (t - mu G3) v0,       v = -mu G1 / (r r0) d0 + (1 - mu G2 / r) v0
//
// (Stumpff, "Himmelsmechanik" I, 1959; Danby, "Fundamentals of Celestial Mechanics", 6.9). All of it in 32 digits,
// whole periods taken off first, so that after a thousand turns nothing but the last rounding is lost.
#pragma once

#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/instant.hpp"
#include "rbdyn/basics/vector.hpp"

namespace rbdyn::inline RBDYN_FORM {

class KeplerMotion {
public:
    struct State {
        Vector3Of<DoubleDouble> place, velocity;
    };
    /// mu [m^3/s^2], positive where the two attract each other; place [m] and velocity [m/s] at t = 0. They must not be
    /// on one line with the centre: such a motion ends, or began, where r = 0.
    [[gnu::cold]] KeplerMotion(const DoubleDouble& mu, const Vector3Of<DoubleDouble>& place,
                               const Vector3Of<DoubleDouble>& velocity);

    /// Whether place and velocity are on one line with the centre, to the rounding of 32 digits.
    static bool is_radial(const Vector3Of<DoubleDouble>& place, const Vector3Of<DoubleDouble>& velocity);

    /// At a time [s] of either sign.
    State at(Instant t) const;

    /// Time of a turn [s]; infinite for orbits that are not closed.
    double period() const { return period_.hi; }
    /// Least distance of the conic [m], and the speed there [m/s].
    double pericentre() const { return pericentre_; }
    double largest_speed() const { return largest_speed_; }

    /// Estimated error at a time [s]: of the place relative to its extent, of the velocity likewise; before they are
    /// rounded to doubles.
    double error(double t) const;

private:
    static constexpr double noise = 1e-29;  // what an evaluation loses of 32 digits, of its largest terms

    struct G {
        DoubleDouble g0, g1, g2, g3;
    };
    G functions(const DoubleDouble& s) const;
    /// The root of Kepler's equation.
    DoubleDouble anomaly(const DoubleDouble& t) const;

    State start_;
    DoubleDouble mu_, r0_, e0_, b_, root_, period_;  // root_: of |b|
    double pericentre_ = 0.0, largest_speed_ = 0.0, sensitivity_ = 0.0;
};

}  // namespace rbdyn::inline RBDYN_FORM
