// Definitions of rbdyn/special/point_observables.hpp.
#pragma once

#include "rbdyn/special/point_observables.hpp"

#include <cstddef>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "rbdyn/basics/vector.hpp"
#include "rbdyn/curve/point.hpp"
#include "rbdyn/expression/elementary.hpp"
#include "rbdyn/expression/expression.hpp"
#include "rbdyn/expression/node.hpp"
#include "rbdyn/model/acting.hpp"
#include "rbdyn/model/rigid_state.hpp"
#include "rbdyn/scene/couplings.hpp"
#include "rbdyn/scene/watch.hpp"
#include "rbdyn/special/point_laws.hpp"
#include "rbdyn/special/point_state.hpp"
#include "rbdyn/special/points_now.hpp"
#include "rbdyn/special/rigid_law.hpp"
#include "rbdyn/special/rigid_observables.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE RecordedPoints::RecordedPoints(const PointLaws& laws, const S& t, const std::vector<PointState<S>>& states,
                                            const std::vector<Body>& bodies)
    : laws_(laws), t_(t), states_(states), bodies_(bodies) {}

RBDYN_INLINE RecordedPoints::S RecordedPoints::value(const Observable& o) const {
    switch (o.quantity) {
        case Quantity::time: return t_;
        case Quantity::length: {
            const PairState<S> ends = laws_.ends<S>(laws_.couplings()[at(o.subject)], t_, states_);
            return length(Vector3Of<S>(ends.ra - ends.rb), std::string());
        }
        case Quantity::coupling_force: {
            const PointLaws::Connected& c = laws_.couplings()[at(o.subject)];
            return c.present() ? component(laws_.coupling_force<S>(c, t_, states_), o) : S(0.0);
        }
        default: break;
    }
    const Body& b = bodies_[at(o.subject)];
    const PointLaws::Body& law = laws_.body(o.subject);
    if (law.rigid)
        return rbdyn::observed<S>(*law.rigid, *b.state.rigid, Wrench<S>{b.force.force, b.moment}, b.rates, o);
    const CurvePoint<S>& c = b.state.curve;
    switch (o.quantity) {
        case Quantity::position: return laws_.in_world<S>(b.state.r)[o.component];
        case Quantity::velocity: return component(b.state.v, o);
        case Quantity::acceleration: return component(acceleration(b, law), o);
        case Quantity::force: return component(force(b), o);
        case Quantity::reaction:
            if (!b.on_rail) return 0.0;
            return component(acceleration(b, law) * S(law.mass) - force(b), o);
        // in flight: where it left its rail, along which it does not move
        case Quantity::parameter: return law.curve ? parameter(o.subject) : S(0.0);
        case Quantity::speed:
            if (b.on_rail) return sqrt(c.speed_squared) * b.state.w;
            return law.curve ? S(0.0) : length(b.state.v, std::string());
        case Quantity::tangential_force:
            if (!b.on_rail) return 0.0;
            return (dot<S>(c.first, b.state.in_rail(b.force.force)) + b.force.along) / sqrt(c.speed_squared);
        default: return S(0.5 * law.mass) * dot<S>(b.state.v, b.state.v);
    }
}

RBDYN_INLINE Vector3Of<RecordedPoints::S> RecordedPoints::force(const Body& b) {
    Vector3Of<S> f = b.force.force;
    if (!b.force.along.is_zero()) f += b.state.curve.first * (b.force.along / b.state.curve.speed_squared);
    return f;
}

RBDYN_INLINE Vector3Of<RecordedPoints::S> RecordedPoints::acceleration(const Body& b, const PointLaws::Body& law) {
    return b.on_rail ? b.state.acceleration(b.rate) : Vector3Of<S>(force(b) * (S(1.0) / S(law.mass)));
}

RBDYN_INLINE double observed(const PointsNow& now, const Observable& o) {
    const PointLaws& laws = now.laws;
    const auto vector = [&](const Vector3& v) { return v[o.component]; };
    if (o.quantity == Quantity::time) return now.t;
    if (o.quantity == Quantity::length) {
        const auto& c = laws.couplings()[static_cast<std::size_t>(o.subject)];
        const PairState<double> ends = laws.ends<double>(c, now.t, now.states);
        return (ends.ra - ends.rb).norm();
    }
    if (o.quantity == Quantity::coupling_force) return vector(laws.view().axes * now.coupling_force(o.subject));
    if (const auto& body = laws.body(o.subject); body.rigid) {
        const RigidState<double>& s = *now.states[static_cast<std::size_t>(o.subject)].rigid;
        double q_rate[8], v_rate[6];
        Wrench<double> w;
        if (now.acting != nullptr) {
            w = {now.acting->force(o.subject), now.acting->moment(o.subject)};
            laws.rates_of(body, *now.acting, v_rate);
        } else {
            w = laws.wrench<double>(o.subject, now.couplings);
            body.rigid->rates<double>(s, laws.variables_of(body, now.x).q, w, q_rate, v_rate);
        }
        return observed<double>(*body.rigid, s, w, v_rate, o);
    }
    const PointReport r = laws.report(o.subject, now);
    switch (o.quantity) {
        case Quantity::position: return vector(r.position);
        case Quantity::velocity: return vector(r.velocity);
        case Quantity::acceleration: return vector(r.acceleration);
        case Quantity::force: return vector(r.force);
        case Quantity::reaction: return vector(r.reaction);
        case Quantity::parameter: return r.u;
        case Quantity::speed: return r.speed;
        case Quantity::tangential_force: return r.tangential_force;
        default: return 0.5 * laws.body(o.subject).mass * r.velocity.squaredNorm();
    }
}

}  // namespace rbdyn::inline RBDYN_FORM
