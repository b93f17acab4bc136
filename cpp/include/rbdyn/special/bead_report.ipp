// Definitions of rbdyn/special/bead_law.hpp: what is told of a bead in numbers and words, and what changes it.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "rbdyn/basics/double_double_vector.hpp"
#include "rbdyn/basics/error.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/curve/curve.hpp"
#include "rbdyn/curve/point.hpp"
#include "rbdyn/curve/regular_stretch.hpp"
#include "rbdyn/model/acting.hpp"
#include "rbdyn/model/state_map.hpp"
#include "rbdyn/scene/couplings.hpp"
#include "rbdyn/scene/loads.hpp"
#include "rbdyn/scene/scene.hpp"
#include "rbdyn/scene/watch.hpp"
#include "rbdyn/special/bead_law.hpp"
#include "rbdyn/special/bead_state.hpp"
#include "rbdyn/special/body_form.hpp"
#include "rbdyn/special/laws_now.hpp"
#include "rbdyn/special/single_laws.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE PointReport BeadLaw::report(const LawsNow& now) const {
    const signed char phase = now.slip[static_cast<std::size_t>(index)];
    const auto& p = own<BeadState<double>>(now.state(index));
    const auto size = [](double w) { return std::abs(w); };
    Applied f;
    if (now.acting != nullptr) {
        f = applied_in_mode(now);
    } else {
        const Resultant<double> acts = applied<double>(now.t, p, phase == flies, size);
        f = {acts.force, acts.force, acts.along};
        add_couplings<double>(f.all, now.couplings);
    }
    if (phase == flies) {
        PointReport r = report_in_space(f, p);
        r.u = now.laws.map().value(first, now.x);
        return r;
    }
    const CurvePoint<double>& c = p.curve;
    const bool stuck = sticks_in(phase);
    PointReport r;
    Vector3 force = f.all;
    r.applied = f.own;
    if (f.along != 0.0) {
        force += c.first * (f.along / c.speed_squared);
        r.applied += c.first * (f.along / c.speed_squared);
    }
    const Resultant<double> g = guided<double>(p, {f.all, f.along});
    const double w_rate =
        now.acting != nullptr ? now.rate_of(first_rate)
        : stuck               ? carried_rate<double>(now.t, p)
                : sliding_rate<double>(p, g, static_cast<double>(phase), friction_vector<double>(p, g).norm());
    const Vector3 acceleration = p.acceleration(w_rate);
    const double norm = std::sqrt(c.speed_squared);
    r.rail_speed = rough_ ? drive_(now.t) : 0.0;
    const double turn = r.rail_speed / norm;
    r.effort = force.norm() + mass * (acceleration.norm() + turn * turn * c.first_cross_second.norm() / norm);
    r.u = now.laws.map().value(first, now.x);
    r.w = p.w;
    r.w_rate = w_rate;
    r.speed = stuck ? drive_(now.t) : p.w * norm;
    r.tangential_force = (dot<double>(c.first, p.in_rail(f.all)) + f.along) / norm;
    r.acceleration = acceleration;
    r.force = force;
    r.reaction = acceleration * mass - force;
    turn_to_world(r, p);
    return r;
}

RBDYN_INLINE void BeadLaw::report(const LawsNow& now, Asked asked, BodyReport& r) const {
    r.coordinate = now.laws.map().value(first, now.x);
    PointLaw::report(now, asked, r);
}

RBDYN_INLINE void BeadLaw::slope(const LawsNow& now, std::span<double> dq, std::span<double> dv) const {
    std::fill(dq.begin(), dq.end(), 0.0);
    std::fill(dv.begin(), dv.end(), 0.0);
    if (now.slip[static_cast<std::size_t>(index)] == flies) return slope_in_space(now, &dq[1], &dv[1]);
    const PointReport r = report(now);
    dq[0] = r.w;
    dv[0] = r.w_rate;
}

RBDYN_INLINE void BeadLaw::observe(const LawsNow& now, std::vector<Observed>& out) const {
    const PointReport r = observe_motion(now, out);
    out.push_back({r.reaction, false, 0.0, r.effort, Alike::force});
}

RBDYN_INLINE Matrix3 BeadLaw::rail_turn(double t) const {
    if (!motion_.present()) return Matrix3::Identity();
    const RigidPlacement<double> p = motion_.at(t);
    Matrix3 r;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) r(i, j) = p.row[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)];
    return r;
}

RBDYN_INLINE Holding BeadLaw::holding(const SingleLaws& laws, double t, std::span<const double> x,
                                      std::span<const signed char> slip) const {
    constexpr double epsilon = std::numeric_limits<double>::epsilon();
    const SingleStates<double> all = laws.states(t, x, slip);
    auto& p = static_cast<BeadState<double>&>(all[static_cast<std::size_t>(index)]);
    p.set_rate(drive_(t) / std::sqrt(p.curve.speed_squared));
    const CouplingForces<double> coupled(laws, t, all);
    Resultant<double> acts = applied<double>(t, p, false, [](double v) { return std::abs(v); });
    add_couplings<double>(acts.force, coupled);
    const auto f = guided<double>(p, acts);
    const double rate = carried_rate<double>(t, p), needed = tangential<double>(p, f, rate);
    double terms =
        rounded(force_).norm() + mass * (p.acceleration(rate).norm() + p.curve.first_cross_second.norm() * p.w * p.w);
    for (const Load& function : functions_)
        terms += force_of<double>(function, t, view_.in_world<double>(p.r), view_.axes * p.v).norm();
    for (const Drag& drag : drags_) terms += (drag.linear.now() + drag.quadratic.now() * p.v.norm()) * p.v.norm();
    for (const int k : couplings) {
        const SingleLaws::Connected& joined = laws.coupling(k);
        const double size = coupled[k].norm();
        terms += size + effort_of(joined.coupling, laws.ends<double>(joined, t, all), size);
    }
    return {needed, friction_vector<double>(p, f).norm(), 64.0 * epsilon * std::sqrt(p.curve.speed_squared) * terms};
}

RBDYN_INLINE bool BeadLaw::holds_what_touches() const {
    // what differs by rounding is meant to be equal
    return mu_static_ - mu_dynamic_ > 64.0 * std::numeric_limits<double>::epsilon() * mu_static_;
}

RBDYN_INLINE std::optional<double> BeadLaw::change(const StateChange& c, const LawsNow& now, const std::string& user,
                                                   std::span<double> x) const {
    require_words(c, user, name);
    double* const q = x.data() + first;
    double* const v = x.data() + first_rate;
    if (now.slip[static_cast<std::size_t>(index)] == flies) {
        put_in_space(c, user, q + 1, v + 1);
        return std::nullopt;
    }
    if (c.position || c.velocity)
        throw InvalidInput(user + ": its action changes position or velocity of " + name +
                           ", which is on a rail; give parameter, speed");
    const double before = std::sqrt(curve_point(*q).speed_squared) * *v;
    if (c.parameter) {
        const Domain domain = curve_.domain();
        require(curve_.closed() || (*c.parameter >= domain.begin && *c.parameter <= domain.end) ||
                    !std::isfinite(*c.parameter),
                user, "parameter of " + name + " its action gives", *c.parameter,
                "it lies in the domain of its curve, " + text(domain.begin) + " to " + text(domain.end));
        put(*c.parameter, user, *q);
        curve_.require_regular(*c.parameter);
    }
    const double speed = c.speed.value_or(before);
    put(speed / std::sqrt(curve_point(*q).speed_squared), user, *v);
    return rough_ ? std::optional<double>(speed) : std::nullopt;
}

RBDYN_INLINE std::unique_ptr<const BodyForm> BeadLaw::closed_form(const Scene& /*scene*/,
                                                                  const Vector3Of<DoubleDouble>& /*a*/) const {
    return nullptr;
}

RBDYN_INLINE std::string BeadLaw::why_not_linear() const {
    return rough_     ? "the friction of " + name + " is not linear"
           : may_fly_ ? name + " may leave its rail"
                      : std::string();
}

RBDYN_INLINE std::string BeadLaw::coordinates(const StateMap& /*map*/) const {
    return "parameter u of its " + curve_.name();
}

RBDYN_INLINE void BeadLaw::leave_out(const StateMap& map, std::vector<Omission>& omissions) const {
    if (may_fly_)
        omissions.push_back({"no variable of " + name, "it may leave its rail, and then be anywhere"});
    else if (!map.is_simulated(first_rate))
        omissions.push_back(
            {"u' of " + name, "stays at " + text(map.start(first_rate)) + "; a force along its rail brings it in"});
}

RBDYN_INLINE std::string BeadLaw::not_finite(const LawsNow& now) const {
    const SingleState<double>& p = now.state(index);
    const double u = now.laws.map().value(first, now.x);
    if (!is_finite(p.r) || !is_finite(p.v))
        return "the curve or the motion of the rail of " + name + " at u = " + text(u);
    if (std::string what = load_not_finite(now); !what.empty()) return what;
    if (rough_ && !std::isfinite(drive_(now.t))) return "the drive of the rail of " + name;
    if (now.slip[static_cast<std::size_t>(index)] != flies)
        if (std::string what = singular_at(curve_, u); !what.empty())
            return "the rail of " + name + " at u = " + text(u) + ", where " + what;
    return acceleration_not_finite(now);
}

}  // namespace rbdyn::inline RBDYN_FORM
