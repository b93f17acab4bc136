// Definitions of rbdyn/special/bead_law.hpp: a bead's variables and equations.
#pragma once

#include "rbdyn/special/bead_law.hpp"

#include <cmath>
#include <cstddef>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/double_double_functions.hpp"
#include "rbdyn/basics/double_double_vector.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/curve/one_side.hpp"
#include "rbdyn/curve/point.hpp"
#include "rbdyn/expression/elementary.hpp"
#include "rbdyn/expression/expression.hpp"
#include "rbdyn/expression/phases.hpp"
#include "rbdyn/expression/recorder.hpp"
#include "rbdyn/model/equations.hpp"
#include "rbdyn/model/equations_writer.hpp"
#include "rbdyn/model/rail_landing.hpp"
#include "rbdyn/model/rail_singular.hpp"
#include "rbdyn/model/state_map.hpp"
#include "rbdyn/scene/couplings.hpp"
#include "rbdyn/scene/joints.hpp"
#include "rbdyn/scene/scene.hpp"
#include "rbdyn/scene/watch.hpp"
#include "rbdyn/special/bead_state.hpp"
#include "rbdyn/special/laws_now.hpp"
#include "rbdyn/special/single_laws.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE BeadLaw::BeadLaw(const Scene::Body& b, int place, const SceneView& view)
    : PointLaw(b, place, view), curve_(b.rail()->curve()) {
    const Rail& rail = *b.rail();
    side_ = rail.side();
    ends_ = rail.ends();
    may_fly_ = rail.may_release();
    if (const auto friction = rail.friction()) {
        rough_ = true;
        mu_static_ = friction->mu_static;
        mu_dynamic_ = friction->dynamic();
    }
}

RBDYN_INLINE std::unique_ptr<SingleLaw> BeadLaw::copy() const { return std::make_unique<BeadLaw>(*this); }

RBDYN_INLINE void BeadLaw::take_start(const Scene::Body& b) {
    if (only_pushes()) {
        one_side_ = curves::one_side(curve_, b.parameter, b.rail()->up(), b.name);
        if (side_ == RailSide::minus) one_side_->sign = -one_side_->sign;
        binormal_ = view_.seen(one_side_->binormal());
    }
    start_u_ = {b.parameter, b.parameter_rest};
    start_speed_ = b.speed;
    start_rate_ = DoubleDouble(start_speed_) / sqrt(curve_.at<DoubleDouble>(start_u_, view_).speed_squared);
}

RBDYN_INLINE void BeadLaw::take_loads(const Scene& scene, const std::vector<int>& own) {
    PointLaw::take_loads(scene, own);
    const Rail& rail = *scene.bodies()[static_cast<std::size_t>(index)].rail();
    drive_ = with_small_phases(rail.drive());
    motion_ = rail.motion();
}

RBDYN_INLINE void BeadLaw::take_map(const StateMap& map) {
    landing_ = nullptr;
    singularity_ = nullptr;
    singular_landing_ = nullptr;
    if (one_side_)
        landing_ = std::make_shared<const RailLanding>(curve_, *one_side_, view_, map.place(first),
                                                       map.place(first_of_space()), map.place(first_of_velocity()));
    if (curve_.always_regular()) return;
    if (one_side_)
        singular_landing_ =
            std::make_shared<const SingularLanding>(curve_, start_u_.hi, view_, map.place(first_of_space()));
    if (map.is_simulated(first))
        singularity_ =
            std::make_shared<const RailSingularity>(curve_, start_u_.hi, map.place(first), map.place(first_rate));
}

RBDYN_INLINE bool BeadLaw::sets_view(const Scene& scene) const {
    return scene.bodies().size() == 1 && curve_.straight();
}

RBDYN_INLINE bool BeadLaw::takes_numbers(const StateMap& /*map*/) const { return rough_; }

RBDYN_INLINE std::vector<VariableGroup> BeadLaw::groups(bool of_positions) const {
    const Alike alike = of_positions ? Alike::place : Alike::velocity;
    // one of the parameter is |r'| metres
    std::vector<VariableGroup> result{
        {0, 1, of_positions, 0.0, alike, std::sqrt(curve_point(start_u_.hi).speed_squared)}};
    if (may_fly_) result.push_back({1, 3, of_positions, 0.0, alike});
    return result;
}

RBDYN_INLINE void BeadLaw::start(double t, DoubleDouble* q, DoubleDouble* v) const {
    *q = start_u_;
    *v = start_rate_;
    if (!may_fly_) return;
    const double u = q->hi, w = v->hi;
    const BeadState<double> p = moving<double>(t, &u, &w, false);
    for (int i = 0; i < 3; ++i) q[1 + i] = p.r[i];
}

RBDYN_INLINE void BeadLaw::keep_in(std::vector<bool>& stays) const {
    if (!rough_ && !may_fly_) return;
    for (int k = 0; k < positions(); ++k)
        stays[static_cast<std::size_t>(first + k)] = stays[static_cast<std::size_t>(first_rate + k)] = false;
}

template <class T>
BeadState<T> BeadLaw::moving(const T& t, const T* q, const T* v, bool is_flying) const {
    if (is_flying) return {Vector3Of<T>(q[1], q[2], q[3]), Vector3Of<T>(v[1], v[2], v[3])};
    std::shared_ptr<const RailFrame<T>> frame;
    if (motion_.present()) frame = std::make_shared<const RailFrame<T>>(motion_, t, view_);
    return {curve_.at<T>(*q, view_), *v, std::move(frame)};
}

RBDYN_INLINE void BeadLaw::add_state(SingleStates<double>& states, double t, const double* q, const double* v,
                                     signed char phase) const {
    auto& p = states.add<BeadState<double>>(moving<double>(t, q, v, phase == flies));
    // held by its rail: the rail's own speed, exactly
    if (sticks_in(phase)) p.set_rate(drive_(t) / std::sqrt(p.curve.speed_squared));
}

RBDYN_INLINE void BeadLaw::add_state(SingleStates<S>& states, const S& t, const S* q, const S* v,
                                     signed char phase) const {
    states.add<BeadState<S>>(moving<S>(t, q, v, phase == flies));
}

RBDYN_INLINE signed char BeadLaw::kind(signed char phase) const {
    return phase == flies || sticks_in(phase) ? phase : static_cast<signed char>(1);
}

template <class T, class Length>
BeadLaw::Resultant<T> BeadLaw::applied(const T& t, const BeadState<T>& p, bool is_flying, Length&& length_of_w) const {
    using std::sqrt;
    if (is_flying || p.frame) return {forces_in_space<T>(t, p), T(0.0)};
    Resultant<T> f{forces<T>(t, p), T(0.0)};
    if (!drags_.empty())
        f.along -=
            resistance<T>(drags_,
                          [&](const T& factor) { return T(factor * sqrt(p.curve.speed_squared) * length_of_w(p.w)); }) *
            p.w * p.curve.speed_squared;
    return f;
}

template <class T>
BeadLaw::Resultant<T> BeadLaw::guided(const BeadState<T>& p, const Resultant<T>& f) const {
    if (!p.frame) return f;
    return {p.in_rail(f.force - p.transport() * T(mass)), f.along};
}

template <class T>
Vector3Of<T> BeadLaw::friction_vector(const BeadState<T>& p, const Resultant<T>& f) const {
    return p.curve.first_cross_second * (T(mass) * (p.w * p.w)) - cross<T>(p.curve.first, f.force);
}

template <class T>
T BeadLaw::sliding_rate(const BeadState<T>& p, const Resultant<T>& f, const T& sign, const T& across) const {
    const CurvePoint<T>& c = p.curve;
    T along = dot<T>(c.first, f.force) + f.along;
    if (rough_ && mu_dynamic_ > 0.0) along -= T(mu_dynamic_) * sign * across;
    return (along / T(mass) - c.first_dot_second * (p.w * p.w)) / c.speed_squared;
}

template <class T>
T BeadLaw::carried_rate(const T& t, const BeadState<T>& p) const {
    using std::sqrt;
    const T norm = sqrt(p.curve.speed_squared);
    return (drive_.template rate<T>(t) - p.curve.first_dot_second * (p.w * p.w) / norm) / norm;
}

template <class T>
T BeadLaw::tangential(const BeadState<T>& p, const Resultant<T>& f, const T& rate) const {
    const CurvePoint<T>& c = p.curve;
    return T(mass) * (c.speed_squared * rate + c.first_dot_second * (p.w * p.w)) - dot<T>(c.first, f.force) - f.along;
}

RBDYN_INLINE void BeadLaw::lay_down(RecordedBody& present, const CouplingForces<S>& coupled, S* q_rate,
                                    S* v_rate) const {
    const auto& p = own<BeadState<S>>(*present.state);
    const bool is_flying = present.phase == flies, slips = slips_in(present.phase);
    const S sign = slips ? present.recorder->parameter(index) : S(1.0);
    // with a rail at rest, the sign of the slip is the sign of w
    const auto length_of_w = [&](const S& w) -> S {
        if (w.is_zero()) return 0.0;
        return (slips && drive_.is_zero() ? sign : locked_sign(w, "speed of " + name)) * w;
    };
    Resultant<S> f = applied<S>(coupled.time(), p, is_flying, length_of_w);
    add_couplings<S>(f.force, coupled);
    present.force = f.force;
    present.along = f.along;
    if (is_flying) return lay_down_in_space(present, q_rate + 1, v_rate + 1);
    const Resultant<S> g = guided<S>(p, f);
    S rate = 0.0;
    if (!rough_) {
        rate = sliding_rate<S>(p, g, S(0.0), S(0.0));
    } else if (slips) {
        S across = 0.0;
        if (mu_dynamic_ > 0.0) across = length(friction_vector<S>(p, g), "normal reaction on " + name, index);
        rate = sliding_rate<S>(p, g, sign, across);
    } else if (!is_held(present.phase)) {
        rate = carried_rate<S>(coupled.time(), p);
    }
    *q_rate = p.w;
    *v_rate = rate;
}

RBDYN_INLINE BeadLaw::S BeadLaw::pull(const RecordedBody& present) const {
    const auto& p = own<BeadState<S>>(*present.state);
    return tangential<S>(p, guided<S>(p, acting(present)), present.rates[0]);
}

RBDYN_INLINE void BeadLaw::guard(EquationsWriter& write, const RecordedBody& present, const S& t) const {
    if (present.phase == flies) {
        if (only_pushes()) write.outside({.kind = EventKind::land, .subject = index, .locator = landing_});
        if (singular_landing_)
            write.outside(
                {.kind = EventKind::rail_end, .role = GuardRole::stop, .subject = index, .locator = singular_landing_});
        return;
    }
    const auto& p = own<BeadState<S>>(*present.state);
    const Resultant<S> g = guided<S>(p, acting(present));
    if (slips_in(present.phase)) {
        S slipping = p.w;
        if (!drive_.is_zero()) slipping = sqrt(p.curve.speed_squared) * p.w - drive_(t);
        write.guard({.kind = EventKind::reverse, .subject = index, .sign_parameter = index, .name = "slip of " + name},
                    slipping);
    } else if (rough_) {
        const S needed = pull(present);
        const Vector3Of<S> across = friction_vector<S>(p, g);
        write.guard({.kind = EventKind::slip, .subject = index, .name = "hold of " + name},
                    (S(mu_static_) * S(mu_static_)) * dot<S>(across, across) - needed * needed);
    }
    if (only_pushes()) {
        const S pressing = dot<S>(binormal_, friction_vector<S>(p, g));
        if (!is_rounding(pressing, p, g)) write.decide({.kind = EventKind::detach, .subject = index}, pressing);
    }
    const bool is_held_here = is_held(present.phase);
    if (singularity_ && !is_held_here)
        write.outside({.kind = EventKind::singular, .role = GuardRole::stop, .subject = index, .locator = singularity_},
                      !p.w.is_zero());
    const Domain domain = curve_.domain();
    if (curve_.closed() || is_held_here) return;
    const GuardRole role = ends_ == RailEnds::stop ? GuardRole::stop : GuardRole::mode;
    const Guard end{.kind = EventKind::rail_end, .role = role, .subject = index};
    if (std::isfinite(domain.begin)) write.guard(end, present.q[0] - S(domain.begin));
    if (std::isfinite(domain.end)) write.guard(end, S(domain.end) - present.q[0]);
}

RBDYN_INLINE std::shared_ptr<const Locator> BeadLaw::locator(EventKind kind) const {
    if (kind == EventKind::land) return landing_;
    if (kind == EventKind::singular) return singularity_;
    return singular_landing_;
}

RBDYN_INLINE bool BeadLaw::is_rounding(const S& pressing, const BeadState<S>& p, const Resultant<S>& f) {
    if (!pressing.is_constant()) return false;
    const Vector3Of<S>& along = p.curve.first;
    double size = 0.0;
    for (int i = 0; i < 3; ++i)
        for (int k = 0; k < 3; ++k)
            if (i != k && along[i].is_constant() && f.force[k].is_constant())
                size += std::abs(along[i].value() * f.force[k].value());
    return std::abs(pressing.value()) <= 16.0 * std::numeric_limits<double>::epsilon() * size;
}

RBDYN_INLINE Vector3Of<Expression> BeadLaw::force(const RecordedBody& present) {
    const auto& p = own<BeadState<S>>(*present.state);
    Vector3Of<S> f = present.force;
    if (!present.along.is_zero()) f += p.curve.first * (present.along / p.curve.speed_squared);
    return f;
}

RBDYN_INLINE BeadLaw::S BeadLaw::observed(const RecordedBody& present, const Observable& o) const {
    const auto& p = own<BeadState<S>>(*present.state);
    const bool is_flying = present.phase == flies;
    if (o.quantity == Quantity::parameter) return present.q[0];
    // in flight: where it left its rail, along which it does not move
    if (is_flying) return o.quantity == Quantity::speed ? S(0.0) : observed_in_space(present, o);
    const auto acceleration = [&] { return p.acceleration(present.rates[0]); };
    switch (o.quantity) {
        case Quantity::acceleration: return component(acceleration(), o);
        case Quantity::force: return component(force(present), o);
        case Quantity::reaction: return component(acceleration() * S(mass) - force(present), o);
        case Quantity::speed: return sqrt(p.curve.speed_squared) * p.w;
        case Quantity::tangential_force:
            return (dot<S>(p.curve.first, p.in_rail(present.force)) + present.along) / sqrt(p.curve.speed_squared);
        default: return observed_in_space(present, o);
    }
}

}  // namespace rbdyn::inline RBDYN_FORM
