// Definitions of rbdyn/scene/joints.hpp.
#pragma once

#include "rbdyn/scene/joints.hpp"

#include <cmath>
#include <optional>
#include <string>
#include <utility>

#include "rbdyn/basics/error.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/curve/curve.hpp"
#include "rbdyn/curve/one_side.hpp"
#include "rbdyn/curve/point.hpp"
#include "rbdyn/expression/function.hpp"
#include "rbdyn/expression/given.hpp"
#include "rbdyn/expression/numbers.hpp"
#include "rbdyn/expression/time_function.hpp"
#include "rbdyn/scene/rigid_motion.hpp"

namespace rbdyn::inline RBDYN_FORM::joints {

RBDYN_INLINE void require_finite(const std::string& object, const std::string& what, const Vector3& v) {
    for (int i = 0; i < 3; ++i)
        require(std::isfinite(v[i]), object, "component " + std::to_string(i) + " of " + what, v[i],
                "it is finite; give it in SI units");
}

RBDYN_INLINE void require_direction(const std::string& object, const Vector3& axis) {
    require_finite(object, "axis", axis);
    require(axis.norm() > 0.0, object, "length of axis", axis.norm(), "an axis has a direction; its length is free");
}

/// Torques against rolling and pivoting are of contacts.
inline void require_no_torques(const std::string& object, const Coulomb& friction) {
    if (friction.has_torques())
        throw InvalidInput(object +
                           ": its friction has rolling or pivoting, which are torques at contacts; leave them out");
}

/// Of a hinge or a slide.
inline void require_friction(const std::string& object, const Coulomb& friction, bool is_driven) {
    friction.validate();
    require_no_torques(object, friction);
    require(std::isfinite(friction.mu_static.now()), "Coulomb", "mu_static", friction.mu_static.now(),
            "in a joint a friction coefficient is finite; what never moves is a Fixed joint");
    if (is_driven && friction.present())
        throw InvalidInput(object +
                           ": friction is given, and motion too; where the coordinate is prescribed friction changes "
                           "nothing of the motion: leave one of them out");
}

RBDYN_INLINE void require_right_angle(const std::string& object, const std::string& what, const Vector3& a,
                                      const Vector3& b) {
    const double cosine = a.dot(b) / (a.norm() * b.norm());
    require(std::abs(cosine) <= 1e-6, object, "cosine of the angle between " + what, cosine,
            "they are at right angles (within 1e-6, and then made so)");
}

}  // namespace rbdyn::inline RBDYN_FORM::joints

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE bool Coulomb::operator==(const Coulomb& other) const {
    return mu_static == other.mu_static &&
           mu_dynamic.value_or(mu_static) == other.mu_dynamic.value_or(other.mu_static) && rolling == other.rolling &&
           pivoting == other.pivoting;
}

RBDYN_INLINE Coulomb Coulomb::frozen() const {
    Coulomb result{mu_static.frozen(), mu_dynamic, rolling.frozen(), pivoting.frozen()};
    if (mu_dynamic) result.mu_dynamic = mu_dynamic->frozen();
    result.validate();
    return result;
}

RBDYN_INLINE void Coulomb::give(GivenNumbers& numbers) const {
    mu_static.give(numbers);
    if (mu_dynamic) mu_dynamic->give(numbers);
    rolling.give(numbers);
    pivoting.give(numbers);
}

RBDYN_INLINE void Coulomb::validate() const {
    require(mu_static >= 0.0, "Coulomb", "mu_static", mu_static, "a friction coefficient is zero or positive");
    require(dynamic() >= 0.0, "Coulomb", "mu_dynamic", dynamic(), "a friction coefficient is zero or positive");
    require(dynamic() <= mu_static, "Coulomb", "mu_dynamic", dynamic(),
            "the dynamic coefficient is at most the static one, which is " + text(mu_static.now()) +
                "; exchange them, or make them equal");
    const auto require_length = [](const char* what, double length) {
        require(length >= 0.0 && std::isfinite(length), "Coulomb", what, length,
                "it is a length in m, zero or positive, and finite");
    };
    require_length("rolling", rolling.now());
    require_length("pivoting", pivoting.now());
    if (has_torques() && mu_static.is_zero())
        throw InvalidInput(
            "Coulomb: rolling or pivoting is given, and mu_static is 0; torques of friction act where a contact has "
            "friction: give mu_static, too");
}

RBDYN_INLINE Rail::Rail(Curve curve, std::optional<Coulomb> friction, RailOptions options)
    : curve_(std::move(curve)), friction_(friction), options_(std::move(options)) {
    if (friction_) {
        friction_->validate();
        require(std::isfinite(static_cast<double>(friction_->mu_static)), "Coulomb", "mu_static", friction_->mu_static,
                "on a rail a friction coefficient is finite; what never slips is at rest on it");
        joints::require_no_torques("Rail", *friction_);
    }
    if (options_.drive.is_constant())
        require(std::isfinite(options_.drive.constant()), "Rail", "drive", options_.drive.constant(),
                "the speed of a rail's surface is finite; give it in m/s");
    if (options_.side != RailSide::both && options_.motion.present())
        throw InvalidInput(
            "Rail: side is given, and motion too; where a bead lands on a rail that moves is not known here: use "
            "side \"both\", or a rail at rest");
    if (!options_.up) return;
    joints::require_finite("Rail", "up", *options_.up);
    require(options_.up->norm() > 0.0, "Rail", "length of up", options_.up->norm(),
            "up is a direction; its length is free");
    if (options_.side == RailSide::both)
        throw InvalidInput(
            "Rail: up is given, and side is \"both\"; up says which side of a rail is \"+\": give side \"+\", or "
            "\"-\" for the other");
}

RBDYN_INLINE std::optional<Vector3> Rail::pushes(double u, const std::string& name) const {
    if (options_.side == RailSide::both) return std::nullopt;
    const Vector3 normal = curves::one_side(curve_, u, options_.up, name).normal();
    return options_.side == RailSide::plus ? normal : Vector3(-normal);
}

RBDYN_INLINE bool Rail::may_release() const {
    const Domain d = curve_.domain();
    const bool ends = !curve_.closed() && (std::isfinite(d.begin) || std::isfinite(d.end));
    return options_.side != RailSide::both || (options_.ends == RailEnds::release && ends);
}

RBDYN_INLINE Rail Rail::frozen() const {
    Rail result = *this;
    if (friction_) result.friction_ = friction_->frozen();
    result.options_.drive = options_.drive.frozen();
    result.options_.motion = options_.motion.frozen();
    return result;
}

RBDYN_INLINE void Rail::give(GivenNumbers& numbers) const {
    if (friction_) friction_->give(numbers);
    options_.drive.function().give(numbers);
    options_.motion.function().give(numbers);
}

RBDYN_INLINE bool Rail::operator==(const Rail& other) const {
    return curve_ == other.curve_ && friction() == other.friction() && drive() == other.drive() &&
           motion() == other.motion() && side() == other.side() && ends() == other.ends() && up() == other.up();
}

namespace joints {

inline std::optional<Coulomb> unless_none(const std::optional<Coulomb>& friction) {
    const bool is_none = !friction || (friction->mu_static.is_zero() && friction->mu_dynamic.value_or(0.0).is_zero());
    return is_none ? std::nullopt : friction;
}

}  // namespace joints

RBDYN_INLINE bool is_driven(const Joint& joint) {
    if (const Revolute* hinge = std::get_if<Revolute>(&joint)) return hinge->motion.has_value();
    if (const Prismatic* slide = std::get_if<Prismatic>(&joint)) return slide->motion.has_value();
    return false;
}

RBDYN_INLINE std::optional<Coulomb> friction_in(const Joint& joint) {
    if (const Revolute* hinge = std::get_if<Revolute>(&joint)) return joints::unless_none(hinge->friction);
    if (const Prismatic* slide = std::get_if<Prismatic>(&joint)) return joints::unless_none(slide->friction);
    return std::nullopt;
}

RBDYN_INLINE std::optional<Coulomb> friction_on(const Rail& rail) { return joints::unless_none(rail.given_friction()); }

RBDYN_INLINE void Spherical::validate() const {
    joints::require_finite("Spherical", "at", at);
    joints::require_finite("Spherical", "point", point);
}

RBDYN_INLINE void Revolute::validate() const {
    joints::require_direction("Revolute", axis);
    joints::require_finite("Revolute", "at", at);
    joints::require_finite("Revolute", "point", point);
    if (motion && motion->is_constant())
        require(std::isfinite(motion->constant()), "Revolute", "motion", motion->constant(), "it is finite, in rad");
    if (friction) joints::require_friction("Revolute", *friction, motion.has_value());
    require(std::isfinite(pin_radius.now()) && pin_radius.now() >= 0.0, "Revolute", "pin_radius", pin_radius.now(),
            "the radius of a pin is zero or positive, and finite; give it in m");
    if (friction && friction->present() && !pin_radius.varies())
        require(pin_radius.now() > 0.0, "Revolute", "pin_radius", pin_radius.now(),
                "friction in a hinge is a torque at its pin; give the radius of the pin in m, or no friction");
}

RBDYN_INLINE void Prismatic::validate() const {
    joints::require_direction("Prismatic", axis);
    joints::require_finite("Prismatic", "at", at);
    joints::require_finite("Prismatic", "point", point);
    if (motion && motion->is_constant())
        require(std::isfinite(motion->constant()), "Prismatic", "motion", motion->constant(), "it is finite, in m");
    if (friction) joints::require_friction("Prismatic", *friction, motion.has_value());
}

RBDYN_INLINE void Universal::validate() const {
    joints::require_direction("Universal, first axis", first);
    joints::require_direction("Universal, second axis", second);
    joints::require_right_angle("Universal", "first and second axis", first, second);
    joints::require_finite("Universal", "at", at);
    joints::require_finite("Universal", "point", point);
}

RBDYN_INLINE void Cylindrical::validate() const {
    joints::require_direction("Cylindrical", axis);
    joints::require_finite("Cylindrical", "at", at);
    joints::require_finite("Cylindrical", "point", point);
}

RBDYN_INLINE void Planar::validate() const {
    joints::require_direction("Planar, x", x);
    joints::require_direction("Planar, y", y);
    joints::require_right_angle("Planar", "x and y", x, y);
    joints::require_finite("Planar", "at", at);
}

RBDYN_INLINE void Fixed::validate() const {
    joints::require_finite("Fixed", "at", at);
    joints::require_finite("Fixed", "point", point);
}

RBDYN_INLINE double arc_length_origin(const Curve& curve) {
    return std::isfinite(curve.domain().begin) ? curve.domain().begin : 0.0;
}

}  // namespace rbdyn::inline RBDYN_FORM
