// The equations of particles as recorded programs, one for each structure: which bodies stick.
//
// What does not move is not in the equations: a bead that sticks to a rail at rest is a parameter, not a variable.
// Guards: the slip of a bead that slides (reverse), the static limit of one that sticks (slip), the ends of rails, and
// the switches of the recorded functions (normal reactions, speeds under quadratic drag).
#pragma once

#include <memory>
#include <vector>

#include "rbdyn/model/equations.hpp"
#include "rbdyn/model/point_laws.hpp"

namespace rbdyn {

/// Equations of one structure. `still`: nothing can move or happen in it.
struct PointStructure {
    Equations equations;
    bool still = false;
};

namespace recording {

inline std::size_t at(int i) { return static_cast<std::size_t>(i); }

/// Whether an expression stays what it is during smooth motion.
inline bool is_constant(const Recorder& r, const Expression& x) {
    if (x.is_constant()) return true;
    std::vector<std::int32_t> todo{x.node()};
    std::vector<bool> seen(at(r.size()), false);
    while (!todo.empty()) {
        const std::int32_t n = todo.back();
        todo.pop_back();
        if (seen[at(n)]) continue;
        seen[at(n)] = true;
        const Node& node = r.node(n);
        if (node.operation == Operation::input || node.operation == Operation::time) return false;
        if (node.operation == Operation::parameter) continue;
        for (std::int32_t operand : {node.a, node.b, node.c})
            if (operand >= 0) todo.push_back(operand);
    }
    return true;
}

}  // namespace recording

/// Equations for the bodies that stick (`held`) and those that do not.
inline std::unique_ptr<PointStructure> record_points(const PointLaws& laws, const std::vector<bool>& held) {
    using S = Expression;
    using recording::at;
    Recorder r;
    const int n = laws.freedoms(), count = static_cast<int>(laws.bodies().size());
    if (count > 0) r.parameter(2 * count - 1);
    const S t = r.time();
    // a bead that sticks to a rail at rest does not move: its coordinate is a parameter
    std::vector<S> q(at(n)), v(at(n));
    std::vector<bool> fixed(at(count), false);
    for (int i = 0; i < count; ++i) {
        const PointLaws::Body& b = laws.body(i);
        fixed[at(i)] = held[at(i)] && b.drive.is_zero();
        for (int k = b.first; k < b.first + b.freedoms(); ++k) {
            q[at(k)] = fixed[at(i)] ? r.parameter(count + i) : r.input(k);
            v[at(k)] = fixed[at(i)] ? S(0.0) : r.input(n + k);
        }
    }
    std::vector<PointState<S>> states;
    for (const PointLaws::Body& b : laws.bodies())
        states.push_back(laws.moving<S>(b, &q[at(b.first)], &v[at(b.first)]));
    std::vector<S> outputs(at(2 * n), S(0.0)), watched;
    std::vector<Guard> guards;
    const auto guard = [&](EventKind kind, GuardRole role, int i, const S& value, int sign, const std::string& name) {
        if (recording::is_constant(r, value)) return;
        guards.push_back({kind, role, i, 2 * n + static_cast<int>(watched.size()), sign, Direction::falling, name});
        watched.push_back(value);
    };
    for (int i = 0; i < count; ++i) {
        const PointLaws::Body& b = laws.body(i);
        const PointState<S>& p = states[at(i)];
        const bool slips = b.rough && !held[at(i)];
        r.set_subject(i);
        const S sign = slips ? r.parameter(i) : S(1.0);
        // with a rail at rest, the sign of the slip is the sign of w
        const auto length_of_w = [&](const S& w) -> S {
            if (w.is_zero()) return 0.0;
            return (slips && b.drive.is_zero() ? sign : locked_sign(w, "speed of " + b.name)) * w;
        };
        const Resultant<S> f = laws.resultant<S>(i, t, states, length_of_w);
        if (!b.curve) {
            for (int k = 0; k < 3; ++k) {
                outputs[at(b.first + k)] = p.v[k];
                outputs[at(n + b.first + k)] = f.force[k] / S(b.mass);
            }
            continue;
        }
        const CurvePoint<S>& c = p.curve;
        S rate = 0.0;
        if (!b.rough) {
            rate = PointLaws::sliding_rate<S>(b, c, p.w, f, S(0.0), S(0.0));
        } else if (slips) {
            S across = 0.0;
            if (b.mu_dynamic > 0.0)
                across = length(PointLaws::friction_vector<S>(b, c, p.w, f), "normal reaction on " + b.name, i);
            rate = PointLaws::sliding_rate<S>(b, c, p.w, f, sign, across);
            S slip = p.w;
            if (!b.drive.is_zero()) slip = PointLaws::sqrt_of(c.speed_squared) * p.w - b.drive(t);
            guard(EventKind::reverse, GuardRole::mode, i, slip, i, "slip of " + b.name);
        } else {
            if (!fixed[at(i)]) rate = PointLaws::carried_rate<S>(b, t, c, p.w);
            const S needed = S(b.mass) * (c.speed_squared * rate + c.first_dot_second * (p.w * p.w)) -
                             dot<S>(c.first, f.force) - f.along;
            const Vector3Of<S> across = PointLaws::friction_vector<S>(b, c, p.w, f);
            guard(EventKind::slip, GuardRole::mode, i,
                  S(b.mu_static * b.mu_static) * dot<S>(across, across) - needed * needed, -1, "hold of " + b.name);
        }
        outputs[at(b.first)] = p.w;
        outputs[at(n + b.first)] = rate;
        const Domain domain = b.curve->domain();
        if (!b.curve->closed() && !fixed[at(i)]) {
            if (std::isfinite(domain.begin))
                guard(EventKind::rail_end, GuardRole::stop, i, q[at(b.first)] - S(domain.begin), -1, {});
            if (std::isfinite(domain.end))
                guard(EventKind::rail_end, GuardRole::stop, i, S(domain.end) - q[at(b.first)], -1, {});
        }
    }
    auto result = std::make_unique<PointStructure>();
    result->still = guards.empty();
    for (const S& out : outputs) result->still = result->still && out.is_zero();
    outputs.insert(outputs.end(), watched.begin(), watched.end());
    Equations& e = result->equations;
    e.program = Program(r, outputs, 2 * n);
    e.guards = std::move(guards);
    for (std::size_t k = 0; k < e.program.switches().size(); ++k) {
        const Switch& s = e.program.switches()[k];
        e.guards.push_back({s.tag >= 0 ? EventKind::normal_zero : EventKind::switching, GuardRole::mode, s.subject,
                            e.program.outputs() + static_cast<int>(k), s.is_norm ? -1 : s.parameter, Direction::falling,
                            s.name});
        if (s.is_norm) e.start_flags.push_back(s.parameter);
    }
    for (const PointLaws::Body& b : laws.bodies()) e.groups.push_back({b.first, b.freedoms(), true});
    for (const PointLaws::Body& b : laws.bodies()) e.groups.push_back({n + b.first, b.freedoms(), false});
    return result;
}

}  // namespace rbdyn
