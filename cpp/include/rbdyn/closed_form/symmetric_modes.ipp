// Definitions of rbdyn/closed_form/symmetric_modes.hpp.
#pragma once

#include "rbdyn/closed_form/symmetric_modes.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "rbdyn/basics/dense.hpp"
#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/interruption.hpp"

namespace rbdyn::inline RBDYN_FORM::refining {

RBDYN_INLINE void turn(WideMatrix& x, const WideMatrix& s, const WideMatrix& r, const std::vector<DoubleDouble>& values,
                       const std::vector<int>& group) {
    const int n = static_cast<int>(group.size());
    DoubleDouble mean = 0.0;
    for (const int i : group) mean += values[at(i)];
    mean /= static_cast<double>(n);
    SquareMatrix rest(n);
    for (int p = 0; p < n; ++p)
        for (int q = 0; q < n; ++q) {
            const int i = group[at(std::min(p, q))], j = group[at(std::max(p, q))];
            rest(p, q) = static_cast<double>(p == q ? values[at(i)] - mean : s(i, j) + mean * r(i, j));
        }
    const SquareMatrix turned = symmetric_eigen(rest).vectors;
    std::vector<DoubleDouble> row(at(n));
    for (int k = 0; k < x.size(); ++k) {
        for (int p = 0; p < n; ++p) row[at(p)] = x(k, group[at(p)]);
        for (int p = 0; p < n; ++p) {
            DoubleDouble sum = 0.0;
            for (int q = 0; q < n; ++q) sum += row[at(q)] * turned(q, p);
            x(k, group[at(p)]) = sum;
        }
    }
}

RBDYN_INLINE WideMatrix across(const WideMatrix& a, const WideMatrix& b) {
    const int n = a.size();
    WideMatrix result(n);
    for (int k = 0; k < n; ++k) {
        Interruption::point();
        for (int i = 0; i < n; ++i) {
            const DoubleDouble factor = a(k, i);
            for (int j = i; j < n; ++j) result(i, j) += factor * b(k, j);
        }
    }
    return result;
}

}  // namespace rbdyn::inline RBDYN_FORM::refining

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE SymmetricModes symmetric_modes(const WideMatrix& a) {
    using refining::at;
    const int n = a.size();
    // a bound on the rounding of sums of n products, two units of 2^-104 each
    SymmetricModes result{std::vector<DoubleDouble>(at(n)), WideMatrix(n), 4.0 * n * 0x1p-104 * a.largest()};
    WideMatrix& x = result.vectors;
    std::vector<DoubleDouble>& values = result.values;
    if (n == 1) {
        values[0] = a(0, 0);
        x(0, 0) = 1.0;
        return result;
    }
    SquareMatrix near(n);
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) near(i, j) = static_cast<double>(a(i, j));
    const SquareMatrix first = symmetric_eigen(near).vectors;
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) x(i, j) = first(i, j);
    // the digits double with each; one that turns vectors does not count
    constexpr int most_rounds = 8;
    for (int round = 0; round < most_rounds; ++round) {
        const WideMatrix s = refining::across(x, product(a, x));
        WideMatrix r = refining::across(x, x);
        for (int i = 0; i < n; ++i)
            for (int j = i; j < n; ++j) r(i, j) = (i == j ? 1.0 : 0.0) - r(i, j);
        for (int i = 0; i < n; ++i) values[at(i)] = s(i, i) / (1.0 - r(i, i));
        SquareMatrix e(n);
        std::vector<int> head(at(n));  // of those that are turned together, the first
        std::iota(head.begin(), head.end(), 0);
        double largest = 0.0;
        bool turns = false;
        for (int i = 0; i < n; ++i) e(i, i) = 0.5 * r(i, i).hi;
        for (int i = 0; i < n; ++i)
            for (int j = i + 1; j < n; ++j) {
                const double gap = (values[at(j)] - values[at(i)]).hi, up = (s(i, j) + values[at(j)] * r(i, j)).hi,
                             down = (s(i, j) + values[at(i)] * r(i, j)).hi,
                             most = std::max(std::abs(up), std::abs(down));
                const bool is_noise = most <= result.error;
                if (!is_noise && most < 1e-3 * std::abs(gap)) {
                    e(i, j) = up / gap;
                    e(j, i) = -down / gap;
                } else {
                    e(i, j) = e(j, i) = 0.5 * r(i, j).hi;
                }
                if (!is_noise && most >= 1e-3 * std::abs(gap)) {
                    const auto [low, high] = std::minmax(head[at(i)], head[at(j)]);
                    std::replace(head.begin(), head.end(), int(high), int(low));
                    turns = true;
                }
                largest = std::max({largest, std::abs(e(i, j)), std::abs(e(j, i))});
            }
        for (int k = 0; k < n; ++k) {
            Interruption::point();
            std::vector<double> more(at(n));
            for (int i = 0; i < n; ++i)
                for (int j = 0; j < n; ++j) more[at(j)] += x(k, i).hi * e(i, j);
            for (int j = 0; j < n; ++j) x(k, j) += more[at(j)];
        }
        if (turns)
            for (int i = 0; i < n; ++i) {
                if (head[at(i)] != i) continue;
                std::vector<int> group;
                for (int j = i; j < n; ++j)
                    if (head[at(j)] == i) group.push_back(j);
                if (group.size() > 1) refining::turn(x, s, r, values, group);
            }
        // an error of the vectors counts by its square in the values
        else if (largest < 1e-20)
            break;
    }
    for (DoubleDouble& value : values)
        if (std::abs(value.hi) <= result.error) value = 0.0;
    return result;
}

}  // namespace rbdyn::inline RBDYN_FORM
