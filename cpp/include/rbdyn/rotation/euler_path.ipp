// Definitions of rbdyn/rotation/euler_path.hpp.
#pragma once

#include "rbdyn/rotation/euler_path.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "rbdyn/basics/vector.hpp"
#include "rbdyn/rotation/euler_angles.hpp"
#include "rbdyn/rotation/quaternion.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE EulerStep::EulerStep(double t, const Turning& now, const EulerAngles& a)
    : time(t),
      speed(now.angular_velocity.norm()),
      across(std::hypot(now.angular_velocity[0], now.angular_velocity[1])),
      nearest(std::min(std::hypot(now.attitude.w, now.attitude.z), std::hypot(now.attitude.x, now.attitude.y))),
      angular_velocity(now.angular_velocity),
      angles(a) {}

}  // namespace rbdyn::inline RBDYN_FORM

namespace rbdyn::inline RBDYN_FORM::euler_path {

RBDYN_INLINE double rate(const EulerStep& s, double least) {
    return std::max(s.speed, 0.5 * s.across / std::max(s.nearest, least));
}

RBDYN_INLINE EulerAngles begin(const Turning& start, const std::optional<EulerAngles>& given) {
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

RBDYN_INLINE EulerAngles beside(const EulerAngles& before, const Quaternion& q) {
    using rotations::nearest;
    const EulerAngles a = euler_angles(q);
    const bool is_crossed = std::sin(before.theta) < 0.0;
    const double half_turn = is_crossed ? std::numbers::pi : 0.0;
    return {nearest(is_crossed ? -a.theta : a.theta, before.theta), nearest(a.psi + half_turn, before.psi),
            nearest(a.phi + half_turn, before.phi)};
}

RBDYN_INLINE EulerAngles of_turn(const Vector3& axis, double angle, double start) {
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

}  // namespace rbdyn::inline RBDYN_FORM::euler_path
