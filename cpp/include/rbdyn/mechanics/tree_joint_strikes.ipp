// Definitions of rbdyn/mechanics/tree_model.hpp: impacts of contacts where joints have friction.
//
// In an impact (J. J. Moreau, Unilateral contact and dry friction in finite freedom dynamics, 1988) a joint resists by
// an impulse up to k |P|, P what of the impulse of its reaction is across its axis, k with the dynamic coefficient;
// against its rate after it, and all of that if it comes to rest. The states of joints are searched for around the
// problem of contacts, as in tree_joint_contacts.ipp.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

#include "rbdyn/mechanics/cone_choice.hpp"
#include "rbdyn/mechanics/friction_cones.hpp"
#include "rbdyn/mechanics/joint_friction.hpp"
#include "rbdyn/mechanics/touched.hpp"
#include "rbdyn/mechanics/tree_joint_contacts.ipp"
#include "rbdyn/mechanics/tree_model.hpp"

namespace rbdyn::inline RBDYN_FORM {

/// Of rates, the part that is rounding where joints resist, too.
inline constexpr double rounding_of_jolts = 8e-15;

/// What an impact does to contacts and joints.
struct TreeModel::Jolt {
    mechanics::ConeForces contacts;
    std::vector<double> joints, rates;  // impulses of friction; rates of joints after it
    std::vector<double> changes;        // of the velocity variables
    double work = 0.0, size = 0.0;      // of all impulses, P (u+ + u-) / 2, and of what that is a sum
    std::vector<int> sign;              // of joints: zero where they come to rest
    std::vector<bool> is_beyond;        // whether that would take more than there is
    std::vector<double> depends;        // how impulses of contacts may be others, if that gives another motion
    bool is_solved = false;
};

RBDYN_INLINE TreeModel::Jolt TreeModel::jolted(const Touched& touched, const std::vector<double>& u,
                                               const std::vector<double>& back, const std::vector<double>& noise,
                                               const std::vector<double>& slip, double t) const {
    const std::size_t n = joints_.size(), count = u.size();
    const auto every = conditions_->rows<double>(*tree_, touched.moving);
    const auto constraints = constraints_of(every);
    std::vector<std::array<double, 2>> along(n, {0.0, 0.0});
    double fastest = 0.0;
    for (const double one : noise) fastest = std::max(fastest, one / rounding_of_jolts);
    // whether other impulses of contacts, by which those of joints are others, give another motion
    const auto depends = [&](const mechanics::ConeForces& found, const mechanics::Square& a,
                             const friction::Coupled& coupled, const std::vector<std::vector<double>>& answers) {
        for (const auto& other : mechanics::other_forces(a, noise, touched.cones, found)) {
            std::vector<double> z = other.change;
            for (std::size_t h = 0; h < answers.front().size(); ++h) {
                z.push_back(0.0);
                for (std::size_t j = 0; j < count; ++j) z.back() += answers[j][h] * other.change[j];
            }
            const std::vector<double> changes = coupled.changes(z);
            bool makes_difference = other.makes_difference(a, fastest);
            for (const mechanics::RoughJoint& joint : joints_)
                makes_difference = makes_difference || std::abs(joint.radius * changes[at(joint.v)]) >
                                                           std::max(1e-12 * fastest, 1e2 * other.rounding);
            if (makes_difference) return other.change;
        }
        return std::vector<double>();
    };
    const auto solve = [&](const std::vector<int>& sign) {
        Jolt jolt;
        jolt.sign = sign;
        double last = 2.0;
        for (std::array<double, 2>& one : along) one = {0.0, 0.0};
        bool converges = false;
        for (int pass = 0; pass < 60 && !converges; ++pass) {
            friction::JointLaw law{&joints_, t, {}, {}, {}};
            std::vector<std::size_t> held;
            std::vector<mechanics::Row<double>> rows = touched.rows, acting = touched.pushes;
            for (std::size_t i = 0; i < n; ++i) {
                if (sign[i] == 0) {
                    held.push_back(i);
                    rows.push_back(every[at(conditions_->joint_row(static_cast<int>(i)))]);
                    acting.push_back(rows.back());
                } else {
                    law.sliding.push_back(i);
                    law.factor.push_back(-static_cast<double>(sign[i]) * joints_[i].mu_dynamic * joints_[i].radius);
                    law.along.push_back(along[i]);
                }
            }
            const friction::Coupled coupled(*tree_, touched.moving, constraints, rows, acting, &law);
            const mechanics::Square all = coupled.matrix();
            // what stops in joints is solved for first
            mechanics::Square a(count, std::vector<double>(count)), own(held.size(), std::vector<double>(held.size()));
            for (std::size_t i = 0; i < held.size(); ++i)
                for (std::size_t j = 0; j < held.size(); ++j) own[i][j] = all[count + i][count + j];
            const auto held_by = [&](const auto& rate) {
                std::vector<double> b;
                for (std::size_t i = 0; i < held.size(); ++i) b.push_back(-rate(i));
                return mechanics::solve_any(own, b);
            };
            const std::vector<double> first = held_by([&](std::size_t i) { return slip[held[i]]; });
            std::vector<double> b = back;
            std::vector<std::vector<double>> answers;
            for (std::size_t j = 0; j < count; ++j)
                answers.push_back(held_by([&](std::size_t i) { return all[count + i][j]; }));
            for (std::size_t i = 0; i < count; ++i) {
                for (std::size_t h = 0; h < held.size(); ++h) b[i] += all[i][count + h] * first[h];
                for (std::size_t j = 0; j < count; ++j) {
                    a[i][j] = all[i][j];
                    for (std::size_t h = 0; h < held.size(); ++h) a[i][j] += all[i][count + h] * answers[j][h];
                }
            }
            jolt.contacts = mechanics::solve_cones(a, b, noise, touched.cones);
            if (!jolt.contacts.is_solved) {
                // what joints take of what contacts do leaves its rounding
                std::vector<double> more = noise;
                for (double& one : more) one *= 100.0;
                jolt.contacts = mechanics::solve_cones(a, b, more, touched.cones);
            }
            if (!jolt.contacts.is_solved) return jolt;
            std::vector<double> z = jolt.contacts.force;
            for (std::size_t h = 0; h < held.size(); ++h) {
                z.push_back(first[h]);
                for (std::size_t j = 0; j < count; ++j) z.back() += answers[j][h] * jolt.contacts.force[j];
            }
            jolt.changes = coupled.changes(z);
            jolt.joints.assign(n, 0.0);
            for (std::size_t h = 0; h < held.size(); ++h) jolt.joints[held[h]] = z[count + h];
            std::vector<std::array<double, 2>> pressed(n, {0.0, 0.0});
            for (std::size_t p = 0; p < z.size(); ++p) {
                for (std::size_t s = 0; s < law.sliding.size(); ++s)
                    jolt.joints[law.sliding[s]] += coupled.rubbing(p)[s] * z[p];
                for (std::size_t i = 0; i < n; ++i)
                    for (std::size_t k = 0; k < 2; ++k) pressed[i][k] += coupled.loads(p)[i][k] * z[p];
            }
            double turned = 0.0;
            for (std::size_t i = 0; i < n; ++i) {
                const double size = std::hypot(pressed[i][0], pressed[i][1]);
                const std::array<double, 2> now =
                    size > 0.0 ? std::array<double, 2>{pressed[i][0] / size, pressed[i][1] / size}
                               : std::array<double, 2>{0.0, 0.0};
                if (sign[i] != 0) turned = std::max(turned, std::hypot(now[0] - along[i][0], now[1] - along[i][1]));
                along[i] = now;
            }
            converges = turned < 1e-13 || (turned < 1e-9 && turned >= last);
            last = turned;
            if (converges) jolt.depends = depends(jolt.contacts, a, coupled, answers);
            // what follows for joints
            jolt.is_solved = converges;
            jolt.is_beyond.assign(n, false);
            jolt.rates.assign(n, 0.0);
            jolt.work = jolt.size = 0.0;
            const auto count_work = [&](double impulse, double before, double after) {
                jolt.work += 0.5 * impulse * (before + after);
                jolt.size += std::abs(impulse) * (std::abs(before) + std::abs(after));
            };
            for (std::size_t i = 0; i < n; ++i) {
                const mechanics::RoughJoint& joint = joints_[i];
                jolt.rates[i] = sign[i] == 0 ? 0.0 : slip[i] + joint.pace(touched.moving) * jolt.changes[at(joint.v)];
                count_work(jolt.joints[i], slip[i], jolt.rates[i]);
                const double limit = joint.mu_dynamic * joint.radius * std::hypot(pressed[i][0], pressed[i][1]);
                const double rounding = 1e-13 * (limit + std::abs(jolt.joints[i]));
                if (sign[i] == 0 && std::abs(jolt.joints[i]) > limit + rounding) {
                    jolt.is_beyond[i] = true;
                    jolt.is_solved = false;
                }
                if (sign[i] != 0 && static_cast<double>(sign[i]) * jolt.rates[i] <
                                        -1e-14 * (std::abs(slip[i]) + std::abs(jolt.rates[i])))
                    jolt.is_solved = false;
            }
            for (std::size_t i = 0; i < count; ++i) {
                double after = u[i];
                for (std::size_t j = 0; j < z.size(); ++j) after += all[i][j] * z[j];
                count_work(z[i], u[i], after);
            }
        }
        return jolt;
    };
    // each goes on as it does, if it can
    std::vector<int> sign;
    for (const double one : slip) sign.push_back(one > 0.0 ? 1 : one < 0.0 ? -1 : 0);
    Jolt jolt = solve(sign);
    for (std::size_t turn = 0; turn <= 2 * n && !jolt.is_solved && jolt.contacts.is_solved; ++turn) {
        // what would be thrown past its rest stops, what is held by more than there is moves on
        bool changes = false;
        for (std::size_t i = 0; i < n && !changes; ++i) {
            if (sign[i] != 0 && static_cast<double>(sign[i]) * jolt.rates[i] < 0.0) {
                sign[i] = 0;
                changes = true;
            } else if (sign[i] == 0 && jolt.is_beyond[i]) {
                sign[i] = jolt.joints[i] > 0.0 ? -1 : 1;
                changes = true;
            }
        }
        if (!changes) break;
        jolt = solve(sign);
    }
    if (!jolt.is_solved && n <= 4) {
        constexpr std::array choices{0, 1, -1};
        std::vector<std::size_t> every_joint;
        for (std::size_t i = 0; i < n; ++i) every_joint.push_back(i);
        std::fill(sign.begin(), sign.end(), 0);
        do {
            jolt = solve(sign);
        } while (!jolt.is_solved && joint_contacts::next_way(every_joint, choices, sign));
    }
    return jolt;
}

RBDYN_INLINE std::vector<double> TreeModel::strike_jointed(double t, std::span<double> x,
                                                           const std::vector<int>& struck, Touched& touched,
                                                           Strokes& strokes) const {
    const auto& all = touched.moving;
    std::vector<double> u, noise, normal(at(contacts()), 0.0), slip;
    for (const auto& row : touched.rows) u.push_back(mechanics::Conditions::rate(row, all));
    double fastest = 0.0;
    for (const int k : struck) fastest = std::max(fastest, speed_of(k, all));
    noise.assign(u.size(), rounding_of_jolts * fastest);
    for (std::size_t i = 0; i < joints_.size(); ++i) {
        const mechanics::RoughJoint& joint = joints_[i];
        slip.push_back(joint.slip(t, all, x[at(tree_->positions() + joint.v)]));
        if (std::abs(slip.back()) <= 1e-15 * fastest && joint.rail) slip.back() = 0.0;
    }
    const auto solved = [&](double part) {
        std::vector<double> back = u;
        for (std::size_t i = 0; i < struck.size(); ++i) {
            double& one = back[static_cast<std::size_t>(touched.cones[i].first)];
            if (one < 0.0) one *= 1.0 + part * conditions_->contacts()[at(struck[i])].restitution;
        }
        return jolted(touched, u, back, noise, slip, t);
    };
    const auto gains_nothing = [](const Jolt& jolt, double rounding) {
        return jolt.is_solved && jolt.work <= rounding * jolt.size;
    };
    Jolt jolt = solved(1.0);
    if (!gains_nothing(jolt, 1e-13)) {
        double low = 0.0, high = 1.0;
        for (int i = 0; i < 60 && high - low > 1e-16; ++i) {
            const double middle = 0.5 * (low + high);
            (gains_nothing(solved(middle), 0.0) ? low : high) = middle;
        }
        strokes.lowered = low > 1e-6 ? low : 0.0;
        jolt = solved(strokes.lowered);
    }
    if (!jolt.is_solved) {
        strokes.impossible = no_forces("impulses", struck);
        return normal;
    }
    if (!jolt.depends.empty()) {
        strokes.impossible = impulses_not_unique(jolt.depends, struck, touched.cones);
        return normal;
    }
    for (int k = 0; k < tree_->velocities(); ++k) x[at(tree_->positions() + k)] += jolt.changes[at(k)];
    const Mode undecided = this->undecided();
    for (std::size_t i = 0; i < joints_.size(); ++i)
        if (jolt.sign[i] == 0 || std::abs(jolt.rates[i]) <= 1e-13 * std::abs(slip[i]))
            carry(undecided, static_cast<int>(i), t, x);
    const auto after = moving(t, x);
    strokes.pushed.assign(at(contacts()), Vector3::Zero());
    for (std::size_t i = 0; i < struck.size(); ++i)
        tell_stroke(touched, i, jolt.contacts, after, noise, strokes, normal);
    return normal;
}

}  // namespace rbdyn::inline RBDYN_FORM
