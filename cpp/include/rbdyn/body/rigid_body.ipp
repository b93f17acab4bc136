// Definitions of rbdyn/body/rigid_body.hpp.
#pragma once

#include "rbdyn/body/rigid_body.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>

#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/double_double_functions.hpp"
#include "rbdyn/basics/double_double_vector.hpp"
#include "rbdyn/basics/error.hpp"
#include "rbdyn/basics/instant.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/body/mass_properties.hpp"
#include "rbdyn/body/principal_axes.hpp"
#include "rbdyn/body/validation.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE RigidBody::RigidBody(double mass, const Inertia& inertia, const RigidBodyOptions& options)
    : RigidBody(checked(mass, inertia, options), options.inertia_about) {}

RBDYN_INLINE RigidBody::RigidBody(MassProperties given, InertiaAbout about, const std::string& body)
    : given_(std::move(given)), about_(about), central_(given_) {
    std::string derived;
    if (about_ == InertiaAbout::origin) {
        central_.inertia -= point_inertia(given_.mass, given_.com);
        derived = " (what was given about the origin less m d^2)";
    }
    bodies::require_moments(body, principal().moments, given_size(), derived);
}

RBDYN_INLINE Matrix3 RigidBody::inertia(InertiaAbout about) const {
    if (about == about_) return given_inertia();
    return about == InertiaAbout::com ? rounded(central_.inertia) : inertia(Vector3(0, 0, 0));
}

RBDYN_INLINE Matrix3Of<DoubleDouble> RigidBody::inertia_exact(const Vector3& point) const {
    for (int i = 0; i < 3; ++i)
        require(std::isfinite(point[i]), name, "point[" + std::to_string(i) + "]", point[i],
                "it is finite; give it in m");
    const Matrix3Of<DoubleDouble> about = rbdyn::inertia_about(central_, widened(point));
    for (int i = 0; i < 9; ++i)
        require(std::isfinite(about(i / 3, i % 3).hi), name,
                "element " + std::to_string(i / 3) + std::to_string(i % 3) + " of the inertia about a point",
                about(i / 3, i % 3).hi, "it is beyond what a double holds; give a point nearer to the centre of mass");
    return about;
}

RBDYN_INLINE PrincipalAxesOf<DoubleDouble> RigidBody::principal_exact(const Vector3& point) const {
    return principal_axes(inertia_exact(point));
}

RBDYN_INLINE std::optional<Vector3> RigidBody::gyroscope_axis(double rtol) const {
    require(rtol >= 0.0, name, "rtol", rtol, "a relative tolerance is zero or positive");
    const PrincipalAxes p = principal();
    std::optional<Vector3> axis;
    double closest = rtol;
    for (const int k : {2, 0, 1}) {
        const double a = p.moments[(k + 1) % 3], b = p.moments[(k + 2) % 3];
        const double difference = a == b ? 0.0 : std::abs(a - b) / std::max(std::abs(a), std::abs(b));
        if (difference > closest || (axis && difference == closest)) continue;
        closest = difference;
        axis = column(p.axes, k);
    }
    return axis;
}

RBDYN_INLINE Imbalance RigidBody::imbalance(const Vector3& axis, const Vector3& point) const {
    for (int i = 0; i < 3; ++i)
        require(std::isfinite(axis[i]), name, "axis[" + std::to_string(i) + "]", axis[i], "a direction is finite");
    require(axis.norm() > 0.0, name, "length of axis", axis.norm(), "an axis has a direction; its length is free");
    const Vector3Of<DoubleDouble> a = widened(axis), c = central_.com - widened(point);
    const DoubleDouble squared = dot<DoubleDouble>(a, a);
    const Vector3Of<DoubleDouble> across = c - a * (dot<DoubleDouble>(a, c) / squared),
                                  couple = cross<DoubleDouble>(a, product(inertia_exact(point), a));
    return {rounded(Vector3Of<DoubleDouble>(across * central_.mass)),
            rounded(Vector3Of<DoubleDouble>(couple / squared))};
}

RBDYN_INLINE bool RigidBody::is_balanced(const Vector3& axis, const Vector3& point, double rtol) const {
    require(rtol >= 0.0, name, "rtol", rtol, "a relative tolerance is zero or positive");
    const Imbalance i = imbalance(axis, point);
    const double moments = inertia(point).trace();
    return i.offset.norm() <= rtol * std::sqrt(mass() * moments) && i.couple.norm() <= rtol * moments;
}

RBDYN_INLINE bool RigidBody::is_point() const {
    const Vector3 moments = principal().moments;
    return moments[greatest(moments)] <= bodies::no_moment * given_size();
}

RBDYN_INLINE std::optional<Vector3> RigidBody::rod_axis() const {
    const PrincipalAxes p = principal();
    const int smallest = least(p.moments);
    if (p.moments[smallest] > bodies::no_moment * given_size()) return std::nullopt;
    return column(p.axes, smallest);
}

RBDYN_INLINE RigidBody RigidBody::shifted(const Vector3& r) const {
    for (int i = 0; i < 3; ++i)
        require(std::isfinite(r[i]), name, "component " + std::to_string(i) + " of a shift", r[i],
                "a shift is finite; give it in m");
    return RigidBody(MassProperties{central_.mass, central_.com + widened(r), central_.inertia});
}

RBDYN_INLINE MassProperties RigidBody::checked(double mass, const Inertia& inertia, const RigidBodyOptions& options) {
    bodies::require_mass(name, mass);
    for (int i = 0; i < 3; ++i)
        require(std::isfinite(options.com[i]), name, "com[" + std::to_string(i) + "]", options.com[i],
                "the centre of mass is a point; give it in m");
    const Matrix3& given = inertia.tensor;
    bodies::require_symmetric(name, given);
    Matrix3Of<DoubleDouble> tensor = widened(given);
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < i; ++j) tensor(i, j) = tensor(j, i) = exact_sum(0.5 * given(i, j), 0.5 * given(j, i));
    return {mass, widened(options.com), tensor};
}

}  // namespace rbdyn::inline RBDYN_FORM
