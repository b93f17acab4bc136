// Definitions of rbdyn/mechanics/tree_model.hpp: impacts of contacts with friction.
//
// Impulses inside their cones, of the dynamic coefficients, give what strikes the velocities of Newton's law, or of its
// largest part that gains no energy; what they bring to rest is at rest.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

#include "rbdyn/mechanics/closure.hpp"
#include "rbdyn/mechanics/cone_choice.hpp"
#include "rbdyn/mechanics/contact_state.hpp"
#include "rbdyn/mechanics/friction_cones.hpp"
#include "rbdyn/mechanics/touched.hpp"
#include "rbdyn/mechanics/tree_model.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE std::vector<double> TreeModel::strike_rough(const Mode& before, double t, std::span<double> x,
                                                         const std::vector<int>& struck, Strokes& strokes) const {
    const auto all = moving(t, x);
    Touched touched = this->touched(before, t, all, struck, {}, true);
    if (!joints_.empty()) return strike_jointed(t, x, struck, touched, strokes);
    std::vector<double> u, b, noise, normal(at(contacts()), 0.0);
    double fastest = 0.0;
    for (const int k : struck) fastest = std::max(fastest, speed_of(k, all));
    const auto see = [&] {
        u.clear();
        for (const auto& row : touched.rows) u.push_back(mechanics::Conditions::rate(row, all));
        noise.assign(u.size(), 1e-15 * fastest);
    };
    see();
    const auto solved = [&](double part) {
        b = u;
        for (std::size_t i = 0; i < struck.size(); ++i) {
            double& one = b[static_cast<std::size_t>(touched.cones[i].first)];
            if (one < 0.0) one *= 1.0 + part * conditions_->contacts()[at(struck[i])].restitution;
        }
        return mechanics::solve_any_cones(touched.matrix, b, noise, touched.cones);
    };
    // whether there are impulses, and P (u+ + u-) / 2 is no more than rounding
    const auto gains_nothing = [&](const mechanics::ConeForces& found, double rounding) {
        if (!found.is_solved) return false;
        double sum = 0.0, size = 0.0;
        for (std::size_t i = 0; i < u.size(); ++i) {
            double after = u[i];
            for (std::size_t j = 0; j < u.size(); ++j) after += touched.matrix[i][j] * found.force[j];
            sum += 0.5 * found.force[i] * (after + u[i]);
            size += std::abs(found.force[i]) * (std::abs(after) + std::abs(u[i]));
        }
        return sum <= rounding * size;
    };
    mechanics::ConeForces found = solved(1.0);
    // what slips faster by far than impulses can change goes on in its direction, and doubles have no digits of more
    if (!found.is_solved && slip_on(before, t, all, struck, touched)) {
        see();
        found = solved(1.0);
    }
    // where nothing comes nothing is struck
    bool comes = false;
    for (const mechanics::Cone& cone : touched.cones)
        comes = comes || u[static_cast<std::size_t>(cone.first)] < -noise[static_cast<std::size_t>(cone.first)];
    const auto lawful = [&] {
        std::vector<mechanics::ConeForces> all_choices;
        if (comes) all_choices = mechanics::every_choice(touched.matrix, b, touched.cones);
        std::erase_if(all_choices, [&](const mechanics::ConeForces& one) { return !gains_nothing(one, 1e-13); });
        return all_choices;
    };
    std::vector<mechanics::ConeForces> choices = lawful();
    if (!gains_nothing(found, 1e-13) && !choices.empty()) found = choices.front();
    if (!gains_nothing(found, 1e-13)) {
        // Newton's law and friction together may gain energy, or ask what no impulse can do: the largest part of e
        // that does neither
        double low = 0.0, high = 1.0;
        for (int i = 0; i < 60 && high - low > 1e-16; ++i) {
            const double middle = 0.5 * (low + high);
            (gains_nothing(solved(middle), 0.0) ? low : high) = middle;
        }
        strokes.lowered = low > 1e-6 ? low : 0.0;
        found = solved(strokes.lowered);
        choices = lawful();
    }
    if (!found.is_solved) {
        strokes.impossible = no_forces("impulses", struck);
        return normal;
    }
    for (const auto& other : mechanics::other_forces(touched.matrix, noise, touched.cones, found))
        if (other.changes_normals(touched.cones) && other.makes_difference(touched.matrix, fastest)) {
            strokes.impossible = impulses_not_unique(other.change, struck, touched.cones);
            return normal;
        }
    for (const mechanics::ConeForces& other : choices) {
        double apart = 0.0;
        for (std::size_t i = 0; i < u.size(); ++i) apart = std::max(apart, std::abs(other.rate[i] - found.rate[i]));
        if (apart <= 1e-9 * fastest) continue;
        strokes.impossible = several_velocities(struck);
        return normal;
    }
    const std::vector<double> changes = touched.coupled->changes(found.force);
    for (int k = 0; k < tree_->velocities(); ++k) x[at(tree_->positions() + k)] += changes[at(k)];
    if (struck.size() > 1) {
        // to the velocities that the law asks for, not to what rounding makes of the sum of several impulses
        const auto then = moving(t, x);
        const auto every = conditions_->rows<double>(*tree_, then);
        std::vector<int> rows = rows_;
        std::vector<double> asked(rows.size(), 0.0);
        for (std::size_t i = 0; i < struck.size(); ++i) {
            if (found.states[i] == mechanics::ConeState::open) continue;
            const double came = u[static_cast<std::size_t>(touched.cones[i].first)],
                         back = -strokes.lowered * conditions_->contacts()[at(struck[i])].restitution;
            rows.push_back(conditions_->normal_row(struck[i]));
            asked.push_back((came < 0.0 ? back * came : 0.0) -
                            mechanics::Conditions::rate(every[at(rows.back())], then));
        }
        const std::vector<int> independent =
            mechanics::independent_rows(*tree_, *conditions_, rows, then, rows_.size());
        std::vector<double> wanted;
        for (const int r : independent)
            wanted.push_back(asked[static_cast<std::size_t>(std::find(rows.begin(), rows.end(), r) - rows.begin())]);
        const std::vector<double> rest =
            mechanics::closing::Responses(*tree_, *conditions_, independent, then).exact_changes(wanted);
        for (int k = 0; k < tree_->velocities(); ++k) x[at(tree_->positions() + k)] += rest[at(k)];
    }
    const auto after = moving(t, x);
    strokes.pushed.assign(at(contacts()), Vector3::Zero());
    for (std::size_t i = 0; i < struck.size(); ++i) tell_stroke(touched, i, found, after, noise, strokes, normal);
    if (is_driven()) return normal;
    // what impulses bring to rest has no velocity of rounding left
    std::vector<int> still = rows_;
    for (std::size_t i = 0; i < struck.size(); ++i) {
        const int k = struck[i];
        const bool bounces = u[static_cast<std::size_t>(touched.cones[i].first)] < 0.0 &&
                             strokes.lowered * conditions_->contacts()[at(k)].restitution > 0.0;
        if (found.states[i] == mechanics::ConeState::open || bounces) continue;
        const bool is_stuck = std::find(strokes.stuck.begin(), strokes.stuck.end(), k) != strokes.stuck.end();
        if (!is_stuck) still.push_back(conditions_->normal_row(k));
        for (int axis = 0; axis < 3 && is_stuck; ++axis) still.push_back(conditions_->held_row(k, axis));
    }
    if (still.size() > rows_.size())
        set_to_rest(mechanics::independent_rows(*tree_, *conditions_, still, after, rows_.size()), t, x, {});
    return normal;
}

RBDYN_INLINE bool TreeModel::slip_on(const Mode& before, double t, const std::vector<mechanics::Moving<double>>& all,
                                     const std::vector<int>& struck, Touched& touched) const {
    // so much faster than what comes that no impulse turns them
    constexpr double faster = 1e6;
    double came = 0.0;
    for (const Touched::One& one : touched.all) came = std::max(came, -one.at.normal.dot(one.at.velocity));
    std::vector<int> slow;
    for (const Touched::One& one : touched.all)
        if (!(one.slip.norm() > faster * came)) slow.push_back(one.contact);
    if (slow.size() == struck.size()) return false;
    touched = this->touched(before, t, all, struck, slow, false);
    for (std::size_t i = 0; i < struck.size(); ++i)
        touched.cones[i].mu = conditions_->contacts()[at(struck[i])].mu_dynamic;
    return true;
}

RBDYN_INLINE void TreeModel::tell_stroke(const Touched& touched, std::size_t i, const mechanics::ConeForces& found,
                                         const std::vector<mechanics::Moving<double>>& after,
                                         const std::vector<double>& noise, Strokes& strokes,
                                         std::vector<double>& normal) const {
    const auto f = static_cast<std::size_t>(touched.cones[i].first);
    const int k = touched.all[i].contact;
    normal[at(k)] = found.force[f];
    // without dynamic friction it slips on as it did
    const double slip = touched.cones[i].is_line
                            ? conditions_->contacts()[at(k)].touching<double>(*tree_, after).slip().norm()
                            : std::hypot(found.rate[f + 1], found.rate[f + 2]);
    const bool slips = found.states[i] == mechanics::ConeState::slides && slip > 1e2 * noise[f];
    if (found.states[i] != mechanics::ConeState::open && is_rough(k) && !slips) strokes.stuck.push_back(k);
    for (int j = 0; j < (touched.cones[i].is_line ? 1 : 3); ++j)
        strokes.pushed[at(k)] += touched.all[i].axes[j] * found.force[f + at(j)];
    if (touched.all[i].slides)
        strokes.pushed[at(k)] -= touched.all[i].along * (touched.all[i].sliding * found.force[f]);
}

}  // namespace rbdyn::inline RBDYN_FORM
