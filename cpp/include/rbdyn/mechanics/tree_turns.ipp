// Definitions of rbdyn/mechanics/tree_model.hpp: contacts that strike by turns, ever slower, and end without a force.
//
// Three balls in a row, or one between a wall and another, throw each other back and forth: where restitution is small
// the speeds left get less than rounding tells from none long before the time that is left does. Between these impacts
// gaps change as their rates and accelerations say, and an impact of contact i changes the rates u by
//     u_j += A_ji P,   P = -(1 + e_i) u_i / A_ii,   A = J M^-1 J^T   (Newton's law, see tree_strikes.ipp),
// which is linear in gaps, rates and accelerations: their limit is found in digits of their own size, however small.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>
#include <vector>

#include "rbdyn/basics/vector.hpp"
#include "rbdyn/mechanics/closure.hpp"
#include "rbdyn/mechanics/contact_state.hpp"
#include "rbdyn/mechanics/touched.hpp"
#include "rbdyn/mechanics/tree_model.hpp"

namespace rbdyn::inline RBDYN_FORM {

namespace bouncing {

/// Open contacts that strike one after the other.
struct Turns {
    std::vector<double> gap, rate, acceleration, restitution;
    std::vector<std::vector<double>> coupling;
    double time = 0.0;       // s: when the last of them strikes
    std::vector<int> ended;  // those that strike until then

    /// Whether they have such a limit, within a time. False: they part, or strike together what one impact does not
    /// decide.
    bool end(double longest);

private:
    static constexpr int most = 20000;
    // of the time so far, below which flights do not count
    static constexpr double shortest = 0x1p-56;

    std::size_t size() const { return gap.size(); }
    bool are_coupled(std::size_t i, std::size_t j) const {
        return std::abs(coupling[i][j]) > 1e-12 * std::sqrt(coupling[i][i] * coupling[j][j]);
    }
    /// When a contact strikes next.
    double next(std::size_t i) const;
    void strike(std::size_t i);
    void scale();
};

RBDYN_INLINE double Turns::next(std::size_t i) const {
    const double g = std::max(gap[i], 0.0), u = rate[i], w = acceleration[i];
    const double square = u * u - 2.0 * g * w;
    // zeros of g + u t + w t^2 / 2, without cancellation
    if (u < 0.0 && square >= 0.0) return 2.0 * g / (-u + std::sqrt(square));
    if (w < 0.0) return (u + std::sqrt(square)) / -w;
    return std::numeric_limits<double>::infinity();
}

RBDYN_INLINE void Turns::strike(std::size_t i) {
    const double u = rate[i], impulse = -(1.0 + restitution[i]) * u / coupling[i][i];
    for (std::size_t j = 0; j < size(); ++j) rate[j] += coupling[j][i] * impulse;
    rate[i] = -restitution[i] * u;
    gap[i] = 0.0;
}

RBDYN_INLINE void Turns::scale() {
    double largest = 0.0;
    for (const double u : rate)
        if (u < 0.0) largest = std::max(largest, -u);
    if (!(largest > 0.0 && largest < 0x1p-300)) return;
    for (auto* all : {&gap, &rate, &acceleration})
        for (double& one : *all) one *= 0x1p300;
}

RBDYN_INLINE bool Turns::end(double longest) {
    std::vector<int> last(size(), -1);
    const int some = 4 * static_cast<int>(size());
    for (int turn = 0, quiet = 0; turn < most; ++turn) {
        std::vector<double> times;
        for (std::size_t i = 0; i < size(); ++i) times.push_back(next(i));
        const auto first = std::ranges::min_element(times);
        const double flight = *first;
        const auto i = static_cast<std::size_t>(first - times.begin());
        if (!std::isfinite(flight)) return false;
        for (std::size_t j = 0; j < size(); ++j)
            if (j != i && times[j] - flight <= 1e-9 * flight && are_coupled(i, j)) return false;
        for (std::size_t j = 0; j < size(); ++j) {
            gap[j] = std::max(0.0, gap[j] + flight * (rate[j] + 0.5 * flight * acceleration[j]));
            rate[j] += flight * acceleration[j];
        }
        strike(i);
        last[i] = turn;
        time += flight;
        if (time > longest) return false;
        quiet = flight <= shortest * time ? quiet + 1 : 0;
        if (quiet <= some) {
            scale();
            continue;
        }
        for (std::size_t j = 0; j < size(); ++j)
            if (last[j] > turn - some) ended.push_back(static_cast<int>(j));
        return true;
    }
    return false;
}

}  // namespace bouncing

RBDYN_INLINE std::vector<int> TreeModel::ending_by_turns(const Mode& after, double t, std::span<const double> x,
                                                         std::span<const double> rest, const std::vector<int>& closed,
                                                         LeftOut& left) const {
    if (contacts() < 2 || conditions_->is_rough() || !follows_gaps()) return {};
    const auto all = moving(t, x);
    const std::vector<double> gaps = fine_gaps(t, x, rest);
    std::vector<int> near, listed;
    bouncing::Turns turns;
    double speed = 0.0, least = std::numeric_limits<double>::infinity(), most = 0.0;
    for (int k = 0; k < contacts(); ++k) {
        const mechanics::ContactLaw& c = conditions_->contacts()[at(k)];
        if (c.is_gone || after.slip[at(k)] != flies || !(gaps[at(k)] <= 1e-13 * size_of(k, all))) continue;
        const double u = fine_rate(k, t, x, rest);
        if (c.restitution >= 1.0 || u == 0.0) continue;
        near.push_back(k);
        turns.gap.push_back(std::max(gaps[at(k)], 0.0));
        turns.rate.push_back(u);
        turns.restitution.push_back(c.restitution);
        speed = std::max(speed, speed_of(k, all));
        least = std::min(least, std::abs(u));
        most = std::max(most, std::abs(u));
    }
    // what is left of the speeds is not yet less than what their rounding makes of any time
    if (near.size() < 2 || !(least <= slow_turn * speed || most * most <= epsilon * speed * speed)) return {};
    // what others hold is struck with them
    listed = near;
    for (int k = 0; k < contacts(); ++k)
        if (!conditions_->contacts()[at(k)].is_gone && after.slip[at(k)] != flies) listed.push_back(k);
    turns.coupling = coupling(all, listed);
    const auto& a = turns.coupling;
    for (std::size_t i = 0; i < near.size(); ++i)
        for (std::size_t j = near.size(); j < listed.size(); ++j)
            if (std::abs(a[i][j]) > 1e-12 * std::sqrt(a[i][i] * a[j][j])) return {};
    const auto [w, noise] = opening(after, t, x, near);
    double pull = 0.0;
    for (std::size_t i = 0; i < near.size(); ++i) {
        turns.acceleration.push_back(std::abs(w[i]) > noise[i] ? w[i] : 0.0);
        pull = std::max(pull, std::abs(turns.acceleration.back()));
    }
    // those that a force ends are followed as far as doubles go
    if (!turns.end(pull > 0.0 ? 0.5 * most / pull : std::numeric_limits<double>::infinity())) return {};
    // from where on what is left of the speeds is less than what their rounding makes of the times, and not later than
    // where impacts do not tell it from none
    const bool is_told = least <= slow_turn * speed,
               is_less = (most / speed) * (most / speed) <= epsilon * turns.time / std::max(std::abs(t), turns.time);
    if (!is_told && !is_less) return {};
    std::vector<int> group;
    for (const int i : turns.ended) group.push_back(near[at(i)]);
    const auto ends = [&](int k) { return std::ranges::find(group, k) != group.end(); };
    // what is thrown back for good strikes first
    if (group.size() < 2 || std::ranges::any_of(closed, [&](int k) { return after.slip[at(k)] == flies && !ends(k); }))
        return {};
    // directions change meanwhile, and what impulses do with them
    double turning = 0.0;
    for (const int k : group) {
        const mechanics::ContactLaw& c = conditions_->contacts()[at(k)];
        turning = std::max(turning, c.touching<double>(*tree_, all).normal_rate.norm());
        for (const mechanics::Anchor* end : {&c.a, &c.b})
            if (end->body >= 0 && !rounded(end->point).isZero(0.0))
                turning = std::max(turning, safe_norm(all[at(end->body)].omega));
    }
    std::ranges::stable_partition(group, [&](int k) { return std::ranges::find(closed, k) != closed.end(); });
    left.time = turns.time;
    left.is_by_turns = true;
    left.unsure = most / speed * std::abs(t) + turning * turns.time * turns.time;
    return group;
}

}  // namespace rbdyn::inline RBDYN_FORM
