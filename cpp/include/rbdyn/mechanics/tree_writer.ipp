// Definitions of rbdyn/mechanics/tree_writer.hpp.
#pragma once

#include "rbdyn/mechanics/tree_writer.hpp"

#include <string>
#include <utility>
#include <vector>

#include "rbdyn/basics/error.hpp"
#include "rbdyn/expression/expression.hpp"
#include "rbdyn/mechanics/accelerate.hpp"
#include "rbdyn/mechanics/closure.hpp"
#include "rbdyn/model/hybrid.hpp"
#include "rbdyn/rotation/quaternion.hpp"

namespace rbdyn::inline RBDYN_FORM::mechanics {

RBDYN_INLINE TreeWriter::TreeWriter(Recorder& r, const Tree& tree, const Conditions& conditions, const Exerted& exerted,
                                    const std::vector<int>& rows)
    : r_(r), tree_(tree), conditions_(conditions), exerted_(exerted), rows_(rows) {
    const recording::WideFolding all_digits;
    for (int i = 0; i < tree.positions(); ++i) q_.push_back(r.input(i));
    for (int i = 0; i < tree.velocities(); ++i) v_.push_back(r.input(tree.positions() + i));
    moving_ = tree.moving<S>(r.time(), q_.data(), v_.data());
}

RBDYN_INLINE std::vector<Expression> TreeWriter::laws() {
    const recording::WideFolding all_digits;
    const Acts acts = exerted_.all(tree_, r_.time(), moving_, q_.data(), v_.data());
    // what is left to be balanced while the joints do not accelerate
    std::vector<Wrench<S>> left;
    for (int i = 0; i < tree_.size(); ++i) {
        const Node& n = tree_.node(i);
        const Moving<S>& m = moving_[at(i)];
        const Vector3Of<S> c = m.to_world(exactly<S>(n.center));
        Wrench<S> w;
        w.force = m.bias_at(c) * exactly<S>(n.mass);
        w.moment = cross<S>(c, w.force);
        if (!n.is_point) {
            const auto inertia = tree_.inertia_of<S>(i, m);
            const auto times = [&](const Vector3Of<S>& a) {
                Vector3Of<S> result = none<S>();
                for (int j = 0; j < 3; ++j)
                    for (int k = 0; k < 3; ++k) result[j] += inertia[at(j)][at(k)] * a[k];
                return result;
            };
            w.moment += times(m.bias_turn) + cross<S>(m.omega, times(m.omega));
        }
        w.force -= acts.wrenches[at(i)].force;
        w.moment -= acts.wrenches[at(i)].moment;
        left.push_back(w);
    }
    const Accelerate<S> tree = accelerate<S>(tree_, moving_);
    std::vector<S> u = tree.driven(std::move(left), acts.joints), multipliers;
    if (!rows_.empty()) {
        const auto all = conditions_.rows<S>(tree_, moving_);
        std::vector<Accelerate<S>::Sparse> responses;
        std::vector<S> b;
        for (const int r : rows_) {
            responses.push_back(tree.response(all[at(r)]));
            b.push_back(-(all[at(r)].bias + tree.along(responses.back(), u)));
        }
        std::vector<std::vector<S>> a(b.size(), std::vector<S>(b.size(), S(0.0)));
        for (std::size_t i = 0; i < b.size(); ++i)
            for (std::size_t j = 0; j <= i; ++j) a[i][j] = tree.between(responses[i], responses[j]);
        multipliers = solve_definite<S>(std::move(a), std::move(b));
        for (std::size_t j = 0; j < multipliers.size(); ++j)
            for (const auto& [n, one] : responses[j]) u[at(n)] += one * multipliers[j];
    }
    const auto result = tree.spread(u);
    std::vector<S> values(at(tree_.positions()), S(0.0));
    for (const Node& n : tree_.nodes()) n.joint.rates<S>(&q_[0] + n.q, v_.data() + n.v, values.data() + n.q);
    const std::vector<S> changes = velocity_changes<S>(tree_, result);
    values.insert(values.end(), changes.begin(), changes.end());
    // what turns freely: all of its angular acceleration
    for (int i = 0; i < tree_.size(); ++i)
        if (const int first = tree_.node(i).joint.attitude(); first >= 0)
            for (int k = 0; k < 3; ++k)
                values[at(tree_.positions() + tree_.node(i).v + first + k)] += moving_[at(i)].bias_turn[k];
    const auto put = [&](const Vector3Of<S>& v) { values.insert(values.end(), {v[0], v[1], v[2]}); };
    for (int i = 0; i < tree_.size(); ++i) {
        put(acts.wrenches[at(i)].force);
        put(acts.wrenches[at(i)].moment);
        put(result.bodies[at(i)].turn + moving_[at(i)].bias_turn);
        put(result.bodies[at(i)].move + moving_[at(i)].bias);
    }
    for (const auto& f : acts.couplings) put(f);
    values.insert(values.end(), acts.powers.begin(), acts.powers.end());
    values.insert(values.end(), acts.joints.begin(), acts.joints.end());
    values.insert(values.end(), multipliers.begin(), multipliers.end());
    return values;
}

RBDYN_INLINE void TreeWriter::touch(EquationsWriter& write, const std::vector<signed char>& states) const {
    const recording::WideFolding all_digits;
    const std::size_t first = values_.size() - rows_.size();
    for (std::size_t k = 0; k < states.size(); ++k) {
        const ContactLaw& c = conditions_.contacts()[k];
        const int contact = static_cast<int>(k), row = conditions_.constraint_rows() + contact;
        if (states[k] == flies)
            write.guard({.kind = EventKind::land, .contact = contact, .name = "gap of " + c.name},
                        c.touching<S>(tree_, moving_).gap);
        for (std::size_t r = 0; r < rows_.size(); ++r)
            if (rows_[r] == row)
                write.guard({.kind = EventKind::detach, .contact = contact, .name = "force of " + c.name},
                            values_[first + r]);
    }
}

RBDYN_INLINE void TreeWriter::watch(EquationsWriter& write, const std::vector<Scene::Watch>& watches) const {
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
            write.outside(std::move(g));
            continue;
        }
        std::vector<S> x;
        for (const Observable& o : w.function.arguments()) x.push_back(observed(o));
        write.watch(std::move(g), w.function.function()(std::span<const S>(x))[0]);
    }
}

RBDYN_INLINE Vector3Of<Expression> TreeWriter::acting(int first) const {
    const std::size_t i = at(tree_.variables() + first);
    return {values_[i], values_[i + 1], values_[i + 2]};
}

RBDYN_INLINE Vector3Of<Expression> TreeWriter::acceleration(int body, const Vector3Of<S>& arm) const {
    const Vector3Of<S> turning = acting(12 * body + 6), omega = moving_[at(body)].omega;
    return acting(12 * body + 9) + cross<S>(turning, arm) + cross<S>(omega, cross<S>(omega, arm));
}

RBDYN_INLINE Wrench<Expression> TreeWriter::reaction(int body) const {
    const Node& n = tree_.node(body);
    const Moving<S>& m = moving_[at(body)];
    const Vector3Of<S> c = m.to_world(exactly<S>(n.center));
    Wrench<S> w;
    w.force = acceleration(body, c) * exactly<S>(n.mass);
    w.moment = cross<S>(c, w.force);
    if (!n.is_point) {
        const auto inertia = tree_.inertia_of<S>(body, m);
        const auto times = [&](const Vector3Of<S>& a) {
            Vector3Of<S> result = none<S>();
            for (int j = 0; j < 3; ++j)
                for (int k = 0; k < 3; ++k) result[j] += inertia[at(j)][at(k)] * a[k];
            return result;
        };
        w.moment += times(acting(12 * body + 6)) + cross<S>(m.omega, times(m.omega));
    }
    w.force -= acting(12 * body);
    w.moment -= acting(12 * body + 3);
    if (!rows_.empty()) {
        const auto all = conditions_.rows<S>(tree_, moving_);
        const std::size_t first = values_.size() - rows_.size();
        for (std::size_t k = 0; k < rows_.size(); ++k) {
            const Row<S>& row = all[at(rows_[k])];
            if (row.a == body) add<S>(w, row.on_a, S(-values_[first + k]));
            if (row.b == body) add<S>(w, row.on_b, S(-values_[first + k]));
        }
    }
    for (int child = body + 1; child < tree_.size(); ++child)
        if (tree_.node(child).parent == body)
            add<S>(w, about<S>(reaction(child), Vector3Of<S>(moving_[at(child)].place - m.place)), S(1.0));
    return w;
}

RBDYN_INLINE Wrench<Expression> TreeWriter::reaction_alone(int body) const {
    Wrench<S> w = reaction(body);
    const std::size_t first = values_.size() - rows_.size() - at(tree_.velocities());
    const Moving<S>& m = moving_[at(body)];
    for (std::size_t k = 0; k < m.joint.size(); ++k)
        add<S>(w, Wrench<S>{m.joint[k].move, m.joint[k].turn}, S(-values_[first + at(tree_.node(body).v) + k]));
    return w;
}

RBDYN_INLINE Expression TreeWriter::observed(const Observable& o) const {
    if (o.quantity == Quantity::time) return r_.time();
    if (is_of_coupling(o.quantity)) {
        const Exerted::Coupled& c = exerted_.couplings()[at(o.subject)];
        if (o.quantity == Quantity::coupling_force) return acting(12 * tree_.size() + 3 * o.subject)[o.component];
        return length(tree_.point<S>(c.a, moving_).place - tree_.point<S>(c.b, moving_).place, std::string());
    }
    const int body = o.subject;
    const Node& n = tree_.node(body);
    const Moving<S>& m = moving_[at(body)];
    const Vector3Of<S> c = m.to_world(exactly<S>(n.center)),
                       origin = n.is_point ? none<S>() : m.to_world(exactly<S>(n.joint.held().point)) * S(-1.0);
    const auto coordinate = [&](int k) { return k < 0 ? S(0.0) : q_[at(n.q + k)]; };
    const Vector3Of<S>* e[3] = {&m.axes.e1, &m.axes.e2, &m.axes.e3};
    const RailLaw* rail = n.joint.as<RailLaw>();
    switch (o.quantity) {
        case Quantity::position: return (m.place + origin)[o.component];
        case Quantity::velocity: return m.velocity_at(origin)[o.component];
        case Quantity::acceleration: return acceleration(body, origin)[o.component];
        case Quantity::center_of_mass: return (m.place + c)[o.component];
        case Quantity::center_of_mass_velocity: return m.velocity_at(c)[o.component];
        case Quantity::center_of_mass_acceleration: return acceleration(body, c)[o.component];
        case Quantity::force: return acting(12 * body)[o.component];
        case Quantity::reaction: return reaction_alone(body).force[o.component];
        case Quantity::reaction_torque: return reaction_alone(body).moment[o.component];
        case Quantity::parameter: return rail != nullptr ? q_[at(n.q)] : S(0.0);
        case Quantity::speed:
            if (rail != nullptr) return sqrt(rail->curve->at<S>(q_[at(n.q)], Placement{}).speed_squared) * v_[at(n.v)];
            return length(m.velocity, std::string());
        case Quantity::kinetic_energy: {
            const Vector3Of<S> v = m.velocity_at(c);
            S energy = S(0.5) * exactly<S>(n.mass) * dot<S>(v, v);
            if (n.is_point) return energy;
            const auto inertia = tree_.inertia_of<S>(body, m);
            for (int j = 0; j < 3; ++j)
                for (int k = 0; k < 3; ++k) energy += S(0.5) * inertia[at(j)][at(k)] * m.omega[j] * m.omega[k];
            return energy;
        }
        case Quantity::rotation_matrix: return (*e[o.component % 3])[o.component / 3];
        case Quantity::angular_velocity: return m.to_body(m.omega)[o.component];
        case Quantity::angular_velocity_world: return m.omega[o.component];
        case Quantity::angular_acceleration: return m.to_body(acting(12 * body + 6))[o.component];
        case Quantity::poisson_vector: return (*e[o.component])[2];
        case Quantity::angle: return coordinate(turning_velocity(n.joint));
        case Quantity::displacement: return coordinate(sliding_velocity(n.joint));
        case Quantity::rate: return v_[at(n.v)];
        case Quantity::quaternion:
            if (const int first = n.joint.attitude(); first >= 0) return coordinate(first + o.component);
            [[fallthrough]];
        default:
            throw InvalidInput("watch: of " + n.name +
                               " the quaternion and Euler angles are not recorded on this joint; ask for its "
                               "rotation_matrix, angle or angular_velocity, or have the function called back");
    }
}

}  // namespace rbdyn::inline RBDYN_FORM::mechanics
