// Definitions of rbdyn/mechanics/tree_model.hpp: which contacts that have come to rest push, and which open: those
// with 0 <= N, gap'' >= 0, one of each pair zero (C. Glocker, Set-Valued Force Laws, 2001).
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <span>
#include <utility>
#include <vector>

#include "rbdyn/basics/double_double_functions.hpp"
#include "rbdyn/expression/borrowed_series.hpp"
#include "rbdyn/expression/evaluate.hpp"
#include "rbdyn/expression/program.hpp"
#include "rbdyn/expression/series_evaluator.hpp"
#include "rbdyn/mechanics/complementarity.hpp"
#include "rbdyn/mechanics/contact_state.hpp"
#include "rbdyn/mechanics/touched.hpp"
#include "rbdyn/mechanics/tree_model.hpp"
#include "rbdyn/model/leading_sign.hpp"

namespace rbdyn::inline RBDYN_FORM {

namespace settling {

inline constexpr int most_zeros = 4;

/// How many of the first coefficients of a force in time are rounding: what they make of it within `time` is nothing
/// beside the forces that act, `size`. most_zeros + 1: it is none, as between bodies that fall together. Of equations
/// that call back no more than its value is told.
inline int zeros(const Mode& mode, double t, std::span<const double> x, int output, double size, double time) {
    constexpr double nothing = 1e-12;
    const Program& program = mode.equations->program;
    const int order = program.has_calls() ? 0 : most_zeros;
    const BorrowedSeries borrowed(program, order);
    SeriesEvaluator& series = *borrowed;
    series.set_parameters(mode.parameters);
    series.begin(t, 1.0);
    for (std::size_t i = 0; i < x.size(); ++i) series.set_input(static_cast<int>(i), 0, x[i]);
    double power = 1.0;
    for (int k = 0; k <= order; ++k, power *= time) {
        series.advance(k);
        if (k < order)
            for (int i = 0; i < program.inputs(); ++i) series.set_input(i, k + 1, series.output(i)[k] / (k + 1));
        if (std::abs(series.output(output)[k]) * power > nothing * size) return k;
    }
    return order + 1;
}

}  // namespace settling

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
    const auto opens = opening(mode, t, x, candidates);
    const std::vector<double>&b = opens.first, &noise = opens.second;
    const auto all = moving(t, x);
    // what has ended again at the instant at which loads were shared anew is at its edge
    const bool is_at_edge = !doubtful.empty() && std::ranges::any_of(candidates, [&](int k) {
        return before.slip[at(k)] == rests && mechanics::ContactMemory::of(before.memory, k).since == t;
    });
    // forces that depend on each other: all are closed if there are such that push everywhere
    if (doubtful.empty() || (shares_load(before) && !is_at_edge)) {
        if (depend(candidates, all) && share_load(before, mode, t, all, candidates, b, noise)) {
            choose(mode, t, x, {}, true);
            return;
        }
    }
    const auto a = coupling(all, candidates);
    const auto found = mechanics::solve_complementary(a, b, noise);
    // what forces make of an acceleration, and take again, leaves its rounding
    const auto is_level = [&](std::size_t i) {
        double size = noise[i];
        for (std::size_t j = 0; j < candidates.size(); ++j) size += 1e-13 * std::abs(a[i][j] * found.z[j]);
        return std::abs(found.w[i]) <= 8.0 * size;
    };
    std::vector<int> pushing = rows_, uncertain;
    for (std::size_t i = 0; i < candidates.size(); ++i) {
        const int k = candidates[i];
        const bool is_doubtful =
            std::find(doubtful.begin(), doubtful.end(), k) != doubtful.end() || (found.z[i] <= 0.0 && is_level(i));
        if (is_doubtful)
            uncertain.push_back(k);
        else if (found.z[i] > 0.0)
            pushing.push_back(conditions_->constraint_rows() + k);
    }
    const auto independent = mechanics::independent_rows(*tree_, *conditions_, pushing, all);
    const auto is_in = [&](const std::vector<int>& rows, int k) {
        return std::find(rows.begin(), rows.end(), conditions_->constraint_rows() + k) != rows.end();
    };
    std::vector<int> bearing, touching;
    std::ranges::copy_if(candidates, std::back_inserter(bearing), [&](int k) { return is_in(pushing, k); });
    std::ranges::copy_if(uncertain, std::back_inserter(touching),
                         [&](int k) { return std::ranges::find(doubtful, k) == doubtful.end(); });
    const std::vector<int> sharing = share_beside(before, mode, t, all, candidates, bearing, touching, b, noise);
    std::erase_if(uncertain, [&](int k) { return std::ranges::find(sharing, k) != sharing.end(); });
    // as many push as are independent, the others need no force of their own
    for (const int k : candidates)
        if (sharing.empty() && is_in(pushing, k)) {
            mode.slip[at(k)] = is_in(independent, k) ? pushes : rests;
            mechanics::ContactMemory().put(mode.memory, k);
        }
    choose(mode, t, x, {}, true);
    push_or_open(mode, t, x, uncertain, doubtful);
}

RBDYN_INLINE bool TreeModel::depend(const std::vector<int>& of,
                                    const std::vector<mechanics::Moving<double>>& all) const {
    std::vector<int> rows = rows_;
    for (const int k : of) rows.push_back(conditions_->normal_row(k));
    return mechanics::independent_rows(*tree_, *conditions_, rows, all, rows_.size()).size() < rows.size();
}

RBDYN_INLINE std::vector<int> TreeModel::share_beside(const Mode& before, Mode& mode, double t,
                                                      const std::vector<mechanics::Moving<double>>& all,
                                                      const std::vector<int>& candidates,
                                                      const std::vector<int>& bearing, const std::vector<int>& touching,
                                                      const std::vector<double>& b,
                                                      const std::vector<double>& noise) const {
    const auto is_in = [](const std::vector<int>& list, int k) { return std::ranges::find(list, k) != list.end(); };
    std::vector<int> sharing;
    const Mode open = mode;
    const auto shares = [&](const std::vector<int>& of) {
        std::vector<double> asked, rounding;
        for (std::size_t i = 0; i < candidates.size(); ++i)
            if (is_in(of, candidates[i])) {
                asked.push_back(b[i]);
                rounding.push_back(noise[i]);
            }
        Mode tried = open;
        if (!depend(of, all) || !share_load(before, tried, t, all, of, asked, rounding)) return false;
        mode = std::move(tried);
        sharing = of;
        return true;
    };
    // in the order of the candidates: those, and what touches, all of it or between the bodies that one is between
    const auto joined = [&](const std::vector<int>& of, const mechanics::ContactLaw* between) {
        std::vector<int> result;
        for (const int k : candidates) {
            const mechanics::ContactLaw& c = conditions_->contacts()[at(k)];
            const bool is_near = between == nullptr || (c.a.body == between->a.body && c.b.body == between->b.body);
            if (is_in(of, k) || (is_near && is_in(touching, k))) result.push_back(k);
        }
        return result;
    };
    const std::vector<int> every = joined(bearing, nullptr);
    if (!depend(every, all) || shares(every)) return sharing;
    shares(bearing);
    for (const int k : every) {
        const std::vector<int>& now = sharing.empty() ? bearing : sharing;
        if (!is_in(now, k)) shares(joined(now, &conditions_->contacts()[at(k)]));
    }
    return sharing;
}

RBDYN_INLINE void TreeModel::push_or_open(Mode& mode, double t, std::span<double> x, const std::vector<int>& uncertain,
                                          const std::vector<int>& doubtful) const {
    const auto all = moving(t, x);
    // the time in which all that acts on what a contact joins moves it as far as it is large
    const auto moves_in = [&](int k) {
        const mechanics::ContactLaw& c = conditions_->contacts()[at(k)];
        const mechanics::TreeState state = look(mode, t, x);
        double time = 0.0;
        for (const int i : {c.a.body, c.b.body}) {
            if (i < 0) continue;
            const double force = state.bodies[at(i)].effort.force.norm(),
                         way = size_of(k, state.moving) * static_cast<double>(tree_->node(i).mass);
            if (force > 0.0) time = std::max(time, std::sqrt(way / force));
        }
        return time;
    };
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
        else if (const int force = force_of(closed, k); force >= 0) {
            const int zeros = settling::zeros(closed, t, x, force, forces_at(k, look(closed, t, x)), moves_in(k));
            sign = zeros > settling::most_zeros ? 0 : leading_sign(closed, t, x, force, zeros);
        }
        if (sign >= 0 || (!has_fired && stands(closed, k, t, x))) mode = std::move(closed);
    }
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

}  // namespace rbdyn::inline RBDYN_FORM
