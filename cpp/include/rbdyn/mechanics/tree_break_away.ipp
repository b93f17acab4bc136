// Definitions of rbdyn/mechanics/tree_model.hpp: what is held, what breaks away, and what opens.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include "rbdyn/mechanics/closure.hpp"
#include "rbdyn/mechanics/contact_state.hpp"
#include "rbdyn/mechanics/friction_cones.hpp"
#include "rbdyn/mechanics/touched.hpp"
#include "rbdyn/mechanics/tree_model.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE void TreeModel::settle_breaking(const Mode& before, Mode& mode, double t, std::span<double> x,
                                             const std::vector<int>& candidates, const Fired& fired,
                                             std::vector<int> breaking) const {
    using mechanics::ConeState;
    using namespace mechanics::contact_state;
    for (const int k : candidates) mode.slip[at(k)] = flies;
    choose(mode, t, x, {}, true);
    if (candidates.empty()) return;
    const mechanics::TreeState open = look(mode, t, x);
    const auto& all = open.moving;
    std::vector<int> at_rest = fired.stuck;
    // what has left its last direction by more than rounding, or than it loses within the rounding of the time at which
    // its end is located, has not stopped
    const auto lost_in_time = [&](const mechanics::Touching<double>& touching) {
        if (before.equations == nullptr) return 0.0;
        const mechanics::TreeState slows = look(before, t, x);
        const auto along = [&](const Vector3& axis) {
            return acceleration_along(touching.row(axis, Vector3(Vector3::Zero())), slows).first;
        };
        const auto [first, second] = friction::across(touching.normal);
        return 8.0 * epsilon * std::abs(t) * std::hypot(along(first), along(second));
    };
    for (const int k : fired.stopping) {
        const auto touching = conditions_->contacts()[at(k)].touching<double>(*tree_, all);
        const double left = touching.slip().norm();
        if (left <= 16.0 * mechanics::ContactMemory::of(before.memory, k).least || left <= lost_in_time(touching))
            at_rest.push_back(k);
    }
    // what was held is at rest, unless an impact has moved it
    for (int k = 0; k < contacts(); ++k)
        if (is_held(before.slip[at(k)]) && before.jumps == mode.jumps) at_rest.push_back(k);
    // what stops together does so within the rounding of its speeds
    std::vector<int> stopping = at_rest;
    if (!fired.stopping.empty())
        for (const int k : candidates) {
            if (!mechanics::contact_state::slides(before.slip[at(k)])) continue;
            const double speed = conditions_->contacts()[at(k)].touching<double>(*tree_, all).slip().norm();
            if (speed <= 16.0 * mechanics::ContactMemory::of(before.memory, k).least) stopping.push_back(k);
        }
    Touched touched;
    std::vector<double> b, noise;
    const auto see = [&](const std::vector<int>& resting) {
        touched = this->touched(before, t, all, candidates, resting, false, &mode);
        touched.state.assign(x.begin(), x.end());
        b.clear();
        noise.clear();
        for (const auto& row : touched.rows) {
            const auto [sum, size] = acceleration_along(row, open);
            b.push_back(sum);
            noise.push_back(1e-14 * size);
        }
        // where joints hold all of it nothing drives it but rounding
        for (std::size_t i = 0; i < b.size() && !joints_.empty(); ++i)
            if (!(touched.matrix[i][i] > 1e-10 * touched.coupled->alone(i))) b[i] = 0.0;
    };
    see(stopping);
    const auto breaks = [&](int k) { return std::find(breaking.begin(), breaking.end(), k) != breaking.end(); };
    const Mode undecided = mode;
    mechanics::ConeForces found;
    // forces shared anew at this very instant that are at an edge again: no time is left in which some inside go on
    bool is_over = false;
    for (int k = 0; k < contacts() && !fired.breaking.empty() && shares_load(before); ++k)
        if (const auto memory = mechanics::ContactMemory::of(before.memory, k);
            is_held(before.slip[at(k)]) && memory.shares)
            is_over = is_over || t - memory.since <= 16.0 * epsilon * std::abs(t);
    // first, whether all that is at rest can be held
    if (breaking.empty() && !is_over && (fired.doubtful.empty() || shares_load(before))) {
        found = mechanics::held_by(touched.matrix, b, noise, touched.cones);
        if (found.is_solved && take(before, mode, t, touched, found, b, noise, breaking)) {
            choose(mode, t, x, {}, true);
            return;
        }
        mode = undecided;
    }
    if (stopping.size() > at_rest.size()) see(at_rest);
    const auto is_still = [&](std::size_t i) {
        const auto f = static_cast<std::size_t>(touched.cones[i].first);
        bool is_none = true;
        for (std::size_t j = f; j < f + 3; ++j) is_none = is_none && std::abs(found.rate[j]) <= 1e3 * noise[j];
        return is_none;
    };
    const auto is_on_edge = [&](std::size_t i) {
        const auto f = static_cast<std::size_t>(touched.cones[i].first);
        return found.states[i] == ConeState::held && std::hypot(found.force[f + 1], found.force[f + 2]) >=
                                                         (1.0 - 1e-6) * touched.cones[i].mu * found.force[f];
    };
    // what neither pushes nor moves has no direction to slide in
    const auto idles = [&](std::size_t i) {
        if (touched.cones[i].is_line || !is_still(i)) return false;
        const auto f = static_cast<std::size_t>(touched.cones[i].first);
        double largest = 0.0, own = 0.0;
        for (const double one : found.force) largest = std::max(largest, std::abs(one));
        for (std::size_t j = f; j < f + 3; ++j) own = std::max(own, std::abs(found.force[j]));
        return own <= 1e-13 * largest;
    };
    // what would have to pull opens, whatever rounding has left of its force
    const auto open_doubtful = [&](mechanics::ConeForces& forces) {
        const double largest = *std::max_element(forces.force.begin(), forces.force.end());
        for (std::size_t i = 0; i < candidates.size(); ++i) {
            const auto f = static_cast<std::size_t>(touched.cones[i].first);
            const bool is_fired =
                std::find(fired.doubtful.begin(), fired.doubtful.end(), candidates[i]) != fired.doubtful.end();
            // friction without bound may be all of it
            const bool is_unbounded =
                !touched.cones[i].is_line && conditions_->contacts()[at(candidates[i])].never_slips();
            const double own =
                is_unbounded ? std::hypot(forces.force[f], forces.force[f + 1], forces.force[f + 2]) : forces.force[f];
            if (!is_fired || own > 1e-8 * largest) continue;
            forces.states[i] = ConeState::open;
            for (std::size_t j = f; j < f + (touched.cones[i].is_line ? 1U : 3U); ++j) forces.force[j] = 0.0;
        }
    };
    while (true) {
        for (std::size_t i = 0; i < candidates.size(); ++i) {
            const mechanics::ContactLaw& c = conditions_->contacts()[at(candidates[i])];
            touched.cones[i].mu = breaks(candidates[i]) ? c.sliding() : static_cast<double>(c.mu_static);
        }
        found = mechanics::solve_any_cones(touched.matrix, b, noise, touched.cones);
        std::vector<int> more;
        mechanics::ConeForces held = found;
        bool is_slip = is_over;
        for (std::size_t i = 0; i < candidates.size(); ++i) {
            if (touched.cones[i].is_line || breaks(candidates[i]) || idles(i)) continue;
            const bool slides = found.states[i] == ConeState::slides;
            if (!slides && !(is_over && is_on_edge(i))) continue;
            more.push_back(candidates[i]);
            held.states[i] = ConeState::held;
            is_slip = is_slip || (slides && !is_still(i));
        }
        if (more.empty()) break;
        // of forces that are one choice of many some are on an edge, and what slides there by rounding alone is held if
        // there are others
        open_doubtful(held);
        if (found.is_solved && !is_slip && take(before, mode, t, touched, held, b, noise, breaking)) {
            choose(mode, t, x, {}, true);
            return;
        }
        mode = undecided;
        breaking.insert(breaking.end(), more.begin(), more.end());
    }
    if (!found.is_solved) {
        mode.impossible = no_forces("forces", candidates);
        return;
    }
    for (std::size_t i = 0; i < candidates.size(); ++i)
        if (found.states[i] == ConeState::slides && !breaks(candidates[i]) && idles(i)) {
            found.states[i] = ConeState::open;
            const auto f = static_cast<std::size_t>(touched.cones[i].first);
            for (std::size_t j = f; j < f + 3; ++j) found.force[j] = 0.0;
        }
    open_doubtful(found);
    // what forces elsewhere do not press, and what parts by more than its own rounding, is open
    const auto parts = [&](std::size_t i) {
        if (found.states[i] != ConeState::open) return false;
        const auto f = static_cast<std::size_t>(touched.cones[i].first);
        double size = noise[f];
        for (std::size_t j = 0; j < found.force.size(); ++j)
            size += 1e-11 * std::abs(touched.matrix[f][j] * found.force[j]);
        const bool has_landed =
            std::find(fired.landing.begin(), fired.landing.end(), candidates[i]) != fired.landing.end();
        return found.rate[f] > size || (has_landed && before.jumps == mode.jumps);
    };
    // one that does nothing on the edge of opening or sliding is held with the others, if forces inside all cones are
    // left then
    mechanics::ConeForces marginal = found;
    bool is_marginal = false;
    for (std::size_t i = 0; i < candidates.size(); ++i) {
        if (touched.cones[i].is_line || found.states[i] == ConeState::held || breaks(candidates[i])) continue;
        if (std::find(fired.doubtful.begin(), fired.doubtful.end(), candidates[i]) != fired.doubtful.end()) continue;
        if (!is_still(i) || parts(i)) continue;
        marginal.states[i] = ConeState::held;
        is_marginal = true;
    }
    if (!is_marginal || !take(before, mode, t, touched, marginal, b, noise, breaking)) {
        mode = undecided;
        bool is_inside = take(before, mode, t, touched, found, b, noise, breaking), lets_go = false;
        // what is held without a force, where none is inside its cone, touches and does no more
        for (std::size_t i = 0; i < candidates.size() && !is_inside && mode.impossible.empty(); ++i)
            if (found.states[i] == ConeState::held && !breaks(candidates[i]) && idles(i)) {
                found.states[i] = ConeState::open;
                lets_go = true;
            }
        if (lets_go) {
            mode = undecided;
            is_inside = take(before, mode, t, touched, found, b, noise, breaking);
        }
        // forces on the edges of their cones, and none inside: what is on its edge slides
        std::size_t more = breaking.size();
        for (std::size_t i = 0; i < candidates.size() && !is_inside && mode.impossible.empty(); ++i) {
            if (!touched.cones[i].is_line && !breaks(candidates[i]) && is_on_edge(i)) breaking.push_back(candidates[i]);
        }
        if (breaking.size() > more) return settle_breaking(before, mode, t, x, candidates, fired, breaking);
    }
    if (mode.impossible.empty()) choose(mode, t, x, {}, true);
}

RBDYN_INLINE bool TreeModel::take(const Mode& before, Mode& mode, double t, Touched& touched,
                                  const mechanics::ConeForces& found, const std::vector<double>& b,
                                  const std::vector<double>& noise, const std::vector<int>& breaking) const {
    using mechanics::ConeState;
    using namespace mechanics::contact_state;
    const std::vector<mechanics::Moving<double>>& all = touched.moving;
    const auto breaks = [&](int k) { return std::find(breaking.begin(), breaking.end(), k) != breaking.end(); };
    std::vector<int> candidates;
    for (const Touched::One& one : touched.all) candidates.push_back(one.contact);
    // sliding forces come first, then what is held
    std::vector<int> rows = rows_without_contacts(mode);
    for (std::size_t i = 0; i < candidates.size(); ++i) {
        const int k = candidates[i];
        Touched::One& one = touched.all[i];
        const auto f = static_cast<std::size_t>(touched.cones[i].first);
        if (found.states[i] == ConeState::open) continue;
        if (!is_rough(k)) {
            rows.push_back(conditions_->normal_row(k));
            continue;
        }
        mechanics::ContactMemory memory = mechanics::ContactMemory::of(mode.memory, k);
        const bool begins = !one.slides && (found.states[i] == ConeState::slides || breaks(k));
        if (!one.slides && !begins) continue;
        rows.push_back(conditions_->normal_row(k));
        // a motion that an impact or its own stop did not touch goes on in its form
        if (one.slides && before.jumps == mode.jumps) {
            const signed char was = before.slip[at(k)];
            if (slides(was) || was == veers) {
                mode.slip[at(k)] = was == veers ? mechanics::contact_state::turning : was;
                continue;
            }
        }
        if (begins) {
            const Vector3 rate = one.axes[1] * found.rate[f + 1] + one.axes[2] * found.rate[f + 2],
                          force = one.axes[1] * found.force[f + 1] + one.axes[2] * found.force[f + 2];
            one.along = (rate.norm() > 1e3 * (noise[f + 1] + noise[f + 2]) ? rate : Vector3(-force)).normalized();
        }
        double fastest = speed_of(k, all), size = 0.0;
        for (std::size_t j = f; j < f + (touched.cones[i].is_line ? 1U : 3U); ++j)
            size = std::max(size, std::max(std::abs(b[j]), std::abs(found.rate[j])));
        memory.axis = one.at.normal.cross(one.along);
        memory.least = 0x1p-43 * std::max({fastest, std::sqrt(size * size_of(k, all)), least_speed});
        memory.at_edge =
            begins && std::hypot(found.rate[f + 1], found.rate[f + 2]) <= 1e-9 * std::hypot(b[f], b[f + 1], b[f + 2]);
        if (begins) memory.since = t;
        memory.put(mode.memory, k);
        mode.slip[at(k)] = begins ? mechanics::contact_state::starts : straight;
    }
    const std::size_t first = rows.size();
    for (std::size_t i = 0; i < candidates.size(); ++i) {
        const int k = candidates[i];
        if (touched.cones[i].is_line || found.states[i] != ConeState::held || breaks(k)) continue;
        for (int axis = 0; axis < 3; ++axis) rows.push_back(conditions_->held_row(k, axis));
        mode.slip[at(k)] = held;
    }
    const auto chosen = mechanics::independent_rows(*tree_, *conditions_, rows, all, first);
    const auto is_chosen = [&](int row) { return std::binary_search(chosen.begin(), chosen.end(), row); };
    for (std::size_t i = 0; i < candidates.size(); ++i) {
        const int k = candidates[i];
        if (is_held(mode.slip[at(k)])) {
            for (int axis = 0; axis < 3; ++axis)
                if (is_chosen(conditions_->held_row(k, axis))) mode.slip[at(k)] += static_cast<signed char>(1 << axis);
        } else if (!is_rough(k) && found.states[i] != ConeState::open) {
            mode.slip[at(k)] = is_chosen(conditions_->normal_row(k)) ? pushes : rests;
        } else if (slides(mode.slip[at(k)]) && !is_chosen(conditions_->normal_row(k))) {
            // one of many forces that give this motion, if its friction does what that of the others would
            if (!makes_no_difference(mode, touched, i, chosen)) {
                mode.impossible = not_unique({k});
                return false;
            }
            mode.slip[at(k)] = follows_slip(mode.slip[at(k)]) ? veers : rests;
        }
    }
    return hold_by_friction(before, mode, t, touched, found.force, all);
}

}  // namespace rbdyn::inline RBDYN_FORM
