// Definitions of rbdyn/mechanics/redundant.hpp.
#pragma once

#include "rbdyn/mechanics/redundant.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "rbdyn/basics/double_double_functions.hpp"
#include "rbdyn/mechanics/closure.hpp"

namespace rbdyn::inline RBDYN_FORM::mechanics {

RBDYN_INLINE std::vector<double> open_by(const Tree& tree, const Conditions& conditions,
                                         const std::vector<Moving<double>>& all) {
    std::vector<double> gaps;
    for (int k = 0; k < static_cast<int>(conditions.all().size()); ++k) gaps.push_back(conditions.gap(tree, k, all));
    return gaps;
}

RBDYN_INLINE std::vector<double> opening_rates(const Tree& tree, const Conditions& conditions,
                                               const std::vector<Moving<double>>& all) {
    const auto rows = conditions.rows<double>(tree, all);
    const std::vector<double> measures = conditions.measures();
    std::vector<double> rates;
    for (const Condition& c : conditions.all()) {
        double squares = 0.0;
        for (int row = c.first; row < c.first + c.rows(); ++row) {
            const auto r = static_cast<std::size_t>(row);
            squares += std::pow(Conditions::rate(rows[r], all) / measures[r], 2);
        }
        rates.push_back(std::sqrt(squares));
    }
    return rates;
}

RBDYN_INLINE double fastest(const std::vector<Moving<double>>& all, double size) {
    double most = 0.0;
    for (const Moving<double>& m : all) most = std::max(most, m.velocity.norm() + m.omega.norm() * size);
    return most;
}

namespace redundant {

/// A place beside another one, on the rows that are used.
struct Place {
    std::vector<DoubleDouble> x;
    double moved;  // how far the bodies have moved [m]
};

/// All bodies at positions, at rest but for what is driven.
inline std::vector<Moving<double>> resting(const Tree& tree, double t, const std::vector<DoubleDouble>& q) {
    std::vector<double> all = closing::nearest(q);
    std::fill(all.begin() + tree.positions(), all.end(), 0.0);
    return closing::moving<double>(tree, t, all);
}

/// Whether rows are closed at a place, to far less than a tolerance.
inline bool is_closed(const Conditions& conditions, const Tree& tree, const std::vector<int>& rows,
                      const std::vector<Moving<double>>& all, double tolerance) {
    return closing::largest(closing::chosen(conditions.gaps<double>(tree, all), rows),
                            closing::measures_of(conditions, rows)) <= 1e-3 * tolerance;
}

/// Some way along what the rows that are used allow, in a direction that is none of the scene's own, as far as they can
/// be followed; none if nothing can move.
inline std::optional<Place> aside(const Tree& tree, const Conditions& conditions, const std::vector<int>& rows,
                                  double t, const std::vector<DoubleDouble>& x, double size, double tolerance) {
    const auto place = [](int i) { return static_cast<std::size_t>(i); };
    const auto positions = x.begin() + tree.positions();
    const auto with = [&](const std::vector<double>& v) {
        std::vector<double> all = closing::nearest(x);
        std::copy(v.begin(), v.end(), all.begin() + tree.positions());
        return closing::moving<double>(tree, t, all);
    };
    const auto here = resting(tree, t, x);
    std::vector<double> direction = closing::ways(tree, here, size);
    for (int k = 0; k < tree.velocities(); ++k) direction[place(k)] *= std::sin(1.0 + 2.3999632297286533 * k);
    const closing::Responses now(tree, conditions, rows, here);
    const auto speed_along = [&](const std::vector<double>& v) {
        // what driven joints add is none of it
        const auto moving = with(v);
        double most = 0.0;
        for (std::size_t i = 0; i < moving.size(); ++i)
            most = std::max(
                most, (moving[i].velocity - here[i].velocity).norm() + (moving[i].omega - here[i].omega).norm() * size);
        return most;
    };
    const double all_of_it = speed_along(direction);
    const auto every = conditions.rows<double>(tree, here);
    const auto moving = with(direction);
    std::vector<double> asked;
    for (const int r : rows)
        asked.push_back(Conditions::rate(every[place(r)], here) - Conditions::rate(every[place(r)], moving));
    const std::vector<double> changes = now.changes(asked);
    for (std::size_t k = 0; k < direction.size(); ++k) direction[k] += changes[k];
    const double speed = speed_along(direction);
    if (!(speed > 1e-9 * all_of_it)) return std::nullopt;
    for (double moved = 0.05 * size; moved > 1e-4 * size; moved *= 0.25) {
        std::vector<double> way = direction;
        for (double& v : way) v *= moved / speed;
        std::vector<DoubleDouble> there(x.begin(), positions);
        there.resize(x.size(), DoubleDouble(0.0));
        closing::move<DoubleDouble>(tree, t, way, there);
        for (int pass = 0; pass < 4; ++pass) closing::normalize<DoubleDouble>(tree, there);
        close(tree, conditions, rows, t, there);
        if (is_closed(conditions, tree, rows, resting(tree, t, there), tolerance))
            return Place{std::move(there), moved};
    }
    return std::nullopt;
}

/// The logarithm of how far from orthogonal the rows that are used are to what the others depend on: of the part of the
/// Gram determinant of all independent choices that this choice has.
inline double obliquity(const Tree& tree, const Conditions& conditions, const std::vector<int>& rows,
                        const std::vector<Moving<double>>& all) {
    const auto loose = dependences(tree, conditions, rows, all);
    std::vector<std::vector<double>> gram(loose.size(), std::vector<double>(loose.size(), 0.0));
    for (std::size_t i = 0; i < loose.size(); ++i)
        for (std::size_t j = 0; j <= i; ++j)
            for (std::size_t r = 0; r < loose[i].size(); ++r) gram[i][j] += loose[i][r] * loose[j][r];
    std::vector<double> pivots;
    solve_definite<double>(gram, std::vector<double>(loose.size(), 0.0), &pivots);
    double sum = 0.0;
    for (const double pivot : pivots) sum += std::log(pivot);
    return sum;
}

/// The direction in which the two points of a constraint are not held by it, where what depends on others is its rows
/// alone: one that depends on the other two.
inline std::optional<Vector3> not_held(const Conditions& conditions, int constraint,
                                       const std::vector<std::vector<double>>& loose) {
    constexpr double none = 1e-9;
    const std::size_t first = static_cast<std::size_t>(conditions.all()[static_cast<std::size_t>(constraint)].first);
    std::optional<Vector3> result;
    for (const std::vector<double>& one : loose) {
        const Vector3 own(one[first], one[first + 1], one[first + 2]);
        double others = 0.0;
        for (std::size_t r = 0; r < one.size(); ++r)
            if (r < first || r >= first + 3) others = std::max(others, std::abs(one[r]));
        if (!(own.norm() > none * others)) continue;
        if (result || others > none * own.norm()) return std::nullopt;
        result = own;
    }
    return result;
}

/// Whether a row that is not used is none by itself at all places: it depends on no others.
inline bool stays_none(const Tree& tree, const Conditions& conditions, const std::vector<int>& rows, int row,
                       const std::vector<std::vector<Moving<double>>>& places) {
    if (std::binary_search(rows.begin(), rows.end(), row)) return false;
    return std::all_of(places.begin(), places.end(),
                       [&](const auto& all) { return dependences(tree, conditions, rows, {row}, all).empty(); });
}

}  // namespace redundant

RBDYN_INLINE std::optional<Opening> opening(const Tree& tree, const Conditions& conditions,
                                            const std::vector<int>& rows, double t, const std::vector<DoubleDouble>& x,
                                            double size, double tolerance) {
    const auto there = redundant::aside(tree, conditions, rows, t, x, size, tolerance);
    if (!there) return std::nullopt;
    const std::vector<double> before = open_by(tree, conditions, redundant::resting(tree, t, x)),
                              after = open_by(tree, conditions, redundant::resting(tree, t, there->x));
    std::optional<Opening> most;
    for (std::size_t k = 0; k < after.size(); ++k)
        if (!(after[k] <= before[k] + std::max(tolerance, most ? most->gap : 0.0)))
            most = Opening{static_cast<int>(k), after[k] - before[k], there->moved};
    return most;
}

RBDYN_INLINE std::vector<bool> held_still(const Tree& tree, const Conditions& conditions, const std::vector<int>& rows,
                                          double t, const std::vector<DoubleDouble>& x, double size, double tolerance) {
    constexpr double none = 1e-9;  // of what it would be
    const auto count = static_cast<std::size_t>(tree.velocities()), bodies = static_cast<std::size_t>(tree.size());
    std::vector<bool> held(count + 2 * bodies, !rows.empty());
    const auto look = [&](const std::vector<DoubleDouble>& q) {
        const auto here = redundant::resting(tree, t, q);
        const auto every = conditions.rows<double>(tree, here);
        const closing::Responses responses(tree, conditions, rows, here);
        // two motions, of which no velocity is small
        for (const double pace : {2.3999632297286533, 1.6180339887498949}) {
            std::vector<double> all = closing::nearest(q), way = closing::ways(tree, here, size);
            for (std::size_t k = 0; k < count; ++k) way[k] *= 2.0 + std::sin(1.0 + pace * static_cast<double>(k));
            std::copy(way.begin(), way.end(), all.begin() + tree.positions());
            const auto moving = closing::moving<double>(tree, t, all);
            std::vector<double> asked;
            for (const int r : rows) {
                const Row<double>& row = every[static_cast<std::size_t>(r)];
                asked.push_back(Conditions::rate(row, here) - Conditions::rate(row, moving));
            }
            const std::vector<double> changes = responses.changes(asked);
            for (std::size_t k = 0; k < count; ++k) {
                held[k] = held[k] && std::abs(way[k] + changes[k]) <= none * way[k];
                all[static_cast<std::size_t>(tree.positions()) + k] += changes[k];
            }
            const auto left = closing::moving<double>(tree, t, all);
            for (std::size_t i = 0; i < bodies; ++i) {
                // what drives move is not held
                const auto is_none = [&](const Vector3& rate, const Vector3& would_be) {
                    return rate.norm() <= none * would_be.norm();
                };
                const auto center = [&](const Moving<double>& m) {
                    return m.velocity_at(m.to_world(exactly<double>(tree.node(static_cast<int>(i)).center)));
                };
                const std::size_t turns = count + i, moves = turns + bodies;
                held[turns] = held[turns] && is_none(left[i].omega, moving[i].omega);
                held[moves] = held[moves] && is_none(center(left[i]), center(moving[i]));
            }
        }
    };
    look(x);
    if (std::find(held.begin(), held.end(), true) == held.end()) return held;
    if (const auto there = redundant::aside(tree, conditions, rows, t, x, size, tolerance)) look(there->x);
    return held;
}

RBDYN_INLINE Conditions steadiest(const Tree& tree, const Conditions& conditions, const std::vector<int>& rows,
                                  double t, const std::vector<DoubleDouble>& x, double size, double tolerance) {
    constexpr double steady = 1e-8;  // far above rounding, far below what a turn of some degrees makes
    const auto here = redundant::resting(tree, t, x);
    std::vector<int> partial;
    const auto loose = dependences(tree, conditions, rows, here);
    for (std::size_t k = 0; k < conditions.all().size(); ++k) {
        const Condition& c = conditions.all()[k];
        if (c.points != Condition::Points::coincide) continue;
        const auto is_unused = [&](const std::vector<double>& one) {
            for (int r = c.first; r < c.first + 3; ++r)
                if (one[static_cast<std::size_t>(r)] == 1.0 && !std::binary_search(rows.begin(), rows.end(), r))
                    return true;
            return false;
        };
        if (std::any_of(loose.begin(), loose.end(), is_unused)) partial.push_back(static_cast<int>(k));
    }
    if (partial.empty()) return conditions;
    std::vector<std::vector<Moving<double>>> places;
    if (const auto there = redundant::aside(tree, conditions, rows, t, x, size, tolerance))
        places.push_back(redundant::resting(tree, t, there->x));
    // what is driven moves with time
    if (const double speed = fastest(here, size); speed > 0.0) {
        const double later = t + 0.05 * size / speed;
        std::vector<DoubleDouble> there = x;
        close(tree, conditions, rows, later, there);
        auto all = redundant::resting(tree, later, there);
        if (redundant::is_closed(conditions, tree, rows, all, tolerance)) places.push_back(std::move(all));
    }
    std::vector<int> every(static_cast<std::size_t>(conditions.constraint_rows()));
    for (std::size_t r = 0; r < every.size(); ++r) every[r] = static_cast<int>(r);
    // along a direction that nothing holds a row is none by itself, for good where that stays so elsewhere
    const bool is_seen = !places.empty();
    places.push_back(here);
    const auto along = [&]() -> std::optional<Conditions> {
        Conditions told = conditions;
        for (const int k : partial) {
            const auto n = redundant::not_held(conditions, k, loose);
            if (!n) return std::nullopt;
            told.tell_along(k, *n);
        }
        const std::vector<int> used = independent_rows(tree, told, every, here);
        if (used.size() != rows.size()) return std::nullopt;
        for (const int k : partial) {
            const int row = told.all()[static_cast<std::size_t>(k)].first + 2;
            if (!redundant::stays_none(tree, told, used, row, places)) return std::nullopt;
        }
        return told;
    };
    if (is_seen)
        if (auto told = along()) return *std::move(told);
    Conditions best = conditions;
    double least = std::numeric_limits<double>::infinity();
    for (const auto axes : {Condition::Axes::world, Condition::Axes::of_b, Condition::Axes::of_a}) {
        Conditions told = conditions;
        for (const int k : partial) told.tell_in(k, axes);
        const std::vector<int> used = independent_rows(tree, told, every, here);
        if (used.size() != rows.size()) continue;
        const double before = redundant::obliquity(tree, told, used, here);
        double change = 0.0;
        for (const auto& all : places)
            change = std::max(change, std::abs(redundant::obliquity(tree, told, used, all) - before));
        if (!(change < least)) continue;
        least = change;
        best = std::move(told);
        if (least <= steady) break;
    }
    return best;
}

}  // namespace rbdyn::inline RBDYN_FORM::mechanics
