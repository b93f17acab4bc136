// Definitions of rbdyn/mechanics/tree_model.hpp: bounces that get ever shorter, without end.
//
// A contact that bounces alone begins each flight at its surface, and is known as far as its time and its speed are.
// Where several bounce by turns, as the ends of a rod do, each flies on while others strike: how high it is then, which
// is less than the rounding of its gap in doubles, is known by the digits of the state beyond doubles. So what is
// struck is put on its surface to 32 digits, and gaps are searched from values of as many (event/search_low.ipp).
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <limits>
#include <span>
#include <vector>

#include "rbdyn/basics/double_double_functions.hpp"
#include "rbdyn/basics/instant.hpp"
#include "rbdyn/expression/rounding_sizes.hpp"
#include "rbdyn/mechanics/closure.hpp"
#include "rbdyn/mechanics/contact_state.hpp"
#include "rbdyn/mechanics/tree_model.hpp"

namespace rbdyn::inline RBDYN_FORM {

namespace bouncing {

/// A state of two doubles a number.
inline std::vector<DoubleDouble> wide(std::span<const double> x, std::span<const double> rest) {
    std::vector<DoubleDouble> result;
    for (std::size_t i = 0; i < x.size(); ++i) result.push_back(DoubleDouble(exact_sum(x[i], rest[i])));
    return result;
}

}  // namespace bouncing

RBDYN_INLINE void TreeModel::make_attitudes_unit(std::span<double> x, std::span<double> rest) const {
    const auto turns = [](const mechanics::Node& n) { return n.joint.attitude() >= 0; };
    if (std::ranges::none_of(tree_->nodes(), turns)) return;
    std::vector<DoubleDouble> wide = bouncing::wide(x, rest);
    // what a piece leaves of it, and then what is left of that
    for (int pass = 0; pass < 2; ++pass) mechanics::closing::normalize<DoubleDouble>(*tree_, wide);
    for (std::size_t i = 0; i < x.size(); ++i) {
        x[i] = wide[i].hi;
        rest[i] = wide[i].lo;
    }
}

RBDYN_INLINE bool TreeModel::goes_on_bouncing(int contact, double t, double flight, double speed,
                                              const std::vector<mechanics::Moving<double>>& all) const {
    const double e = conditions_->contacts()[at(contact)].restitution;
    return e * flight > many_roundings * epsilon * std::abs(t) &&
           e * speed > 1e3 * slowest_bounce * (speed_of(contact, all) + 2.0 * speed);
}

RBDYN_INLINE bool TreeModel::follows_together(const Mode& mode) const {
    // what slides meanwhile begins a flight anew where it turns
    bool none_slides = true;
    for (int k = 0; k < contacts(); ++k) {
        const signed char state = mode.slip[at(k)];
        const bool is_smooth = !leaves_out() && !is_rough(k);
        none_slides = none_slides && (state == flies || is_smooth || mechanics::contact_state::is_held(state));
    }
    return none_slides && follows_gaps();
}

RBDYN_INLINE bool TreeModel::follows_gaps() const {
    // joints that turn back in a flight begin it anew
    const bool all_lose = std::ranges::all_of(conditions_->contacts(),
                                              [](const mechanics::ContactLaw& c) { return c.restitution < 1.0; });
    return joints_.empty() && resistances() == 0 && (!leaves_out() || all_lose);
}

RBDYN_INLINE std::vector<int> TreeModel::reached(const std::vector<int>& closed,
                                                 const std::vector<int>& landing) const {
    const bool is_joined = std::ranges::any_of(tree_->nodes(), [](const mechanics::Node& n) { return n.parent >= 0; });
    if (is_joined || !rows_.empty() || !joints_.empty()) return closed;
    std::vector<bool> moves(at(bodies()), false), is_reached(at(contacts()), false);
    const auto reach = [&](int k) {
        is_reached[at(k)] = true;
        for (const int i : {conditions_->contacts()[at(k)].a.body, conditions_->contacts()[at(k)].b.body})
            if (i >= 0) moves[at(i)] = true;
    };
    std::ranges::for_each(landing, reach);
    for (bool goes_on = true; goes_on;) {
        goes_on = false;
        for (const int k : closed) {
            const mechanics::ContactLaw& c = conditions_->contacts()[at(k)];
            if (is_reached[at(k)] ||
                std::ranges::none_of(std::array{c.a.body, c.b.body}, [&](int i) { return i >= 0 && moves[at(i)]; }))
                continue;
            reach(k);
            goes_on = true;
        }
    }
    std::vector<int> result;
    std::ranges::copy_if(closed, std::back_inserter(result), [&](int k) { return is_reached[at(k)]; });
    return result;
}

RBDYN_INLINE std::vector<int> TreeModel::collapsing(const Mode& before, const Mode& after, double t,
                                                    std::span<double> x, std::span<const double> rest,
                                                    const std::vector<int>& closed, Strokes& strokes) const {
    constexpr int most = 1000;
    const auto rates = [&](const std::vector<mechanics::Moving<double>>& all) {
        const auto rows = conditions_->rows<double>(*tree_, all);
        std::vector<double> u;
        for (int k = 0; k < contacts(); ++k)
            u.push_back(mechanics::Conditions::rate(rows[at(conditions_->normal_row(k))], all));
        return u;
    };
    std::vector<double> y(x.begin(), x.end());
    auto all = moving(t, y);
    std::vector<double> u = rates(all);
    const std::vector<double> gaps = fine_gaps(t, x, rest);
    // what touches at this very instant
    double first = 0.0;
    std::vector<int> near;
    for (int k = 0; k < contacts(); ++k)
        if (const double late = 4.0 * epsilon * std::abs(t) * speed_of(k, all);
            !conditions_->contacts()[at(k)].is_gone && gaps[at(k)] <= std::max(1e-13 * size_of(k, all), late))
            near.push_back(k);
    for (const int k : near) first = std::max(first, -u[at(k)]);
    std::erase_if(near, [&](int k) {
        return after.slip[at(k)] == flies && gaps[at(k)] > 16.0 * epsilon * (size_of(k, all) + first * std::abs(t));
    });
    std::vector<bool> strikes(at(contacts()), false);
    // how fast each came last, what part that was of the time before, and how much that part has changed
    struct Series {
        double speed = 0.0, ratio = 0.0, change = 1.0;
        int turn = 0;
        bool is_geometric() const { return ratio < 1.0 && change <= 1e-9 * (1.0 - ratio); }
    };
    std::vector<Series> series(at(contacts()));
    Strokes last;
    for (int turn = 0;; ++turn) {
        const auto slow = [&](int k) { return slowest_bounce * std::max(speed_of(k, all), first); };
        // without friction geometric series end in zero, however slowly
        const auto goes_on = [&](int k) {
            const Series& one = series[at(k)];
            return !conditions_->is_rough() && one.is_geometric() &&
                   turn - one.turn <= 2 * static_cast<int>(near.size());
        };
        std::vector<int> struck;
        bool comes = false, are_geometric = true;
        for (const int k : near) {
            if (u[at(k)] <= slow(k)) struck.push_back(k);
            comes = comes || u[at(k)] < -slow(k);
            are_geometric = are_geometric &&
                            (std::abs(u[at(k)]) <= 32.0 * slow(k) || goes_on(k) || (u[at(k)] > 0.0 && !strikes[at(k)]));
        }
        if (!comes || are_geometric) {
            // what is thrown back for good has not come to rest
            std::vector<int> group;
            for (const int k : near) {
                if (!strikes[at(k)]) continue;
                if (!are_geometric && u[at(k)] > 32.0 * slow(k)) return {};
                if (after.slip[at(k)] == flies) group.push_back(k);
            }
            if (group.size() < 2) return {};
            std::stable_partition(group.begin(), group.end(),
                                  [&](int k) { return std::ranges::find(closed, k) != closed.end(); });
            std::ranges::copy(y, x.begin());
            if (turn > 0) strokes.stuck = last.stuck;
            return group;
        }
        if (turn == most) return {};
        for (const int k : struck) {
            if (u[at(k)] >= -slow(k)) continue;
            Series& one = series[at(k)];
            const double ratio = one.speed > 0.0 ? -u[at(k)] / one.speed : 0.0;
            one = {-u[at(k)], ratio, one.ratio > 0.0 ? std::abs(ratio - one.ratio) : 1.0, turn};
        }
        last = Strokes();
        const std::vector<double> impulses = strike(before, t, y, struck, last);
        if (!last.impossible.empty()) return {};
        for (const int k : struck) strikes[at(k)] = strikes[at(k)] || impulses[at(k)] > 0.0;
        all = moving(t, y);
        u = rates(all);
    }
}

RBDYN_INLINE std::vector<double> TreeModel::fine_gaps(double t, std::span<const double> x,
                                                      std::span<const double> rest) const {
    const auto all = mechanics::closing::moving<DoubleDouble>(*tree_, t, bouncing::wide(x, rest));
    std::vector<double> gaps;
    for (const mechanics::ContactLaw& c : conditions_->contacts())
        gaps.push_back(static_cast<double>(c.touching<DoubleDouble>(*tree_, all).gap));
    return gaps;
}

RBDYN_INLINE void TreeModel::meet(double t, std::span<double> x, std::span<double> rest,
                                  const std::vector<int>& of) const {
    const auto now = moving(t, x);
    std::vector<int> rows = rows_;
    for (const int k : of) rows.push_back(conditions_->normal_row(k));
    rows = mechanics::independent_rows(*tree_, *conditions_, rows, now, rows_.size());
    const mechanics::closing::Responses responses(*tree_, *conditions_, rows, now);
    std::vector<DoubleDouble> wide = bouncing::wide(x, rest);
    const std::vector<double> measures = mechanics::closing::measures_of(*conditions_, rows);
    double before = std::numeric_limits<double>::infinity();
    for (int pass = 0; pass < 4; ++pass) {
        const auto gaps =
            conditions_->gaps<DoubleDouble>(*tree_, mechanics::closing::moving<DoubleDouble>(*tree_, t, wide));
        const std::vector<double> asked = mechanics::closing::chosen(gaps, rows);
        const double left = mechanics::closing::largest(asked, measures);
        // as far as they get smaller: beyond that it is rounding
        if (left == 0.0 || left > 1e-2 * before) break;
        before = left;
        mechanics::closing::move<DoubleDouble>(*tree_, t, responses.changes(asked), wide);
    }
    for (std::size_t i = 0; i < x.size(); ++i) {
        x[i] = wide[i].hi;
        rest[i] = wide[i].lo;
    }
}

RBDYN_INLINE std::vector<int> TreeModel::accumulating(const Mode& after, double t, std::span<const double> x,
                                                      std::span<const double> rest, const std::vector<int>& closed,
                                                      double came, LeftOut& left) const {
    // those that bounce, then those that are as near as that and would strike next
    std::vector<int> bouncing, group;
    const auto is_struck = [&](int k) { return std::find(closed.begin(), closed.end(), k) != closed.end(); };
    for (const int k : closed)
        if (after.slip[at(k)] == flies) bouncing.push_back(k);
    if (bouncing.empty()) return group;
    // without loss there is no end to come to: what then loses speed elsewhere does so too slowly to be followed
    const bool is_alone = bouncing.size() == 1 && closed.size() == 1 && joints_.empty(),
               is_coarse = ((left.slid || !follows_together(after)) && !is_alone) ||
                           std::any_of(bouncing.begin(), bouncing.end(),
                                       [&](int k) { return conditions_->contacts()[at(k)].restitution >= 1.0; });
    const auto all = moving(t, x);
    const auto rows = conditions_->rows<double>(*tree_, all);
    const auto u_of = [&](int k) { return mechanics::Conditions::rate(rows[at(conditions_->normal_row(k))], all); };
    RoundingSizes sizes(after.equations->program);
    sizes.set_parameters(after.parameters);
    if (is_coarse) sizes(t, x);
    const auto gap_rounding = [&](int k) {
        double gap_size = 0.0;
        for (const Guard& guard : after.equations->guards)
            if (guard.contact == k && guard.output >= 0) gap_size = sizes.size(guard.output);
        return epsilon * gap_size;
    };
    const auto lowest = [&](int k) { return lowest_bounce * gap_rounding(k); };
    // where what slid flies with them no ratio says how they go on: they are followed as far as doubles have digits of
    // them
    const bool is_mixed = is_coarse && left.slid && follows_together(after);
    const double few = mixed_bounce * epsilon * std::abs(t), shortest = is_mixed ? few : 64.0 * epsilon * std::abs(t);
    // a slip that a force distinguishes by its speed takes many pieces for each flight, none of them shorter than that
    const bool is_distinguished =
        conditions_->is_rough() && std::ranges::any_of(after.equations->guards, [](const Guard& g) {
            return g.kind == EventKind::switching && !g.is_watched();
        });
    const double least_flight = (is_distinguished ? 4096.0 : 2.0) * epsilon * std::abs(t);
    // slips slower than this have no direction: friction beside no longer takes from what is thrown back without loss
    // what ends it
    double slowest_slip = 0.0;
    for (const int k : closed)
        if (is_rough(k) && mechanics::contact_state::slides(after.slip[at(k)]))
            slowest_slip = std::max(slowest_slip, mechanics::ContactMemory::of(after.memory, k).least);
    std::vector<double> gaps;
    if (contacts() > 1) gaps = fine_gaps(t, x, rest);
    for (int k = 0; k < contacts(); ++k)
        if (after.slip[at(k)] == flies && !is_struck(k) && !conditions_->contacts()[at(k)].is_gone &&
            gaps[at(k)] <= 1e-9 * size_of(k, all))
            bouncing.push_back(k);
    const auto [w, noise] = opening(after, t, x, bouncing);
    for (std::size_t i = 0; i < bouncing.size(); ++i) {
        const int k = bouncing[i];
        const double u = u_of(k), height = 0.5 * u * u / -w[i];
        const bool falls = w[i] < -noise[i];
        if (!is_struck(k)) {
            if (!falls) continue;
            const double end = std::sqrt(u * u + 2.0 * std::max(gaps[at(k)], 0.0) * -w[i]);
            const bool is_near = is_coarse && !is_mixed
                                     ? gaps[at(k)] <= lowest(k) && height <= lowest(k)
                                     : (u + end) / -w[i] <= shortest || end <= 8.0 * slowest_bounce * speed_of(k, all);
            if (is_near) group.push_back(k);
            continue;
        }
        // what flies on for longer does not keep others from coming to rest, nor does what only touches
        const bool only_touches = std::abs(u) <= 1e-3 * came && !falls;
        if ((!is_coarse || only_touches) && (u <= 0.0 || !falls)) continue;
        if (u <= 0.0 || !falls) return {};
        left.pull = std::max(left.pull, -w[i]);
        const double next = 2.0 * u / -w[i];
        const double e = conditions_->contacts()[at(k)].restitution;
        const bool is_slowest = e >= 1.0 && u <= slowest_slip && next <= few;
        // what comes back no slower than it came, though it loses, does so by the rounding of its friction
        const bool is_rounding =
            e < 1.0 && came > 0.0 && u >= came && u <= slow_bounce * slowest_bounce * speed_of(k, all);
        const bool is_shortest =
            is_coarse
                ? (!is_mixed && height <= lowest(k)) || next <= shortest || is_slowest
                : next <= least_flight || (e > 0.0 ? e : 1.0) * u <= slowest_bounce * speed_of(k, all) || is_rounding;
        if (!is_coarse && !is_shortest) continue;
        if (!is_shortest) return {};
        // bounces get shorter by the coefficient of restitution, or as this impact has made speeds
        const bool is_known = e > 0.0 && e < 1.0;
        // what is as quick as it came but for rounding has no end
        const double measured = came > 0.0 ? u / came : 1.0, ratio = is_known ? e : measured < 0.999 ? measured : 1.0;
        // those that do not are no bounces once they are far below rounding
        const bool goes_on = height > 1e-3 * lowest(k) && next > 64.0 * epsilon * std::abs(t) && !is_slowest;
        if (is_coarse && ratio >= 1.0 && goes_on) return {};
        const double sum = next / (1.0 - (ratio < 1.0 ? ratio : 0.9));
        // where this impact tells nothing it may be any time of that size
        if (!(ratio < 1.0) || is_rounding) left.unsure = std::max(left.unsure, sum);
        // nor do flights lower than the rounding of places take a time that is known better than one as low as that
        if (is_mixed) left.unsure = std::max(left.unsure, 4.0 * sum);
        if (is_coarse && conditions_->is_rough() && height < 64.0 * gap_rounding(k))
            left.unsure = std::max(left.unsure, std::sqrt(2.0 * gap_rounding(k) / -w[i]));
        left.time = std::max(left.time, sum);
        group.push_back(k);
    }
    left.is_summed = is_coarse;
    const bool is_any = std::any_of(group.begin(), group.end(), is_struck);
    return is_any ? group : std::vector<int>();
}

}  // namespace rbdyn::inline RBDYN_FORM
