// Definitions of rbdyn/mechanics/exert.hpp.
#pragma once

#include "rbdyn/mechanics/exert.hpp"

#include <algorithm>
#include <variant>
#include <vector>

#include "rbdyn/basics/double_double_vector.hpp"
#include "rbdyn/expression/expression.hpp"
#include "rbdyn/scene/joint_loads.hpp"
#include "rbdyn/scene/torque.hpp"

namespace rbdyn::inline RBDYN_FORM::mechanics {

RBDYN_INLINE int turning_velocity(const JointLaw& joint) {
    if (joint.as<PlanarLaw>() != nullptr) return 2;
    const bool turns = joint.as<RevoluteLaw>() != nullptr || joint.as<CylindricalLaw>() != nullptr ||
                       joint.as<UniversalLaw>() != nullptr;
    return turns ? 0 : -1;
}

RBDYN_INLINE int sliding_velocity(const JointLaw& joint) {
    return joint.as<PrismaticLaw>() != nullptr ? 0 : joint.as<CylindricalLaw>() != nullptr ? 1 : -1;
}

RBDYN_INLINE Exerted::Exerted(const Scene& scene, const Tree& tree) : gravity_(widened(scene.gravity())) {
    for (const Scene::AppliedLoad& l : scene.loads())
        loads_.push_back({l.load, tree.anchor(l.at ? End(BodyPoint{l.body, *l.at}) : End(BodyHandle{l.body}))});
    for (const Scene::Connection& c : scene.connections())
        couplings_.push_back({c.coupling, tree.anchor(c.a), tree.anchor(c.b)});
}

RBDYN_INLINE void Exerted::keep_still(int body) {
    for (Applied& load : loads_)
        load.is_idle = load.is_idle || (load.at.body == body && std::holds_alternative<Drag>(load.load));
}

RBDYN_INLINE Wrench<Expression> Exerted::wrench(const Applied& load, const Tree& tree, const S& t,
                                                const std::vector<Moving<S>>& all) {
    Wrench<S> w;
    const int body = load.at.body;
    const Moving<S>& m = all[at(body)];
    if (const Torque* torque = std::get_if<Torque>(&load.load)) {
        const bool in_body = torque->frame() == Frame::body;
        RotationOf<S> r{};
        const Vector3Of<S>* e[3] = {&m.axes.e1, &m.axes.e2, &m.axes.e3};
        for (std::size_t i = 0; i < 3; ++i)
            for (std::size_t j = 0; j < 3; ++j) r[i][j] = (*e[j])[static_cast<Eigen::Index>(i)];
        const Vector3Of<S> moment = (*torque)(t, r, in_body ? m.to_body(m.omega) : m.omega);
        w.moment = in_body ? m.to_world(moment) : moment;
        return w;
    }
    const auto p = tree.point<S>(load.at, all);
    if (const Drag* drag = std::get_if<Drag>(&load.load)) {
        w.force = drag_force<S>(*drag, p.velocity, tree.node(body).name);
    } else {
        w.force = force_of<S>(load.load, t, p.place, p.velocity);
        if (const Force* force = std::get_if<Force>(&load.load); force != nullptr && force->frame() == Frame::body)
            w.force = m.to_world(w.force);
    }
    w.moment = cross<S>(p.arm, w.force);
    return w;
}

RBDYN_INLINE bool Exerted::acts_on(int body) const {
    return std::ranges::any_of(loads_, [&](const Applied& load) { return load.at.body == body; }) ||
           std::ranges::any_of(couplings_, [&](const Coupled& c) { return c.a.body == body || c.b.body == body; });
}

RBDYN_INLINE Acts Exerted::all(const Tree& tree, const S& t, const std::vector<Moving<S>>& all, const S* q,
                               const S* v) const {
    Acts acts;
    acts.joints.assign(at(tree.velocities()), S(0.0));
    for (int i = 0; i < tree.size(); ++i) {
        const Node& n = tree.node(i);
        Wrench<S> weight;
        weight.force = exactly<S>(scaled(gravity_, n.mass));
        weight.moment = cross<S>(all[at(i)].to_world(exactly<S>(n.center)), weight.force);
        acts.wrenches.push_back(weight);
    }
    for (const Applied& load : loads_) {
        const int body = load.at.body;
        const Node& n = tree.node(body);
        S power(0.0);
        const auto along = [&](const JointLoad& joint_load, int k) {
            const S exerted = joint_load(t, q[n.q + k], v[n.v + k]);
            acts.joints[at(n.v + k)] += exerted;
            return S(exerted * v[n.v + k]);
        };
        if (const TorsionSpring* spring = std::get_if<TorsionSpring>(&load.load)) {
            const int k = turning_velocity(n.joint);
            const S torque = -spring->resistance<S>(q[n.q + k], v[n.v + k]);
            acts.joints[at(n.v + k)] += torque;
            power = torque * v[n.v + k];
        } else if (const JointTorque* torque = std::get_if<JointTorque>(&load.load)) {
            power = along(*torque, turning_velocity(n.joint));
        } else if (const JointForce* force = std::get_if<JointForce>(&load.load)) {
            power = along(*force, sliding_velocity(n.joint));
        } else if (is_present(load.load) && !load.is_idle) {
            const Wrench<S> w = wrench(load, tree, t, all);
            add<S>(acts.wrenches[at(body)], w, S(1.0));
            power = mechanics::power(Twist<S>{all[at(body)].omega, all[at(body)].velocity}, w);
        }
        acts.powers.push_back(power);
    }
    for (const Coupled& c : couplings_) {
        if (!is_present(c.coupling)) {
            acts.couplings.push_back(none<S>());
            continue;
        }
        const auto a = tree.point<S>(c.a, all), b = tree.point<S>(c.b, all);
        const S masses =
            c.a.body >= 0 && c.b.body >= 0 ? exactly<S>(tree.node(c.a.body).mass * tree.node(c.b.body).mass) : S(0.0);
        const Vector3Of<S> force =
            force_of<S>(c.coupling, PairState<S>{t, a.place, b.place, a.velocity, b.velocity, masses});
        acts.couplings.push_back(force);
        if (c.a.body >= 0) {
            acts.wrenches[at(c.a.body)].force += force;
            acts.wrenches[at(c.a.body)].moment += cross<S>(a.arm, force);
        }
        if (c.b.body >= 0) {
            acts.wrenches[at(c.b.body)].force -= force;
            acts.wrenches[at(c.b.body)].moment -= cross<S>(b.arm, force);
        }
    }
    return acts;
}

}  // namespace rbdyn::inline RBDYN_FORM::mechanics
