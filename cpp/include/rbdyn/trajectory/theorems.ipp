// Definitions of rbdyn/trajectory/theorems.hpp.
#pragma once

#include "rbdyn/trajectory/theorems.hpp"

#include <cstddef>
#include <utility>
#include <vector>

#include "rbdyn/basics/double_double_functions.hpp"
#include "rbdyn/basics/error.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/model/system_report.hpp"
#include "rbdyn/scene/handles.hpp"
#include "rbdyn/trajectory/pole.hpp"

namespace rbdyn::inline RBDYN_FORM {

template <class F>
Vector3 SystemPart::mean(F&& f) const {
    Vector3 sum = Vector3::Zero();
    each([&](const BodyReport& b, int) { sum += b.mass * f(b); });
    return sum / mass();
}

template <class F>
void SystemPart::each_external(F&& f) const {
    for (const CouplingReport& c : system_.couplings) {
        const bool a = has(c.a), b = has(c.b);
        if (a && !b) f(c.place_a, c.force);
        if (b && !a) f(c.place_b, Vector3(-c.force));
    }
}

RBDYN_INLINE SystemPart::SystemPart(const SystemReport& system, std::vector<BodyHandle> of)
    : system_(system), of_(std::move(of)) {
    if (of_.empty()) return;
    is_in_.resize(system.bodies.size());
    for (const BodyHandle b : of_) {
        require(b.index >= 0 && b.index < static_cast<int>(system.bodies.size()), "Trajectory", "body", b.index,
                "a handle comes from the scene of this run");
        is_in_[static_cast<std::size_t>(b.index)] = true;
    }
}

RBDYN_INLINE bool SystemPart::is_within_or_to_world(const CouplingReport& c) const {
    return (has(c.a) || c.a < 0) && (has(c.b) || c.b < 0);
}

RBDYN_INLINE double SystemPart::mass() const {
    double sum = 0.0;
    each([&](const BodyReport& b, int) { sum += b.mass; });
    return sum;
}

RBDYN_INLINE Vector3 SystemPart::center_of_mass() const {
    return mean([](const BodyReport& b) { return b.position; });
}

RBDYN_INLINE Vector3 SystemPart::center_of_mass_velocity() const {
    return mean([](const BodyReport& b) { return b.velocity; });
}

RBDYN_INLINE Vector3 SystemPart::center_of_mass_acceleration() const {
    return mean([](const BodyReport& b) { return b.acceleration; });
}

RBDYN_INLINE double SystemPart::kinetic_energy(const Vector3& axes) const {
    double sum = 0.0;
    each([&](const BodyReport& b, int) { sum += 0.5 * b.mass * (b.velocity - axes).squaredNorm() + b.spin_energy; });
    return sum;
}

RBDYN_INLINE double SystemPart::power() const {
    double sum = 0.0;
    each([&](const BodyReport& b, int) { sum += (b.force + b.reaction).dot(b.velocity) + b.spin_power; });
    return sum;
}

RBDYN_INLINE Vector3 SystemPart::momentum() const {
    Vector3 sum = Vector3::Zero();
    each([&](const BodyReport& b, int) { sum += b.mass * b.velocity; });
    return sum;
}

RBDYN_INLINE Vector3 SystemPart::angular_momentum(const Vector3& pole) const {
    Vector3 sum = Vector3::Zero();
    each([&](const BodyReport& b, int) {
        sum += (b.position - pole).cross(Vector3(b.mass * b.velocity)) + b.spin_momentum;
    });
    return sum;
}

RBDYN_INLINE Vector3 SystemPart::external_force() const {
    Vector3 sum = Vector3::Zero();
    each([&](const BodyReport& b, int) { sum += b.applied + b.reaction; });
    each_external([&](const Vector3&, const Vector3& force) { sum += force; });
    return sum;
}

RBDYN_INLINE Vector3 SystemPart::external_moment(const Vector3& pole) const {
    Vector3 sum = Vector3::Zero();
    each([&](const BodyReport& b, int) {
        sum += (b.position - pole).cross(Vector3(b.applied + b.reaction)) + b.applied_moment + b.reaction_moment;
    });
    each_external([&](const Vector3& place, const Vector3& force) { sum += (place - pole).cross(force); });
    return sum;
}

RBDYN_INLINE std::pair<Vector3, Vector3> SystemPart::cardinal_residuals(const Pole::Now& pole) const {
    Vector3 q_rate = Vector3::Zero(), k_rate = Vector3::Zero();
    each([&](const BodyReport& b, int) {
        q_rate += b.mass * b.acceleration;
        k_rate += (b.position - pole.place).cross(Vector3(b.mass * b.acceleration)) + b.spin_rate;
    });
    const Vector3 carried = pole.velocity.cross(momentum());
    k_rate -= carried;
    return {external_force() - q_rate, external_moment(pole.place) - k_rate - carried};
}

namespace theorems {

/// The velocity of G is that of the origin and what turning adds to it: where they cancel it is rounding of these.
inline double size_of_velocity(const BodyReport& b) {
    return b.velocity.norm() + b.angular_velocity.norm() * (b.position - b.origin).norm();
}

}  // namespace theorems

RBDYN_INLINE double SystemPart::size_of_momentum() const {
    double sum = 0.0;
    each([&](const BodyReport& b, int) { sum += b.mass * theorems::size_of_velocity(b); });
    return sum;
}

RBDYN_INLINE double SystemPart::size_of_angular_momentum(const Vector3& pole) const {
    double sum = 0.0;
    each([&](const BodyReport& b, int) {
        sum += b.mass * (b.position - pole).norm() * theorems::size_of_velocity(b) + b.spin_momentum.norm();
    });
    return sum;
}

}  // namespace rbdyn::inline RBDYN_FORM
