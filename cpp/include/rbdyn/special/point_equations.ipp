// Definitions of rbdyn/special/point_equations.hpp.
#pragma once

#include "rbdyn/special/point_equations.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/double_double_functions.hpp"
#include "rbdyn/basics/error.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/curve/curve.hpp"
#include "rbdyn/curve/point.hpp"
#include "rbdyn/expression/elementary.hpp"
#include "rbdyn/expression/expression.hpp"
#include "rbdyn/expression/function.hpp"
#include "rbdyn/expression/node.hpp"
#include "rbdyn/expression/recorder.hpp"
#include "rbdyn/expression/time_function.hpp"
#include "rbdyn/model/equations.hpp"
#include "rbdyn/model/equations_writer.hpp"
#include "rbdyn/model/hybrid.hpp"
#include "rbdyn/model/recorded_model.hpp"
#include "rbdyn/model/rigid_state.hpp"
#include "rbdyn/model/sliding.hpp"
#include "rbdyn/model/state_map.hpp"
#include "rbdyn/model/watch_role.hpp"
#include "rbdyn/scene/couplings.hpp"
#include "rbdyn/scene/joints.hpp"
#include "rbdyn/scene/loads.hpp"
#include "rbdyn/scene/scene.hpp"
#include "rbdyn/scene/watch.hpp"
#include "rbdyn/special/point_laws.hpp"
#include "rbdyn/special/point_observables.hpp"
#include "rbdyn/special/point_state.hpp"
#include "rbdyn/special/points_now.hpp"
#include "rbdyn/special/projection.hpp"
#include "rbdyn/special/rigid_law.hpp"
#include "rbdyn/special/rigid_loads.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE PointsWriter::PointsWriter(Recorder& r, const PointLaws& laws, const StateMap& map,
                                        const std::vector<signed char>& slip)
    : r_(r), laws_(laws), map_(map), slip_(slip), count_(static_cast<int>(laws.bodies().size())) {
    const recording::WideFolding all_digits;
    const int n = laws.positions();
    if (laws.takes_numbers()) r.parameter(2 * count_ - 1);
    const auto constant_start = [&](int i) {
        const DoubleDouble x = map.exact_start(i);
        return x.lo == 0.0 ? S(x.hi) : S(x);
    };
    const auto variable = [&](int i) { return map.is_simulated(i) ? r.input(map.place(i)) : constant_start(i); };
    // a bead that sticks to a rail at rest does not move: its coordinate is a parameter
    q_.resize(at(n));
    v_.resize(at(laws.variables() - n));
    fixed_.assign(at(count_), false);
    for (int i = 0; i < count_; ++i) {
        const PointLaws::Body& b = laws.body(i);
        fixed_[at(i)] = held(i) && b.drive.is_zero();
        for (int k = 0; k < b.positions(); ++k) {
            const bool is_still = fixed_[at(i)] && k == 0;
            q_[at(b.first + k)] = is_still ? r.parameter(count_ + i) : variable(b.first + k);
        }
        for (int k = 0; k < b.velocities(); ++k) {
            const bool is_still = fixed_[at(i)] && k == 0;
            v_[at(b.first_rate - n + k)] = is_still ? S(0.0) : variable(b.first_rate + k);
        }
        // the spin of a body whose frame follows its axis does not change
        if (b.rigid && b.rigid->follows_axis && map.is_simulated(b.fixed_variable()))
            v_[at(b.fixed_variable() - n)] = r.parameter(count_ + i);
    }
}

RBDYN_INLINE const std::vector<PointsWriter::S>& PointsWriter::lay_down() {
    const recording::WideFolding all_digits;
    const S t = r_.time();
    const int n = laws_.positions();
    rates_.assign(at(laws_.variables()), S(0.0));
    states_.clear();
    present_.clear();
    for (int i = 0; i < count_; ++i) {
        const PointLaws::Body& b = laws_.body(i);
        r_.set_subject(i);
        states_.push_back(laws_.moving<S>(b, t, &q_[at(b.first)], &v_[at(b.first_rate - n)], slip_[at(i)] == flies));
    }
    const CouplingForces<S> couplings(laws_, t, states_);
    for (int i = 0; i < count_; ++i) {
        r_.set_subject(i);
        present_.push_back(lay_down(i, couplings));
    }
    r_.set_subject(-1);
    return rates_;
}

RBDYN_INLINE std::vector<PointsWriter::S> PointsWriter::switched() {
    lay_down();
    std::vector<S> values(at(map_.size()));
    bool is_broken = false;
    for (int i = 0; i < map_.variables(); ++i) {
        const S& rate = rates_[at(i)];
        if (map_.is_simulated(i))
            values[at(map_.place(i))] = rate;
        else if (rate.is_constant() && !std::isfinite(rate.value()) && map_.size() > 0)
            is_broken = true;
        else if (!rate.is_zero())
            throw Error("a variable that was left out of the state does not stay as it starts");
    }
    // a force that is not a number moves what it does not belong to: there is no motion
    if (is_broken) std::fill(values.begin(), values.end(), S(std::numeric_limits<double>::quiet_NaN()));
    const auto put = [&](const Vector3Of<S>& v) { values.insert(values.end(), {v[0], v[1], v[2]}); };
    for (const RecordedPoints::Body& b : present_) {
        put(b.force.force);
        values.push_back(b.force.along);
        put(b.moment);
    }
    distinguishes_ = recording::distinguishes(r_);
    if (!distinguishes_) return values;
    const CouplingForces<S> couplings(laws_, r_.time(), states_);
    for (int k = 0; k < static_cast<int>(laws_.couplings().size()); ++k)
        put(laws_.couplings()[at(k)].present() ? couplings[k] : Vector3Of<S>(S(0.0), S(0.0), S(0.0)));
    const std::size_t first = values.size();
    values.resize(first + at(laws_.loads()), S(0.0));
    for (int i = 0; i < count_; ++i) powers(i, std::span(values).subspan(first));
    return values;
}

RBDYN_INLINE void PointsWriter::take(std::span<const S> values) {
    for (int i = 0; i < map_.variables(); ++i)
        if (map_.is_simulated(i)) rates_[at(i)] = values[at(map_.place(i))];
    std::size_t next = at(map_.size());
    const auto vector = [&] {
        next += 3;
        return Vector3Of<S>(values[next - 3], values[next - 2], values[next - 1]);
    };
    for (int i = 0; i < count_; ++i) {
        RecordedPoints::Body& b = present_[at(i)];
        b.force.force = vector();
        b.force.along = values[next++];
        b.moment = vector();
        if (b.on_rail) b.rate = rates_[at(laws_.body(i).first_rate)];
    }
}

RBDYN_INLINE void PointsWriter::guard(EquationsWriter& write) const {
    for (int i = 0; i < count_; ++i) guard(write, i);
}

RBDYN_INLINE void PointsWriter::watch(EquationsWriter& write, const std::vector<Scene::Watch>& watches) const {
    RecordedPoints now(laws_, r_.time(), states_, present_);
    for (int i = 0; i < count_; ++i) now.parameters.push_back(q_[at(laws_.body(i).first)]);
    for (std::size_t k = 0; k < watches.size(); ++k) {
        const Scene::Watch& w = watches[k];
        Guard g{.kind = EventKind::watch,
                .role = role_of(w.options.action.kind),
                .direction = w.options.direction,
                .name = w.name,
                .watch = static_cast<int>(k)};
        if (!w.function.is_recorded()) {
            // nobody knows what it depends on
            write.outside(std::move(g));
            continue;
        }
        std::vector<S> x;
        for (const Observable& o : w.function.arguments()) x.push_back(now.value(o));
        write.watch(g, w.function.function(), x);
    }
}

RBDYN_INLINE std::vector<PointsWriter::S> PointsWriter::drives() const {
    std::vector<S> result;
    const auto changes = [](const PointLaws::Body& b) { return b.rough && !b.drive.is_constant(); };
    if (std::any_of(laws_.bodies().begin(), laws_.bodies().end(), changes))
        for (const PointLaws::Body& b : laws_.bodies()) result.push_back(b.rough ? b.drive(r_.time()) : S(0.0));
    return result;
}

RBDYN_INLINE std::vector<PointsWriter::S> PointsWriter::pulls() const {
    std::vector<S> result;
    for (int i = 0; i < count_; ++i) {
        if (!laws_.body(i).curve || !held(i)) continue;
        result.resize(at(count_), S(0.0));
        result[at(i)] = pull(i);
    }
    return result;
}

RBDYN_INLINE PointsWriter::S PointsWriter::pull(int i) const {
    const PointLaws::Body& b = laws_.body(i);
    const RecordedPoints::Body& now = present_[at(i)];
    const CurvePoint<S>& c = now.state.curve;
    const Resultant<S> g = PointLaws::guided(b, now.state, now.force);
    return S(b.mass) * (c.speed_squared * now.rate + c.first_dot_second * (now.state.w * now.state.w)) -
           dot<S>(c.first, g.force) - g.along;
}

RBDYN_INLINE RecordedPoints::Body PointsWriter::lay_down(int i, const CouplingForces<S>& couplings) {
    const PointLaws::Body& b = laws_.body(i);
    const PointState<S>& p = states_[at(i)];
    if (b.rigid) {
        const Wrench<S> w = laws_.wrench<S>(i, couplings);
        b.rigid->rates<S>(*p.rigid, &q_[at(b.first)], w, &rates_[at(b.first)], &rates_[at(b.first_rate)]);
        return {p, {w.force, S(0.0)}, 0.0, false, w.moment, &rates_[at(b.first_rate)]};
    }
    const S sign = slips(i) ? r_.parameter(i) : S(1.0);
    // with a rail at rest, the sign of the slip is the sign of w
    const auto length_of_w = [&](const S& w) -> S {
        if (w.is_zero()) return 0.0;
        return (slips(i) && b.drive.is_zero() ? sign : locked_sign(w, "speed of " + b.name)) * w;
    };
    const Resultant<S> f = laws_.resultant<S>(i, couplings, flying(i), length_of_w);
    if (!b.curve || flying(i)) {
        const int space = b.first_of_space();
        for (int k = 0; k < 3; ++k) {
            rates_[at(space + k)] = p.v[k];
            rates_[at(b.first_of_velocity() + k)] = f.force[k] / S(b.mass);
        }
        return {p, f, 0.0, false};
    }
    const Resultant<S> g = PointLaws::guided(b, p, f);
    const CurvePoint<S>& c = p.curve;
    S rate = 0.0;
    if (!b.rough) {
        rate = PointLaws::sliding_rate<S>(b, c, p.w, g, S(0.0), S(0.0));
    } else if (slips(i)) {
        S across = 0.0;
        if (b.mu_dynamic > 0.0)
            across = length(PointLaws::friction_vector<S>(b, c, p.w, g), "normal reaction on " + b.name, i);
        rate = PointLaws::sliding_rate<S>(b, c, p.w, g, sign, across);
    } else if (!fixed_[at(i)]) {
        rate = PointLaws::carried_rate<S>(b, couplings.time(), c, p.w);
    }
    rates_[at(b.first)] = p.w;
    rates_[at(b.first_rate)] = rate;
    return {p, f, rate, true};
}

RBDYN_INLINE void PointsWriter::guard(EquationsWriter& write, int i) const {
    const PointLaws::Body& b = laws_.body(i);
    if (b.rigid || !b.curve) return;
    if (flying(i)) {
        if (b.side != RailSide::both)
            write.outside({.kind = EventKind::land, .subject = i, .locator = laws_.landing(i)});
        if (const auto tips = laws_.singular_landing(i))
            write.outside({.kind = EventKind::rail_end, .role = GuardRole::stop, .subject = i, .locator = tips});
        return;
    }
    const RecordedPoints::Body& now = present_[at(i)];
    const PointState<S>& p = now.state;
    const CurvePoint<S>& c = p.curve;
    const Resultant<S> g = PointLaws::guided(b, p, now.force);
    if (slips(i)) {
        S slipping = p.w;
        if (!b.drive.is_zero()) slipping = PointLaws::sqrt_of(c.speed_squared) * p.w - b.drive(r_.time());
        write.guard({.kind = EventKind::reverse, .subject = i, .sign_parameter = i, .name = "slip of " + b.name},
                    slipping);
    } else if (b.rough) {
        const S needed = pull(i);
        const Vector3Of<S> across = PointLaws::friction_vector<S>(b, c, p.w, g);
        write.guard({.kind = EventKind::slip, .subject = i, .name = "hold of " + b.name},
                    (S(b.mu_static) * S(b.mu_static)) * dot<S>(across, across) - needed * needed);
    }
    if (b.side != RailSide::both) {
        const S pressing = dot<S>(b.binormal, PointLaws::friction_vector<S>(b, c, p.w, g));
        if (!PointLaws::is_rounding(pressing, c, g)) write.decide({.kind = EventKind::detach, .subject = i}, pressing);
    }
    if (const auto singularity = laws_.singularity(i); singularity && !fixed_[at(i)])
        write.outside({.kind = EventKind::singular, .role = GuardRole::stop, .subject = i, .locator = singularity},
                      !p.w.is_zero());
    const Domain domain = b.curve->domain();
    if (b.curve->closed() || fixed_[at(i)]) return;
    const GuardRole role = b.ends == RailEnds::stop ? GuardRole::stop : GuardRole::mode;
    const Guard end{.kind = EventKind::rail_end, .role = role, .subject = i};
    if (std::isfinite(domain.begin)) write.guard(end, q_[at(b.first)] - S(domain.begin));
    if (std::isfinite(domain.end)) write.guard(end, S(domain.end) - q_[at(b.first)]);
}

RBDYN_INLINE void PointsWriter::powers(int i, std::span<S> power) const {
    const PointLaws::Body& b = laws_.body(i);
    const PointState<S>& p = states_[at(i)];
    const S t = r_.time();
    for (std::size_t k = 0; k < b.functions.size(); ++k) {
        const Vector3Of<S> r = laws_.in_world<S>(p.r), v = PointLaws::turned<S>(laws_.view().axes, p.v);
        power[at(b.function_loads[k])] = dot<S>(force_of<S>(b.functions[k], t, r, v), v);
    }
    for (const RigidLoad& load : b.loads) {
        Wrench<S> w;
        add_load(w, *b.rigid, *p.rigid, load, t, b.name);
        power[at(load.index)] = dot<S>(w.force, p.rigid->v) + dot<S>(w.moment, p.rigid->omega);
    }
}

RBDYN_INLINE std::vector<VariableGroup> groups_of(const PointLaws& laws) {
    const StateMap& map = laws.map();
    std::vector<VariableGroup> groups;
    const auto add = [&](const VariableGroup& g) {
        VariableGroup simulated = g;
        simulated.count = 0;
        for (int i = g.first; i < g.first + g.count; ++i) {
            if (!map.is_simulated(i))
                simulated.steady = std::max(simulated.steady, std::abs(map.start(i)));
            else if (simulated.count++ == 0)
                simulated.first = map.place(i);
        }
        if (simulated.count > 0) groups.push_back(simulated);
    };
    for (const bool is_position : {true, false})
        for (const PointLaws::Body& b : laws.bodies()) {
            const int first = is_position ? b.first : b.first_rate;
            if (b.rigid) {
                for (VariableGroup g : b.rigid->groups(is_position)) {
                    g.first += first;
                    add(g);
                }
                continue;
            }
            const Alike alike = is_position ? Alike::place : Alike::velocity;
            // one of the parameter is |r'| metres
            if (b.curve)
                add({first, 1, is_position, 0.0, alike, std::sqrt(laws.curve_point(b, b.start_u.hi).speed_squared)});
            if (!b.curve || b.may_fly) add({first + b.positions() - 3, 3, is_position, 0.0, alike});
        }
    return groups;
}

RBDYN_INLINE std::unique_ptr<Structure> record_points(const std::shared_ptr<const PointLaws>& of,
                                                      const std::vector<Scene::Watch>& watches,
                                                      const std::vector<signed char>& slip,
                                                      const RecordedFor& at_state) {
    const recording::WideFolding all_digits;
    const auto at = [](int i) { return static_cast<std::size_t>(i); };
    Recorder r;
    const PointLaws& laws = *of;
    const int count = static_cast<int>(laws.bodies().size());
    const StateMap& map = laws.map();
    std::vector<double> parameters;
    if (laws.takes_numbers()) parameters.resize(at(2 * count));
    for (int i = 0; i < count && laws.takes_numbers(); ++i) {
        parameters[at(i)] = slip[at(i)];
        parameters[at(count + i)] = map.value(laws.body(i).fixed_variable(), at_state.x);
    }
    const Decisions& decided = at_state.decided;
    r.follow(at_state.t, at_state.x, parameters, decided.forced, decided.sides);
    int drives = -1, pulls = -1;
    PointsWriter points(r, laws, map, slip);
    auto result = written(
        r, map.size(), decided.sliding, [&] { return points.switched(); },
        [&](EquationsWriter& write, std::span<const Expression> values) {
            points.take(values);
            for (int i = 0; i < map.size(); ++i) write.rate(i) = values[at(i)];
            points.guard(write);
            points.watch(write, watches);
            const auto put = [&](int& first, const std::vector<Expression>& all) {
                for (const Expression& value : all) {
                    const int output = write.output(value);
                    if (first < 0) first = output;
                }
            };
            put(drives, points.drives());
            put(pulls, points.pulls());
            if (points.distinguishes()) write.acting(values.subspan(at(map.size())));
            return groups_of(laws);
        });
    if (!result) return result;
    result->equations.drives = drives;
    result->equations.pulls = pulls;
    std::vector<int> held;
    for (int i = 0; i < count; ++i)
        if (laws.is_conservative(i) && laws.turns(i)) held.push_back(i);
    if (!held.empty())
        result->equations.projection = [of, held](std::span<const double> state, std::span<const double> rest) {
            std::vector<double> x(static_cast<std::size_t>(of->variables())), low(x.size());
            of->map().spread(state, x);
            of->map().spread_zero(rest, low);
            std::vector<std::unique_ptr<const Projection>> parts;
            for (const int i : held) {
                const PointLaws::Body& b = of->body(i);
                if (b.rigid->turns_freely())
                    parts.push_back(std::make_unique<RigidProjection>(*b.rigid, b.first, b.first_rate, x, low));
                else
                    parts.push_back(std::make_unique<HingeProjection>(*b.rigid, b.first, b.first_rate, x, low));
            }
            return std::make_unique<const Projections>(of->map(), std::move(parts));
        };
    return result;
}

}  // namespace rbdyn::inline RBDYN_FORM
