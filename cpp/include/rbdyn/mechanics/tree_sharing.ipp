// Definitions of rbdyn/mechanics/tree_model.hpp: forces of contacts that the motion does not determine.
//
// What is held by more than it needs, or stands on more than it needs, has forces that are one choice of many: numbers
// of the mode, well inside of all cones, each a straight line in time through the last two choices.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "rbdyn/mechanics/contact_state.hpp"
#include "rbdyn/mechanics/friction_cones.hpp"
#include "rbdyn/mechanics/touched.hpp"
#include "rbdyn/mechanics/tree_model.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE bool TreeModel::shares_load(const Mode& mode) const {
    for (int k = 0; k < contacts(); ++k)
        if (mechanics::contact_state::is_given(mode.slip[at(k)]) ||
            (mechanics::contact_state::is_held(mode.slip[at(k)]) &&
             mechanics::ContactMemory::of(mode.memory, k).shares))
            return true;
    return false;
}

RBDYN_INLINE std::vector<std::string> TreeModel::sharing_contacts() const {
    std::vector<std::string> names;
    if (contacts() < 2) return names;
    std::vector<double> x = TreeModel::start(origin());
    const Mode mode = begin(origin(), x);
    if (!mode.impossible.empty() || !shares_load(mode)) return names;
    const auto all = mechanics::closing::moving<double>(*tree_, origin(), x);
    std::vector<int> rows = rows_, contact_of(at(conditions_->rows()), -1);
    const auto take = [&](int row, int contact) {
        rows.push_back(row);
        contact_of[at(row)] = contact;
    };
    for (int k = 0; k < contacts(); ++k) {
        const signed char state = mode.slip[at(k)];
        if (mechanics::contact_state::is_held(state))
            for (int axis = 0; axis < 3; ++axis) take(conditions_->held_row(k, axis), k);
        else if (state != flies)
            take(conditions_->normal_row(k), k);
    }
    const std::vector<int> used = mechanics::independent_rows(*tree_, *conditions_, rows, all, rows_.size());
    std::erase_if(rows, [&](int r) { return std::binary_search(used.begin(), used.end(), r); });
    std::vector<bool> is_one_of_many(at(contacts()), false);
    for (const auto& one : mechanics::dependences(*tree_, *conditions_, used, rows, all))
        for (std::size_t r = 0; r < one.size(); ++r)
            if (contact_of[r] >= 0 && std::abs(one[r]) > 1e-9) is_one_of_many[at(contact_of[r])] = true;
    for (int k = 0; k < contacts(); ++k)
        if (is_one_of_many[at(k)]) names.push_back(conditions_->contacts()[at(k)].name);
    return names;
}

RBDYN_INLINE bool TreeModel::share_load(const Mode& before, Mode& mode, double t,
                                        const std::vector<mechanics::Moving<double>>& all,
                                        const std::vector<int>& candidates, const std::vector<double>& b,
                                        const std::vector<double>& noise) const {
    Touched touched = this->touched(before, t, all, candidates, {}, false, &mode);
    const auto found = mechanics::held_by(touched.matrix, b, noise, touched.cones);
    Mode shared = mode;
    if (!found.is_solved || !take(before, shared, t, touched, found, b, noise, {})) return false;
    mode = std::move(shared);
    return true;
}

RBDYN_INLINE bool TreeModel::makes_no_difference(const Mode& mode, const Touched& touched, std::size_t one,
                                                 const std::vector<int>& chosen) const {
    // a unit of its force, and of the others what keeps their accelerations
    std::vector<mechanics::Row<double>> rows, acting;
    const auto every = conditions_->rows<double>(*tree_, touched.moving);
    const auto constraints = constraints_of(mode, every);
    const auto law = joint_law(mode, touched.t);
    const auto coupled = [&](const auto& of, const auto& by_what) {
        return friction::Coupled(*tree_, touched.moving, constraints, of, by_what, law ? &*law : nullptr);
    };
    for (std::size_t i = 0; i < touched.all.size(); ++i) {
        const int k = touched.all[i].contact;
        const auto f = static_cast<std::size_t>(touched.cones[i].first);
        if (i == one) continue;
        if (std::binary_search(chosen.begin(), chosen.end(), conditions_->normal_row(k))) {
            rows.push_back(touched.rows[f]);
            acting.push_back(touched.pushes[f]);
        }
        for (int axis = 0; axis < 3; ++axis)
            if (std::binary_search(chosen.begin(), chosen.end(), conditions_->held_row(k, axis))) {
                rows.push_back(every[at(conditions_->held_row(k, axis))]);
                acting.push_back(rows.back());
            }
    }
    const auto f = static_cast<std::size_t>(touched.cones[one].first);
    const mechanics::Square a = coupled(rows, acting).matrix(),
                            by = coupled(rows, std::vector{touched.pushes[f]}).matrix();
    std::vector<double> right;
    for (std::size_t i = 0; i < rows.size(); ++i) right.push_back(-by[i][0]);
    std::vector<double> impulses = mechanics::solve_any(a, right);
    acting.push_back(touched.pushes[f]);
    impulses.push_back(1.0);
    const friction::Coupled all = coupled(rows, acting);
    std::vector<double> alone(acting.size(), 0.0);
    alone.back() = 1.0;
    const std::vector<double> changes = all.changes(impulses), size = all.changes(alone);
    // directions at the edges of cones are known to the root of rounding until they are found as those of one motion
    const bool is_at_edge = std::ranges::any_of(touched.all, [&](const Touched::One& other) {
        return mechanics::contact_state::is_start(mode.slip[at(other.contact)]) &&
               mechanics::ContactMemory::of(mode.memory, other.contact).at_edge;
    });
    const double tolerance = is_at_edge ? 1e-6 : 1e-11;
    for (std::size_t i = 0; i < changes.size(); ++i)
        if (std::abs(changes[i]) > tolerance * (std::abs(size[i]) + *std::max_element(size.begin(), size.end())))
            return false;
    return true;
}

RBDYN_INLINE std::vector<double> TreeModel::forces_with_joints(
    const Mode& mode, double t, std::vector<double> x, const std::vector<std::size_t>& sharing,
    const std::vector<std::pair<int, int>>& loose, const std::vector<double>& force,
    const mechanics::Square& directions, const std::vector<mechanics::Cone>& cones, double size) const {
    // what joints exert, and what presses them, is linear in those forces
    const auto said = [&](int bumped, double by) {
        Mode tried = mode;
        for (std::size_t l = 0; l < loose.size(); ++l) {
            const auto [contact, axis] = loose[l];
            mechanics::ContactMemory memory = mechanics::ContactMemory::of(tried.memory, contact);
            memory.rate = Vector3::Zero();
            memory.since = t;
            if (static_cast<int>(l) == bumped) memory.force[axis] += by;
            memory.put(tried.memory, contact);
        }
        choose(tried, t, x, {}, true);
        return said_of_joints(tried, t, x);
    };
    constexpr std::size_t numbers = mechanics::JointMemory::said;
    const std::vector<double> none = said(-1, 0.0);
    for (const std::size_t j : sharing)
        size = std::max({size, std::abs(none[numbers * j]) / joints_[j].radius,
                         std::hypot(none[numbers * j + 1], none[numbers * j + 2])});
    if (!(size > 0.0)) return {};
    std::vector<std::vector<double>> by;
    for (std::size_t l = 0; l < loose.size(); ++l) {
        by.push_back(said(static_cast<int>(l), size));
        for (std::size_t i = 0; i < by.back().size(); ++i) by.back()[i] = (by.back()[i] - none[i]) / size;
    }
    // k e . R >= |T|, e the direction of R at an answer: |R| is no less
    const auto inside = [&](const std::vector<double>& at_last, bool is_other, std::vector<double>* nearest) {
        std::vector<double> whole = force;
        mechanics::Square ways = directions;
        std::vector<mechanics::Cone> with = cones;
        for (const std::size_t j : sharing) {
            const auto load = [&](const std::vector<double>& c, std::size_t k) {
                double sum = none[numbers * j + 1 + k];
                for (std::size_t l = 0; l < c.size(); ++l) sum += c[l] * by[l][numbers * j + 1 + k];
                return sum;
            };
            double e[2] = {load(at_last, 0), load(at_last, 1)};
            if (const double length = std::hypot(e[0], e[1]); !is_other && length > 1e-9 * size)
                for (double& part : e) part /= length;
            else
                for (std::size_t k = 0; k < 2; ++k)
                    e[k] = by[0][numbers * j + 1 + k] /
                           std::max(std::hypot(by[0][numbers * j + 1], by[0][numbers * j + 2]), 1e-300);
            // of a hinge over its radius, so that all are forces
            const double mu = joints_[j].mu_static, radius = joints_[j].radius;
            with.push_back({static_cast<int>(whole.size()), false, mu});
            whole.insert(whole.end(), {e[0] * none[numbers * j + 1] + e[1] * none[numbers * j + 2],
                                       none[numbers * j] / radius, 0.0});
            for (std::size_t l = 0; l < ways.size(); ++l)
                ways[l].insert(ways[l].end(), {e[0] * by[l][numbers * j + 1] + e[1] * by[l][numbers * j + 2],
                                               by[l][numbers * j] / radius, 0.0});
        }
        return mechanics::forces_inside(whole, ways, with, size, nearest);
    };
    const auto apart = [](const std::vector<double>& c, const std::vector<double>& other) {
        double change = 0.0;
        for (std::size_t l = 0; l < c.size(); ++l) change = std::max(change, std::abs(c[l] - other[l]));
        return change;
    };
    // as joints are pressed without what is loose, along another way of pressing, and where least is lacking there
    std::vector<double> nearest[2];
    const std::vector<double> nothing(loose.size(), 0.0);
    std::vector<double> parts;
    for (const bool is_other : {false, true}) {
        nearest[is_other ? 1 : 0] = nothing;
        if (parts.empty()) parts = inside(nothing, is_other, &nearest[is_other ? 1 : 0]);
    }
    for (std::vector<double>& near : nearest)
        for (int pass = 0; pass < 40 && parts.empty(); ++pass) {
            const std::vector<double> last = near;
            parts = inside(last, false, &near);
            if (apart(near, last) <= 1e-12 * size) break;
        }
    for (int pass = 0; pass < 7 && !parts.empty(); ++pass) {
        const std::vector<double> last = parts;
        parts = inside(last, false, nullptr);
        if (!parts.empty() && apart(parts, last) <= 1e-6 * size) break;
    }
    return parts;
}

RBDYN_INLINE bool TreeModel::hold_by_friction(const Mode& before, Mode& mode, double t, const Touched& touched,
                                              const std::vector<double>& force,
                                              const std::vector<mechanics::Moving<double>>& all,
                                              bool may_be_on_edges) const {
    using namespace mechanics::contact_state;
    std::vector<mechanics::Cone> cones;
    for (std::size_t i = 0; i < touched.cones.size(); ++i)
        if (const signed char state = mode.slip[at(touched.all[i].contact)]; state != flies) {
            // what slides is on the edge of its cone, and only has to push; but no foot begins to without an
            // acceleration beside one of the same bodies that is held
            const int k = touched.all[i].contact;
            const mechanics::ContactLaw& c = conditions_->contacts()[at(k)];
            const bool stays =
                is_start(state) && mechanics::ContactMemory::of(mode.memory, k).at_edge &&
                std::ranges::any_of(touched.all, [&](const Touched::One& other) {
                    const mechanics::ContactLaw& o = conditions_->contacts()[at(other.contact)];
                    return is_held(mode.slip[at(other.contact)]) && o.a.body == c.a.body && o.b.body == c.b.body;
                });
            cones.push_back(touched.cones[i]);
            cones.back().is_line = cones.back().is_line || (!is_held(state) && !stays);
        }
    const auto are_in = [&](const std::vector<double>& z) { return mechanics::are_inside(z, cones); };
    // forces along the axes that are held, from those that solve the problem: some along axes without rows are loose
    std::vector<mechanics::Row<double>> rows, acting, loose_rows;
    struct Place {
        std::size_t one;
        Vector3 along;
    };
    std::vector<Place> places, loose;
    const auto every = conditions_->rows<double>(*tree_, all);
    double size = 0.0;
    std::vector<std::pair<int, int>> names;
    for (std::size_t i = 0; i < touched.all.size(); ++i) {
        const Touched::One& one = touched.all[i];
        const signed char state = mode.slip[at(one.contact)];
        const auto f = static_cast<std::size_t>(touched.cones[i].first);
        // one.along is none where it does not slide
        const Vector3 along = one.at.normal - one.along * one.sliding;
        if (state == pushes || slides(state)) {
            rows.push_back(every[at(conditions_->normal_row(one.contact))]);
            acting.push_back(one.at.row(along, Vector3(Vector3::Zero())));
            places.push_back({i, along});
            size = std::max(size, std::abs(force[f]));
        }
        if (is_given(state)) {
            loose.push_back({i, along});
            loose_rows.push_back(one.at.row(along, Vector3(Vector3::Zero())));
            names.emplace_back(one.contact, 0);
            size = std::max(size, std::abs(force[f]));
            mechanics::ContactMemory memory = mechanics::ContactMemory::of(mode.memory, one.contact);
            memory.force = Vector3(force[f], 0, 0);
            memory.rate = Vector3::Zero();
            memory.since = t;
            memory.put(mode.memory, one.contact);
        }
        if (!is_held(state)) continue;
        Vector3 whole = Vector3::Zero();
        for (int j = 0; j < 3; ++j) whole += one.axes[j] * force[f + at(j)];
        size = std::max(size, whole.norm());
        mechanics::ContactMemory memory = mechanics::ContactMemory::of(mode.memory, one.contact);
        memory.shares = false;
        for (int axis = 0; axis < 3; ++axis) {
            const auto& row = every[at(conditions_->held_row(one.contact, axis))];
            const Vector3 e = one.at.held_axis(axis);
            memory.force[axis] = whole.dot(e);
            if (is_row(state, axis)) {
                rows.push_back(row);
                acting.push_back(row);
                places.push_back({i, e});
                memory.force[axis] = 0.0;
            } else {
                loose.push_back({i, e});
                loose_rows.push_back(row);
                names.emplace_back(one.contact, axis);
            }
        }
        memory.put(mode.memory, one.contact);
    }
    // joints that are held at rest share the load
    std::vector<std::size_t> sharing;
    for (std::size_t j = 0; j < joints_.size(); ++j)
        if (mode.slip[at(first_joint()) + j] == mechanics::joint_state::held) sharing.push_back(j);
    if (loose.empty() || (sharing.empty() && !(size > 0.0))) return are_in(force);
    // what a unit along each loose axis makes of all others
    const auto constraints = constraints_of(mode, every);
    const auto law = joint_law(mode, t);
    const mechanics::Square
        a = friction::Coupled(*tree_, all, constraints, rows, acting, law ? &*law : nullptr).matrix(),
        by = friction::Coupled(*tree_, all, constraints, rows, loose_rows, law ? &*law : nullptr).matrix();
    mechanics::Square directions;
    std::vector<std::size_t> alive;
    for (std::size_t l = 0; l < loose.size(); ++l) {
        std::vector<double> right, direction(force.size(), 0.0);
        double most = 0.0;
        for (std::size_t i = 0; i < rows.size(); ++i) {
            right.push_back(-by[i][l]);
            most = std::max(most, std::abs(by[i][l]));
        }
        // along an axis that nothing can move along there is no force, but that of joints
        if (sharing.empty() && !(most > 1e-13 * std::abs(a.empty() ? 0.0 : a[0][0]))) continue;
        const std::vector<double> answer = mechanics::solve_any(a, right);
        const auto put = [&](const Place& place, double times) {
            const auto f = static_cast<std::size_t>(touched.cones[place.one].first);
            if (touched.cones[place.one].is_line) {
                direction[f] += times;
                return;
            }
            for (int j = 0; j < 3; ++j) direction[f + at(j)] += times * touched.all[place.one].axes[j].dot(place.along);
        };
        put(loose[l], 1.0);
        for (std::size_t i = 0; i < rows.size(); ++i) put(places[i], answer[i]);
        directions.push_back(std::move(direction));
        alive.push_back(l);
    }
    std::vector<std::pair<int, int>> alive_names;
    for (const std::size_t l : alive) alive_names.push_back(names[l]);
    const std::vector<double> parts =
        sharing.empty() || directions.empty()
            ? mechanics::forces_inside(force, directions, cones, size)
            : forces_with_joints(mode, t, touched.state, sharing, alive_names, force, directions, cones, size);
    // the nearer to the edges of all cones, the less is known of which choice is well inside of them: a part of
    // rounding over the square of how far it is. One that is where it was to be, as far as that is known, changes as it
    // did: over a short time what is not known would be any rate
    std::vector<double> whole = force;
    for (std::size_t l = 0; l < parts.size(); ++l)
        for (std::size_t i = 0; i < whole.size(); ++i) whole[i] += parts[l] * directions[l][i];
    double inside = 1.0;
    for (const mechanics::Cone& cone : cones) {
        const auto f = static_cast<std::size_t>(cone.first);
        if (cone.is_line || !(cone.mu > 0.0) || !std::isfinite(cone.mu)) continue;
        inside = std::min(inside, 1.0 - std::hypot(whole[f + 1], whole[f + 2]) / (cone.mu * whole[f]));
    }
    const double known = inside > 0.0 ? 0x1p-46 / (inside * inside) : std::numeric_limits<double>::infinity();
    std::vector<double> apart(force.size(), 0.0);
    for (std::size_t l = 0; l < parts.size(); ++l) {
        const auto [contact, axis] = names[alive[l]];
        const mechanics::ContactMemory now = mechanics::ContactMemory::of(mode.memory, contact),
                                       last = mechanics::ContactMemory::of(before.memory, contact);
        const double off = now.force[axis] + parts[l] - last.force[axis] - last.rate[axis] * (t - last.since);
        for (std::size_t i = 0; i < apart.size(); ++i) apart[i] += off * directions[l][i];
    }
    bool is_foreseen = true;
    for (const mechanics::Cone& cone : cones) {
        const auto f = static_cast<std::size_t>(cone.first);
        const double along = cone.is_line ? 0.0 : std::hypot(apart[f + 1], apart[f + 2]);
        is_foreseen = is_foreseen && std::max(std::abs(apart[f]), along / std::min(cone.mu, 1.0)) <= known * size;
    }
    for (std::size_t i = 0; i < loose.size(); ++i) {
        const auto [contact, axis] = names[i];
        mechanics::ContactMemory memory = mechanics::ContactMemory::of(mode.memory, contact);
        const mechanics::ContactMemory last = mechanics::ContactMemory::of(before.memory, contact);
        const auto found = std::ranges::find(alive, i);
        const bool is_one = is_given(mode.slip[at(contact)]), is_alive = found != alive.end(),
                   goes_on = same_states(before, mode) && (is_one || last.shares) && t > last.since;
        memory.since = t;
        memory.rate[axis] = 0.0;
        if (!is_alive)
            memory.force[axis] = 0.0;
        else if (!is_one)
            memory.shares = true;
        if (is_alive && !parts.empty()) memory.force[axis] += parts[static_cast<std::size_t>(found - alive.begin())];
        // where the loads go on as they did, so do the forces inside the cones: then they end where the cones do.
        // Within the rounding of the time what has changed is no rate, and along a surface without bound nothing comes
        // to an end
        const bool is_now = t - last.since <= 1024.0 * epsilon * std::abs(t),
                   is_unbounded = sticks_without_bound(mode, contact) &&
                                  std::abs(loose[i].along.dot(touched.all[loose[i].one].at.normal)) <= 1e-12;
        if (goes_on && is_alive && !is_unbounded)
            memory.rate[axis] =
                is_foreseen || is_now ? last.rate[axis] : (memory.force[axis] - last.force[axis]) / (t - last.since);
        memory.put(mode.memory, contact);
    }
    if (directions.empty()) return are_in(force);
    if (!parts.empty() || !may_be_on_edges || !are_in(force)) return !parts.empty();
    // on the edges of cones it is held too, where joints that share the load hold what they have to
    Mode tried = mode;
    if (!sharing.empty()) choose(tried, t, touched.state, {}, true);
    const std::vector<double> said = sharing.empty() ? std::vector<double>() : said_of_joints(tried, t, touched.state);
    return std::ranges::all_of(sharing, [&](std::size_t j) {
        const double* const one = said.data() + mechanics::JointMemory::said * j;
        return std::abs(one[0]) <= joints_[j].mu_static * joints_[j].radius * std::hypot(one[1], one[2]);
    });
}

}  // namespace rbdyn::inline RBDYN_FORM
