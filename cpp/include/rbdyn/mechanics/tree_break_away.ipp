// Definitions of rbdyn/mechanics/tree_model.hpp: what breaks away, and what it does then.
//
// At the edge of its cone, where the coefficient does not fall, a slip begins with neither a speed nor an acceleration,
// against the force that held it. Where what is asked for turns, its direction d turns with it, and friction pulls the
// slip u back to that way at a rate like mu N / (m |u|), |u| like t^2: faster than any step follows. What it does is
// regular nevertheless: with d a series in t, u = O(t^2) along d is a condition on each order of d after the other,
// linear in it, for the acceleration across d has - mu N d_k / m in the order of t^k. The series diverges, as such do
// (k! in the place of 1), but a few terms of it hold for long enough to leave the rest to u/|u|.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include "rbdyn/expression/borrowed_series.hpp"
#include "rbdyn/expression/series_evaluator.hpp"
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
    // first, whether all that is at rest can be held
    if (breaking.empty() && (fired.doubtful.empty() || shares_load(before))) {
        found = mechanics::held_by(touched.matrix, b, noise, touched.cones);
        if (found.is_solved && take(before, mode, t, touched, found, b, noise, breaking)) {
            choose(mode, t, x, {}, true);
            return;
        }
        mode = undecided;
    }
    if (stopping.size() > at_rest.size()) see(at_rest);
    // what neither pushes nor moves has no direction to slide in
    const auto idles = [&](std::size_t i) {
        const auto f = static_cast<std::size_t>(touched.cones[i].first);
        double largest = 0.0, own = 0.0;
        for (const double one : found.force) largest = std::max(largest, std::abs(one));
        bool is_still = !touched.cones[i].is_line;
        for (std::size_t j = f; is_still && j < f + 3; ++j) {
            own = std::max(own, std::abs(found.force[j]));
            is_still = std::abs(found.rate[j]) <= 1e3 * noise[j];
        }
        return is_still && own <= 1e-13 * largest;
    };
    while (true) {
        for (std::size_t i = 0; i < candidates.size(); ++i) {
            const mechanics::ContactLaw& c = conditions_->contacts()[at(candidates[i])];
            touched.cones[i].mu = breaks(candidates[i]) ? c.mu_dynamic : c.mu_static;
        }
        found = mechanics::solve_cones(touched.matrix, b, noise, touched.cones);
        std::size_t more = breaking.size();
        for (std::size_t i = 0; i < candidates.size(); ++i)
            if (!touched.cones[i].is_line && found.states[i] == ConeState::slides && !breaks(candidates[i]) &&
                !idles(i))
                breaking.push_back(candidates[i]);
        if (breaking.size() == more) break;
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
    // what would have to pull opens, whatever rounding has left of its force
    const double largest = *std::max_element(found.force.begin(), found.force.end());
    for (std::size_t i = 0; i < candidates.size(); ++i) {
        const auto f = static_cast<std::size_t>(touched.cones[i].first);
        const bool is_fired =
            std::find(fired.doubtful.begin(), fired.doubtful.end(), candidates[i]) != fired.doubtful.end();
        if (!is_fired || found.force[f] > 1e-8 * largest) continue;
        found.states[i] = ConeState::open;
        for (std::size_t j = f; j < f + (touched.cones[i].is_line ? 1U : 3U); ++j) found.force[j] = 0.0;
    }
    // one that does nothing on the edge of opening or sliding is held with the others, if forces inside all cones are
    // left then
    mechanics::ConeForces marginal = found;
    bool is_marginal = false;
    for (std::size_t i = 0; i < candidates.size(); ++i) {
        if (touched.cones[i].is_line || found.states[i] == ConeState::held || breaks(candidates[i])) continue;
        if (std::find(fired.doubtful.begin(), fired.doubtful.end(), candidates[i]) != fired.doubtful.end()) continue;
        const auto f = static_cast<std::size_t>(touched.cones[i].first);
        bool is_none = true;
        for (std::size_t j = f; j < f + 3; ++j) is_none = is_none && std::abs(found.rate[j]) <= 1e3 * noise[j];
        if (!is_none) continue;
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
            const auto f = static_cast<std::size_t>(touched.cones[i].first);
            if (touched.cones[i].is_line || found.states[i] != ConeState::held || breaks(candidates[i])) continue;
            const double along = std::hypot(found.force[f + 1], found.force[f + 2]);
            if (along >= (1.0 - 1e-6) * touched.cones[i].mu * found.force[f]) breaking.push_back(candidates[i]);
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
        if (one.slides && slides(before.slip[at(k)]) && before.jumps == mode.jumps) {
            mode.slip[at(k)] = before.slip[at(k)];
            continue;
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
        if (mode.slip[at(k)] >= held) {
            for (int axis = 0; axis < 3; ++axis)
                if (is_chosen(conditions_->held_row(k, axis))) mode.slip[at(k)] += static_cast<signed char>(1 << axis);
        } else if (!is_rough(k) && found.states[i] != ConeState::open) {
            mode.slip[at(k)] = is_chosen(conditions_->normal_row(k)) ? pushes : rests;
        } else if (slides(mode.slip[at(k)]) && !is_chosen(conditions_->normal_row(k))) {
            // one of many forces that give this motion, if its friction does what that of the others would
            if (!makes_no_difference(mode, touched, i, chosen)) {
                mode.impossible =
                    "the forces of contacts that slide are not unique, and the motion depends on them, of " +
                    conditions_->contacts()[at(k)].name;
                return false;
            }
            mode.slip[at(k)] = rests;
        }
    }
    return hold_by_friction(before, mode, t, touched, found.force, all);
}

namespace breaking_away {

using mechanics::ContactMemory;

/// Speeds along and across the directions of slips that begin, as series in time.
struct Slips {
    static constexpr int order = ContactMemory::terms + 3;
    using Series = std::array<double, order + 1>;

    Slips(const Mode& mode, const std::vector<int>& of) : series_(mode.equations->program, order) {
        for (const int k : of) {
            std::vector<int> sides;
            int stops = -1;
            for (const Guard& guard : mode.equations->guards) {
                if (guard.contact != k || guard.joint >= 0) continue;
                if (guard.kind == EventKind::stick) stops = guard.output;
                if (guard.kind == EventKind::switching) sides.push_back(guard.output);
            }
            outputs_.push_back({stops, sides[0], sides[1]});
        }
    }

    void find(const Mode& mode, double t, std::span<const double> x) {
        series_.set_parameters(mode.parameters);
        series_.begin(t, 1.0);
        for (std::size_t i = 0; i < x.size(); ++i) series_.set_input(static_cast<int>(i), 0, x[i]);
        for (int k = 0; k <= order; ++k) {
            series_.advance(k);
            if (k < order) series_.integrate(k);
        }
        along.clear();
        across.clear();
        for (const auto& [speed, less, more] : outputs_) {
            Series a, c;
            for (int k = 0; k <= order; ++k) {
                a[static_cast<std::size_t>(k)] = series_.output(speed)[k];
                // m + across and m - across
                c[static_cast<std::size_t>(k)] = 0.5 * (series_.output(more)[k] - series_.output(less)[k]);
            }
            along.push_back(a);
            across.push_back(c);
        }
    }

    std::vector<Series> along, across;

private:
    SeriesEvaluator series_;
    std::vector<std::array<int, 3>> outputs_;
};

/// How velocities begin: the size of the first acceleration, and the time in which it changes by as much [s].
inline std::pair<double, double> first_pace(const Mode& mode, double t, std::span<const double> x, int positions) {
    constexpr int order = 6;
    const BorrowedSeries borrowed(mode.equations->program, order);
    SeriesEvaluator& series = *borrowed;
    series.set_parameters(mode.parameters);
    series.begin(t, 1.0);
    for (std::size_t i = 0; i < x.size(); ++i) series.set_input(static_cast<int>(i), 0, x[i]);
    for (int k = 0; k < order; ++k) {
        series.advance(k);
        series.integrate(k);
    }
    const auto size = [&](int k) {
        double largest = 0.0;
        for (int i = positions; i < static_cast<int>(x.size()); ++i)
            largest = std::max(largest, std::abs(series.coefficients(i)[k]));
        return largest;
    };
    const double first = size(1);
    double time = std::numeric_limits<double>::infinity();
    for (int k = 2; k <= order && first > 0.0; ++k)
        if (const double next = size(k); next > 0.0) time = std::min(time, std::pow(first / next, 1.0 / (k - 1)));
    return {first, time};
}

}  // namespace breaking_away

RBDYN_INLINE void TreeModel::curve(const Mode& before, Mode& mode, double t, std::span<const double> x) const {
    using mechanics::ContactMemory;
    namespace states = mechanics::contact_state;
    constexpr auto terms = static_cast<std::size_t>(ContactMemory::terms);
    std::vector<int> of, pulled;
    for (int k = 0; k < contacts(); ++k)
        if (mode.slip[at(k)] == states::starts && before.slip[at(k)] != states::starts)
            (ContactMemory::of(mode.memory, k).at_edge ? of : pulled).push_back(k);
    // what is pulled away keeps its first direction for as long as the time of its start is unknown, and what has no
    // size that would tell what is small for a small part of the time in which its acceleration changes
    if (!pulled.empty() && !mode.equations->program.has_calls()) {
        const auto [first, time] = breaking_away::first_pace(mode, t, x, tree_->positions());
        for (const int k : pulled) {
            ContactMemory memory = ContactMemory::of(mode.memory, k);
            if (memory.least <= 0x1p-43 * states::least_speed && std::isfinite(time))
                memory.least = 0x1p-43 * first * time;
            memory.least = std::max(memory.least, 8.0 * epsilon * std::abs(t) * first);
            memory.put(mode.memory, k);
        }
        own_parameters(mode, x);
    }
    if (of.empty() || mode.equations->program.has_calls()) return;
    const std::size_t count = of.size();
    Mode bent = mode;
    std::vector<ContactMemory> memories;
    for (const int k : of) {
        bent.slip[at(k)] = states::curves;
        memories.push_back(ContactMemory::of(mode.memory, k));
        memories.back().since = t;
        std::fill(std::begin(memories.back().angle), std::end(memories.back().angle), 0.0);
        memories.back().until = std::numeric_limits<double>::max();
    }
    const auto put = [&] {
        for (std::size_t i = 0; i < count; ++i) memories[i].put(bent.memory, of[i]);
    };
    put();
    choose(bent, t, x, {});
    breaking_away::Slips slips(bent, of);
    const auto find = [&] {
        put();
        own_parameters(bent, x);
        slips.find(bent, t, x);
    };
    find();
    // what a first coefficient of each does to the others
    const auto still = slips.across;
    mechanics::Square by(count, std::vector<double>(count));
    for (std::size_t j = 0; j < count; ++j) {
        memories[j].angle[0] = 1.0;
        find();
        memories[j].angle[0] = 0.0;
        for (std::size_t i = 0; i < count; ++i) by[i][j] = slips.across[i][2] - still[i][2];
    }
    find();
    for (std::size_t n = 0; n < terms; ++n)
        // what is asked for first is rounded, then what is left is taken away
        for (int turn = 0; turn < 3; ++turn) {
            std::vector<double> left;
            for (std::size_t i = 0; i < count; ++i)
                left.push_back(-slips.across[i][n + 2] * 0.5 * static_cast<double>(n + 2));
            const std::vector<double> more = mechanics::solve_any(by, left);
            for (std::size_t i = 0; i < count; ++i) memories[i].angle[n] += more[i];
            find();
        }
    // as long as the terms left out are nothing beside the slip, and it is drawn to its direction fast enough
    double until = std::numeric_limits<double>::infinity(), turned = 0.0;
    for (std::size_t i = 0; i < count; ++i) {
        const double grows = slips.along[i][2];
        if (!(grows > 0.0) || !(std::abs(by[i][i]) > 0.0)) return;
        until = std::min(until, std::abs(by[i][i]) / grows / 15.0);
        for (const std::size_t n : {terms, terms + 1})
            if (const double left = std::abs(slips.across[i][n + 2]); left > 0.0)
                until = std::min(until, std::pow(1e-13 * grows / left, 1.0 / static_cast<double>(n)));
    }
    if (!(until > 1e4 * epsilon * std::abs(t)) || !std::isfinite(until)) return;
    const auto all = moving(t, x);
    for (std::size_t i = 0; i < count; ++i) {
        ContactMemory& memory = memories[i];
        // from rest a slip has a direction from the first: what is small is so beside what it comes to by itself, in
        // the time in which its acceleration turns back
        double turns_back = until;
        for (std::size_t n = 3; n <= 6; ++n)
            if (const double next = std::abs(slips.along[i][n]); next > 0.0)
                turns_back = std::min(turns_back, std::pow(slips.along[i][2] / next, 1.0 / static_cast<double>(n - 2)));
        const double own = 0x1p-43 * slips.along[i][2] * turns_back * turns_back,
                     by_size = memory.least > 0x1p-43 * states::least_speed ? std::min(memory.least, own) : own;
        // the force at the edge of the cone is rounded, and may throw it back until it has grown by as much
        const double rounding = std::max(32.0 * epsilon * std::abs(by[i][i]), 2.0 * std::abs(slips.along[i][1]));
        memory.least = std::max({by_size, 0x1p-43 * speed_of(of[i], all), rounding * rounding / slips.along[i][2]});
        ContactMemory plain = ContactMemory::of(mode.memory, of[i]);
        plain.least = memory.least;
        plain.put(mode.memory, of[i]);
        double angle = 0.0;
        for (std::size_t n = terms; n-- > 0;) angle = (angle + memory.angle[n]) * until;
        turned = std::max(turned, std::abs(angle));
        memory.until = t + until;
    }
    own_parameters(mode, x);
    // what does not turn starts as what is straight does
    if (!(turned > 1e-10)) return;
    put();
    own_parameters(bent, x);
    mode = std::move(bent);
}

}  // namespace rbdyn::inline RBDYN_FORM
