// Definitions of rbdyn/special/point_laws.hpp.
#pragma once

#include "rbdyn/special/point_laws.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <variant>
#include <vector>

#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/double_double_functions.hpp"
#include "rbdyn/basics/double_double_vector.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/curve/axes.hpp"
#include "rbdyn/curve/curve.hpp"
#include "rbdyn/curve/one_side.hpp"
#include "rbdyn/curve/point.hpp"
#include "rbdyn/expression/given.hpp"
#include "rbdyn/expression/node.hpp"
#include "rbdyn/expression/numbers.hpp"
#include "rbdyn/expression/time_function.hpp"
#include "rbdyn/model/acting.hpp"
#include "rbdyn/model/hybrid.hpp"
#include "rbdyn/model/rail_landing.hpp"
#include "rbdyn/model/rail_singular.hpp"
#include "rbdyn/model/rigid_state.hpp"
#include "rbdyn/model/state_map.hpp"
#include "rbdyn/rotation/attitude.hpp"
#include "rbdyn/scene/couplings.hpp"
#include "rbdyn/scene/handles.hpp"
#include "rbdyn/scene/joints.hpp"
#include "rbdyn/scene/loads.hpp"
#include "rbdyn/scene/rigid_motion.hpp"
#include "rbdyn/scene/scene.hpp"
#include "rbdyn/special/point_state.hpp"
#include "rbdyn/special/points_now.hpp"
#include "rbdyn/special/rigid_law.hpp"
#include "rbdyn/special/rigid_loads.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE PointLaws::PointLaws(const Scene& scene, const Placement& view) : view_(view) {
    const auto& bodies = scene.bodies();
    int position = 0;
    for (const Scene::Body& b : bodies) {
        Body body;
        body.mass = b.mass();
        body.name = b.name;
        if (b.rigid() != nullptr) body.rigid.emplace(scene, static_cast<int>(bodies_.size()));
        if (const Rail* rail = b.rail()) {
            body.curve = rail->curve();
            body.side = rail->side();
            body.ends = rail->ends();
            body.may_fly = rail->may_release();
            if (const auto friction = rail->friction()) {
                body.rough = true;
                body.mu_static = friction->mu_static;
                body.mu_dynamic = friction->dynamic();
            }
        }
        body.first = position;
        position += body.positions();
        bodies_.push_back(std::move(body));
    }
    take_starts(scene);
    positions_ = variables_ = position;
    for (Body& b : bodies_) {
        b.first_rate = variables_;
        variables_ += b.velocities();
    }
    take_functions(scene);
    for (const Scene::Connection& c : scene.connections()) couplings_.push_back({c.coupling, end(c.a), end(c.b)});
    take_couplings(scene);
    leave_out(std::vector<bool>(at(variables_), false));
}

RBDYN_INLINE void PointLaws::take_starts(const Scene& scene) {
    for (std::size_t i = 0; i < bodies_.size(); ++i) {
        const Scene::Body& b = scene.bodies()[i];
        Body& body = bodies_[i];
        if (body.rigid) {
            body.rigid->start(b, body.start_positions, body.start_velocities);
            body.start_angles = b.attitude.given_angles();
        }
        if (body.side != RailSide::both) {
            body.one_side = curves::one_side(*body.curve, b.parameter, b.rail()->up(), b.name);
            if (body.side == RailSide::minus) body.one_side->sign = -body.one_side->sign;
            body.binormal = seen(body.one_side->binormal());
        }
        body.start_u = {b.parameter, b.parameter_rest};
        body.start_speed = b.speed;
        body.start_position = b.position;
        body.start_velocity = b.velocity;
    }
}

RBDYN_INLINE void PointLaws::take_functions(const Scene& scene) {
    for (std::size_t i = 0; i < bodies_.size(); ++i) {
        Body& body = bodies_[i];
        body.force = seen_exactly(scene.gravity()) * DoubleDouble(body.mass);
        body.drags.clear();
        body.functions.clear();
        body.function_loads.clear();
        body.loads.clear();
        if (const Rail* rail = scene.bodies()[i].rail()) {
            body.drive = rail->drive();
            body.motion = rail->motion();
        }
    }
    loads_ = static_cast<int>(scene.loads().size());
    for (int index = 0; index < loads_; ++index) {
        const Scene::AppliedLoad& load = scene.loads()[at(index)];
        Body& body = bodies_[at(load.body)];
        const auto keep_as_function = [&] {
            body.functions.push_back(load.load);
            body.function_loads.push_back(index);
        };
        if (body.rigid) {
            const auto point = load.at ? body.rigid->point_in_frame(*load.at) : body.rigid->exact.center;
            if (is_present(load.load)) body.loads.push_back({load.load, point, index});
        } else if (const Force* force = std::get_if<Force>(&load.load)) {
            // along a line the view follows the forces
            const bool is_seen_along = scene.bodies().size() == 1 && body.curve && body.curve->straight();
            if (force->is_constant() && (is_seen_along || !force->is_of_numbers()))
                body.force += seen_exactly(force->settled());
            else
                keep_as_function();
        } else if (const Drag* drag = std::get_if<Drag>(&load.load)) {
            if (drag->present()) body.drags.push_back(*drag);
        } else if (const Lorentz* lorentz = std::get_if<Lorentz>(&load.load);
                   lorentz == nullptr || lorentz->present()) {
            keep_as_function();
        }
    }
    for (Body& body : bodies_) body.force = snapped(body.force, rounded(body.force).norm());
    if (!couplings_.empty()) take_couplings(scene);
}

RBDYN_INLINE void PointLaws::take_couplings(const Scene& scene) {
    for (Body& b : bodies_) b.couplings.clear();
    for (std::size_t k = 0; k < couplings_.size(); ++k) {
        Connected& c = couplings_[k];
        c.coupling = scene.connections()[k].coupling;
        if (c.a.body >= 0 && c.b.body >= 0)
            c.masses = DoubleDouble(bodies_[at(c.a.body)].mass) * DoubleDouble(bodies_[at(c.b.body)].mass);
        if (!c.present()) continue;
        if (c.a.body >= 0) bodies_[at(c.a.body)].couplings.push_back(static_cast<int>(k));
        if (c.b.body >= 0 && c.b.body != c.a.body) bodies_[at(c.b.body)].couplings.push_back(static_cast<int>(k));
    }
}

RBDYN_INLINE void PointLaws::leave_out(const std::vector<bool>& stays) {
    const std::vector<double> rest = start_rest();
    map_ = StateMap(start(), stays, rest);
    landings_.assign(bodies_.size(), nullptr);
    singularities_.assign(bodies_.size(), nullptr);
    singular_landings_.assign(bodies_.size(), nullptr);
    for (std::size_t i = 0; i < bodies_.size(); ++i) {
        const Body& b = bodies_[i];
        if (b.one_side)
            landings_[i] =
                std::make_shared<const RailLanding>(*b.curve, *b.one_side, view_, map_.place(b.first),
                                                    map_.place(b.first_of_space()), map_.place(b.first_of_velocity()));
        if (b.one_side && !b.curve->always_regular())
            singular_landings_[i] =
                std::make_shared<const SingularLanding>(*b.curve, b.start_u.hi, view_, map_.place(b.first_of_space()));
        if (b.curve && !b.curve->always_regular() && map_.is_simulated(b.first))
            singularities_[i] = std::make_shared<const RailSingularity>(*b.curve, b.start_u.hi, map_.place(b.first),
                                                                        map_.place(b.first_rate));
    }
}

RBDYN_INLINE PointLaws::Variables PointLaws::variables_of(const Body& b, std::span<const double> x) const {
    Variables own;
    for (int k = 0; k < b.positions(); ++k) own.q[k] = map_.value(b.first + k, x);
    for (int k = 0; k < b.velocities(); ++k) own.v[k] = map_.value(b.first_rate + k, x);
    return own;
}

RBDYN_INLINE std::vector<DoubleDouble> PointLaws::exact_start(double t) const {
    std::vector<DoubleDouble> x(at(variables_), 0.0);
    for (const Body& b : bodies_) {
        DoubleDouble* q = x.data() + b.first;
        DoubleDouble* v = x.data() + b.first_rate;
        if (b.rigid) {
            std::copy(b.start_positions, b.start_positions + b.positions(), q);
            std::copy(b.start_velocities, b.start_velocities + b.velocities(), v);
            continue;
        }
        if (b.curve) {
            *q = b.start_u;
            *v = DoubleDouble(b.start_speed) / sqrt(b.curve->at<DoubleDouble>(b.start_u, view_).speed_squared);
            if (b.may_fly) {
                const double u = q->hi, w = v->hi;
                const PointState<double> p = moving<double>(b, t, &u, &w, false);
                for (int i = 0; i < 3; ++i) q[1 + i] = p.r[i];
            }
            continue;
        }
        const Vector3Of<DoubleDouble> r = seen_point(b.start_position), vel = seen_exactly(b.start_velocity);
        for (int i = 0; i < 3; ++i) {
            q[i] = r[i];
            v[i] = vel[i];
        }
    }
    return x;
}

RBDYN_INLINE std::vector<double> PointLaws::start(double t) const {
    std::vector<double> x;
    for (const DoubleDouble& d : exact_start(t)) x.push_back(d.hi);
    return x;
}

RBDYN_INLINE std::vector<double> PointLaws::start_rest(double t) const {
    std::vector<double> rest;
    for (const DoubleDouble& d : exact_start(t)) rest.push_back(std::isfinite(d.lo) ? d.lo : 0.0);
    const bool is_exact = std::all_of(rest.begin(), rest.end(), [](double r) { return r == 0.0; });
    return is_exact ? std::vector<double>() : rest;
}

RBDYN_INLINE std::vector<PointState<double>> PointLaws::states(double t, std::span<const double> x,
                                                               std::span<const signed char> slip) const {
    std::vector<PointState<double>> result;
    result.reserve(bodies_.size());
    for (std::size_t i = 0; i < bodies_.size(); ++i) {
        const Body& b = bodies_[i];
        const Variables own = variables_of(b, x);
        result.push_back(moving<double>(b, t, own.q, own.v, slip[i] == flies));
        // held by its rail: the rail's own speed, exactly
        if (b.rough && slip[i] == sticks)
            result.back().set_rate(b.drive(t) / std::sqrt(result.back().curve.speed_squared));
    }
    return result;
}

RBDYN_INLINE PointReport PointLaws::report(int index, std::span<const signed char> slip, double t,
                                           std::span<const double> x) const {
    return report(index, PointsNow(*this, slip, t, x));
}

RBDYN_INLINE PointReport PointLaws::report(int index, const PointsNow& now) const {
    const Body& b = bodies_[at(index)];
    const double t = now.t;
    const std::span<const double> x = now.x;
    const Acting* const acting = now.acting;
    const signed char phase = now.slip[at(index)];
    const PointState<double>& p = now.states[at(index)];
    PointReport result;
    if (b.rigid) {
        const RigidReport r = rigid_report(index, now);
        result.position = p.r;
        result.velocity = p.v;
        result.acceleration = r.center_acceleration;
        result.force = r.force;
        result.reaction = r.reaction;
        result.speed = p.v.norm();
        result.effort = r.force_effort;
        result.spin_momentum = r.spin_momentum;
        result.spin_energy = r.spin_energy;
        result.spin_power = r.spin_power;
        return result;
    }
    const auto size = [](double w) { return std::abs(w); };
    Resultant<double> own, f;
    if (acting != nullptr) {
        own = f = {acting->force(index), acting->along(index)};
        for (const int k : b.couplings) own.force -= now.force_on(index, k);
    } else {
        own = applied<double>(index, t, p, phase == flies, size);
        f = with_couplings<double>(index, own, now.couplings);
    }
    Vector3 force = f.force, acceleration, reaction = Vector3::Zero();
    result.applied = own.force;
    if (!b.curve || phase == flies) {
        acceleration = force / b.mass;
        if (b.curve)
            result.u = map_.value(b.first, x);
        else
            result.speed = p.v.norm();
    } else {
        const CurvePoint<double>& c = p.curve;
        const bool stuck = b.rough && phase == sticks;
        if (f.along != 0.0) {
            force += c.first * (f.along / c.speed_squared);
            result.applied += c.first * (f.along / c.speed_squared);
        }
        const Resultant<double> g = guided(b, p, f);
        const double w_rate = acting != nullptr ? rate_of(b.first_rate, *acting)
                              : stuck           ? carried_rate<double>(b, t, c, p.w)
                                                : sliding_rate<double>(b, c, p.w, g, static_cast<double>(phase),
                                                             friction_vector<double>(b, c, p.w, g).norm());
        acceleration = p.acceleration(w_rate);
        reaction = acceleration * b.mass - force;
        const double norm = std::sqrt(c.speed_squared);
        result.rail_speed = b.rough ? b.drive(t) : 0.0;
        const double turn = result.rail_speed / norm;
        result.effort =
            force.norm() + b.mass * (acceleration.norm() + turn * turn * c.first_cross_second.norm() / norm);
        result.u = map_.value(b.first, x);
        result.w = p.w;
        result.w_rate = w_rate;
        result.speed = stuck ? b.drive(t) : p.w * norm;
        result.tangential_force = (dot<double>(c.first, p.in_rail(f.force)) + f.along) / norm;
    }
    result.position = view_.origin + view_.axes * p.r;
    result.velocity = view_.axes * p.v;
    result.acceleration = view_.axes * acceleration;
    result.force = view_.axes * force;
    result.applied = view_.axes * result.applied;
    result.reaction = view_.axes * reaction;
    return result;
}

RBDYN_INLINE RigidReport PointLaws::rigid_report(int index, const PointsNow& now) const {
    const Body& b = bodies_[at(index)];
    const RigidState<double>& s = *now.states[at(index)].rigid;
    if (now.acting == nullptr)
        return rbdyn::rigid_report(*b.rigid, s, wrench<double>(index, now.couplings), variables_of(b, now.x).q);
    double v_rate[6];
    rates_of(b, *now.acting, v_rate);
    return rigid_report_of_rates(*b.rigid, s, {now.acting->force(index), now.acting->moment(index)}, v_rate);
}

RBDYN_INLINE RigidReport PointLaws::rigid_report(int index, std::span<const signed char> slip, double t,
                                                 std::span<const double> x) const {
    return rigid_report(index, PointsNow(*this, slip, t, x));
}

RBDYN_INLINE void PointLaws::rates_of(const Body& b, const Acting& acting, double* v_rate) const {
    for (int k = 0; k < b.velocities(); ++k) v_rate[k] = rate_of(b.first_rate + k, acting);
}

RBDYN_INLINE Matrix3 PointLaws::rail_turn(int index, double t) const {
    const RigidMotion& motion = bodies_[at(index)].motion;
    if (!motion.present()) return Matrix3::Identity();
    const RigidPlacement<double> p = motion.at(t);
    Matrix3 r;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) r(i, j) = p.row[at(i)][j];
    return r;
}

RBDYN_INLINE bool PointLaws::is_conservative(int index) const {
    const Body& b = bodies_[at(index)];
    return b.rigid && b.rigid->kind != RigidLaw::Kind::prismatic && b.loads.empty() && b.couplings.empty();
}

RBDYN_INLINE bool PointLaws::takes_numbers() const {
    return std::any_of(bodies_.begin(), bodies_.end(), [&](const Body& b) {
        return b.rough || (b.rigid && b.rigid->follows_axis && map_.is_simulated(b.fixed_variable()));
    });
}

RBDYN_INLINE bool PointLaws::turns(int index) const {
    const Body& b = bodies_[at(index)];
    if (!b.rigid || b.rigid->kind == RigidLaw::Kind::prismatic) return false;
    for (int k = b.rigid->kind == RigidLaw::Kind::free ? 3 : 0; k < b.positions(); ++k)
        if (map_.is_simulated(b.first + k)) return true;
    return false;
}

RBDYN_INLINE bool PointLaws::moves(int index) const {
    const Body& b = bodies_[at(index)];
    for (int k = 0; k < b.positions(); ++k)
        if (map_.is_simulated(b.first + k)) return true;
    for (int k = 0; k < b.velocities(); ++k)
        if (map_.is_simulated(b.first_rate + k)) return true;
    return false;
}

RBDYN_INLINE bool PointLaws::is_function(const Scene::AppliedLoad& load, int index) const {
    const Body& b = bodies_[at(load.body)];
    return b.rigid ? is_present(load.load)
                   : std::find(b.function_loads.begin(), b.function_loads.end(), index) != b.function_loads.end();
}

RBDYN_INLINE double PointLaws::power(const Scene::AppliedLoad& load, std::span<const signed char> slip, double t,
                                     std::span<const double> x) const {
    const Body& b = bodies_[at(load.body)];
    const PointState<double> p = states(t, x, slip)[at(load.body)];
    if (!b.rigid) {
        const Vector3 v = view_.axes * p.v;
        if (const Drag* drag = std::get_if<Drag>(&load.load)) {
            const double speed = v.norm();
            return -(drag->linear + drag->quadratic * speed) * speed * speed;
        }
        return force_of<double>(load.load, t, in_world<double>(p.r), v).dot(v);
    }
    Wrench<double> w;
    add_load(w, *b.rigid, *p.rigid, {load.load, load.at ? b.rigid->point_in_frame(*load.at) : b.rigid->exact.center}, t,
             b.name);
    return w.force.dot(p.rigid->v) + w.moment.dot(p.rigid->omega);
}

RBDYN_INLINE void PointLaws::slope(int index, const PointsNow& now, std::span<double> dq, std::span<double> dv) const {
    const Body& b = bodies_[at(index)];
    if (b.rigid) {
        b.rigid->rates<double>(*now.states[at(index)].rigid, variables_of(b, now.x).q,
                               wrench<double>(index, now.couplings), dq.data(), dv.data());
        return;
    }
    const PointReport r = report(index, now);
    for (int k = 0; k < b.positions(); ++k) dq[at(k)] = dv[at(k)] = 0.0;
    if (b.curve && now.slip[at(index)] != flies) {
        dq[0] = r.w;
        dv[0] = r.w_rate;
        return;
    }
    const int space = b.first_of_space() - b.first;
    const Vector3 velocity = view_.axes.transpose() * r.velocity,
                  acceleration = view_.axes.transpose() * r.acceleration;
    for (int k = 0; k < 3; ++k) {
        dq[at(space + k)] = velocity[k];
        dv[at(space + k)] = acceleration[k];
    }
}

RBDYN_INLINE Holding PointLaws::holding(int i, double t, std::span<const double> x,
                                        std::span<const signed char> slip) const {
    const Body& b = bodies_[at(i)];
    std::vector<PointState<double>> all = states(t, x, slip);
    PointState<double>& p = all[at(i)];
    p.set_rate(b.drive(t) / std::sqrt(p.curve.speed_squared));
    const CurvePoint<double>& c = p.curve;
    const CouplingForces<double> couplings(*this, t, all);
    const auto f = guided(b, p, resultant<double>(i, couplings, false, [](double v) { return std::abs(v); }));
    const double rate = carried_rate<double>(b, t, c, p.w);
    const double needed =
        b.mass * (c.speed_squared * rate + c.first_dot_second * (p.w * p.w)) - dot<double>(c.first, f.force) - f.along;
    double terms =
        rounded(b.force).norm() + b.mass * (p.acceleration(rate).norm() + c.first_cross_second.norm() * p.w * p.w);
    for (const auto& function : b.functions)
        terms += force_of<double>(function, t, in_world<double>(p.r), view_.axes * p.v).norm();
    for (const Drag& drag : b.drags) terms += (drag.linear.now() + drag.quadratic.now() * p.v.norm()) * p.v.norm();
    for (const int k : b.couplings) {
        const Connected& joined = couplings_[at(k)];
        const double force = couplings[k].norm();
        terms += force + effort_of(joined.coupling, ends<double>(joined, t, all), force);
    }
    return {needed, friction_vector<double>(b, c, p.w, f).norm(), 64.0 * epsilon * std::sqrt(c.speed_squared) * terms};
}

RBDYN_INLINE bool PointLaws::is_rounding(const Expression& pressing, const CurvePoint<Expression>& c,
                                         const Resultant<Expression>& f) {
    if (!pressing.is_constant()) return false;
    double size = 0.0;
    for (int i = 0; i < 3; ++i)
        for (int k = 0; k < 3; ++k)
            if (i != k && c.first[i].is_constant() && f.force[k].is_constant())
                size += std::abs(c.first[i].value() * f.force[k].value());
    return std::abs(pressing.value()) <= 16.0 * epsilon * size;
}

RBDYN_INLINE Vector3Of<DoubleDouble> PointLaws::seen_exactly(const Vector3& v) const {
    return snapped(curves::turned<DoubleDouble>(view_.exact_axes().transpose(), widened(v)), v.norm());
}

RBDYN_INLINE double PointLaws::rate_of(int variable, const Acting& acting) const {
    return map_.is_simulated(variable) ? acting.rate(map_.place(variable)) : 0.0;
}

RBDYN_INLINE Vector3 PointLaws::snapped(Vector3 v, double size) {
    for (int i = 0; i < 3; ++i)
        if (std::abs(v[i]) <= 4.0 * epsilon * size) v[i] = 0.0;
    return v;
}

RBDYN_INLINE Vector3Of<DoubleDouble> PointLaws::snapped(Vector3Of<DoubleDouble> v, double size) {
    for (int i = 0; i < 3; ++i)
        if (std::abs(v[i].hi) <= 4.0 * epsilon * size) v[i] = 0.0;
    return v;
}

RBDYN_INLINE Vector3Of<DoubleDouble> PointLaws::seen_point(const Vector3& p) const {
    const Vector3Of<DoubleDouble> offset = widened(p) - widened(view_.origin);
    return snapped(curves::turned<DoubleDouble>(view_.exact_axes().transpose(), offset),
                   p.norm() + view_.origin.norm());
}

RBDYN_INLINE PointLaws::CouplingEnd PointLaws::end(const End& e) const {
    if (const Vector3* point = std::get_if<Vector3>(&e)) return {-1, seen_point(*point), false};
    const int body = body_of(e);
    const std::optional<RigidLaw>& rigid = bodies_[at(body)].rigid;
    if (!rigid) return {body, {}, false};
    const BodyPoint* point = std::get_if<BodyPoint>(&e);
    return {body, {}, true, point != nullptr ? rigid->point_in_frame(point->point) : rigid->exact.center};
}

}  // namespace rbdyn::inline RBDYN_FORM
