// Euler angles along a path of attitudes: which of all that give an attitude are those that came about continuously.
//
// With w + i z = cos(theta/2) e^{i (psi + phi)/2} and x + i y = sin(theta/2) e^{i (psi - phi)/2} both arguments are
// continuous as long as neither number vanishes. Both change by at most |omega|/2 a second, so within |x + i y| and
// |w + i z| of their own size no turn is lost: the nearer to theta = 0 or pi, the shorter the steps. There psi and phi
// turn by pi each in as little time as the axis needs to pass, and that is followed. A path that passes nearer than
// `through` counts as one through the pole: theta goes on to the other side, psi keeps its value.
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>

#include "rbdyn/rotation/euler_angles.hpp"

namespace rbdyn {

/// An attitude, body axes to world, with the angular velocity in body axes [rad/s].
struct Turning {
    Quaternion attitude;
    Vector3 angular_velocity;
};

/// Angles at a time of a path, and what the next step follows from.
struct EulerStep {
    double time = 0.0, speed = 0.0;  // s, |omega|
    double nearest = 0.0;            // sine of half of what theta is from 0 or pi
    EulerAngles angles;

    EulerStep() = default;
    EulerStep(double t, const Turning& now, const EulerAngles& a)
        : time(t),
          speed(now.angular_velocity.norm()),
          nearest(std::min(std::hypot(now.attitude.w, now.attitude.z), std::hypot(now.attitude.x, now.attitude.y))),
          angles(a) {}
};

namespace euler_path {

/// Below this a pass cannot be told from one through the pole: far above what attitudes of long runs are off by
/// rounding, far below what a motion at random comes to.
inline constexpr double through = 1e-10;
/// Radians from one step to the next; a quarter of a turn would be too much.
inline constexpr double longest = 0.25;

/// How far the body may turn from a step to the next [rad].
inline double reach(const EulerStep& from) {
    return from.nearest > through ? std::min(longest, 0.5 * from.nearest) : longest;
}

/// Goes from a step to time t in steps short enough to lose no turn. `motion(time)`: a Turning; `keep(step)`: called
/// with each new step before t. Returns the last of them.
template <class Motion, class Keep>
EulerStep follow(EulerStep last, double t, Motion&& motion, Keep&& keep) {
    while (last.time < t) {
        const double far = reach(last);
        double step = std::min(far / last.speed, t - last.time);
        Turning now = motion(last.time + step);
        // a body that turns faster there may have turned far in between
        while (now.angular_velocity.norm() * step > 2.0 * far && last.time + 0.5 * step > last.time) {
            step *= 0.5;
            now = motion(last.time + step);
        }
        if (last.time + step >= t || last.time + step == last.time) break;
        last = {last.time + step, now, continue_from(last.angles, now.attitude)};
        keep(last);
    }
    return last;
}

/// The angles a path begins with: those given, or the principal ones; at theta = 0 and pi, where these say nothing of
/// psi and phi apart, those to which a body that turns comes from just after.
inline EulerAngles begin(const Turning& start, const std::optional<EulerAngles>& given) {
    using rotations::nearest, rotations::no_component;
    const Quaternion& q = start.attitude;
    if (given) return continue_from(*given, q);
    const double upright = std::hypot(q.w, q.z), fallen = std::hypot(q.x, q.y);
    const double w1 = start.angular_velocity[0], w2 = start.angular_velocity[1];
    EulerAngles a = euler_angles(q);
    const bool leaves = std::hypot(w1, w2) > no_component * start.angular_velocity.norm();
    if (!leaves || (fallen > no_component && upright > no_component)) return a;
    // of x + i y the rate is (w + i z)(omega1 + i omega2)/2, of w + i z it is -(x + i y)(omega1 - i omega2)/2
    const double across = std::atan2(w2, w1);
    double half_sum = std::atan2(q.z, q.w), half_difference = std::atan2(q.y, q.x);
    if (fallen <= no_component)
        half_difference = half_sum + across;
    else
        half_sum = half_difference - across + std::numbers::pi;
    a.psi = nearest(half_sum + half_difference, 0.0);
    a.phi = nearest(half_sum - half_difference, 0.0);
    return a;
}

/// The angles of an attitude whose whole turns are unknown: theta on the side where it was, the others nearest to what
/// they were.
inline EulerAngles beside(const EulerAngles& before, const Quaternion& q) {
    using rotations::nearest;
    const EulerAngles a = euler_angles(q);
    const bool is_crossed = std::sin(before.theta) < 0.0;
    const double half_turn = is_crossed ? std::numbers::pi : 0.0;
    return {nearest(is_crossed ? -a.theta : a.theta, before.theta), nearest(a.psi + half_turn, before.psi),
            nearest(a.phi + half_turn, before.phi)};
}

/// The angles of a turn about an axis, of unit length, that began at another angle [rad]: continuous, at the start
/// theta in [0, pi], psi and phi in [-pi, pi]. About the vertical theta = 0 and psi keeps its value.
inline EulerAngles of_turn(const Vector3& axis, double angle, double start) {
    using rotations::nearest;
    const double across = std::hypot(axis[0], axis[1]), up = axis[2];
    const auto at = [&](double turned) -> EulerAngles {
        const double c = std::cos(0.5 * turned), s = std::sin(0.5 * turned);
        if (up == 0.0) return {turned, std::atan2(axis[1], axis[0]), -std::atan2(axis[1], axis[0])};
        // w + i z = cos + i up sin, which goes round as half the angle does
        const double round = nearest(std::atan2(std::abs(up) * s, c), 0.5 * turned), sum = up > 0.0 ? round : -round;
        if (across == 0.0) return {0.0, 0.0, 2.0 * sum};
        const double difference = std::atan2(axis[1], axis[0]);
        return {2.0 * std::atan2(across * s, std::hypot(c, up * s)), sum + difference, sum - difference};
    };
    const EulerAngles first = at(start), now = at(angle);
    const double lean = nearest(first.theta, 0.0), sheet = lean < 0.0 ? -1.0 : 1.0;
    const double half_turn = sheet < 0.0 ? std::numbers::pi : 0.0;
    const double psi = nearest(first.psi + half_turn, 0.0), phi = nearest(first.phi + half_turn, 0.0);
    return {sheet * (lean + (now.theta - first.theta)), psi + (now.psi - first.psi), phi + (now.phi - first.phi)};
}

}  // namespace euler_path

}  // namespace rbdyn
