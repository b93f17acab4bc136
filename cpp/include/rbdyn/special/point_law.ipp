// Definitions of rbdyn/special/point_law.hpp.
#pragma once

#include "rbdyn/special/point_law.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "rbdyn/basics/double_double_vector.hpp"
#include "rbdyn/basics/error.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/expression/elementary.hpp"
#include "rbdyn/expression/expression.hpp"
#include "rbdyn/model/acting.hpp"
#include "rbdyn/scene/couplings.hpp"
#include "rbdyn/scene/loads.hpp"
#include "rbdyn/scene/scene.hpp"
#include "rbdyn/scene/watch.hpp"
#include "rbdyn/special/laws_now.hpp"
#include "rbdyn/special/single_laws.hpp"
#include "rbdyn/special/view.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE void PointLaw::take_loads(const Scene& scene, const std::vector<int>& own) {
    force_ = view_.seen_exactly(scene.gravity()) * DoubleDouble(mass);
    drags_.clear();
    functions_.clear();
    function_loads_.clear();
    for (const int place : own) {
        const Load& load = scene.loads()[static_cast<std::size_t>(place)].load;
        const Force* force = std::get_if<Force>(&load);
        const Drag* drag = std::get_if<Drag>(&load);
        const Lorentz* lorentz = std::get_if<Lorentz>(&load);
        if (force != nullptr && force->is_constant() && (sets_view(scene) || !force->is_of_numbers())) {
            force_ += view_.seen_exactly(force->settled());
        } else if (drag != nullptr) {
            if (drag->present()) drags_.push_back(*drag);
        } else if (lorentz == nullptr || lorentz->present()) {
            functions_.push_back(load);
            function_loads_.push_back(place);
        }
    }
    force_ = SceneView::snapped(force_, rounded(force_).norm());
}

RBDYN_INLINE void PointLaw::powers(const RecordedBody& present, const S& t, std::span<S> power) const {
    for (std::size_t k = 0; k < functions_.size(); ++k) {
        const Vector3Of<S> r = view_.in_world<S>(present.state->r), v = times<S>(view_.axes, present.state->v);
        power[static_cast<std::size_t>(function_loads_[k])] = dot<S>(force_of<S>(functions_[k], t, r, v), v);
    }
}

RBDYN_INLINE bool PointLaw::is_function(const Scene::AppliedLoad& /*load*/, int of_scene) const {
    return std::find(function_loads_.begin(), function_loads_.end(), of_scene) != function_loads_.end();
}

RBDYN_INLINE double PointLaw::power(const Scene::AppliedLoad& load, double t, const SingleState<double>& state) const {
    const Vector3 v = view_.axes * state.v;
    if (const Drag* drag = std::get_if<Drag>(&load.load)) {
        const double speed = v.norm();
        return -(drag->linear + drag->quadratic * speed) * speed * speed;
    }
    return force_of<double>(load.load, t, view_.in_world<double>(state.r), v).dot(v);
}

RBDYN_INLINE PointReport PointLaw::report_in_space(const Applied& f, const SingleState<double>& p) const {
    PointReport r;
    r.applied = f.own;
    r.force = f.all;
    r.acceleration = f.all / mass;
    r.reaction = Vector3::Zero();
    turn_to_world(r, p);
    return r;
}

RBDYN_INLINE void PointLaw::turn_to_world(PointReport& r, const SingleState<double>& p) const {
    r.position = view_.origin + view_.axes * p.r;
    r.velocity = view_.axes * p.v;
    for (Vector3* v : {&r.acceleration, &r.force, &r.applied, &r.reaction}) *v = view_.axes * *v;
}

RBDYN_INLINE void PointLaw::report(const LawsNow& now, Asked asked, BodyReport& r) const {
    if (asked == Asked::motion) return;
    const PointReport own = report(now);
    r.acceleration = own.acceleration;
    r.force = own.force;
    r.applied = own.applied;
    r.reaction = own.reaction;
}

RBDYN_INLINE PointReport PointLaw::observe_motion(const LawsNow& now, std::vector<Observed>& out) const {
    const PointReport r = report(now);
    double effort = r.effort;
    for (const int k : couplings) {
        const SingleLaws::Connected& c = now.laws.coupling(k);
        // what is left of the large terms of a spring is rounding, where it has hardly moved
        if (std::holds_alternative<Spring>(c.coupling))
            effort += effort_of(c.coupling, now.laws.ends<double>(c, now.t, now.states), 0.0);
    }
    out.push_back({r.position, true, 0.0, r.position.norm(), Alike::place});
    out.push_back({r.velocity, false, std::abs(r.rail_speed), r.velocity.norm(), Alike::velocity, 0.0F, effort / mass});
    return r;
}

RBDYN_INLINE void PointLaw::observe(const LawsNow& now, std::vector<Observed>& out) const { observe_motion(now, out); }

RBDYN_INLINE double PointLaw::observed(const LawsNow& now, const Observable& o) const {
    const PointReport r = report(now);
    switch (o.quantity) {
        case Quantity::position: return r.position[o.component];
        case Quantity::velocity: return r.velocity[o.component];
        case Quantity::acceleration: return r.acceleration[o.component];
        case Quantity::force: return r.force[o.component];
        case Quantity::reaction: return r.reaction[o.component];
        case Quantity::parameter: return r.u;
        case Quantity::speed: return r.speed;
        case Quantity::tangential_force: return r.tangential_force;
        default: return 0.5 * mass * r.velocity.squaredNorm();
    }
}

RBDYN_INLINE PointLaw::S PointLaw::observed_in_space(const RecordedBody& present, const Observable& o) const {
    const SingleState<S>& p = *present.state;
    switch (o.quantity) {
        case Quantity::position: return view_.in_world<S>(p.r)[o.component];
        case Quantity::velocity: return component(p.v, o);
        case Quantity::acceleration: return component(Vector3Of<S>(present.force * (S(1.0) / S(mass))), o);
        case Quantity::force: return component(present.force, o);
        case Quantity::reaction:
        case Quantity::parameter:
        case Quantity::tangential_force: return 0.0;
        case Quantity::speed: return length(p.v, std::string());
        default: return S(0.5 * mass) * dot<S>(p.v, p.v);
    }
}

RBDYN_INLINE void PointLaw::lay_down_in_space(const RecordedBody& present, S* q_rate, S* v_rate) const {
    for (int k = 0; k < 3; ++k) {
        q_rate[k] = present.state->v[k];
        v_rate[k] = present.force[k] / S(mass);
    }
}

RBDYN_INLINE void PointLaw::slope_in_space(const LawsNow& now, double* dq, double* dv) const {
    const PointReport r = report(now);
    const Vector3 velocity = view_.axes.transpose() * r.velocity,
                  acceleration = view_.axes.transpose() * r.acceleration;
    for (int k = 0; k < 3; ++k) {
        dq[k] = velocity[k];
        dv[k] = acceleration[k];
    }
}

RBDYN_INLINE void PointLaw::require_words(const StateChange& c, const std::string& user, const std::string& name) {
    for (const std::string& word : c.words())
        if (word != "position" && word != "velocity" && word != "parameter" && word != "speed")
            throw InvalidInput(user + ": its action changes " + word + " of " + name +
                               ", a particle; give position and velocity, three numbers each, or on a rail parameter "
                               "and speed");
}

RBDYN_INLINE void PointLaw::put(double value, const std::string& user, double& x) {
    require(std::isfinite(value), user, "a number its action gives", value, "a state is finite");
    x = value;
}

RBDYN_INLINE void PointLaw::put_in_space(const StateChange& c, const std::string& user, double* q, double* v) const {
    if (c.parameter || c.speed)
        throw InvalidInput(user + ": its action changes parameter or speed of " + name +
                           ", which is free; give position, velocity");
    for (int k = 0; k < 3; ++k) {
        if (c.position) put((view_.axes.transpose() * (*c.position - view_.origin))[k], user, q[k]);
        if (c.velocity) put((view_.axes.transpose() * *c.velocity)[k], user, v[k]);
    }
}

RBDYN_INLINE std::string PointLaw::load_not_finite(const LawsNow& now) const {
    const SingleState<double>& p = now.state(index);
    const Vector3 r = view_.in_world<double>(p.r), v = view_.axes * p.v;
    for (const Load& load : functions_)
        if (const Vector3 f = force_of<double>(load, now.t, r, v); !is_finite(f))
            return title_of(load) + " on " + name + ", which is [" + text(f[0]) + ", " + text(f[1]) + ", " +
                   text(f[2]) + "]";
    return {};
}

RBDYN_INLINE std::string PointLaw::acceleration_not_finite(const LawsNow& now) const {
    if (std::string what = now.coupling_not_finite(couplings); !what.empty()) return what;
    return is_finite(report(now).acceleration) ? std::string() : "the acceleration of " + name;
}

RBDYN_INLINE std::string PointLaw::grown(const LawsNow& was, const LawsNow& is, double beyond) const {
    const auto size = [&](const Load& load, const LawsNow& now) {
        const SingleState<double>& p = now.state(index);
        return force_of<double>(load, now.t, view_.in_world<double>(p.r), view_.axes * p.v).norm();
    };
    for (const Load& load : functions_) {
        const double first_size = size(load, was), last = size(load, is);
        if (last > beyond * first_size && first_size > 0.0)
            return title_of(load) + " on " + name + ", which has grown from " + text(first_size) + " to " + text(last) +
                   " N";
    }
    return {};
}

RBDYN_INLINE PointLaw::Applied PointLaw::applied_in_mode(const LawsNow& now) const {
    Applied f{now.acting->force(index), now.acting->force(index), now.acting->along(index)};
    for (const int k : couplings) f.own -= now.force_on(index, k);
    return f;
}

}  // namespace rbdyn::inline RBDYN_FORM
