// Definitions of rbdyn/mechanics/tree_model.hpp: what is held, what breaks away, and what opens.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include "rbdyn/mechanics/acceleration_at.hpp"
#include "rbdyn/mechanics/closure.hpp"
#include "rbdyn/mechanics/contact_state.hpp"
#include "rbdyn/mechanics/friction_cones.hpp"
#include "rbdyn/mechanics/touched.hpp"
#include "rbdyn/mechanics/tree_model.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE bool TreeModel::is_at_end(const Mode& before, int contact, double t, std::span<const double> x) const {
    const auto touching = conditions_->contacts()[at(contact)].touching<double>(*tree_, moving(before, t, x));
    const double left = touching.slip().norm();
    if (left <= 16.0 * mechanics::ContactMemory::of(before.memory, contact).least) return true;
    if (before.equations == nullptr) return false;
    const mechanics::TreeState slows = look(before, t, x);
    const auto [first, second] = slip_acceleration(touching, slows);
    double rate = std::hypot(first, second);
    // what a surface is driven with changes by the acceleration of that, however slowly the slip does
    if (is_driven())
        rate = std::max({rate, mechanics::acceleration_at(slows, touching.a, touching.arm_a).norm(),
                         mechanics::acceleration_at(slows, touching.b, touching.arm_b).norm()});
    return left <= 8.0 * epsilon * std::abs(t) * rate;
}

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
    // what has left its last direction by more than rounding has not stopped
    for (const int k : fired.stopping)
        if (is_at_end(before, k, t, x)) at_rest.push_back(k);
    // what was held is at rest, unless an impact has moved it
    for (int k = 0; k < contacts(); ++k)
        if (is_held(before.slip[at(k)]) && before.jumps == mode.jumps) at_rest.push_back(k);
    // what stops together does so within the rounding of its speeds
    std::vector<int> stopping = at_rest;
    if (!fired.stopping.empty() || !fired.rubbed_stopping.empty())
        for (const int k : candidates) {
            if (!slides(before.slip[at(k)]) && !(is_given(before.slip[at(k)]) && is_rough(k))) continue;
            if (is_at_end(before, k, t, x)) stopping.push_back(k);
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
        // where joints hold all of it no force accelerates it, and what of its acceleration is rounding of the forces
        // that hold them is none; another one is that of what turns on about them
        for (std::size_t k = 0; k < candidates.size() && !joints_.empty(); ++k) {
            const auto first = static_cast<std::size_t>(touched.cones[k].first);
            const double forces = 1e-12 * forces_at(candidates[k], open);
            for (std::size_t i = first; i < first + (touched.cones[k].is_line ? 1U : 3U); ++i) {
                const double alone = touched.coupled->alone(i);
                if (touched.matrix[i][i] > 1e-10 * alone) continue;
                std::ranges::fill(touched.matrix[i], 0.0);
                if (std::abs(b[i]) <= forces * alone) b[i] = 0.0;
            }
        }
    };
    see(stopping);
    const auto breaks = [&](int k) { return std::find(breaking.begin(), breaking.end(), k) != breaking.end(); };
    const Mode undecided = mode;
    mechanics::ConeForces found;
    // what comes to its edge goes past it, and so does what shares its load with a joint that does
    const bool may_be_on_edges =
        fired.breaking.empty() && (joints_.empty() || (fired.rubbed_breaking.empty() && fired.doubtful.empty()));
    // forces shared anew at this very instant that are at an edge again: no time is left in which some inside go on
    bool is_over = false;
    const bool is_any = !(fired.breaking.empty() && fired.doubtful.empty());
    for (int k = 0; k < contacts() && is_any && shares_load(before); ++k)
        if (const auto memory = mechanics::ContactMemory::of(before.memory, k);
            is_held(before.slip[at(k)]) && memory.shares)
            is_over = is_over || t - memory.since <= 16.0 * epsilon * std::abs(t);
    // what sticks without bound goes past its edge where it presses no more
    const bool goes_past = shares_load(before) &&
                           std::ranges::any_of(fired.doubtful, [&](int k) { return sticks_without_bound(before, k); });
    const bool on_edges = may_be_on_edges && !goes_past;
    const auto is_doubtful = [&](std::size_t i) {
        return std::find(fired.doubtful.begin(), fired.doubtful.end(), candidates[i]) != fired.doubtful.end();
    };
    const auto let_go_of = [&](mechanics::ConeForces& forces, std::size_t i) {
        const auto f = static_cast<std::size_t>(touched.cones[i].first);
        forces.states[i] = ConeState::open;
        for (std::size_t j = f; j < f + (touched.cones[i].is_line ? 1U : 3U); ++j) forces.force[j] = 0.0;
    };
    // what would have to pull opens, whatever rounding has left of its force
    const auto open_doubtful = [&](mechanics::ConeForces& forces) {
        const double largest = *std::max_element(forces.force.begin(), forces.force.end());
        for (std::size_t i = 0; i < candidates.size(); ++i) {
            const auto f = static_cast<std::size_t>(touched.cones[i].first);
            // friction without bound may be all of it
            const bool is_unbounded =
                !touched.cones[i].is_line && conditions_->contacts()[at(candidates[i])].never_slips();
            const double own =
                is_unbounded ? std::hypot(forces.force[f], forces.force[f + 1], forces.force[f + 2]) : forces.force[f];
            if (is_doubtful(i) && own <= 1e-8 * largest) let_go_of(forces, i);
        }
    };
    // first, whether all that is at rest can be held
    if (breaking.empty() && !is_over && (fired.doubtful.empty() || shares_load(before))) {
        found = mechanics::held_by(touched.matrix, b, noise, touched.cones);
        if (found.is_solved && take(before, mode, t, touched, found, b, noise, breaking, on_edges)) {
            choose(mode, t, x, {}, true);
            const std::vector<int> gone = press_no_more(before, mode, t, x, candidates, fired.doubtful);
            if (gone.empty()) return;
            // they are let go, and the others are held without them, if they can be
            Mode without = undecided;
            for (std::size_t i = 0; i < candidates.size(); ++i)
                if (std::ranges::find(gone, candidates[i]) != gone.end()) let_go_of(found, i);
            if (take(before, without, t, touched, found, b, noise, breaking, on_edges)) mode = std::move(without);
            choose(mode, t, x, {}, true);
            return;
        }
        mode = undecided;
    }
    if (goes_past) {
        if (let_go(before, mode, t, x, candidates, fired, breaking)) return;
        // let go it would move into its surface: it slides
        for (const int k : fired.doubtful)
            if (sticks_without_bound(before, k) && !breaks(k)) breaking.push_back(k);
    }
    if (stopping.size() > at_rest.size()) see(at_rest);
    const auto is_still = [&](std::size_t i) {
        const auto f = static_cast<std::size_t>(touched.cones[i].first);
        bool is_none = true;
        for (std::size_t j = f; j < f + 3; ++j) is_none = is_none && std::abs(found.rate[j]) <= 1e3 * noise[j];
        return is_none;
    };
    const auto is_on_edge = [&](std::size_t i, double to = 1e-6) {
        const auto f = static_cast<std::size_t>(touched.cones[i].first);
        return found.states[i] == ConeState::held &&
               std::hypot(found.force[f + 1], found.force[f + 2]) >= (1.0 - to) * touched.cones[i].mu * found.force[f];
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
    while (true) {
        for (std::size_t i = 0; i < candidates.size(); ++i) {
            const mechanics::ContactLaw& c = conditions_->contacts()[at(candidates[i])];
            touched.cones[i].mu = breaks(candidates[i]) ? touched.all[i].sliding : static_cast<double>(c.mu_static);
        }
        found = mechanics::solve_any_cones(touched.matrix, b, noise, touched.cones);
        std::vector<int> more, moving_off;
        mechanics::ConeForces held = found;
        double fastest = 0.0;
        const auto rate_of = [&](std::size_t i) {
            const auto f = static_cast<std::size_t>(touched.cones[i].first);
            return touched.cones[i].is_line ? 0.0 : std::hypot(found.rate[f + 1], found.rate[f + 2]);
        };
        for (std::size_t i = 0; i < candidates.size(); ++i) fastest = std::max(fastest, rate_of(i));
        for (std::size_t i = 0; i < candidates.size(); ++i) {
            if (touched.cones[i].is_line || breaks(candidates[i]) || idles(i)) continue;
            const bool slides = found.states[i] == ConeState::slides;
            if (!slides && !(is_over && is_on_edge(i))) continue;
            more.push_back(candidates[i]);
            held.states[i] = ConeState::held;
            // where something slides already forces are found one after the other, to less than their rounding
            if (slides && !is_still(i) && rate_of(i) > 1e-7 * fastest) moving_off.push_back(candidates[i]);
        }
        if (more.empty()) break;
        // what moves off does so first: beside it others may be on the edges of their cones by choice
        if (!is_over && !moving_off.empty()) more = moving_off;
        const bool is_slip = is_over || !moving_off.empty();
        // of forces that are one choice of many some are on an edge, and what slides there by rounding alone is held if
        // there are others
        open_doubtful(held);
        if (found.is_solved && !is_slip && take(before, mode, t, touched, held, b, noise, breaking, on_edges)) {
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
    // what bears nothing, where others of the same bodies begin to slide without an acceleration, begins with them:
    // their forces are one choice of many
    const auto begins_beside = [&](std::size_t i) {
        const mechanics::ContactLaw& c = conditions_->contacts()[at(candidates[i])];
        for (std::size_t j = 0; j < candidates.size(); ++j) {
            const mechanics::ContactLaw& other = conditions_->contacts()[at(candidates[j])];
            if (!touched.cones[j].is_line && found.states[j] == ConeState::slides && is_still(j) && !idles(j) &&
                other.a.body == c.a.body && other.b.body == c.b.body)
                return true;
        }
        return false;
    };
    for (std::size_t i = 0; i < candidates.size(); ++i) {
        if (touched.cones[i].is_line || !idles(i) || is_doubtful(i) || !begins_beside(i)) continue;
        found.states[i] = ConeState::slides;
        if (!breaks(candidates[i])) breaking.push_back(candidates[i]);
    }
    // what is on its edge when others begin to slide without an acceleration begins with them
    const std::size_t known = breaking.size();
    for (std::size_t i = 0; i < candidates.size(); ++i) {
        if (touched.cones[i].is_line || breaks(candidates[i]) || idles(i) || !is_on_edge(i, 1e-9)) continue;
        for (std::size_t j = 0; j < candidates.size(); ++j)
            if (!touched.cones[j].is_line && found.states[j] == ConeState::slides && is_still(j) && !idles(j)) {
                breaking.push_back(candidates[i]);
                break;
            }
    }
    if (breaking.size() > known) return settle_breaking(before, mode, t, x, candidates, fired, breaking);
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
    // one that does not press, where the others bear all of it, and moves along with them does not open: it slides
    for (std::size_t i = 0; i < candidates.size(); ++i) {
        if (touched.cones[i].is_line || found.states[i] != ConeState::open || is_doubtful(i)) continue;
        if (!parts(i) && !is_still(i)) found.states[i] = ConeState::slides;
    }
    // one that does nothing on the edge of opening or sliding is held with the others, if forces inside all cones are
    // left then
    mechanics::ConeForces marginal = found;
    bool is_marginal = false;
    for (std::size_t i = 0; i < candidates.size(); ++i) {
        if (touched.cones[i].is_line || found.states[i] == ConeState::held || breaks(candidates[i])) continue;
        if (is_doubtful(i) || !is_still(i) || parts(i)) continue;
        marginal.states[i] = ConeState::held;
        is_marginal = true;
    }
    if (!is_marginal || !take(before, mode, t, touched, marginal, b, noise, breaking, on_edges)) {
        mode = undecided;
        bool is_inside = take(before, mode, t, touched, found, b, noise, breaking, on_edges), lets_go = false;
        // what is held without a force, where none is inside its cone, touches and does no more
        for (std::size_t i = 0; i < candidates.size() && !is_inside && mode.impossible.empty(); ++i)
            if (found.states[i] == ConeState::held && !breaks(candidates[i]) && idles(i)) {
                found.states[i] = ConeState::open;
                lets_go = true;
            }
        if (lets_go) {
            mode = undecided;
            is_inside = take(before, mode, t, touched, found, b, noise, breaking, on_edges);
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

RBDYN_INLINE bool TreeModel::sticks_without_bound(const Mode& mode, int contact) const {
    return conditions_->contacts()[at(contact)].never_slips() &&
           mechanics::contact_state::is_held(mode.slip[at(contact)]);
}

/// What sticks without bound and presses no more is let go, unless it would move into its surface then.
RBDYN_INLINE bool TreeModel::let_go(const Mode& before, Mode& mode, double t, std::span<double> x,
                                    const std::vector<int>& candidates, const Fired& fired,
                                    const std::vector<int>& breaking) const {
    std::vector<int> others = candidates, gone;
    for (const int k : fired.doubtful)
        if (sticks_without_bound(before, k)) gone.push_back(k);
    Fired left = fired;
    for (auto* const list : {&others, &left.doubtful})
        std::erase_if(*list, [&](int k) { return std::ranges::find(gone, k) != gone.end(); });
    // of the accelerations without contacts
    const mechanics::TreeState open = look(mode, t, x);
    Mode tried = mode;
    settle_breaking(before, tried, t, x, others, left, breaking);
    if (!tried.impossible.empty()) return false;
    const mechanics::TreeState state = look(tried, t, x);
    const auto rows = conditions_->rows<double>(*tree_, state.moving);
    for (const int k : gone) {
        const auto& row = rows[at(conditions_->normal_row(k))];
        if (acceleration_along(row, state).first < -1e-11 * acceleration_along(row, open).second) return false;
    }
    mode = std::move(tried);
    return true;
}

}  // namespace rbdyn::inline RBDYN_FORM
