// Definitions of rbdyn/mechanics/tree_writer.hpp.
#pragma once

#include "rbdyn/mechanics/tree_writer.hpp"

#include <cstddef>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "rbdyn/basics/error.hpp"
#include "rbdyn/expression/expression.hpp"
#include "rbdyn/mechanics/accelerate.hpp"
#include "rbdyn/mechanics/joint_number.hpp"
#include "rbdyn/model/hybrid.hpp"
#include "rbdyn/rotation/quaternion.hpp"

namespace rbdyn::inline RBDYN_FORM::mechanics {

RBDYN_INLINE TreeWriter::TreeWriter(Recorder& r, const Tree& tree, const Conditions& conditions, const Exerted& exerted,
                                    const std::vector<RoughJoint>& joints, const std::vector<int>& rows,
                                    const std::vector<signed char>& states)
    : r_(r),
      tree_(tree),
      conditions_(conditions),
      exerted_(exerted),
      joints_(joints),
      rows_(rows),
      states_(states.begin(), states.begin() + static_cast<std::ptrdiff_t>(conditions.contacts().size())),
      resistance_states_(states.begin() + static_cast<std::ptrdiff_t>(conditions.contacts().size()),
                         states.end() - static_cast<std::ptrdiff_t>(joints.size())),
      joint_states_(states.end() - static_cast<std::ptrdiff_t>(joints.size()), states.end()) {
    const recording::WideFolding all_digits;
    for (int i = 0; i < tree.positions(); ++i) q_.push_back(r.input(i));
    for (int i = 0; i < tree.velocities(); ++i) v_.push_back(r.input(tree.positions() + i));
    moving_ = tree.moving<S>(r.time(), q_.data(), v_.data());
    friction_.resize(states_.size());
    for (std::size_t k = 0; k < states_.size(); ++k) {
        touching_.push_back(conditions.contacts()[k].touching<S>(tree, moving_));
        if (!contact_state::has_numbers(conditions.contacts()[k], states_[k])) continue;
        S numbers[ContactMemory::parameters];
        for (S& one : numbers) one = r.parameter(r.new_parameter());
        S curve[ContactMemory::more];
        if (contact_state::is_curved(states_[k]))
            for (S& one : curve) one = r.parameter(r.new_parameter());
        Friction& f = friction_[k];
        f.axis = {numbers[0], numbers[1], numbers[2]};
        f.least = numbers[3];
        f.turns = S(1.0) - numbers[11];
        for (int i = 0; i < 3; ++i) f.force[i] = numbers[4 + i] + numbers[7 + i] * (r.time() - numbers[10]);
        if (!contact_state::slides(states_[k]) &&
            !(contact_state::is_given(states_[k]) && conditions.contacts()[k].is_rough()))
            continue;
        const Vector3Of<S> slip = touching_[k].slip(), last = unit_along(f.axis, touching_[k].normal);
        f.along = last;
        if (contact_state::is_curved(states_[k])) {
            const S time = r.time() - numbers[10];
            S angle(0.0);
            for (int i = ContactMemory::terms; i-- > 0;) angle = (angle + curve[i]) * time;
            f.along = last * cos(angle) + cross<S>(touching_[k].normal, last) * sin(angle);
            f.left = curve[ContactMemory::terms] - r.time();
        }
        f.speed = dot<S>(f.along, slip);
        if (!contact_state::follows_slip(states_[k])) continue;
        f.speed = sqrt(dot<S>(slip, slip));
        f.along = slip * (S(1.0) / f.speed);
    }
    for (std::size_t e = 0; e < resistance_states_.size(); ++e) {
        turning_.emplace_back();
        const signed char state = resistance_states_[e];
        if (!ResistanceMemory::has_numbers(conditions.resistances()[e], state)) continue;
        S numbers[ResistanceMemory::numbers];
        for (S& one : numbers) one = r.parameter(r.new_parameter());
        const Resistance& law = conditions.resistances()[e];
        const Touching<S>& t = touching_[at(law.contact)];
        Turning& now = turning_.back();
        now.last = now.along = {numbers[0], numbers[1]};
        now.least = numbers[2];
        for (int k = 0; k < law.rows(); ++k) now.rate[at(k)] = dot<S>(law.about(t, k), t.turning);
        now.speed = now.along[0] * now.rate[0] + now.along[1] * now.rate[1];
        if (state != contact_state::turning) continue;
        now.speed = sqrt(now.rate[0] * now.rate[0] + now.rate[1] * now.rate[1]);
        for (std::size_t k = 0; k < 2; ++k) now.along[k] = now.rate[k] * (S(1.0) / now.speed);
    }
    for (const signed char state : joint_states_) {
        pressed_.emplace_back();
        if (!joint_state::resists(state)) continue;
        S numbers[JointMemory::parameters];
        for (S& one : numbers) one = r.parameter(r.new_parameter());
        pressed_.back() = {numbers[0], numbers[3], {numbers[1], numbers[2]}};
    }
}

RBDYN_INLINE Vector3Of<Expression> TreeWriter::pushing(std::size_t k) const {
    const ContactLaw& c = conditions_.contacts()[k];
    if (!c.is_rough()) return touching_[k].normal;
    const auto touches = [&](int other) { return states_[at(other)] != flies; };
    return touching_[k].normal - friction_[k].along * (c.never_slips() ? S(c.sliding(touches)) : c.mu_dynamic.in<S>());
}

RBDYN_INLINE Vector3Of<Expression> TreeWriter::twisting(std::size_t k) const {
    Vector3Of<S> torque = none<S>();
    for (std::size_t e = 0; e < resistance_states_.size(); ++e) {
        const Resistance& law = conditions_.resistances()[e];
        if (at(law.contact) != k || !contact_state::slides(resistance_states_[e])) continue;
        const ContactLaw& c = conditions_.contacts()[k];
        const S length = (law.pivots ? c.pivoting : c.rolling).in<S>();
        for (int i = 0; i < law.rows(); ++i)
            torque -= Vector3Of<S>(law.about(touching_[k], i) * (turning_[e].along[at(i)] * length));
    }
    return torque;
}

RBDYN_INLINE Vector3Of<Expression> TreeWriter::shared(std::size_t k) const {
    if (contact_state::is_given(states_[k])) return pushing(k) * friction_[k].force[0];
    Vector3Of<S> force = none<S>();
    for (int axis = 0; axis < 3; ++axis)
        if (!contact_state::is_row(states_[k], axis))
            force += Vector3Of<S>(touching_[k].held_axis(axis) * friction_[k].force[axis]);
    return force;
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
        const S mass = exactly<S>(n.mass);
        w.force = m.bias_at(c) * mass;
        // c x (omega x (omega x c)) = (omega.c) (c x omega), nothing where it turns in the plane of c
        if (is_nothing(dot<S>(m.omega, c)))
            w.moment = cross<S>(c, Vector3Of<S>((m.bias + cross<S>(m.bias_turn, c)) * mass));
        else
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
    // what the motion does not determine
    for (std::size_t k = 0; k < states_.size(); ++k) {
        if (!contact_state::is_held(states_[k]) && !contact_state::is_given(states_[k])) continue;
        const Vector3Of<S> force = shared(k);
        const Touching<S>& t = touching_[k];
        const Vector3Of<S> torque = twisting(k) * dot<S>(t.normal, force);
        for (const auto& [body, on, sign] :
             {std::tuple{t.a, t.on_a(force), S(1.0)}, std::tuple{t.b, t.on_b(force), S(-1.0)}}) {
            if (body < 0) continue;
            add<S>(left[at(body)], on, S(-1.0));
            left[at(body)].moment -= Vector3Of<S>(torque * sign);
        }
    }
    const Accelerate<S> tree = accelerate<S>(tree_, moving_);
    std::vector<S> u = tree.driven(std::move(left), acts.joints), multipliers(rows_.size(), S(0.0));
    std::vector<S> numerators(states_.size(), S(0.0)), denominators(states_.size(), S(0.0));
    Solved solved;
    if (!rows_.empty()) {
        auto all = conditions_.rows<S>(tree_, moving_);
        for (std::size_t i = 0; i < joints_.size(); ++i)
            all[at(conditions_.joint_row(static_cast<int>(i)))].bias =
                -joints_[i].carried(r_.time(), q_.data(), v_[at(joints_[i].v)], moving_);
        // what slides comes last: its force is not along its row, and what is left of the others is definite
        std::vector<std::size_t> order, sliding;
        std::vector<int> contact;  // of each of them: it slides, or turns while it is held
        const int held_from = conditions_.held_row(0, 0), held_to = conditions_.resistance_row(0, 0);
        for (std::size_t i = 0; i < rows_.size(); ++i) {
            const int k = rows_[i] - conditions_.constraint_rows();
            const bool slides = k >= 0 && at(k) < states_.size() && contact_state::slides(states_[at(k)]);
            const int held = rows_[i] >= held_from && rows_[i] < held_to ? (rows_[i] - held_from) / 3 : -1;
            const bool turns = held >= 0 && !is_nothing(Wrench<S>{none<S>(), twisting(at(held))});
            (slides || turns ? sliding : order).push_back(i);
            if (slides || turns) contact.push_back(slides ? k : held);
        }
        const std::size_t first = order.size();
        order.insert(order.end(), sliding.begin(), sliding.end());
        std::vector<Accelerate<S>::Sparse> responses, pushes;
        std::vector<S> b;
        for (const std::size_t i : order) {
            const Row<S>& row = all[at(rows_[i])];
            responses.push_back(tree.response(row));
            b.push_back(-(row.bias + tree.along(responses.back(), u)));
        }
        pushes = responses;
        for (const std::size_t i : order) solved.rows.push_back(all[at(rows_[i])]);
        solved.order = order;
        solved.acting = solved.rows;
        solved.is_symmetric = sliding.empty();
        for (std::size_t j = first; j < order.size(); ++j) {
            const std::size_t k = at(contact[j - first]);
            const Touching<S>& t = touching_[k];
            const int row = rows_[order[j]];
            Row<S> push = row == conditions_.normal_row(contact[j - first]) ? t.row(pushing(k), none<S>())
                                                                            : t.held_row((row - held_from) % 3);
            // of a unit of its force, what of it is normal
            const S normal = row == conditions_.normal_row(contact[j - first])
                                 ? S(1.0)
                                 : dot<S>(t.normal, t.held_axis((row - held_from) % 3));
            if (const Vector3Of<S> torque = twisting(k); !is_nothing(Wrench<S>{none<S>(), torque}))
                t.add_torque(push, Vector3Of<S>(torque * normal));
            pushes[j] = tree.response(push);
            solved.acting[j] = push;
        }
        std::vector<std::vector<S>> a(b.size(), std::vector<S>(b.size(), S(0.0)));
        for (std::size_t i = 0; i < b.size(); ++i)
            for (std::size_t j = 0; j < (sliding.empty() ? i + 1 : b.size()); ++j)
                a[i][j] = tree.between(responses[i], pushes[j]);
        std::vector<S> found, pivots;
        const std::vector<std::vector<S>> matrix = makes_up_ && sliding.empty() ? a : std::vector<std::vector<S>>();
        if (sliding.empty()) {
            found = solve_definite<S>(std::move(a), std::move(b), &pivots);
        } else {
            std::vector<S> driven;
            found = solve_in_order<S>(std::move(a), std::move(b), pivots, driven);
            for (std::size_t j = first; j < order.size(); ++j) {
                if (rows_[order[j]] != conditions_.normal_row(contact[j - first])) continue;
                numerators[at(contact[j - first])] = driven[j];
                denominators[at(contact[j - first])] = pivots[j];
            }
        }
        pivots_ = std::move(pivots);
        for (std::size_t j = 0; j < found.size(); ++j) {
            multipliers[order[j]] = found[j];
            for (const auto& [n, one] : pushes[j]) u[at(n)] += one * found[j];
        }
        if (!matrix.empty()) {
            std::vector<S> lacks;
            for (std::size_t j = 0; j < order.size(); ++j)
                lacks.push_back(-(solved.rows[j].bias + tree.along(responses[j], u)));
            const std::vector<S> more = solve_definite<S>(matrix, std::move(lacks));
            for (std::size_t j = 0; j < more.size(); ++j) {
                multipliers[order[j]] += more[j];
                for (const auto& [n, one] : pushes[j]) u[at(n)] += one * more[j];
            }
        }
    }
    const std::vector<S> rubbing = add_friction(tree, acts, solved, u, multipliers);
    const auto result = tree.spread(u);
    std::vector<S> values(at(tree_.positions()), S(0.0));
    for (const Node& n : tree_.nodes()) n.joint.rates<S>(q_.data() + n.q, v_.data() + n.v, values.data() + n.q);
    for (std::size_t k = 0; k < tree_.feet().size(); ++k)
        values[at(tree_.feet()[k].q)] = tree_.feet()[k].rate<S>(moving_, moving_[at(tree_.size()) + k]);
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
    for (std::size_t k = 0; k < states_.size(); ++k) {
        const bool is_shared = contact_state::is_held(states_[k]) || contact_state::is_given(states_[k]);
        Vector3Of<S> force = is_shared ? shared(k) : none<S>();
        const int contact = static_cast<int>(k);
        for (std::size_t r = 0; r < rows_.size(); ++r) {
            for (int axis = 0; axis < 3; ++axis)
                if (rows_[r] == conditions_.held_row(contact, axis))
                    force += Vector3Of<S>(touching_[k].held_axis(axis) * multipliers[r]);
            if (rows_[r] == conditions_.normal_row(contact))
                force = (contact_state::slides(states_[k]) ? pushing(k) : touching_[k].normal) * multipliers[r];
        }
        put(force);
        values.push_back(numerators[k]);
        values.push_back(denominators[k]);
        Vector3Of<S> torque = twisting(k) * dot<S>(touching_[k].normal, force);
        for (std::size_t e = 0; e < resistance_states_.size(); ++e)
            for (std::size_t r = 0; r < rows_.size() && at(conditions_.resistances()[e].contact) == k; ++r)
                for (int i = 0; i < 2; ++i)
                    if (rows_[r] == conditions_.resistance_row(static_cast<int>(e), i))
                        torque += Vector3Of<S>(conditions_.resistances()[e].about(touching_[k], i) * multipliers[r]);
        put(torque);
    }
    values.insert(values.end(), rubbing.begin(), rubbing.end());
    return values;
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
        const std::size_t first = first_multiplier();
        for (std::size_t k = 0; k < rows_.size(); ++k) {
            // what contacts do comes whole
            if (rows_[k] >= conditions_.constraint_rows()) continue;
            const Row<S>& row = all[at(rows_[k])];
            if (row.a == body) add<S>(w, row.on_a, S(-values_[first + k]));
            if (row.b == body) add<S>(w, row.on_b, S(-values_[first + k]));
        }
    }
    for (std::size_t k = 0; k < touching_.size(); ++k) {
        const Touching<S>& t = touching_[k];
        const Vector3Of<S> force = vector_at(place(static_cast<int>(k)));
        const Vector3Of<S> torque = vector_at(place(static_cast<int>(k)) + 5);
        if (t.a == body) add<S>(w, t.on_a(force), S(-1.0));
        if (t.b == body) add<S>(w, t.on_b(force), S(-1.0));
        if (t.a == body) w.moment -= torque;
        if (t.b == body) w.moment += torque;
    }
    for (int child = body + 1; child < tree_.size(); ++child)
        if (tree_.node(child).parent == body)
            add<S>(w, about<S>(reaction(child), Vector3Of<S>(moving_[at(child)].place - m.place)), S(1.0));
    return w;
}

RBDYN_INLINE Wrench<Expression> TreeWriter::reaction_alone(int body) const {
    Wrench<S> w = reaction(body);
    const std::size_t first = first_multiplier() - at(tree_.velocities());
    const Moving<S>& m = moving_[at(body)];
    for (std::size_t k = 0; k < m.joint.size(); ++k)
        add<S>(w, Wrench<S>{m.joint[k].move, m.joint[k].turn}, S(-values_[first + at(tree_.node(body).v) + k]));
    for (std::size_t i = 0; i < joints_.size(); ++i) {
        if (joints_[i].body != body || !joints_[i].turns) continue;
        // what a hinge resists is known itself
        const Vector3Of<S>& axis = m.joint.front().turn;
        w.moment += axis * (values_[first_of_joints() + per_joint * i] - dot<S>(axis, w.moment));
    }
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
    const auto coordinate = [&](int k) { return q_[at(n.q + k)]; };
    if (is_of_joint(o.quantity)) {
        if (const DrivenLaw* law = n.joint.as<DrivenLaw>())
            return joint_number(
                n.joint, o, [&](int) { return law->way(r_.time()); }, [&](int) { return law->rate(r_.time()); });
        return joint_number(n.joint, o, coordinate, [&](int k) { return v_[at(n.v + k)]; });
    }
    const Vector3Of<S>* e[3] = {&m.axes.e1, &m.axes.e2, &m.axes.e3};
    const RailLaw* rail = n.joint.rail();
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
            if (n.joint.flies()) return S(0.0);
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
