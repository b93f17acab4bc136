// Definitions of rbdyn/plan/integrals.hpp.
#pragma once

#include "rbdyn/plan/integrals.hpp"

#include <cmath>
#include <complex>
#include <cstddef>
#include <variant>

#include "rbdyn/basics/vector.hpp"
#include "rbdyn/expression/given.hpp"
#include "rbdyn/model/rigid_law.hpp"
#include "rbdyn/scene/couplings.hpp"
#include "rbdyn/scene/handles.hpp"
#include "rbdyn/scene/joints.hpp"
#include "rbdyn/scene/loads.hpp"
#include "rbdyn/scene/rigid_motion.hpp"
#include "rbdyn/scene/scene.hpp"
#include "rbdyn/scene/torque.hpp"

namespace rbdyn::inline RBDYN_FORM::planning {

RBDYN_INLINE bool has_potential_along_rail(const Scene& scene, const Scene::AppliedLoad& load) {
    const Force* force = std::get_if<Force>(&load.load);
    const Rail* rail = scene.bodies()[static_cast<std::size_t>(load.body)].rail();
    return force != nullptr && !force->is_constant() && !force->depends_on_time() && !force->depends_on_velocity() &&
           rail != nullptr && !rail->friction() && !rail->motion().present() && !rail->may_release();
}

RBDYN_INLINE bool is_kovalevskaya(const RigidLaw& law) {
    const double near = 1e-12;
    return law.kind == RigidLaw::Kind::spherical &&
           std::abs(law.moments[0] - law.moments[1]) <= near * law.moments[0] &&
           std::abs(law.moments[0] - 2.0 * law.moments[2]) <= near * law.moments[0] &&
           std::abs(law.center[2]) <= near * law.center.norm() && !law.center.isZero(0.0);
}

RBDYN_INLINE double kovalevskaya(const RigidLaw& law, double gravity, const Vector3& omega, const Vector3& up) {
    using C = std::complex<double>;
    const C z(omega[0], omega[1]), zeta(up[0], up[1]), c(law.center[0], law.center[1]);
    return std::norm(z * z - law.mass * gravity / law.moments[2] * c * zeta);
}

RBDYN_INLINE Remaining remaining_of(const Scene& scene) {
    Remaining left;
    for (const auto& load : scene.loads()) {
        if (!is_present(load.load)) continue;
        const Force* force = std::get_if<Force>(&load.load);
        if (force != nullptr && force->is_constant() && force->frame() == Frame::world) {
            left.external += sizes(force->constant());
            continue;
        }
        left.known = false;
        if (force != nullptr)
            left.energy = left.energy && force->frame() == Frame::world && has_potential_along_rail(scene, load);
        else if (const TorsionSpring* spring = std::get_if<TorsionSpring>(&load.load))
            left.energy = left.energy && spring->damping.is_zero();
        else if (!std::holds_alternative<Potential>(load.load) && !std::holds_alternative<Lorentz>(load.load))
            left.energy = false;
    }
    for (const Scene::Body& b : scene.bodies()) {
        const Revolute* hinge = std::get_if<Revolute>(&b.joint);
        const Prismatic* slide = std::get_if<Prismatic>(&b.joint);
        if ((hinge != nullptr && hinge->motion) || (slide != nullptr && slide->motion)) left.energy = false;
        const Rail* rail = b.rail();
        if (rail == nullptr) continue;
        left.known = false;
        left.energy = left.energy && !rail->friction() && !rail->motion().present();
    }
    for (const auto& c : scene.connections()) {
        if (!is_present(c.coupling)) continue;
        left.energy = left.energy && std::get<Spring>(c.coupling).damping.is_zero();
        left.known = left.known && body_of(c.a) >= 0 && body_of(c.b) >= 0;
    }
    return left;
}

RBDYN_INLINE FirstIntegrals first_integrals(const Scene& scene, const RigidLaw* body) {
    FirstIntegrals result;
    const Remaining left = remaining_of(scene);
    if (left.energy) result.names.push_back("energy");
    const Vector3& g = scene.gravity();
    const bool has_gravity = !g.isZero(0.0), only_gravity = left.known && left.external.isZero(0.0);
    if (has_gravity) result.up = -direction(g);
    bool all_free = true;
    // what joins bodies to each other is no force from outside
    for (const Scene::Body& b : scene.bodies())
        all_free = all_free && (std::holds_alternative<Free>(b.joint) || b.parent >= 0);
    for (const Scene::Held& c : scene.constraints()) all_free = all_free && body_of(c.b) >= 0;
    if (all_free) {
        const char* names[] = {"momentum x", "momentum y", "momentum z"};
        const Vector3 external = left.external + sizes(g);
        for (int i = 0; i < 3; ++i)
            if (left.known && external[i] == 0.0) result.names.push_back(names[i]);
        if (only_gravity && !has_gravity) result.names.push_back("angular momentum");
        if (only_gravity && has_gravity && g[0] == 0.0 && g[1] == 0.0) result.names.push_back("angular momentum z");
    }
    if (body == nullptr) return result;
    const RigidLaw& law = *body;
    if (law.kind == RigidLaw::Kind::spherical && only_gravity) {
        result.pole = law.at;
        const bool is_heavy = has_gravity && !law.center.isZero(0.0);
        result.names.push_back(is_heavy ? "vertical angular momentum" : "angular momentum");
        if (is_heavy && is_kovalevskaya(law)) result.names.push_back("Kovalevskaya");
    }
    if (law.follows_axis) result.names.push_back("spin");
    return result;
}

}  // namespace rbdyn::inline RBDYN_FORM::planning
