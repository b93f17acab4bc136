// The equations of particles as recorded programs, one for each structure: which bodies stick, slip or fly, and on
// which side of every case distinction they are.
//
// What does not move is not in the equations: a bead that sticks to a rail at rest is a parameter, not a variable; what
// stays as it starts is a number (what_stays.hpp).
// Guards: the slip of a bead that slides (reverse), the static limit of one that sticks (slip), the ends of rails, the
// reaction of rails that only push (detach) and the way back (land), watched functions, the case distinctions of
// recorded functions and their switches (normal reactions, speeds under quadratic drag).
#pragma once

#include <algorithm>
#include <map>
#include <memory>
#include <utility>
#include <vector>

#include "rbdyn/model/equations.hpp"
#include "rbdyn/model/point_laws.hpp"
#include "rbdyn/model/point_observables.hpp"
#include "rbdyn/model/projection.hpp"
#include "rbdyn/model/recorded_model.hpp"

namespace rbdyn {

/// What is written beside guards.
struct WrittenPoints {
    std::vector<Expression> rates;  // of all variables
    std::vector<VariableGroup> groups;
    std::vector<Vector3Of<Expression>> forces;  // active ones, by body
    std::vector<Expression> drives;             // of rough rails, by body; none if no drive changes in time
    std::vector<Expression> pulls;              // tangential reactions that rest needs, by body; none if nothing sticks
};

/// Writes what every body does: sticks, slips or flies. `map`: which variables are simulated.
inline WrittenPoints write_points(Recorder& r, EquationsWriter& write, const PointLaws& laws, const StateMap& map,
                                  const std::vector<Scene::Watch>& watches, const std::vector<signed char>& slip) {
    using S = Expression;
    const recording::WideFolding all_digits;
    const auto at = [](int i) { return static_cast<std::size_t>(i); };
    const int n = laws.positions(), count = static_cast<int>(laws.bodies().size());
    if (laws.takes_numbers()) r.parameter(2 * count - 1);
    const S t = r.time();
    const auto held = [&](int i) { return laws.body(i).rough && slip[at(i)] == sticks; };
    const auto constant_start = [&](int i) {
        const DoubleDouble x = map.exact_start(i);
        return x.lo == 0.0 ? S(x.hi) : S(x);
    };
    const auto variable = [&](int i) { return map.is_simulated(i) ? r.input(map.place(i)) : constant_start(i); };
    // a bead that sticks to a rail at rest does not move: its coordinate is a parameter
    std::vector<S> q(at(n)), v(at(laws.variables() - n)), rates(at(laws.variables()), S(0.0));
    std::vector<bool> fixed(at(count), false);
    for (int i = 0; i < count; ++i) {
        const PointLaws::Body& b = laws.body(i);
        fixed[at(i)] = held(i) && b.drive.is_zero();
        for (int k = 0; k < b.positions(); ++k) {
            const bool is_still = fixed[at(i)] && k == 0;
            q[at(b.first + k)] = is_still ? r.parameter(count + i) : variable(b.first + k);
        }
        for (int k = 0; k < b.velocities(); ++k) {
            const bool is_still = fixed[at(i)] && k == 0;
            v[at(b.first_rate - n + k)] = is_still ? S(0.0) : variable(b.first_rate + k);
        }
        // the spin of a body whose frame follows its axis does not change
        if (b.rigid && b.rigid->follows_axis && map.is_simulated(b.fixed_variable()))
            v[at(b.fixed_variable() - n)] = r.parameter(count + i);
    }
    std::vector<PointState<S>> states;
    for (int i = 0; i < count; ++i) {
        const PointLaws::Body& b = laws.body(i);
        r.set_subject(i);
        states.push_back(laws.moving<S>(b, t, &q[at(b.first)], &v[at(b.first_rate - n)], slip[at(i)] == flies));
    }
    std::vector<RecordedPoints::Body> present;
    std::vector<S> pulls;
    for (int i = 0; i < count; ++i) {
        const PointLaws::Body& b = laws.body(i);
        const PointState<S>& p = states[at(i)];
        const bool is_flying = slip[at(i)] == flies, slips = b.rough && !held(i) && !is_flying;
        r.set_subject(i);
        if (b.rigid) {
            const Wrench<S> w = laws.wrench<S>(i, t, states);
            b.rigid->rates<S>(*p.rigid, &q[at(b.first)], w, &rates[at(b.first)], &rates[at(b.first_rate)]);
            present.push_back({p, {w.force, S(0.0)}, 0.0, false, w.moment, &rates[at(b.first_rate)]});
            continue;
        }
        const S sign = slips ? r.parameter(i) : S(1.0);
        // with a rail at rest, the sign of the slip is the sign of w
        const auto length_of_w = [&](const S& w) -> S {
            if (w.is_zero()) return 0.0;
            return (slips && b.drive.is_zero() ? sign : locked_sign(w, "speed of " + b.name)) * w;
        };
        const Resultant<S> f = laws.resultant<S>(i, t, states, is_flying, length_of_w);
        if (!b.curve || is_flying) {
            const int space = b.first_of_space();
            for (int k = 0; k < 3; ++k) {
                rates[at(space + k)] = p.v[k];
                rates[at(b.first_of_velocity() + k)] = f.force[k] / S(b.mass);
            }
            if (is_flying && b.side != RailSide::both)
                write.outside({.kind = EventKind::land, .subject = i, .locator = laws.landing(i)});
            if (const auto tips = laws.singular_landing(i); is_flying && tips)
                write.outside({.kind = EventKind::rail_end, .role = GuardRole::stop, .subject = i, .locator = tips});
            present.push_back({p, f, 0.0, false});
            continue;
        }
        const Resultant<S> g = PointLaws::guided(b, p, f);
        const CurvePoint<S>& c = p.curve;
        S rate = 0.0;
        if (!b.rough) {
            rate = PointLaws::sliding_rate<S>(b, c, p.w, g, S(0.0), S(0.0));
        } else if (slips) {
            S across = 0.0;
            if (b.mu_dynamic > 0.0)
                across = length(PointLaws::friction_vector<S>(b, c, p.w, g), "normal reaction on " + b.name, i);
            rate = PointLaws::sliding_rate<S>(b, c, p.w, g, sign, across);
            S slipping = p.w;
            if (!b.drive.is_zero()) slipping = PointLaws::sqrt_of(c.speed_squared) * p.w - b.drive(t);
            write.guard({.kind = EventKind::reverse, .subject = i, .sign_parameter = i, .name = "slip of " + b.name},
                        slipping);
        } else {
            if (!fixed[at(i)]) rate = PointLaws::carried_rate<S>(b, t, c, p.w);
            const S needed = S(b.mass) * (c.speed_squared * rate + c.first_dot_second * (p.w * p.w)) -
                             dot<S>(c.first, g.force) - g.along;
            const Vector3Of<S> across = PointLaws::friction_vector<S>(b, c, p.w, g);
            write.guard({.kind = EventKind::slip, .subject = i, .name = "hold of " + b.name},
                        (S(b.mu_static) * S(b.mu_static)) * dot<S>(across, across) - needed * needed);
            pulls.resize(at(count), S(0.0));
            pulls[at(i)] = needed;
        }
        if (b.side != RailSide::both) {
            const S pressing = dot<S>(b.binormal, PointLaws::friction_vector<S>(b, c, p.w, g));
            if (!PointLaws::is_rounding(pressing, c, g))
                write.decide({.kind = EventKind::detach, .subject = i}, pressing);
        }
        rates[at(b.first)] = p.w;
        rates[at(b.first_rate)] = rate;
        present.push_back({p, f, rate, true});
        if (const auto singularity = laws.singularity(i); singularity && !fixed[at(i)])
            write.outside({.kind = EventKind::singular, .role = GuardRole::stop, .subject = i, .locator = singularity},
                          !p.w.is_zero());
        const Domain domain = b.curve->domain();
        if (!b.curve->closed() && !fixed[at(i)]) {
            const GuardRole role = b.ends == RailEnds::stop ? GuardRole::stop : GuardRole::mode;
            const Guard end{.kind = EventKind::rail_end, .role = role, .subject = i};
            if (std::isfinite(domain.begin)) write.guard(end, q[at(b.first)] - S(domain.begin));
            if (std::isfinite(domain.end)) write.guard(end, S(domain.end) - q[at(b.first)]);
        }
    }
    r.set_subject(-1);
    RecordedPoints now(laws, t, present);
    for (int i = 0; i < count; ++i) now.parameters.push_back(q[at(laws.body(i).first)]);
    for (std::size_t k = 0; k < watches.size(); ++k) {
        const Scene::Watch& w = watches[k];
        const GuardRole role = w.options.action.kind == WatchAction::Kind::record ? GuardRole::record
                               : w.options.action.kind == WatchAction::Kind::stop ? GuardRole::stop
                                                                                  : GuardRole::mode;
        Guard g{.kind = EventKind::watch,
                .role = role,
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
        write.watch(std::move(g), w.function.function()(std::span<const S>(x))[0]);
    }
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
    std::vector<Vector3Of<S>> forces;
    for (const RecordedPoints::Body& b : present) forces.push_back(b.force.force);
    // also of what a rail carries, for a drive may jump
    std::vector<S> drives;
    const auto changes = [](const PointLaws::Body& b) { return b.rough && !b.drive.is_constant(); };
    if (std::any_of(laws.bodies().begin(), laws.bodies().end(), changes))
        for (const PointLaws::Body& b : laws.bodies()) drives.push_back(b.rough ? b.drive(t) : S(0.0));
    return {std::move(rates), std::move(groups), std::move(forces), std::move(drives), std::move(pulls)};
}

/// Equations for what every body does: sticks, slips or flies. None if it cannot slide as decided.
inline std::unique_ptr<Structure> record_points(const std::shared_ptr<const PointLaws>& of,
                                                const std::vector<Scene::Watch>& watches,
                                                const std::vector<signed char>& slip, const RecordedFor& at_state) {
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
    int forces = -1, drives = -1, pulls = -1;
    auto result = written(r, map.size(), decided.sliding, [&](EquationsWriter& write) {
        WrittenPoints points = write_points(r, write, laws, map, watches, slip);
        for (int i = 0; i < map.variables(); ++i) {
            if (map.is_simulated(i))
                write.rate(map.place(i)) = points.rates[at(i)];
            else if (!points.rates[at(i)].is_zero())
                throw Error("a variable that was left out of the state does not stay as it starts");
        }
        forces = drives = pulls = -1;
        const auto put = [&](int& first, const Expression& value) {
            const int output = write.output(value);
            if (first < 0) first = output;
        };
        if (!decided.sliding.empty())
            for (const Vector3Of<Expression>& force : points.forces)
                for (int k = 0; k < 3; ++k) put(forces, force[k]);
        for (const Expression& drive : points.drives) put(drives, drive);
        for (const Expression& pull : points.pulls) put(pulls, pull);
        return points.groups;
    });
    if (!result) return result;
    result->equations.forces = forces;
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

}  // namespace rbdyn
