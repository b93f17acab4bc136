// Definitions of rbdyn/mechanics/tree_model.hpp: what contacts do at events.
//
// At an instant where contacts strike, Newton's law holds for all of them that are closed together (J. J. Moreau,
// Unilateral contact and dry friction in finite freedom dynamics, 1988; C. Glocker, Set-Valued Force Laws, 2001):
//     0 <= P,  u+ + e u- >= 0,  one of each pair zero,   u+ = u- + A P,   A = J M^-1 J^T.
// What is then at rest pushes or opens by the same conditions on accelerations, 0 <= N, gap'' >= 0.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <span>
#include <tuple>
#include <utility>
#include <vector>

#include "rbdyn/basics/double_double_functions.hpp"
#include "rbdyn/basics/instant.hpp"
#include "rbdyn/expression/evaluate.hpp"
#include "rbdyn/mechanics/closure.hpp"
#include "rbdyn/mechanics/complementarity.hpp"
#include "rbdyn/mechanics/contact_state.hpp"
#include "rbdyn/mechanics/touched.hpp"
#include "rbdyn/mechanics/tree_model.hpp"
#include "rbdyn/model/acting.hpp"
#include "rbdyn/model/leading_sign.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE std::vector<int> TreeModel::rows_in(const Mode& mode) const {
    std::vector<int> rows = used_rows(mode);
    for (int k = 0; k < contacts(); ++k)
        if (mode.slip[at(k)] == pushes || mechanics::contact_state::slides(mode.slip[at(k)]))
            rows.push_back(conditions_->normal_row(k));
    for (int k = 0; k < contacts(); ++k)
        for (int axis = 0; axis < 3; ++axis)
            if (mechanics::contact_state::is_row(mode.slip[at(k)], axis))
                rows.push_back(conditions_->held_row(k, axis));
    for (int e = 0; e < resistances(); ++e)
        for (int k = 0; k < 2; ++k)
            if (mechanics::contact_state::is_row(resisting(mode, e), k))
                rows.push_back(conditions_->resistance_row(e, k));
    for (int i = 0; i < static_cast<int>(joints_.size()); ++i)
        if (mode.slip[at(first_joint() + i)] == mechanics::joint_state::held) rows.push_back(conditions_->joint_row(i));
    return rows;
}

RBDYN_INLINE std::vector<int> TreeModel::kept_rows(const Mode& mode) const {
    std::vector<int> rows = rows_in(mode);
    std::erase_if(rows, [&](int r) {
        const int joint = r - conditions_->joint_row(0);
        return joint >= 0 && (contacts() == 0 || !joints_[at(joint)].drive.is_zero());
    });
    return rows;
}

RBDYN_INLINE std::vector<int> TreeModel::closed_in(const Mode& mode,
                                                   const std::vector<mechanics::Moving<double>>& all) const {
    if (!conditions_->is_rough()) return kept_rows(mode);
    std::vector<int> rows = rows_;
    for (const int r : kept_rows(mode))
        if (r >= conditions_->joint_row(0)) rows.push_back(r);
    const std::size_t first = rows.size();
    for (int k = 0; k < contacts(); ++k)
        if (mode.slip[at(k)] != flies && mode.slip[at(k)] != rests) rows.push_back(conditions_->normal_row(k));
    return mechanics::independent_rows(*tree_, *conditions_, rows, all, first);
}

RBDYN_INLINE double TreeModel::size_of(int contact, const std::vector<mechanics::Moving<double>>& all) const {
    const mechanics::ContactLaw& c = conditions_->contacts()[at(contact)];
    double size = (tree_->point<double>(c.a, all).place - tree_->point<double>(c.b, all).place).norm();
    size = std::max({size, static_cast<double>(c.radius), static_cast<double>(c.surface_radius)});
    for (const mechanics::Anchor* end : {&c.a, &c.b})
        if (end->body >= 0)
            size = std::max(size, (rounded(end->point) - rounded(tree_->node(end->body).center)).norm());
    return size;
}

RBDYN_INLINE bool TreeModel::feel_each_other(int contact, int other, const Mode& mode, double t,
                                             std::span<const double> x) const {
    const auto all = moving(mode, t, x);
    const auto every = conditions_->rows<double>(*tree_, all);
    std::vector<mechanics::Row<double>> rows;
    std::size_t first = 0;  // of those of the other one
    for (const int k : {contact, other}) {
        first = rows.size();
        rows.push_back(every[at(conditions_->normal_row(k))]);
        for (int axis = 0; axis < 3 && is_rough(k); ++axis) rows.push_back(every[at(conditions_->held_row(k, axis))]);
    }
    const mechanics::Square a = friction::Coupled(*tree_, all, constraints_of(mode, every), rows, rows).matrix();
    for (std::size_t i = 0; i < first; ++i)
        for (std::size_t j = first; j < rows.size(); ++j)
            if (std::abs(a[i][j]) > 1e-9 * std::sqrt(std::abs(a[i][i] * a[j][j]))) return true;
    return false;
}

RBDYN_INLINE double TreeModel::least_size(const Mode& mode, const std::vector<mechanics::Moving<double>>& all) const {
    double least = 0.0;
    for (int k = 0; k < contacts(); ++k)
        if (mode.slip[at(k)] != flies) {
            const double size = size_of(k, all);
            if (size > 0.0 && !(least > 0.0 && least <= size)) least = size;
        }
    return least;
}

RBDYN_INLINE double TreeModel::speed_of(int contact, const std::vector<mechanics::Moving<double>>& all) const {
    const mechanics::ContactLaw& c = conditions_->contacts()[at(contact)];
    double speed = 0.0;
    for (const mechanics::Anchor* end : {&c.a, &c.b})
        if (end->body >= 0) {
            const mechanics::Moving<double>& m = all[at(end->body)];
            const double arm = rounded(end->point).norm() + static_cast<double>(c.radius);
            speed = std::max(speed, m.velocity.norm() + m.omega.norm() * arm);
        }
    return speed;
}

RBDYN_INLINE std::vector<std::vector<double>> TreeModel::coupling(const std::vector<mechanics::Moving<double>>& all,
                                                                  const std::vector<int>& of) const {
    const auto every = conditions_->rows<double>(*tree_, all);
    std::vector<mechanics::Row<double>> rows;
    for (const int k : of) rows.push_back(every[at(conditions_->normal_row(k))]);
    return friction::Coupled(*tree_, all, constraints_of(every), rows, rows).matrix();
}

RBDYN_INLINE std::pair<std::vector<double>, std::vector<double>> TreeModel::opening(const Mode& mode, double t,
                                                                                    std::span<const double> x,
                                                                                    const std::vector<int>& of) const {
    const mechanics::TreeState state = look(mode, t, x);
    const auto rows = conditions_->rows<double>(*tree_, state.moving);
    std::pair<std::vector<double>, std::vector<double>> result;
    for (const int k : of) {
        const auto [sum, size] = acceleration_along(rows[at(conditions_->normal_row(k))], state);
        result.first.push_back(sum);
        result.second.push_back(1e-13 * size);
    }
    return result;
}

RBDYN_INLINE std::pair<double, double> TreeModel::acceleration_along(const mechanics::Row<double>& row,
                                                                     const mechanics::TreeState& state) {
    double sum = row.bias, size = std::abs(row.bias);
    const auto take = [&](int body, const Wrench<double>& on) {
        if (body < 0) return;
        const mechanics::Moving<double>& m = state.moving[at(body)];
        const mechanics::TreeState::Body& b = state.bodies[at(body)];
        const mechanics::Twist<double> linear{b.angular_acceleration - m.bias_turn, b.origin_acceleration - m.bias};
        sum += mechanics::power(linear, on);
        size += b.angular_acceleration.norm() * on.moment.norm() + b.origin_acceleration.norm() +
                m.bias_turn.norm() * on.moment.norm() + m.bias.norm();
    };
    take(row.a, row.on_a);
    take(row.b, row.on_b);
    return {sum, size};
}

RBDYN_INLINE void TreeModel::hold(const Mode& mode, double t, std::span<double> x, std::span<double> rest) const {
    const std::vector<int> rows = rows_in(mode);
    if (rows.empty()) return;
    const mechanics::TreeProjection projection(tree_, conditions_, kept_rows(mode), closed_in(mode, moving(t, x)));
    projection.apply(x, rest, 0.0, t);
    if (!holds_all(rows)) return;
    std::fill(x.begin() + tree_->positions(), x.end(), 0.0);
    std::fill(rest.begin() + tree_->positions(), rest.end(), 0.0);
}

RBDYN_INLINE void TreeModel::set_exactly(const Mode& mode, std::span<const int> fired, double t, std::span<double> x,
                                         std::span<double> rest) const {
    namespace states = mechanics::contact_state;
    if (!joints_.empty() || fired.empty()) return;
    std::vector<int> stopping, rows = rows_in(mode);
    const auto all = moving(t, x);
    for (const int g : fired) {
        const Guard& guard = mode.equations->guards[at(g)];
        if (guard.kind == EventKind::land) return;
        if (guard.contact < 0 || guard.joint >= 0 || guard.kind != EventKind::stick) continue;
        const signed char state = mode.slip[at(guard.contact)];
        const auto memory = mechanics::ContactMemory::of(mode.memory, guard.contact);
        const Vector3 slip = conditions_->contacts()[at(guard.contact)].touching<double>(*tree_, all).slip();
        if ((state == states::straight || state == states::brief) && std::abs(slip.dot(memory.axis)) <= memory.least)
            stopping.push_back(guard.contact);
    }
    const auto is_held = [](signed char state) { return states::is_held(state); };
    if (stopping.empty() && std::none_of(mode.slip.begin(), mode.slip.begin() + contacts(), is_held)) return;
    if (stopping.empty()) return hold(mode, t, x, rest);
    const std::size_t first = rows.size();
    for (const int k : stopping)
        for (int axis = 0; axis < 3; ++axis) rows.push_back(conditions_->held_row(k, axis));
    const mechanics::TreeProjection projection(
        tree_, conditions_, mechanics::independent_rows(*tree_, *conditions_, rows, all, first), closed_in(mode, all));
    projection.apply(x, rest, 0.0, t);
}

RBDYN_INLINE std::vector<int> TreeModel::stop(double t, std::span<double> x, const std::vector<int>& of,
                                              const std::vector<int>& stuck, const friction::JointLaw* law) const {
    const auto all = moving(t, x);
    const auto every = conditions_->rows<double>(*tree_, all);
    auto constraints = constraints_of(every);
    // what is held by joints stays so
    for (int i = 0; i < static_cast<int>(joints_.size()); ++i)
        if (x[at(tree_->positions() + joints_[at(i)].v)] == 0.0)
            constraints.push_back(every[at(conditions_->joint_row(i))]);
    std::vector<mechanics::Row<double>> rows, acting;
    std::vector<int> stopped;
    for (const int k : of) {
        const mechanics::ContactLaw& c = conditions_->contacts()[at(k)];
        const auto touching = c.touching<double>(*tree_, all);
        const auto along = [&](const Vector3& v) { return touching.row(v, Vector3(Vector3::Zero())); };
        rows.push_back(along(touching.normal));
        acting.push_back(rows.back());
        if (!c.is_rough()) continue;
        const Vector3 slip = touching.slip();
        const double speed = slip.norm(), mu = c.sliding();
        const bool is_stuck =
            std::find(stuck.begin(), stuck.end(), k) != stuck.end() || speed <= 0x1p-40 * speed_of(k, all);
        if (!is_stuck) {
            acting.back() = along(touching.normal - slip * (mu / speed));
            continue;
        }
        stopped.push_back(k);
        const auto [first, second] = friction::across(touching.normal);
        for (const Vector3& axis : {first, second}) {
            rows.push_back(along(axis));
            acting.push_back(rows.back());
        }
    }
    std::vector<double> asked;
    for (const auto& row : rows) asked.push_back(-mechanics::Conditions::rate(row, all));
    const friction::Coupled coupled(*tree_, all, constraints, rows, acting, law);
    const std::vector<double> changes = coupled.changes(mechanics::solve_any(coupled.matrix(), asked));
    for (int k = 0; k < tree_->velocities(); ++k) x[at(tree_->positions() + k)] += changes[at(k)];
    return stopped;
}

RBDYN_INLINE std::vector<double> TreeModel::strike(const Mode& before, double t, std::span<double> x,
                                                   const std::vector<int>& struck, Strokes& strokes) const {
    double fastest = 0.0;
    for (const auto was = moving(t, x); const int k : struck) fastest = std::max(fastest, speed_of(k, was));
    std::vector<double> impulses =
        conditions_->is_rough() ? strike_rough(before, t, x, struck, strokes) : strike_smooth(t, x, struck);
    if (struck.size() < 2 || !strokes.impossible.empty()) return impulses;
    const auto all = moving(t, x);
    for (const int k : struck) {
        const auto touching = conditions_->contacts()[at(k)].touching<double>(*tree_, all);
        const double rate = mechanics::Conditions::rate(touching.row(touching.normal, touching.normal_rate), all);
        if (rate >= -1e-3 * fastest) continue;
        strokes.impossible = "doubles have no digits of the impulses that keep " + conditions_->contacts()[at(k)].name +
                             " from going through its surface: what strikes together there differs in mass by 1e11 or "
                             "more";
        break;
    }
    return impulses;
}

RBDYN_INLINE std::vector<double> TreeModel::strike_smooth(double t, std::span<double> x,
                                                          const std::vector<int>& struck) const {
    const auto all = moving(t, x);
    const auto rows = conditions_->rows<double>(*tree_, all);
    std::vector<double> approach, b, noise, impulses(at(contacts()), 0.0);
    for (const int k : struck) {
        const double u = mechanics::Conditions::rate(rows[at(conditions_->constraint_rows() + k)], all);
        approach.push_back(u);
        b.push_back(u < 0.0 ? (1.0 + conditions_->contacts()[at(k)].restitution) * u : u);
        noise.push_back(1e-14 * speed_of(k, all));
    }
    const auto a = coupling(all, struck);
    const auto found = mechanics::solve_evenly(a, b, noise);
    // the constraints keep their velocities; the contacts' impulses change those of the rest
    std::vector<int> used = rows_;
    std::vector<double> asked(used.size(), 0.0);
    for (std::size_t i = 0; i < struck.size(); ++i) {
        impulses[at(struck[i])] = found.z[i];
        if (found.z[i] <= 0.0) continue;
        double change = 0.0;
        for (std::size_t j = 0; j < struck.size(); ++j) change += a[i][j] * found.z[j];
        // to the velocity that the law asks for, not to what rounding makes of the sum
        if (found.w[i] == 0.0) change = b[i] == approach[i] ? -approach[i] : -b[i];
        used.push_back(conditions_->constraint_rows() + struck[i]);
        asked.push_back(change);
    }
    std::vector<int> independent = mechanics::independent_rows(*tree_, *conditions_, used, all);
    std::vector<double> wanted;
    for (const int r : independent)
        wanted.push_back(asked[static_cast<std::size_t>(std::find(used.begin(), used.end(), r) - used.begin())]);
    const mechanics::closing::Responses responses(*tree_, *conditions_, independent, all);
    const std::vector<double> changes = responses.exact_changes(wanted);
    for (int k = 0; k < tree_->velocities(); ++k) x[at(tree_->positions() + k)] += changes[at(k)];
    return impulses;
}

RBDYN_INLINE double TreeModel::fine_rate(int contact, double t, std::span<const double> x,
                                         std::span<const double> rest) const {
    using Real = long double;
    std::vector<Real> wide;
    for (std::size_t i = 0; i < x.size(); ++i) wide.push_back(static_cast<Real>(x[i]) + static_cast<Real>(rest[i]));
    const auto at_contact =
        conditions_->contacts()[at(contact)].touching<Real>(*tree_, mechanics::closing::moving<Real>(*tree_, t, wide));
    return static_cast<double>(dot<Real>(at_contact.normal, at_contact.velocity));
}

RBDYN_INLINE std::pair<double, double> TreeModel::strike_alone(double t, std::span<double> x, std::span<double> rest,
                                                               int struck,
                                                               const std::vector<mechanics::Moving<double>>& all,
                                                               const mechanics::Row<double>& row) const {
    // what is fast along a surface is slow across it at last: the difference is taken, and kept, beyond doubles
    const double u = fine_rate(struck, t, x, rest),
                 asked = -(1.0 + conditions_->contacts()[at(struck)].restitution) * u;
    const auto change = [&](int v, double by) {
        const std::size_t i = at(tree_->positions() + v);
        const Instant sum = exact_sum(x[i], by);
        const Instant whole = exact_sum(sum.hi, sum.lo + rest[i]);
        x[i] = whole.hi;
        rest[i] = whole.lo;
    };
    // of particles that carry nothing the velocity is all there is
    const auto is_lone = [&](int i) {
        return i < 0 || (tree_->node(i).joint.as<mechanics::FreePointLaw>() != nullptr && tree_->node(i).parent < 0 &&
                         std::none_of(tree_->nodes().begin(), tree_->nodes().end(),
                                      [&](const mechanics::Node& n) { return n.parent == i; }));
    };
    if (is_lone(row.a) && is_lone(row.b)) {
        const auto inverse = [&](int i) { return i < 0 ? 0.0 : 1.0 / static_cast<double>(tree_->node(i).mass); };
        const double own =
            row.on_a.force.squaredNorm() * inverse(row.a) + row.on_b.force.squaredNorm() * inverse(row.b);
        for (const auto& [i, force] : {std::pair{row.a, row.on_a.force}, std::pair{row.b, row.on_b.force}})
            for (int k = 0; i >= 0 && k < 3; ++k) change(tree_->node(i).v + k, asked / own * inverse(i) * force[k]);
        return {asked / own, asked};
    }
    const auto accelerate = mechanics::accelerate<double>(*tree_, all);
    const auto response = accelerate.response(row);
    const double own = accelerate.between(response, response), impulse = asked / own;
    std::vector<double> made(at(accelerate.freedoms()), 0.0);
    for (const auto& [n, one] : response) made[at(n)] += one * impulse;
    const std::vector<double> changes = mechanics::velocity_changes<double>(*tree_, accelerate.spread(made));
    for (int k = 0; k < tree_->velocities(); ++k) change(k, changes[at(k)]);
    return {impulse, asked};
}

RBDYN_INLINE void TreeModel::part(const Mode& mode, double t, std::span<double> x,
                                  const std::vector<int>& struck) const {
    for (int turn = 0; turn < 3; ++turn) {
        const auto all = moving(t, x);
        const auto rows = conditions_->rows<double>(*tree_, all);
        std::vector<int> used = rows_in(mode);
        std::vector<double> asked(used.size(), 0.0);
        for (const int k : struck) {
            if (mode.slip[at(k)] != flies) continue;
            const int row = conditions_->normal_row(k);
            const double u = mechanics::Conditions::rate(rows[at(row)], all);
            if (u >= 0.0) continue;
            used.push_back(row);
            // a little more each time, for what is asked for is rounded too
            asked.push_back(-u + turn * 0x1p-53 * speed_of(k, all));
        }
        if (used.size() == rows_in(mode).size()) return;
        const std::vector<int> independent = mechanics::independent_rows(*tree_, *conditions_, used, all);
        std::vector<double> wanted;
        for (const int r : independent)
            wanted.push_back(asked[static_cast<std::size_t>(std::find(used.begin(), used.end(), r) - used.begin())]);
        const mechanics::closing::Responses responses(*tree_, *conditions_, independent, all);
        const std::vector<double> changes = responses.changes(wanted);
        for (int k = 0; k < tree_->velocities(); ++k) x[at(tree_->positions() + k)] += changes[at(k)];
    }
}

RBDYN_INLINE bool TreeModel::stands(const Mode& mode, int contact, double t, std::span<const double> x) const {
    const mechanics::TreeState state = look(mode, t, x);
    const mechanics::ContactLaw& c = conditions_->contacts()[at(contact)];
    const double size = size_of(contact, state.moving);
    for (const int i : {c.a.body, c.b.body}) {
        if (i < 0) continue;
        const mechanics::TreeState::Body& b = state.bodies[at(i)];
        const double mass = static_cast<double>(tree_->node(i).mass), force = b.effort.force.norm(),
                     kinetic = mass * b.velocity.squaredNorm() + state.moving[at(i)].omega.dot(b.spin_momentum);
        if (b.acceleration.norm() * mass * size + b.spin_rate.norm() > 1e-11 * force * size) return false;
        if (kinetic > 1e-22 * force * size) return false;
    }
    return true;
}

RBDYN_INLINE void TreeModel::settle(const Mode& before, Mode& mode, double t, std::span<double> x,
                                    const std::vector<int>& candidates, const Fired& fired) const {
    if (!joints_.empty())
        settle_all(before, mode, t, x, candidates, fired);
    else if (resistances() > 0)
        settle_resisted(before, mode, t, x, candidates, fired);
    else if (conditions_->is_rough())
        settle_rough(before, mode, t, x, candidates, fired);
    else
        settle_smooth(mode, t, x, candidates, fired.doubtful);
}

RBDYN_INLINE void TreeModel::settle_smooth(Mode& mode, double t, std::span<double> x,
                                           const std::vector<int>& candidates, const std::vector<int>& doubtful) const {
    const Mode before = mode;
    for (const int k : candidates) mode.slip[at(k)] = flies;
    choose(mode, t, x, {}, true);
    if (candidates.empty()) return;
    const auto [b, noise] = opening(mode, t, x, candidates);
    const auto all = moving(t, x);
    // forces that depend on each other: all are closed if there are such that push everywhere
    if (doubtful.empty() || shares_load(before)) {
        std::vector<int> every = rows_;
        for (const int k : candidates) every.push_back(conditions_->normal_row(k));
        const bool depends =
            mechanics::independent_rows(*tree_, *conditions_, every, all, rows_.size()).size() < every.size();
        if (depends && share_load(before, mode, t, all, candidates, b, noise)) {
            choose(mode, t, x, {}, true);
            return;
        }
    }
    const auto found = mechanics::solve_complementary(coupling(all, candidates), b, noise);
    std::vector<int> pushing = rows_, uncertain;
    for (std::size_t i = 0; i < candidates.size(); ++i) {
        const int k = candidates[i];
        const bool is_doubtful = std::find(doubtful.begin(), doubtful.end(), k) != doubtful.end() ||
                                 (found.z[i] <= 0.0 && std::abs(found.w[i]) <= 8.0 * noise[i]);
        if (is_doubtful)
            uncertain.push_back(k);
        else if (found.z[i] > 0.0)
            pushing.push_back(conditions_->constraint_rows() + k);
    }
    // of forces that depend on each other as many push as are independent, the others need none of their own
    const auto independent = mechanics::independent_rows(*tree_, *conditions_, pushing, all);
    const auto is_in = [&](const std::vector<int>& rows, int k) {
        return std::find(rows.begin(), rows.end(), conditions_->constraint_rows() + k) != rows.end();
    };
    for (const int k : candidates)
        if (is_in(pushing, k)) {
            mode.slip[at(k)] = is_in(independent, k) ? pushes : rests;
            mechanics::ContactMemory().put(mode.memory, k);
        }
    choose(mode, t, x, {}, true);
    // a force at zero pushes if it grows, and where none is needed for ever; else the contact opens
    for (const int k : uncertain) {
        std::vector<int> with = rows_in(mode);
        with.push_back(conditions_->constraint_rows() + k);
        if (mechanics::independent_rows(*tree_, *conditions_, with, all).size() < with.size()) {
            mode.slip[at(k)] = rests;
            mechanics::ContactMemory().put(mode.memory, k);
            choose(mode, t, x, {}, true);
            continue;
        }
        Mode closed = mode;
        closed.slip[at(k)] = pushes;
        choose(closed, t, x, {}, true);
        // where nothing moves, what changes a force that is zero is rounding
        const bool has_fired = std::find(doubtful.begin(), doubtful.end(), k) != doubtful.end();
        int sign = 1;
        if (has_fired)
            sign = ends(closed, k, t, x) ? -1 : 0;
        else if (const int force = force_of(closed, k); force >= 0)
            sign = leading_sign(closed, t, x, force);
        if (sign >= 0 || (!has_fired && stands(closed, k, t, x))) mode = std::move(closed);
    }
}

RBDYN_INLINE int TreeModel::force_of(const Mode& mode, int contact) {
    if (mode.equations == nullptr) return -1;
    for (const Guard& guard : mode.equations->guards)
        if (guard.contact == contact && guard.kind == EventKind::detach) return guard.output;
    return -1;
}

RBDYN_INLINE double TreeModel::forces_at(int contact, const mechanics::TreeState& state) const {
    const mechanics::ContactLaw& c = conditions_->contacts()[at(contact)];
    const double size = size_of(contact, state.moving);
    double forces = 0.0;
    for (const int body : {c.a.body, c.b.body}) {
        if (body < 0) continue;
        const Wrench<double>& effort = state.bodies[at(body)].effort;
        forces += effort.force.norm() + (size > 0.0 ? effort.moment.norm() / size : 0.0);
    }
    return forces;
}

RBDYN_INLINE bool TreeModel::ends(const Mode& mode, int contact, double t, std::span<const double> x) const {
    const int force = force_of(mode, contact);
    if (force < 0 || leading_sign(mode, t, x, force, 1) >= 0) return false;
    // what slides is told by a numerator, which is none
    const bool is_force = !mechanics::contact_state::slides(mode.slip[at(contact)]);
    return !only_dips(mode, t, x, force, is_force ? forces_at(contact, look(mode, t, x)) : 0.0);
}

RBDYN_INLINE bool TreeModel::pulls(const Mode& mode, double t, std::span<const double> x) const {
    if (contacts() == 0) return false;
    Evaluator<double> values(mode.equations->program);
    values.set_parameters(mode.parameters);
    values(t, x);
    for (const Guard& guard : mode.equations->guards)
        if (guard.contact >= 0 && guard.output >= 0 &&
            (guard.kind == EventKind::detach || guard.kind == EventKind::slip) &&
            values.output(guard.output) < -1e-13 * values.magnitude(guard.output))
            return true;
    return false;
}

RBDYN_INLINE void TreeModel::touch(const Mode& mode, Mode& after, std::span<const int> fired, double t,
                                   std::span<double> x, std::span<double> rest,
                                   std::vector<Happening>& happenings) const {
    set_exactly(mode, fired, t, x, rest);
    const std::vector<double> was(x.begin(), x.end());
    std::vector<double> known = was;  // what `rest` belongs to
    const auto all = moving(t, x);
    // positions stay what they are: so does how contacts lie
    std::vector<std::optional<mechanics::Touching<double>>> touching(at(contacts()));
    const auto touching_of = [&](int k) -> const mechanics::Touching<double>& {
        if (!touching[at(k)]) touching[at(k)] = conditions_->contacts()[at(k)].touching<double>(*tree_, all);
        return *touching[at(k)];
    };
    const auto row_of = [&](int k) { return touching_of(k).row(touching_of(k).normal, touching_of(k).normal_rate); };
    const auto rate = [&](const auto& motion, int k) { return mechanics::Conditions::rate(row_of(k), motion); };
    std::vector<int> closed;
    Fired events;
    const bool joints_change = heed_joints(mode, after, fired, t, x, events.rubbed_breaking, happenings);
    if (!after.impossible.empty()) return;
    const auto forget = [&] {
        for (std::size_t i = 0; i < x.size(); ++i)
            if (x[i] != known[i]) rest[i] = 0.0;
    };
    forget();
    // bounces of several contacts, so low that doubles do not tell how high each of them is
    const double flight = t - mode.memory[0];
    std::vector<double> fine;
    const auto is_low = [&](int k) {
        return contacts() > 1 && follows_together(mode) && flight > 4.0 * epsilon * std::abs(t) &&
               std::abs(rate(all, k)) * flight <= low_bounce * size_of(k, all);
    };
    const auto comes_now = [&](int k) {
        const double gap = touching_of(k).gap, speed = -rate(all, k);
        if (!(std::abs(gap) <= 1e-13 * size_of(k, all) && speed > 0.0)) return false;
        if (!is_low(k)) return true;
        if (fine.empty()) fine = fine_gaps(t, x, rest);
        return fine[at(k)] <= speed * std::max(4.0 * epsilon * std::abs(t), 1e-7 * flight);
    };
    for (int k = 0; k < contacts(); ++k) {
        for (const int index : fired) {
            const Guard& guard = mode.equations->guards[at(index)];
            if (guard.contact != k) continue;
            if (guard.joint >= 0) {
                (guard.kind == EventKind::slip    ? events.resisted_breaking
                 : guard.kind == EventKind::stick ? events.resisted_stopping
                                                  : events.resisted_turning)
                    .push_back(guard.joint);
                continue;
            }
            (guard.kind == EventKind::land       ? events.landing
             : guard.kind == EventKind::detach   ? events.doubtful
             : guard.kind == EventKind::slip     ? events.breaking
             : guard.kind == EventKind::stick    ? events.stopping
             : guard.kind == EventKind::singular ? events.singular
                                                 : events.turning)
                .push_back(k);
        }
        const bool is_closed = mode.slip[at(k)] != flies, has_fired = events.has(k);
        const auto is_close = [&] {
            return !is_closed && !conditions_->contacts()[at(k)].is_gone &&
                   std::abs(touching_of(k).gap) <= 1e-13 * size_of(k, all);
        };
        // what comes to its surface at this very instant strikes with the others
        const bool is_there = !is_closed && !has_fired && !conditions_->contacts()[at(k)].is_gone && comes_now(k);
        if (is_there) events.landing.push_back(k);
        // what a joint has held over it touches as well
        const bool is_near = !joints_.empty() && is_close() && rate(all, k) <= 1e-13 * speed_of(k, all);
        if (is_closed || has_fired || is_there || is_near) closed.push_back(k);
    }
    // what impulses do not reach goes on as it did, whatever rounding makes of it; what flies along with what it
    // touches, pressed by nothing, is struck with it
    std::vector<int> hit;
    if (!events.landing.empty()) {
        std::vector<int> all_that_touch = closed;
        for (int k = 0; k < contacts(); ++k)
            if (std::ranges::find(closed, k) == closed.end() && !conditions_->contacts()[at(k)].is_gone &&
                std::abs(touching_of(k).gap) <= 1e-13 * size_of(k, all) &&
                std::abs(rate(all, k)) <= 1e-13 * speed_of(k, all))
                all_that_touch.push_back(k);
        hit = reached(all_that_touch, events.landing);
        for (const int k : hit)
            if (std::ranges::find(closed, k) == closed.end()) closed.push_back(k);
    }
    if (!fired.empty() && !joints_change && events.none()) return choose(after, t, x, {});
    const std::vector<int>& landing = events.landing;
    after.impossible = lies_flat(closed, all, no_tilt);
    if (!after.impossible.empty()) return;
    std::vector<int> at_rest = closed, group;
    std::vector<double> impulses(at(contacts()), 0.0);
    Strokes strokes;
    LeftOut left;
    const bool is_alone = closed.size() == 1 && landing.size() == 1 && rows_.empty() && resistances() == 0 &&
                          joints_.empty() && !conditions_->is_rough() &&
                          rate(all, closed.front()) < -1e-14 * speed_of(closed.front(), all);
    const bool are_low = contacts() > 1 && std::any_of(landing.begin(), landing.end(), is_low);
    if (!landing.empty()) {
        double made_alone = 0.0;
        if (is_alone) {
            std::tie(impulses[at(closed.front())], made_alone) =
                strike_alone(t, x, rest, closed.front(), all, row_of(closed.front()));
            known.assign(x.begin(), x.end());
        } else {
            impulses = strike(mode, t, x, hit, strokes);
        }
        if (!strokes.impossible.empty()) {
            after.impossible = strokes.impossible;
            return;
        }
        ++after.jumps;
        events.stuck = strokes.stuck;
        const auto motion = is_alone ? std::vector<mechanics::Moving<double>>() : moving(t, x);
        // what impulses make of velocities, and take again, leaves its rounding
        const auto made = is_alone ? std::vector<std::vector<double>>() : coupling(all, closed);
        const auto struck_size = [&](int k) {
            if (is_alone) return speed_of(k, all) + 2.0 * made_alone;
            const auto i = static_cast<std::size_t>(std::find(closed.begin(), closed.end(), k) - closed.begin());
            double size = std::max(speed_of(k, motion), speed_of(k, all));
            for (std::size_t j = 0; j < closed.size(); ++j) size += std::abs(made[i][j] * impulses[at(closed[j])]);
            return size;
        };
        std::erase_if(at_rest, [&](int k) {
            if (std::ranges::find(hit, k) == hit.end()) return false;
            const double e = conditions_->contacts()[at(k)].restitution, size = struck_size(k);
            const double u = is_alone ? -e * rate(all, k) : rate(motion, k);
            const bool bounces = impulses[at(k)] <= 0.0 || e > 0.0;
            // what comes back as fast as its own restitution says is no rounding of others; what was closed has not
            // come
            const double back = mode.slip[at(k)] == flies ? -e * rate(all, k) : 0.0;
            const bool opens = bounces && (u > 1e-13 * size || (back > 8.0 * epsilon * size && u > 0.5 * back));
            if (opens) after.slip[at(k)] = flies;
            return opens;
        });
        settle(mode, after, t, x, at_rest, events);
        if (after.impossible.empty() && !at_rest.empty()) part(after, t, x, at_rest);
        forget();
        if (are_low && after.impossible.empty()) meet(t, x, rest, closed);
        // what bounces alone, its flights long yet, goes on
        const bool goes_on = is_alone && goes_on_bouncing(closed.front(), t, flight, -rate(all, closed.front()), all);
        if (!goes_on) {
            double came = 0.0;
            for (const int k : landing) came = std::max(came, -rate(all, k));
            group = accumulating(after, t, x, rest, closed, came, left);
        }
        if (group.empty() && after.impossible.empty() && flight <= 8.0 * epsilon * std::abs(t))
            group = collapsing(mode, after, t, x, rest, closed, strokes);
        after.memory[0] = t;
        if (!group.empty()) {
            // what is left of their bounces is less than rounding: none of them moves any more
            at_rest.insert(at_rest.end(), group.begin(), group.end());
            const std::vector<double> bounced(x.begin(), x.end());
            const Mode struck = after;
            Fired rested;
            // friction without bound stops what it is not pushed along by
            std::vector<int> stuck = strokes.stuck;
            for (const int k : at_rest)
                if (conditions_->contacts()[at(k)].never_slips() &&
                    (strokes.pushed.empty() || strokes.pushed[at(k)].isZero(0.0)))
                    stuck.push_back(k);
            const auto come_to_rest = [&](const friction::JointLaw* law) {
                std::copy(bounced.begin(), bounced.end(), x.begin());
                after = struck;
                rested.stuck = stop(t, x, at_rest, stuck, law);
                // what is left of rates is rounding
                double fastest = 0.0;
                for (const mechanics::RoughJoint& joint : joints_)
                    fastest = std::max(fastest, std::abs(bounced[at(tree_->positions() + joint.v)]));
                for (const mechanics::RoughJoint& joint : joints_) {
                    const auto place = at(tree_->positions() + joint.v);
                    if (joint.drive.is_zero() &&
                        std::abs(x[place]) <= std::max(1e-10 * std::abs(bounced[place]), 1e-13 * fastest))
                        x[place] = 0.0;
                }
                settle(mode, after, t, x, at_rest, rested);
            };
            come_to_rest(nullptr);
            // joints that slide resist what is left out, pressed as they are then
            if (!joints_.empty() && after.impossible.empty())
                if (const auto law = joint_law(after, t)) come_to_rest(&*law);
            std::fill(rest.begin() + tree_->positions(), rest.end(), 0.0);
        }
    } else {
        settle(mode, after, t, x, at_rest, events);
    }
    if (!after.impossible.empty()) {
        if (const std::string why = lies_flat(closed, all); !why.empty()) after.impossible = why;
        return;
    }
    hold(after, t, x, rest);
    const auto closes = [&](int k) { return after.slip[at(k)] != flies && mode.slip[at(k)] == flies; };
    if (!landing.empty() || !group.empty() || std::any_of(closed.begin(), closed.end(), closes))
        quiet(after, t, x, rest);
    const auto is_in = [](const std::vector<int>& list, int k) {
        return std::find(list.begin(), list.end(), k) != list.end();
    };
    for (const int k : closed) {
        const bool is = after.slip[at(k)] != flies;
        // what is closed and struck from elsewhere tells of itself only if it opens; a group comes to rest once
        const bool comes = is_in(landing, k), last = !group.empty() && k == group.front();
        const bool is_anew = is && mode.slip[at(k)] == flies;
        if (!comes && !last && is && !is_anew) continue;
        if (!group.empty() && !last && is) continue;
        // what a joint has held over it, and does on
        if (!comes && !last && !is && mode.slip[at(k)] == flies) continue;
        // what comes and goes without an impulse has not struck
        if (comes && !last && !is && impulses[at(k)] <= 0.0) continue;
        Happening h{last                 ? EventKind::accumulation
                    : !comes && !is_anew ? EventKind::detach
                    : is                 ? EventKind::land
                                         : EventKind::impact,
                    -1,
                    Direction::falling,
                    {}};
        h.contact = k;
        h.impulse = impulses[at(k)];
        h.push = strokes.pushed.empty() ? Vector3(touching_of(k).normal * h.impulse) : strokes.pushed[at(k)];
        if (comes && strokes.lowered < 1.0)
            h.note = "restitution lowered to " + text(strokes.lowered * conditions_->contacts()[at(k)].restitution) +
                     ": more would gain energy, or ask what no impulses do";
        if (last) h.later = left.time;
        // torques against rolling act while what is left of the bounces goes on, and impacts know none
        if (last && conditions_->is_rough() && (left.is_summed || !follows_together(mode)))
            h.unsure = std::max(resistances() > 0 ? 1e-6 : 2e-11, left.unsure / std::abs(t));
        happenings.push_back(std::move(h));
    }
    if (conditions_->is_rough()) tell_friction(mode, after, events, all, moving(t, x), happenings);
    tell_joints(mode, after, happenings);
    tell_rest(mode, was, after, t, x, happenings);
    put_in_order(happenings);
    come_to_stand(after, t, x);
}

RBDYN_INLINE std::string TreeModel::lies_flat(const std::vector<int>& closed,
                                              const std::vector<mechanics::Moving<double>>& all, double most) const {
    for (const int k : closed) {
        const mechanics::ContactLaw& c = conditions_->contacts()[at(k)];
        if (c.part != mechanics::ContactLaw::Part::disc) continue;
        const Vector3 axis = all[at(c.a.body)].to_world(exactly<double>(c.axis));
        const double tilt = axis.cross(c.touching<double>(*tree_, all).normal).norm();
        if (tilt < most)
            return "the disc of " + c.name + " has come to lie flat, but for " + text(tilt) +
                   " rad: all of its rim touches, and no one point of it goes on";
    }
    return {};
}

RBDYN_INLINE void TreeModel::put_in_order(std::vector<Happening>& happenings) const {
    if (happenings.size() < 2) return;
    const auto name = [&](const Happening& h) {
        return h.contact >= 0   ? conditions_->contacts()[at(h.contact)].name
               : h.subject >= 0 ? tree_->node(h.subject).name
                                : h.name;
    };
    std::stable_sort(happenings.begin(), happenings.end(), [&](const Happening& a, const Happening& b) {
        return a.kind != b.kind ? a.kind < b.kind : name(a) < name(b);
    });
}

}  // namespace rbdyn::inline RBDYN_FORM
