// Definitions of rbdyn/mechanics/complementarity.hpp.
#pragma once

#include "rbdyn/mechanics/complementarity.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <vector>

#include "rbdyn/mechanics/accelerate.hpp"

namespace rbdyn::inline RBDYN_FORM::mechanics {

RBDYN_INLINE Complementary solve_complementary(const std::vector<std::vector<double>>& a, const std::vector<double>& b,
                                               const std::vector<double>& noise) {
    const std::size_t n = b.size();
    Complementary result{std::vector<double>(n, 0.0), b};
    std::vector<std::size_t> active;
    const auto solved = [&] {
        // twice, a little of the diagonal added for what depends on each other, and taken back
        std::vector<std::vector<double>> m;
        std::vector<double> x(active.size(), 0.0);
        for (const std::size_t i : active) {
            m.emplace_back();
            for (const std::size_t j : active) m.back().push_back(a[i][j] + (i == j ? 1e-13 * a[i][i] : 0.0));
        }
        for (int pass = 0; pass < 3; ++pass) {
            std::vector<double> left;
            for (std::size_t i = 0; i < active.size(); ++i) {
                double sum = -b[active[i]];
                for (std::size_t j = 0; j < active.size(); ++j) sum -= a[active[i]][active[j]] * x[j];
                left.push_back(sum);
            }
            const std::vector<double> more = solve_definite<double>(m, left);
            for (std::size_t i = 0; i < x.size(); ++i) x[i] += more[i];
        }
        return x;
    };
    const auto refresh = [&] {
        for (std::size_t i = 0; i < n; ++i) {
            result.w[i] = b[i];
            for (std::size_t j = 0; j < n; ++j) result.w[i] += a[i][j] * result.z[j];
        }
    };
    for (std::size_t round = 0; round < 20 * n + 20; ++round) {
        refresh();
        std::size_t worst = n;
        double most = 0.0;
        for (std::size_t i = 0; i < n; ++i) {
            double size = noise[i];
            for (std::size_t j = 0; j < n; ++j) size += 1e-13 * std::abs(a[i][j] * result.z[j]);
            const bool is_active = std::find(active.begin(), active.end(), i) != active.end();
            if (is_active || result.w[i] >= -size || !(a[i][i] > 0.0)) continue;
            const double lack = -result.w[i] / std::sqrt(a[i][i]);
            if (lack > most) {
                most = lack;
                worst = i;
            }
        }
        if (worst == n) break;
        active.push_back(worst);
        while (!active.empty()) {
            const std::vector<double> x = solved();
            double way = 1.0;
            std::size_t first = active.size();
            for (std::size_t i = 0; i < active.size(); ++i) {
                if (x[i] > 0.0) continue;
                const double now = result.z[active[i]], part = now > x[i] ? now / (now - x[i]) : 0.0;
                if (first == active.size() || part < way) {
                    way = part;
                    first = i;
                }
            }
            for (std::size_t i = 0; i < active.size(); ++i)
                result.z[active[i]] += (first == active.size() ? 1.0 : way) * (x[i] - result.z[active[i]]);
            if (first == active.size()) break;
            result.z[active[first]] = 0.0;
            active.erase(active.begin() + static_cast<std::ptrdiff_t>(first));
        }
    }
    refresh();
    for (const std::size_t i : active) result.w[i] = 0.0;
    return result;
}

RBDYN_INLINE Complementary solve_evenly(const std::vector<std::vector<double>>& a, const std::vector<double>& b,
                                        const std::vector<double>& noise) {
    Complementary found = solve_complementary(a, b, noise);
    std::vector<std::size_t> level;
    bool is_one_of_many = false;
    for (std::size_t i = 0; i < b.size(); ++i) {
        double size = std::abs(b[i]);
        for (std::size_t j = 0; j < b.size(); ++j) size += std::abs(a[i][j] * found.z[j]);
        if (found.z[i] <= 0.0 && !(b[i] < 0.0 && std::abs(found.w[i]) <= noise[i] + 1e-13 * size)) continue;
        level.push_back(i);
        is_one_of_many = is_one_of_many || found.z[i] <= 0.0;
    }
    if (!is_one_of_many) return found;
    // conjugate gradients from zero go to the least solution there is
    const std::size_t n = level.size();
    const auto times = [&](const std::vector<double>& z) {
        std::vector<double> sum(n, 0.0);
        for (std::size_t i = 0; i < n; ++i)
            for (std::size_t j = 0; j < n; ++j) sum[i] += a[level[i]][level[j]] * z[j];
        return sum;
    };
    const auto dot = [&](const std::vector<double>& u, const std::vector<double>& v) {
        return std::inner_product(u.begin(), u.end(), v.begin(), 0.0);
    };
    std::vector<double> left, z(n, 0.0);
    for (const std::size_t i : level) left.push_back(-b[i]);
    std::vector<double> way = left;
    const double whole = dot(left, left);
    double square = whole;
    for (std::size_t step = 0; step < 2 * n && square > 1e-30 * whole; ++step) {
        const std::vector<double> bent = times(way);
        const double length = square / dot(way, bent);
        for (std::size_t i = 0; i < n; ++i) {
            z[i] += length * way[i];
            left[i] -= length * bent[i];
        }
        const double next = dot(left, left);
        for (std::size_t i = 0; i < n; ++i) way[i] = left[i] + next / square * way[i];
        square = next;
    }
    if (!(square <= 1e-24 * whole) || !std::ranges::all_of(z, [](double one) { return one > 0.0; })) return found;
    for (std::size_t i = 0; i < n; ++i) {
        found.z[level[i]] = z[i];
        found.w[level[i]] = 0.0;
    }
    return found;
}

}  // namespace rbdyn::inline RBDYN_FORM::mechanics
