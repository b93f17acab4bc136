// Definitions of rbdyn/special/rigid_law.hpp: what acts on a body.
#pragma once

#include <algorithm>
#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/double_double_vector.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/expression/expression.hpp"
#include "rbdyn/expression/given.hpp"
#include "rbdyn/model/acting.hpp"
#include "rbdyn/model/rigid_state.hpp"
#include "rbdyn/rotation/quaternion.hpp"
#include "rbdyn/scene/loads.hpp"
#include "rbdyn/scene/scene.hpp"
#include "rbdyn/scene/torque.hpp"
#include "rbdyn/special/laws_now.hpp"
#include "rbdyn/special/rigid_law.hpp"
#include "rbdyn/special/single_laws.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE void RigidLaw::take_loads(const Scene& scene, const std::vector<int>& own) {
    loads_.clear();
    for (const int place : own) {
        const Scene::AppliedLoad& load = scene.loads()[static_cast<std::size_t>(place)];
        if (is_present(load.load)) loads_.push_back({load.load, point(load.at), place});
    }
}

template <class T>
void RigidLaw::add_load(Wrench<T>& w, const RigidState<T>& s, const RigidLoad& load, const T& t) const {
    const Vector3Of<T> point = exactly<T>(load.point);
    if (const TorsionSpring* spring = std::get_if<TorsionSpring>(&load.load)) {
        w.moment[2] -= spring->resistance<T>(s.coordinate, s.rate);
        return;
    }
    if (const Torque* torque = std::get_if<Torque>(&load.load)) {
        const bool in_body = torque->frame() == Frame::body;
        RotationOf<T> r{};
        Vector3Of<T> omega = s.omega;
        if (!torque->is_constant()) {
            const Vector3Of<T>* e[3] = {&s.axes.e1, &s.axes.e2, &s.axes.e3};
            for (std::size_t i = 0; i < 3; ++i) {
                const auto k = static_cast<Eigen::Index>(i);
                const Vector3Of<T> row = times<T>(exact.frame, Vector3Of<T>((*e[0])[k], (*e[1])[k], (*e[2])[k]));
                for (std::size_t j = 0; j < 3; ++j) r[i][j] = row[static_cast<Eigen::Index>(j)];
            }
            omega = in_body ? times<T>(exact.frame, s.omega) : s.to_world(s.omega);
        }
        const Vector3Of<T> m = (*torque)(t, r, omega);
        w.moment += in_body ? times<T>(exact.frame.transpose(), m) : s.to_frame(m);
        return;
    }
    const Vector3Of<T> place = s.position(point), velocity = s.velocity(point);
    if (const Drag* drag = std::get_if<Drag>(&load.load)) {
        w.add(s, drag_force<T>(*drag, velocity, name), point);
        return;
    }
    Vector3Of<T> f = force_of<T>(load.load, t, place, velocity);
    if (const Force* force = std::get_if<Force>(&load.load); force != nullptr && force->frame() == Frame::body)
        f = s.to_world(times<T>(exact.frame.transpose(), f));
    w.add(s, f, point);
}

template <class T>
Wrench<T> RigidLaw::applied(const T& t, const RigidState<T>& s) const {
    Wrench<T> w;
    w.add(s, exactly<T>(exact.weight), exactly<T>(exact.center));
    for (const RigidLoad& load : loads_) add_load<T>(w, s, load, t);
    return w;
}

template <class T>
Wrench<T> RigidLaw::wrench(const CouplingForces<T>& forces, const RigidState<T>& s) const {
    Wrench<T> w = applied<T>(forces.time(), s);
    for (const int k : couplings) {
        const SingleLaws::Connected& c = forces.coupling(k);
        if (c.a.body == index) w.add(s, forces[k], exactly<T>(c.a.point));
        if (c.b.body == index) w.add(s, Vector3Of<T>(-forces[k]), exactly<T>(c.b.point));
    }
    return w;
}

RBDYN_INLINE void RigidLaw::lay_down(RecordedBody& present, const CouplingForces<S>& coupled, S* q_rate,
                                     S* v_rate) const {
    const RigidState<S>& s = own<BodyState<S>>(*present.state).at;
    const Wrench<S> w = wrench<S>(coupled, s);
    rates(s, present.q, w, q_rate, v_rate);
    present.force = w.force;
    present.moment = w.moment;
}

RBDYN_INLINE void RigidLaw::powers(const RecordedBody& present, const S& t, std::span<S> power) const {
    const RigidState<S>& s = own<BodyState<S>>(*present.state).at;
    for (const RigidLoad& load : loads_) {
        Wrench<S> w;
        add_load<S>(w, s, load, t);
        power[static_cast<std::size_t>(load.index)] = dot<S>(w.force, s.v) + dot<S>(w.moment, s.omega);
    }
}

RBDYN_INLINE bool RigidLaw::is_function(const Scene::AppliedLoad& load, int /*of_scene*/) const {
    return is_present(load.load);
}

RBDYN_INLINE double RigidLaw::power(const Scene::AppliedLoad& load, double t, const SingleState<double>& state) const {
    const RigidState<double>& s = own<BodyState<double>>(state).at;
    Wrench<double> w;
    add_load<double>(w, s, {load.load, point(load.at)}, t);
    return w.force.dot(s.v) + w.moment.dot(s.omega);
}

RBDYN_INLINE RigidLaw::Acts RigidLaw::acts(const LawsNow& now) const {
    Acts result;
    if (now.acting != nullptr) {
        result.wrench = {now.acting->force(index), now.acting->moment(index)};
        for (int k = 0; k < velocities(); ++k) result.v_rate[k] = now.rate_of(first_rate + k);
        return result;
    }
    const RigidState<double>& s = own<BodyState<double>>(now.state(index)).at;
    result.wrench = wrench<double>(now.couplings, s);
    double q_rate[8];
    rates(s, now.laws.variables_of(*this, now.x).q, result.wrench, q_rate, result.v_rate);
    return result;
}

RBDYN_INLINE void RigidLaw::slope(const LawsNow& now, std::span<double> dq, std::span<double> dv) const {
    const RigidState<double>& s = own<BodyState<double>>(now.state(index)).at;
    rates(s, now.laws.variables_of(*this, now.x).q, wrench<double>(now.couplings, s), dq.data(), dv.data());
}

RBDYN_INLINE std::string RigidLaw::not_finite(const LawsNow& now) const {
    const RigidState<double>& s = own<BodyState<double>>(now.state(index)).at;
    for (const RigidLoad& load : loads_) {
        Wrench<double> w;
        add_load<double>(w, s, load, now.t);
        if (!is_finite(w.force) || !is_finite(w.moment)) return "a load on " + name;
    }
    return now.coupling_not_finite(couplings);
}

template <class T>
RigidLaw::Accelerations<T> RigidLaw::momentum_rates(const RigidState<T>& s, const Accelerations<T>& rates) const {
    const Vector3Of<T> c = exactly<T>(exact.center);
    const auto turned = [&](const Vector3Of<T>& a) { return curves::turned<T>(inertia, a); };
    const Vector3Of<T> a =
        cross<T>(rates.first, c) + cross<T>(s.omega, cross<T>(s.omega, c)) + s.to_frame(rates.second);
    return {Vector3Of<T>(a * T(mass)), Vector3Of<T>(turned(rates.first) + cross<T>(s.omega, turned(s.omega)))};
}

template <class T>
Vector3Of<T> RigidLaw::torque_of_joint(const RigidState<T>& s, const Wrench<T>& w,
                                       const Accelerations<T>& rates) const {
    const auto [moved, spun] = momentum_rates<T>(s, rates);
    Vector3Of<T> torque = spun + cross<T>(exactly<T>(exact.center), moved) - w.moment;
    const auto held = holds_turns();
    for (std::size_t i = 0; i < 3; ++i)
        if (!held[i]) torque[static_cast<Eigen::Index>(i)] = T(0.0);
    return torque;
}

RBDYN_INLINE double RigidLaw::effort_of_torque(const RigidState<double>& s, const Wrench<double>& w,
                                               const Accelerations<double>& rates) const {
    const auto [moved, spun] = momentum_rates<double>(s, rates);
    const Vector3 loads = w.moment - center.cross(s.to_frame(w.force)), force = w.force.cwiseAbs();
    const Vector3 arm = center.cwiseAbs(),
                  f = moved.cwiseAbs() + Vector3(s.axes.e1.cwiseAbs().dot(force), s.axes.e2.cwiseAbs().dot(force),
                                                 s.axes.e3.cwiseAbs().dot(force));
    Vector3 effort =
        spun.cwiseAbs() + loads.cwiseAbs() +
        Vector3(arm[1] * f[2] + arm[2] * f[1], arm[2] * f[0] + arm[0] * f[2], arm[0] * f[1] + arm[1] * f[0]);
    const auto held = holds_turns();
    for (std::size_t i = 0; i < 3; ++i)
        if (!held[i]) effort[static_cast<Eigen::Index>(i)] = 0.0;
    return effort.norm();
}

}  // namespace rbdyn::inline RBDYN_FORM
