// Definitions of rbdyn/special/rigid_law.hpp: axes and moments of a body, its start and its changes.
#pragma once

#include "rbdyn/special/rigid_law.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/double_double_functions.hpp"
#include "rbdyn/basics/double_double_vector.hpp"
#include "rbdyn/basics/error.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/body/mass_properties.hpp"
#include "rbdyn/body/rigid_body.hpp"
#include "rbdyn/rotation/attitude.hpp"
#include "rbdyn/rotation/quaternion.hpp"
#include "rbdyn/scene/joints.hpp"
#include "rbdyn/scene/loads.hpp"
#include "rbdyn/scene/scene.hpp"
#include "rbdyn/scene/watch.hpp"
#include "rbdyn/special/laws_now.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE RigidLaw::RigidLaw(const Scene& scene, int place, const Vector3& at, const Vector3& origin,
                                const Vector3Of<DoubleDouble>& exact_origin)
    : SingleLaw(scene.bodies()[static_cast<std::size_t>(place)], place), at_(at), origin_(origin) {
    exact.mass = body_of(scene, place).exact().mass;
    exact.origin = exact_origin;
    for (int i = 0; i < 3; ++i) exact.weight[i] = exact.mass * scene.gravity()[i];
}

RBDYN_INLINE const RigidBody& RigidLaw::body_of(const Scene& scene, int place) {
    return *scene.bodies()[static_cast<std::size_t>(place)].rigid();
}

RBDYN_INLINE Vector3Of<DoubleDouble> RigidLaw::to_center(const Scene& scene) const {
    return body_of(scene, index).exact().com - exact.origin;
}

RBDYN_INLINE void RigidLaw::take_frame(const Scene& scene) {
    exact.frame_attitude = quaternion(exact.frame);
    exact.center = in_frame(to_center(scene));
    frame = rounded(exact.frame);
    frame_attitude = rounded(exact.frame_attitude);
    center = rounded(exact.center);
    moments = rounded(exact.moments);
    const MassProperties& given = body_of(scene, index).exact();
    inertia = rounded(product(exact.frame.transpose(), product(given.inertia, exact.frame)));
}

RBDYN_INLINE void RigidLaw::take_start(const Scene::Body& b) {
    start_in(b, start_positions_, start_velocities_);
    start_angles_ = b.attitude.given_angles();
}

RBDYN_INLINE void RigidLaw::start(double /*t*/, DoubleDouble* q, DoubleDouble* v) const {
    std::copy_n(start_positions_, positions(), q);
    std::copy_n(start_velocities_, velocities(), v);
}

RBDYN_INLINE void RigidLaw::keep_in(std::vector<bool>& stays) const {
    // a velocity that is no double is held to more digits in the state: what it is short of grows with time
    for (int k = 0; k < velocities(); ++k)
        if (start_velocities_[k].lo != 0.0) stays[static_cast<std::size_t>(first_rate + k)] = false;
}

RBDYN_INLINE Vector3Of<DoubleDouble> RigidLaw::point(const std::optional<Vector3>& given) const {
    return given ? point_in_frame(*given) : exact.center;
}

RBDYN_INLINE void RigidLaw::add_state(SingleStates<double>& states, double /*t*/, const double* q, const double* v,
                                      signed char /*phase*/) const {
    states.add<BodyState<double>>(placed(q, v), exactly<double>(exact.center));
}

RBDYN_INLINE void RigidLaw::add_state(SingleStates<S>& states, const S& /*t*/, const S* q, const S* v,
                                      signed char /*phase*/) const {
    states.add<BodyState<S>>(placed(q, v), exactly<S>(exact.center));
}

RBDYN_INLINE Vector3 RigidLaw::origin(const SingleState<double>& state) const {
    const RigidState<double>& s = own<BodyState<double>>(state).at;
    return s.position(origin_in_frame<double>(s));
}

RBDYN_INLINE Turning RigidLaw::turning(const double* q, const double* v) const {
    const RigidState<double> s = placed(q, v);
    return {attitude(s), to_body<double>(s, s.omega)};
}

RBDYN_INLINE bool RigidLaw::any_turn_held() const {
    const auto held = holds_turns();
    return held[0] || held[1] || held[2];
}

RBDYN_INLINE std::optional<planning::LoneBody> RigidLaw::alone() const {
    return planning::LoneBody{.is_balanced = center.isZero(0.0), .keeps_spin = follows_axis};
}

RBDYN_INLINE std::optional<double> RigidLaw::change(const StateChange& c, const LawsNow& now, const std::string& user,
                                                    std::span<double> x) const {
    c.require_words(words(), user, name);
    const RigidReport was = rigid_report(now);
    Scene::Body changed;
    changed.position = c.position.value_or(was.position);
    changed.velocity = c.velocity.value_or(was.velocity);
    changed.attitude = c.attitude.value_or(was.attitude);
    changed.angular_velocity = joints::angular_velocity(c, changed.attitude, user, was.angular_velocity);
    changed.parameter = coordinate_of(c).value_or(was.coordinate);
    changed.speed = c.rate.value_or(was.rate);
    DoubleDouble q[8], v[6];
    start_in(changed, q, v);
    const auto put = [&](const DoubleDouble& value) {
        require(std::isfinite(value.hi), user, "a number its action gives", value.hi, "a state is finite");
        return value.hi;
    };
    std::transform(q, q + positions(), x.begin() + first, put);
    std::transform(v, v + velocities(), x.begin() + first_rate, put);
    return std::nullopt;
}

RBDYN_INLINE Vector3Of<DoubleDouble> RigidLaw::in_frame(const Vector3Of<DoubleDouble>& v) const {
    Vector3Of<DoubleDouble> c = product(exact.frame.transpose(), v);
    const double size = rounded(v).norm();
    for (int i = 0; i < 3; ++i)
        if (std::abs(c[i].hi) <= (follows_axis ? off_axis : 0x1p-98) * size) c[i] = 0.0;
    return c;
}

RBDYN_INLINE Matrix3Of<DoubleDouble> RigidLaw::axis_frame(const Vector3Of<DoubleDouble>& axis,
                                                          const Vector3Of<DoubleDouble>& to_center) {
    const Vector3Of<DoubleDouble> z = unit(axis);
    const auto across = [&](const Vector3Of<DoubleDouble>& v) { return v - scaled(z, z.dot(v)); };
    const bool has_arm = rounded(across(to_center)).norm() > 1e-15 * rounded(to_center).norm();
    Matrix3Of<DoubleDouble> result;
    result.col(0) = unit(across(has_arm ? to_center : widened(least_along(rounded(z)))));
    result.col(1) = z.cross(result.col(0));
    result.col(2) = z;
    return result;
}

RBDYN_INLINE Vector3Of<DoubleDouble> RigidLaw::unit(const Vector3Of<DoubleDouble>& v) {
    // a power of two, so that squares neither overflow nor vanish
    int exponent = 0;
    const Vector3 size = sizes(rounded(v));
    std::frexp(size[greatest(size)], &exponent);
    const Vector3Of<DoubleDouble> w = scaled(v, std::ldexp(1.0, -exponent));
    return scaled(w, 1.0 / sqrt(w.dot(w)));
}

RBDYN_INLINE Vector3 RigidLaw::least_along(const Vector3& direction) {
    Vector3 e(0, 0, 0);
    e[least(sizes(direction))] = 1.0;
    return e;
}

}  // namespace rbdyn::inline RBDYN_FORM
