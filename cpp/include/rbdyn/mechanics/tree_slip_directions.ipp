// Definitions of rbdyn/mechanics/tree_model.hpp: the directions of slips that begin at the edges of their cones.
//
// At the edge of its cone, where the coefficient does not fall, a slip begins with neither a speed nor an acceleration,
// against the force that held it. Where what is asked for turns, its direction d turns with it, and friction pulls the
// slip u back to that way at a rate like mu N / (m |u|), |u| like t^2: faster than any step follows. What it does is
// regular nevertheless: with d a series in t, u = O(t^2) along d is a condition on each order of d after the other,
// linear in it, for the acceleration across d has - mu N d_k / m in the order of t^k. The series diverges, as such do
// (k! in the place of 1), but a few terms of it hold for long enough to leave the rest to u/|u|.
//
// Its first direction is that of the force asked for, where one contact bears it. Where several do, what they bear
// together says little of each: on the edges of their cones they bear less by the squares of what their directions are
// wrong, which are known to the root of rounding. They are those of one motion of the body, and found as such.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include "rbdyn/basics/dense.hpp"
#include "rbdyn/expression/borrowed_series.hpp"
#include "rbdyn/expression/series_evaluator.hpp"
#include "rbdyn/mechanics/contact_state.hpp"
#include "rbdyn/mechanics/friction_cones.hpp"
#include "rbdyn/mechanics/touched.hpp"
#include "rbdyn/mechanics/tree_model.hpp"

namespace rbdyn::inline RBDYN_FORM {

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

/// The angles at which contacts of one body begin to slip are tied to each other: it has fewer ways to go across them
/// all than there are contacts. What such angles do together to its motion is nothing; that they are those of one
/// motion tells of them, one order of time later.
class Ties {
public:
    /// `by`: what angles a_j do to accelerations across, sum of by_ij a_j. `nothing`: what of that is rounding.
    Ties(const mechanics::Square& by, double nothing)
        : by_(by), none_(kernel(by, false, nothing)), beyond_(kernel(by, true, nothing)) {}

    /// Angles a of an order, and what is added to those of the one before along what does nothing, c: part by a -
    /// grows c = left. Without an order before, what no angle does is left.
    std::pair<std::vector<double>, std::vector<double>> answer(double part, bool has_before,
                                                               const std::vector<double>& grows,
                                                               std::vector<double> left) const {
        const std::size_t n = by_.size(), more = std::min(none_.size(), beyond_.size());
        mechanics::Square m(n + more, std::vector<double>(n + more, 0.0));
        for (std::size_t i = 0; i < n; ++i) {
            for (std::size_t j = 0; j < n; ++j) m[i][j] = part * by_[i][j];
            for (std::size_t k = 0; k < more; ++k) {
                m[i][n + k] = has_before ? -grows[i] * none_[k][i] : beyond_[k][i];
                m[n + k][i] = none_[k][i];
            }
        }
        left.resize(n + more, 0.0);
        std::vector<double> found = mechanics::solve_any(m, left), before(n, 0.0);
        for (std::size_t i = 0; i < n && has_before; ++i)
            for (std::size_t k = 0; k < more; ++k) before[i] += none_[k][i] * found[n + k];
        found.resize(n);
        return {std::move(found), std::move(before)};
    }

private:
    /// Unit vectors v of by v = 0, or of v by = 0, but for rounding.
    static mechanics::Square kernel(const mechanics::Square& by, bool is_left, double nothing) {
        const std::size_t n = by.size();
        SquareMatrix squares(static_cast<int>(n));
        for (std::size_t i = 0; i < n; ++i)
            for (std::size_t j = 0; j < n; ++j) {
                double sum = 0.0;
                for (std::size_t k = 0; k < n; ++k) sum += is_left ? by[i][k] * by[j][k] : by[k][i] * by[k][j];
                squares(static_cast<int>(i), static_cast<int>(j)) = sum;
            }
        const SymmetricEigen parts = symmetric_eigen(squares);
        mechanics::Square result;
        for (std::size_t k = 0; k < n; ++k) {
            if (parts.values[k] > std::max(1e-12 * parts.values[n - 1], nothing * nothing)) continue;
            result.emplace_back();
            for (std::size_t i = 0; i < n; ++i)
                result.back().push_back(parts.vectors(static_cast<int>(i), static_cast<int>(k)));
        }
        return result;
    }

    mechanics::Square by_, none_, beyond_;
};

/// The time in which accelerations change by as much as they are [s].
inline double first_time(const Mode& mode, double t, std::span<const double> x, int positions) {
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
    return time;
}

}  // namespace breaking_away

RBDYN_INLINE void TreeModel::curve(const Mode& before, Mode& mode, double t, std::span<const double> x) const {
    using mechanics::ContactMemory;
    namespace states = mechanics::contact_state;
    constexpr auto terms = static_cast<std::size_t>(ContactMemory::terms);
    std::vector<int> of, pulled;
    for (int k = 0; k < contacts(); ++k)
        if (states::is_start(mode.slip[at(k)]) && !states::is_start(before.slip[at(k)]))
            (ContactMemory::of(mode.memory, k).at_edge ? of : pulled).push_back(k);
    // what is pulled away keeps its first direction for as long as the time of its start is unknown, and what has no
    // size that would tell what is small for a small part of the time in which its acceleration changes
    if (!pulled.empty() && !mode.equations->program.has_calls()) {
        const double time = breaking_away::first_time(mode, t, x, tree_->positions());
        const mechanics::TreeState state = look(mode, t, x);
        for (const int k : pulled) {
            const auto touching = conditions_->contacts()[at(k)].touching<double>(*tree_, state.moving);
            const auto [u, v] = slip_acceleration(touching, state);
            const double first = std::hypot(u, v);
            ContactMemory memory = ContactMemory::of(mode.memory, k);
            if (memory.least <= 0x1p-43 * states::least_speed && std::isfinite(time))
                memory.least = 0x1p-43 * first * time;
            memory.least = std::max(memory.least, 8.0 * epsilon * std::abs(t) * first);
            memory.put(mode.memory, k);
        }
        own_parameters(mode, x);
    }
    // along one direction together it is that in which nothing is left across: what is small beside the forces that
    // cancel is known as well as they are, not its direction
    std::vector<int> left = pulled;
    while (left.size() > 0) {
        const int first = left.front();
        const mechanics::ContactLaw& law = conditions_->contacts()[at(first)];
        const Vector3 axis = ContactMemory::of(mode.memory, first).axis;
        std::vector<int> group;
        std::erase_if(left, [&](int k) {
            const mechanics::ContactLaw& c = conditions_->contacts()[at(k)];
            const bool is_one = k == first || (c.a.body == law.a.body && c.b.body == law.b.body &&
                                               (ContactMemory::of(mode.memory, k).axis - axis).norm() <= 1e-15);
            if (is_one) group.push_back(k);
            return is_one;
        });
        const auto all = moving(t, x);
        const auto touching = law.touching<double>(*tree_, all);
        const auto turned = [&](double by) {
            Mode other = mode;
            for (const int k : group) {
                ContactMemory memory = ContactMemory::of(mode.memory, k);
                memory.axis = (axis * std::cos(by) + touching.normal.cross(axis) * std::sin(by)).normalized();
                memory.put(other.memory, k);
            }
            own_parameters(other, x);
            return other;
        };
        const auto across = [&](const Mode& m) {
            const Vector3 aside = ContactMemory::of(m.memory, first).axis;
            return acceleration_along(touching.row(aside, Vector3(Vector3::Zero())), look(m, t, x)).first;
        };
        constexpr double step = 1e-6;
        const double now = across(mode), by = -now * step / (across(turned(step)) - now);
        if (!(std::abs(by) < 1e-3)) continue;
        Mode better = turned(by);
        if (std::abs(across(better)) < std::abs(now)) mode = std::move(better);
    }
    if (of.empty() || mode.equations->program.has_calls()) return;
    const std::size_t count = of.size();
    Mode bent = mode;
    std::vector<ContactMemory> memories;
    for (const int k : of) {
        bent.slip[at(k)] = states::is_given(mode.slip[at(k)]) ? states::bends : states::curves;
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
    std::vector<Vector3> normals;
    for (const int k : of)
        normals.push_back(conditions_->contacts()[at(k)].touching<double>(*tree_, moving(t, x)).normal);
    // the first coefficient of an angle is the axis itself
    const auto turn = [&](std::size_t i, std::size_t n, double by) {
        ContactMemory& memory = memories[i];
        if (n > 0)
            memory.angle[n - 1] += by;
        else
            memory.axis = (memory.axis * std::cos(by) + normals[i].cross(memory.axis) * std::sin(by)).normalized();
    };
    const auto find = [&] {
        put();
        own_parameters(bent, x);
        slips.find(bent, t, x);
    };
    find();
    // what friction the other way round does to a slip is of the size of what it does across where that is free
    double largest = 0.0;
    for (std::size_t j = 0; j < count; ++j) {
        const Vector3 axis = memories[j].axis;
        memories[j].axis = -axis;
        find();
        memories[j].axis = axis;
        largest = std::max(largest, 0.25 * std::abs(slips.along[j][1]));
    }
    const double nothing = 1e-7 * largest;
    // what a second coefficient of each does to the others; what do nothing together is known as well as the axes are
    mechanics::Square by(count, std::vector<double>(count));
    const auto tied = [&] {
        for (std::size_t i = 0; i < count; ++i) memories[i].angle[0] = 0.0;
        find();
        const auto still = slips.across;
        for (std::size_t j = 0; j < count; ++j) {
            memories[j].angle[0] = 1.0;
            find();
            memories[j].angle[0] = 0.0;
            for (std::size_t i = 0; i < count; ++i) by[i][j] = slips.across[i][2] - still[i][2];
        }
        find();
        return breaking_away::Ties(by, nothing);
    };
    breaking_away::Ties ties = tied();
    // how far the axes have been turned
    const auto answer = [&](std::size_t m) {
        double most = 0.0;
        // what is asked for first is rounded, then what is left is taken away
        for (int pass = 0; pass < 3; ++pass) {
            std::vector<double> against, grows;
            for (std::size_t i = 0; i < count; ++i) {
                against.push_back(-slips.across[i][m]);
                grows.push_back(slips.along[i][2]);
            }
            const auto [own, before_it] = ties.answer(2.0 / static_cast<double>(m), m > 1, grows, against);
            for (std::size_t i = 0; i < count; ++i) {
                if (m <= terms + 1) turn(i, m - 1, own[i]);
                if (m > 1) turn(i, m - 2, before_it[i]);
                if (m == 2) most = std::max(most, std::abs(before_it[i]));
            }
            find();
        }
        return most;
    };
    for (int rounds = 4;;) {
        answer(1);
        if (answer(2) <= 16.0 * epsilon || --rounds == 0) break;
        ties = tied();
    }
    for (std::size_t m = 3; m <= terms + 2; ++m) answer(m);
    // as long as the terms left out are nothing beside the slip, and it is drawn to its direction fast enough
    double until = std::numeric_limits<double>::infinity(), turned = 0.0;
    for (std::size_t i = 0; i < count; ++i) {
        const double grows = slips.along[i][2];
        if (!(grows > 0.0)) return;
        // a way that others hold it to is one that nothing draws it to
        if (std::abs(by[i][i]) > nothing) until = std::min(until, std::abs(by[i][i]) / grows / 15.0);
        for (const std::size_t n : {terms, terms + 1})
            if (const double rest = std::abs(slips.across[i][n + 2]); rest > 0.0)
                until = std::min(until, std::pow(1e-13 * grows / rest, 1.0 / static_cast<double>(n)));
    }
    if (!(until > 1e4 * epsilon * std::abs(t)) || !std::isfinite(until)) return;
    const auto all = moving(t, x);
    for (std::size_t i = 0; i < count; ++i) {
        ContactMemory& memory = memories[i];
        // from rest a slip has a direction from the first: what is small is so beside what it comes to by itself, in
        // the time in which its acceleration turns back
        const bool has_size = memory.least > 0x1p-43 * states::least_speed;
        double turns_back = count > 1 && has_size ? std::numeric_limits<double>::max() : until;
        for (std::size_t n = 3; n <= 6; ++n)
            if (const double next = std::abs(slips.along[i][n]); next > 0.0)
                turns_back = std::min(turns_back, std::pow(slips.along[i][2] / next, 1.0 / static_cast<double>(n - 2)));
        const double own = 0x1p-43 * slips.along[i][2] * turns_back * turns_back,
                     by_size = has_size ? std::min(memory.least, own) : own;
        // the force at the edge of the cone is rounded, and may throw it back until it has grown by as much
        const double rounding = std::max(32.0 * epsilon * std::abs(by[i][i]), 2.0 * std::abs(slips.along[i][1]));
        memory.least = std::max({by_size, 0x1p-43 * speed_of(of[i], all), rounding * rounding / slips.along[i][2]});
        ContactMemory plain = ContactMemory::of(mode.memory, of[i]);
        plain.axis = memory.axis;
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
