// Definitions of rbdyn/mechanics/redundant.hpp.
#pragma once

#include "rbdyn/mechanics/redundant.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
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
    std::vector<double> rates;
    for (const Condition& c : conditions.all()) {
        double squares = 0.0;
        for (int r = c.first; r < c.first + c.rows(); ++r)
            squares += std::pow(Conditions::rate(rows[static_cast<std::size_t>(r)], all), 2);
        const double length = c.points == Condition::Points::distance ? static_cast<double>(c.length) : 1.0;
        rates.push_back(std::sqrt(squares) / length);
    }
    return rates;
}

RBDYN_INLINE double fastest(const std::vector<Moving<double>>& all, double size) {
    double most = 0.0;
    for (const Moving<double>& m : all) most = std::max(most, m.velocity.norm() + m.omega.norm() * size);
    return most;
}

RBDYN_INLINE std::optional<Opening> opening(const Tree& tree, const Conditions& conditions,
                                            const std::vector<int>& rows, double t, const std::vector<DoubleDouble>& x,
                                            double size, double tolerance) {
    const auto place = [](int i) { return static_cast<std::size_t>(i); };
    const auto positions = x.begin() + tree.positions();
    const auto with = [&](const std::vector<DoubleDouble>& q, const std::vector<double>& v) {
        std::vector<double> all = closing::nearest(q);
        std::copy(v.begin(), v.end(), all.begin() + tree.positions());
        return closing::moving<double>(tree, t, all);
    };
    const std::vector<double> rest(place(tree.velocities()), 0.0);
    const auto here = with(x, rest);
    // a direction that is none of the scene's own
    std::vector<double> direction;
    for (int k = 0; k < tree.velocities(); ++k) direction.push_back(std::sin(1.0 + 2.3999632297286533 * k));
    const closing::Responses now(tree, conditions, rows, here);
    const auto speed_along = [&](const std::vector<double>& v) {
        // what driven joints add is none of it
        const auto moving = with(x, v);
        double most = 0.0;
        for (std::size_t i = 0; i < moving.size(); ++i)
            most = std::max(
                most, (moving[i].velocity - here[i].velocity).norm() + (moving[i].omega - here[i].omega).norm() * size);
        return most;
    };
    const double all_of_it = speed_along(direction);
    const auto every = conditions.rows<double>(tree, here);
    const auto moving = with(x, direction);
    std::vector<double> asked;
    for (const int r : rows)
        asked.push_back(Conditions::rate(every[place(r)], here) - Conditions::rate(every[place(r)], moving));
    const std::vector<double> changes = now.changes(asked);
    for (std::size_t k = 0; k < direction.size(); ++k) direction[k] += changes[k];
    const double speed = speed_along(direction);
    if (!(speed > 1e-9 * all_of_it)) return std::nullopt;
    const std::vector<double> before = open_by(tree, conditions, with(x, rest));
    // as far as the used rows can be followed
    for (double moved = 0.05 * size; moved > 1e-4 * size; moved *= 0.25) {
        std::vector<double> way = direction;
        for (double& v : way) v *= moved / speed;
        std::vector<DoubleDouble> there(x.begin(), positions);
        there.resize(x.size(), DoubleDouble(0.0));
        closing::move<DoubleDouble>(tree, t, way, there);
        for (int pass = 0; pass < 4; ++pass) closing::normalize<DoubleDouble>(tree, there);
        close(tree, conditions, rows, t, there);
        const auto all = with(there, rest);
        const auto gaps = conditions.gaps<double>(tree, all);
        double left = 0.0;
        for (const int r : rows) left = std::max(left, std::abs(gaps[place(r)]));
        if (!(left <= 1e-3 * tolerance)) continue;
        const std::vector<double> after = open_by(tree, conditions, all);
        std::optional<Opening> most;
        for (std::size_t k = 0; k < after.size(); ++k)
            if (!(after[k] <= before[k] + std::max(tolerance, most ? most->gap : 0.0)))
                most = Opening{static_cast<int>(k), after[k] - before[k], moved};
        return most;
    }
    return std::nullopt;
}

}  // namespace rbdyn::inline RBDYN_FORM::mechanics
