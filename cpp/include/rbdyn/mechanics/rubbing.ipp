// Definitions of rbdyn/mechanics/rubbing.hpp.
#pragma once

#include "rbdyn/mechanics/rubbing.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

namespace rbdyn::inline RBDYN_FORM {

namespace tree_joints {

RBDYN_INLINE Rubbing::Answer Rubbing::solve(const std::vector<mechanics::RoughJoint>& joints,
                                            const std::vector<int>& sign) const {
    const std::size_t n = joints.size();
    Answer answer{std::vector<double>(n, 0.0), std::vector<double>(n, 0.0), load, false};
    std::vector<std::array<double, 2>> along(n);
    // friction in units in which rows of what is held and of what slides are of one size, whatever those of a scene
    std::vector<double> unit;
    for (std::size_t i = 0; i < n; ++i)
        unit.push_back(alone[i] > 0.0 ? std::ldexp(1.0, -(std::ilogb(alone[i]) / 2)) : 1.0);
    for (int pass = 0; pass < 60 && !answer.is_solved; ++pass) {
        double turned = 0.0;
        for (std::size_t i = 0; i < n; ++i) {
            const double size = answer.pressing(i);
            const std::array<double, 2> now =
                size > 0.0 ? std::array<double, 2>{answer.load[i][0] / size, answer.load[i][1] / size}
                           : std::array<double, 2>{0.0, 0.0};
            turned = std::max(turned, std::hypot(now[0] - along[i][0], now[1] - along[i][1]));
            along[i] = now;
        }
        answer.is_solved = pass > 0 && turned < 1e-13;
        mechanics::Square m(n, std::vector<double>(n, 0.0));
        std::vector<double> b(n);
        for (std::size_t i = 0; i < n; ++i) {
            const bool stays_there = std::abs(sign[i]) == stays, resists = stays_there || std::abs(sign[i]) == 1;
            const double limit = joints[i].coefficient(!stays_there) * joints[i].radius, k = !resists      ? 0.0
                                                                                             : sign[i] < 0 ? -limit
                                                                                                           : limit;
            const double row = sign[i] == 0 ? unit[i] : 1.0 / unit[i];
            b[i] = sign[i] == 0 ? -row * acceleration[i]
                                : -row * k * (along[i][0] * load[i][0] + along[i][1] * load[i][1]);
            for (std::size_t j = 0; j < n; ++j) {
                m[i][j] = sign[i] == 0
                              ? matrix[i][j]
                              : (i == j ? 1.0 : 0.0) + k * (along[i][0] * by[i][j][0] + along[i][1] * by[i][j][1]);
                m[i][j] *= row * unit[j];
            }
        }
        answer.friction = mechanics::solve_any(m, b);
        for (std::size_t i = 0; i < n; ++i) answer.friction[i] *= unit[i];
        for (std::size_t i = 0; i < n; ++i) {
            answer.load[i] = load[i];
            answer.acceleration[i] = acceleration[i];
            for (std::size_t j = 0; j < n; ++j) {
                answer.acceleration[i] += matrix[i][j] * answer.friction[j];
                for (std::size_t k = 0; k < 2; ++k) answer.load[i][k] += by[i][j][k] * answer.friction[j];
            }
        }
    }
    // what moves is not pushed on by its friction
    for (std::size_t i = 0; i < n; ++i)
        if (sign[i] != 0 && static_cast<double>(sign[i]) * answer.friction[i] > noise[i]) answer.is_solved = false;
    return answer;
}

RBDYN_INLINE std::vector<std::size_t> Rubbing::independent(const std::vector<std::size_t>& of) const {
    mechanics::Square left;
    for (const std::size_t i : of) {
        left.emplace_back();
        for (const std::size_t j : of) left.back().push_back(matrix[i][j]);
    }
    std::vector<std::size_t> found;
    for (std::size_t k = 0; k < of.size(); ++k) {
        if (!(left[k][k] > 1e-10 * matrix[of[k]][of[k]])) continue;
        found.push_back(of[k]);
        for (std::size_t i = k + 1; i < of.size(); ++i)
            for (std::size_t j = k + 1; j < of.size(); ++j) left[i][j] -= left[i][k] * left[k][j] / left[k][k];
    }
    return found;
}

RBDYN_INLINE bool Rubbing::share(const std::vector<std::size_t>& resting, std::vector<int>& sign,
                                 const std::function<bool(const std::vector<int>&)>& holds) const {
    constexpr std::size_t most = 8;
    const std::size_t needed = independent(resting).size();
    if (needed == resting.size() || resting.size() > most) return false;
    for (const bool others_resist : {false, true})
        for (unsigned chosen = 1; chosen < (1U << resting.size()); ++chosen) {
            std::vector<std::size_t> holding, others;
            for (std::size_t k = 0; k < resting.size(); ++k)
                ((chosen >> k & 1U) != 0 ? holding : others).push_back(resting[k]);
            if (holding.size() != needed || independent(holding).size() != needed) continue;
            for (unsigned way = 0; way < (others_resist ? 1U << others.size() : 1U); ++way) {
                std::vector<int> tried = sign;
                for (const std::size_t i : holding) tried[i] = 0;
                for (std::size_t k = 0; k < others.size(); ++k)
                    tried[others[k]] = !others_resist ? idle : (way >> k & 1U) != 0 ? -stays : stays;
                if (!holds(tried)) continue;
                sign = std::move(tried);
                return true;
            }
        }
    return false;
}

}  // namespace tree_joints

}  // namespace rbdyn::inline RBDYN_FORM
