// Euler angles along a path of attitudes: which of all that give an attitude are those that came about continuously.
//
// With w + i z = cos(theta/2) e^{i (psi + phi)/2} and x + i y = sin(theta/2) e^{i (psi - phi)/2} both arguments are
// continuous as long as neither number vanishes. They change at rates of |omega_3|/2 and, across the axis, of
// |omega_12|/2 times the larger number over the smaller: what moves the axis, and not the spin, asks for short steps
// beside theta = 0 or pi, there where psi and phi turn by pi each in as little time as the axis needs to pass. From
// step to step the smaller number changes by a share of itself, so a pass takes steps like the logarithm of its
// distance. A path that passes nearer than `through` counts as one through the pole: theta goes on to the other side,
// psi keeps its value; one that stays as near is followed down to `finest`. What rounding moves to and fro there cannot
// ask for more steps than `allowed`.
#pragma once

#include <algorithm>
#include <limits>
#include <optional>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/interruption.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/rotation/euler_angles.hpp"
#include "rbdyn/rotation/quaternion.hpp"

namespace rbdyn::inline RBDYN_FORM {

/// An attitude, body axes to world, with the angular velocity in body axes [rad/s].
struct Turning {
    Quaternion attitude;
    Vector3 angular_velocity;
};

namespace euler_path {

/// Below this a pass cannot be told from one through the pole: far above what attitudes of long runs are off by
/// rounding, far below what a motion at random comes to.
inline constexpr double through = 1e-10;
/// Below this the argument of a component has no second digit.
inline constexpr double finest = 1e-14;
/// Radians from one step to the next; a quarter of a turn would be too much.
inline constexpr double longest = 0.25;
/// Steps for each radian that the body turns, and for each change of omega by its own size, at most: a pass at a
/// distance of `through` takes 200. At a beginning, and at most ahead of the motion, a few of these.
inline constexpr double allowed = 200.0, ahead = 1000.0;

}  // namespace euler_path

/// Angles at a time of a path, and what the next step follows from.
struct EulerStep {
    double time = 0.0, speed = 0.0, across = 0.0;  // s, |omega|, its share across the third axis
    double nearest = 0.0;                          // sine of half of what theta is from 0 or pi
    double left = euler_path::ahead;               // steps that may be taken before the body has turned on
    Vector3 angular_velocity = Vector3::Zero();
    EulerAngles angles;

    EulerStep() = default;
    EulerStep(double t, const Turning& now, const EulerAngles& a);
};

namespace euler_path {

/// How fast the arguments go, at most [rad/s]; components below `least` count as that.
double rate(const EulerStep& s, double least);

/// Goes from a step to time t in steps short enough to lose no turn. `motion(time)`: a Turning; `keep(step)`: called
/// with each new step before t. Returns the last of them.
template <class Motion, class Keep>
EulerStep follow(EulerStep last, double t, Motion&& motion, Keep&& keep) {
    const double any = std::numeric_limits<double>::infinity();
    while (last.time < t) {
        Interruption::point();
        const double until = t - last.time;
        double step = 0.0;
        int asked = 0;
        Turning now;
        EulerStep next;
        const auto go = [&](double length) {
            step = length;
            now = motion(last.time + step);
            next = EulerStep(last.time + step, now, last.angles);
            ++asked;
        };
        // not so far that what goes faster there may have turned far in between
        const auto go_at = [&](double least) {
            go(std::min(longest / rate(last, least), until));
            while (rate(next, least) * step > 2.0 * longest && last.time + 0.5 * step > last.time) go(0.5 * step);
        };
        // straight through the pole, or along beside it
        const double leap = std::min(longest / last.speed, 5.0 * through / last.across);
        const bool is_short = longest / rate(last, finest) < leap;
        if (last.nearest <= through && last.left > 0.0 && is_short && leap < until) go(leap);
        const bool is_through = asked > 0 && next.nearest > through && next.speed * step <= 2.0 * longest;
        if (!is_through) go_at(last.left > 0.0 ? finest : any);
        if (last.time + step >= t || last.time + step == last.time) break;
        const double sizes = last.speed + next.speed;
        const double turned =
            next.speed * step + (sizes > 0.0 ? (next.angular_velocity - last.angular_velocity).norm() / sizes : 0.0);
        next.left = std::min(last.left - asked + allowed * turned, ahead);
        next.angles = continue_from(last.angles, now.attitude);
        last = next;
        keep(last);
    }
    return last;
}

/// The angles a path begins with: those given, or the principal ones; at theta = 0 and pi, where these say nothing of
/// psi and phi apart, those to which a body that turns comes from just after.
EulerAngles begin(const Turning& start, const std::optional<EulerAngles>& given);

/// The angles of an attitude whose whole turns are unknown: theta on the side where it was, the others nearest to what
/// they were.
EulerAngles beside(const EulerAngles& before, const Quaternion& q);

/// The angles of a turn about an axis, of unit length, that began at another angle [rad]: continuous, at the start
/// theta in [0, pi], psi and phi in [-pi, pi]. About the vertical theta = 0 and psi keeps its value.
EulerAngles of_turn(const Vector3& axis, double angle, double start);

}  // namespace euler_path

}  // namespace rbdyn::inline RBDYN_FORM
