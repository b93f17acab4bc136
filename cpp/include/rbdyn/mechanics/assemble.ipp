// Definitions of rbdyn/mechanics/assemble.hpp, and of Scene::assemble().
#pragma once

#include "rbdyn/mechanics/assemble.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <variant>
#include <vector>

#include "rbdyn/basics/double_double_functions.hpp"
#include "rbdyn/basics/error.hpp"
#include "rbdyn/basics/interruption.hpp"
#include "rbdyn/mechanics/closure.hpp"
#include "rbdyn/rotation/attitude.hpp"
#include "rbdyn/rotation/quaternion.hpp"
#include "rbdyn/scene/joints.hpp"

namespace rbdyn::inline RBDYN_FORM::mechanics {

RBDYN_INLINE std::vector<double> smallest_solution(const std::vector<std::vector<double>>& m,
                                                   const std::vector<double>& b) {
    // m m^T y = b, x = m^T y; a little is added for rows that depend on each other, and taken back by refinement
    const std::size_t n = m.size(), columns = n == 0 ? 0 : m[0].size();
    std::vector<std::vector<double>> a(n, std::vector<double>(n, 0.0));
    double trace = 0.0;
    for (std::size_t i = 0; i < n; ++i) {
        for (std::size_t j = 0; j <= i; ++j)
            for (std::size_t k = 0; k < columns; ++k) a[i][j] += m[i][k] * m[j][k];
        trace += a[i][i];
    }
    for (std::size_t i = 0; i < n; ++i) a[i][i] += 1e-13 * trace;
    std::vector<double> x(columns, 0.0), left = b;
    for (int pass = 0; pass < 3 && trace > 0.0; ++pass) {
        const std::vector<double> y = solve_definite<double>(a, left);
        for (std::size_t i = 0; i < n; ++i)
            for (std::size_t k = 0; k < columns; ++k) x[k] += m[i][k] * y[i];
        for (std::size_t i = 0; i < n; ++i) {
            left[i] = b[i];
            for (std::size_t k = 0; k < columns; ++k) left[i] -= m[i][k] * x[k];
        }
    }
    return x;
}

namespace assembling {

RBDYN_INLINE void put(const Tree& tree, int i, const std::vector<Moving<DoubleDouble>>& all,
                      const std::vector<DoubleDouble>& x, Scene::Body& body) {
    const auto at = [](int k) { return static_cast<std::size_t>(k); };
    const Node& n = tree.node(i);
    const Moving<DoubleDouble> ground;
    const Moving<DoubleDouble>&parent = body.parent < 0 ? ground : all[at(body.parent)], &own = all[at(i)];
    const DoubleDouble *q = x.data() + n.q, *v = x.data() + tree.positions() + n.v;
    if (const int first = n.joint.attitude(); first >= 0) {
        const auto matrix = [](const AxesOf<DoubleDouble>& axes) {
            Matrix3Of<DoubleDouble> m;
            m.col(0) = axes.e1;
            m.col(1) = axes.e2;
            m.col(2) = axes.e3;
            return m;
        };
        body.attitude = Attitude(quaternion(product(matrix(parent.axes).transpose(), matrix(own.axes))));
        body.angular_velocity = own.to_body(own.omega - parent.omega);
        body.angular_velocity_world.reset();
    }
    if (std::holds_alternative<Free>(body.joint)) {
        const auto origin = n.is_point ? Vector3Of<DoubleDouble>{} : own.to_world(n.joint.held().point);
        const auto held = body.parent < 0 ? Vector3Of<DoubleDouble>{} : tree.node(body.parent).joint.held().point;
        const auto arm = own.place - origin - parent.place;
        body.position = rounded(parent.to_body(arm) + held);
        body.velocity = rounded(parent.to_body(own.velocity_at(-origin) - parent.velocity_at(arm)));
    } else if (const RailLaw* rail = n.joint.rail()) {
        body.parameter = q[0].hi;
        body.parameter_rest = q[0].lo;
        body.speed = static_cast<double>(v[0] * sqrt(rail->curve->at<DoubleDouble>(q[0], Placement{}).speed_squared));
    } else if (n.joint.attitude() < 0 && n.joint.positions() == 1) {
        body.parameter = static_cast<double>(q[0]);
        body.speed = static_cast<double>(v[0]);
    } else if (n.joint.attitude() < 0) {
        for (int k = 0; k < n.joint.positions(); ++k) {
            body.coordinates[at(k)] = static_cast<double>(q[k]);
            body.rates[at(k)] = static_cast<double>(v[k]);
        }
    }
}

}  // namespace assembling

}  // namespace rbdyn::inline RBDYN_FORM::mechanics

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE double Scene::assemble(const std::vector<BodyHandle>& keep, double start) {
    for (const BodyHandle b : keep) require_body(b, "assemble");
    if (constraints_.empty())
        throw InvalidInput(
            "assemble: the scene has no constraints, so every start satisfies them; constrain() adds "
            "one");
    require(std::isfinite(start), "assemble", "start", start, "a time is finite, in s");
    const mechanics::Tree tree(*this);
    std::vector<DoubleDouble> x = tree.start(start);
    const std::vector<DoubleDouble> before = x;
    const auto wide = [&] { return mechanics::closing::moving<DoubleDouble>(tree, start, x); };
    const mechanics::Conditions conditions(*this, tree, wide());
    const auto locked = [&](std::vector<std::vector<double>> m) {
        for (const BodyHandle b : keep) {
            const mechanics::Node& n = tree.node(b.index);
            for (auto& row : m)
                for (int k = 0; k < n.joint.velocities(); ++k) row[static_cast<std::size_t>(n.v + k)] = 0.0;
        }
        return m;
    };
    const std::vector<double> measures = conditions.measures();
    // rows over their measures, and of what moves a size of the scene counts as a radian: the same in any unit
    const auto scaled = [&](std::vector<std::vector<double>> m, const std::vector<double>& ways) {
        for (std::size_t r = 0; r < m.size(); ++r)
            for (std::size_t k = 0; k < m[r].size(); ++k) m[r][k] *= ways[k] / measures[r];
        return m;
    };
    double size = 0.0, left = 0.0;
    constexpr int most = 200;
    constexpr double longest = 0.5;  // of one step: in rad, and in sizes of the scene
    for (int pass = 0; pass < most; ++pass) {
        Interruption::point();
        const auto all = mechanics::closing::moving<double>(tree, start, mechanics::closing::nearest(x));
        for (const auto& m : all) size = std::max(size, m.place.norm());
        for (const mechanics::Condition& c : conditions.all())
            for (const mechanics::Anchor* a : {&c.a, &c.b})
                size = std::max(size, tree.point<double>(*a, all).place.norm());
        for (std::size_t k = 0; k < tree.feet().size(); ++k)
            size = std::max(
                size, tree.feet()[k].part() * all[static_cast<std::size_t>(tree.size()) + k].joint.front().move.norm());
        const auto gaps = mechanics::closing::nearest(
            mechanics::closing::of_constraints(conditions.gaps<DoubleDouble>(tree, wide()), conditions));
        left = mechanics::closing::largest(gaps, measures);
        if (!(size > 0.0)) size = conditions.arm();
        if (left <= 1e-15 * size) break;
        std::vector<double> asked;
        for (std::size_t r = 0; r < gaps.size(); ++r) asked.push_back(-gaps[r] / measures[r]);
        const std::vector<double> ways = mechanics::closing::ways(tree, all, size);
        std::vector<double> step = mechanics::smallest_solution(
            scaled(locked(mechanics::jacobian(
                       tree, mechanics::closing::of_constraints(conditions.rows<double>(tree, all), conditions), all)),
                   ways),
            asked);
        const double length = mechanics::closing::largest(step);
        for (std::size_t k = 0; k < step.size(); ++k) step[k] *= ways[k] * (length > longest ? longest / length : 1.0);
        mechanics::closing::move<DoubleDouble>(tree, start, step, x);
        mechanics::closing::normalize<DoubleDouble>(tree, x);
        if (length <= 1e-16 && pass > 5) break;
    }
    if (!(left <= 1e-10 * size)) {
        std::string gaps;
        const auto all = mechanics::closing::moving<double>(tree, start, mechanics::closing::nearest(x));
        for (int k = 0; k < static_cast<int>(conditions.all().size()); ++k)
            gaps += (gaps.empty() ? "" : ", ") + conditions.all()[static_cast<std::size_t>(k)].name + " " +
                    text(conditions.gap(tree, k, all)) + " m";
        throw InvalidInput("assemble: no start near the guesses satisfies the constraints; gaps that are left: " +
                           gaps + "; give guesses nearer to one, or keep fewer bodies as they are");
    }
    const auto all = mechanics::closing::moving<double>(tree, start, mechanics::closing::nearest(x));
    const auto rows = mechanics::closing::of_constraints(conditions.rows<double>(tree, all), conditions);
    const auto now = mechanics::closing::moving<DoubleDouble>(tree, start, x);
    std::vector<double> asked;
    for (const auto& row : mechanics::closing::of_constraints(conditions.rows<DoubleDouble>(tree, now), conditions))
        asked.push_back(-static_cast<double>(mechanics::Conditions::rate(row, now)) / measures[asked.size()]);
    // of the rates that were given, too: what is held to stand still is left with rounding of them
    double fastest = 0.0, off = 0.0;
    const auto take = [&](const std::vector<mechanics::Moving<DoubleDouble>>& moving) {
        for (const auto& m : moving)
            fastest = std::max(fastest, rounded(m.velocity).norm() + rounded(m.omega).norm() * size);
    };
    take(now);
    const std::vector<double> ways = mechanics::closing::ways(tree, all, size);
    const std::vector<double> change =
        mechanics::smallest_solution(scaled(locked(mechanics::jacobian(tree, rows, all)), ways), asked);
    for (std::size_t k = 0; k < change.size(); ++k)
        x[static_cast<std::size_t>(tree.positions()) + k] += change[k] * ways[k];
    const auto then = wide();
    const auto last_rows = mechanics::closing::of_constraints(conditions.rows<DoubleDouble>(tree, then), conditions);
    for (std::size_t r = 0; r < last_rows.size(); ++r)
        off =
            std::max(off, std::abs(static_cast<double>(mechanics::Conditions::rate(last_rows[r], then))) / measures[r]);
    take(then);
    require(off <= 1e-9 * std::max(fastest, 1e-300) || off == 0.0, "assemble", "rate of a gap", off,
            "rates that are kept or driven can be kept by the constraints; keep fewer bodies as they are, or give "
            "those of `keep` and of driven joints rates that fit");
    // rates that are left of larger ones by rounding are none
    for (int i = 0; i < tree.size(); ++i) {
        const mechanics::Node& n = tree.node(i);
        for (int k = 0; k < n.joint.velocities(); ++k) {
            const auto& twist = all[static_cast<std::size_t>(i)].joint[static_cast<std::size_t>(k)];
            DoubleDouble& v = x[static_cast<std::size_t>(tree.positions() + n.v + k)];
            const double speed = (twist.move.norm() + twist.turn.norm() * size) * std::abs(v.hi);
            if (speed <= 1e-13 * fastest) v = 0.0;
        }
    }
    const auto last = wide();
    double moved = 0.0;
    for (int i = 0; i < tree.size(); ++i)
        mechanics::assembling::put(tree, i, last, x, bodies_.change()[static_cast<std::size_t>(i)]);
    for (int k = 0; k < tree.positions() - static_cast<int>(tree.feet().size()); ++k)
        moved = std::max(
            moved, std::abs(static_cast<double>(x[static_cast<std::size_t>(k)] - before[static_cast<std::size_t>(k)])));
    plan_.forget();
    return moved;
}

}  // namespace rbdyn::inline RBDYN_FORM
