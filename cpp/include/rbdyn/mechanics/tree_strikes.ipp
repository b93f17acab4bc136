// Definitions of rbdyn/mechanics/tree_model.hpp: impacts of contacts.
//
// At an instant where contacts strike, Newton's law holds for all of them that are closed together (J. J. Moreau,
// Unilateral contact and dry friction in finite freedom dynamics, 1988; C. Glocker, Set-Valued Force Laws, 2001):
//     0 <= P,  u+ + e u- >= 0,  one of each pair zero,   u+ = u- + A P,   A = J M^-1 J^T.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "rbdyn/basics/instant.hpp"
#include "rbdyn/mechanics/closure.hpp"
#include "rbdyn/mechanics/complementarity.hpp"
#include "rbdyn/mechanics/contact_state.hpp"
#include "rbdyn/mechanics/friction_cones.hpp"
#include "rbdyn/mechanics/touched.hpp"
#include "rbdyn/mechanics/tree_model.hpp"

namespace rbdyn::inline RBDYN_FORM {

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
        const double speed = slip.norm(),
                     mu = c.sliding([&](int other) { return std::ranges::find(of, other) != of.end(); });
        const bool is_stuck =
            std::find(stuck.begin(), stuck.end(), k) != stuck.end() || speed <= 0x1p-40 * speed_of(k, all);
        if (!is_stuck) {
            acting.back() = along(touching.normal - slip * (mu / speed));
            continue;
        }
        stopped.push_back(k);
        const auto [first, second] = friction::along(touching);
        for (const Vector3& axis : {first, second}) {
            const bool is_none = touching.is_in_plane && &axis != &first && axis == second;
            rows.push_back(is_none ? touching.no_row() : along(axis));
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

RBDYN_INLINE void TreeModel::part(const Mode& mode, double t, std::span<double> x, const std::vector<int>& struck,
                                  bool anyway) const {
    for (int turn = 0; turn < 3; ++turn) {
        const auto all = moving(t, x);
        const auto rows = conditions_->rows<double>(*tree_, all);
        std::vector<int> used = rows_in(mode);
        std::vector<double> asked(used.size(), 0.0);
        for (const int k : struck) {
            if (mode.slip[at(k)] != flies) continue;
            const int row = conditions_->normal_row(k);
            const double u = mechanics::Conditions::rate(rows[at(row)], all);
            const double little = 0x1p-53 * speed_of(k, all);
            if (u >= (anyway ? little : 0.0)) continue;
            used.push_back(row);
            // a little more each time, for what is asked for is rounded too
            asked.push_back(-u + (anyway ? turn + 2 : turn) * little);
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

}  // namespace rbdyn::inline RBDYN_FORM
