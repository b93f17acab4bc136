// Definitions of rbdyn/engine/band.hpp.
#pragma once

#include "rbdyn/engine/band.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <span>
#include <utility>
#include <vector>

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE BandOrder BandOrder::of(std::span<const std::size_t> first, std::span<const int> columns) {
    const auto at = [](int i) { return static_cast<std::size_t>(i); };
    const int n = static_cast<int>(first.size()) - 1;
    // neighbours both ways, each once
    std::vector<std::vector<int>> beside(at(n));
    for (int i = 0; i < n; ++i)
        for (std::size_t k = first[at(i)]; k < first[at(i) + 1]; ++k) {
            if (columns[k] == i) continue;
            beside[at(i)].push_back(columns[k]);
            beside[at(columns[k])].push_back(i);
        }
    for (std::vector<int>& own : beside) {
        std::sort(own.begin(), own.end());
        own.erase(std::unique(own.begin(), own.end()), own.end());
    }
    const auto fewer = [&](int a, int b) {
        const std::size_t x = beside[at(a)].size(), y = beside[at(b)].size();
        return x != y ? x < y : a < b;
    };
    // in waves from a variable; what is taken is marked
    std::vector<int> order, mark(at(n), -1);
    order.reserve(at(n));
    const auto spread = [&](int from, int sign) {
        const std::size_t begin = order.size();
        order.push_back(from);
        mark[at(from)] = sign;
        for (std::size_t k = begin; k < order.size(); ++k) {
            const std::size_t known = order.size();
            for (const int other : beside[at(order[k])]) {
                if (mark[at(other)] == sign) continue;
                mark[at(other)] = sign;
                order.push_back(other);
            }
            std::sort(order.begin() + static_cast<std::ptrdiff_t>(known), order.end(), fewer);
        }
        return order.back();
    };
    for (int i = 0, sign = 0; i < n; ++i) {
        if (mark[at(i)] >= 0) continue;
        // what is reached last is an end; twice, for the first may begin in the middle
        const std::size_t begin = order.size();
        int end = i;
        for (int pass = 0; pass < 2; ++pass) {
            end = spread(end, sign++);
            order.resize(begin);
        }
        spread(end, sign++);
    }
    BandOrder result{std::vector<int>(at(n)), 0};
    for (int k = 0; k < n; ++k) result.place[at(order[at(k)])] = n - 1 - k;
    for (int i = 0; i < n; ++i)
        for (const int j : beside[at(i)])
            result.width = std::max(result.width, std::abs(result.place[at(i)] - result.place[at(j)]));
    return result;
}

RBDYN_INLINE BandMatrix::BandMatrix(int n, int width)
    : n_(n), width_(width), row_(at(3 * width + 1)), entries_(size(n, width), 0.0), pivots_(at(n), 0) {}

RBDYN_INLINE void BandMatrix::clear() { std::fill(entries_.begin(), entries_.end(), 0.0); }

RBDYN_INLINE bool BandMatrix::factorise() {
    for (int k = 0; k < n_; ++k) {
        const int below = std::min(k + width_, n_ - 1), right = std::min(k + 2 * width_, n_ - 1);
        int pivot = k;
        for (int i = k + 1; i <= below; ++i)
            if (std::abs((*this)(i, k)) > std::abs((*this)(pivot, k))) pivot = i;
        pivots_[at(k)] = pivot;
        double* own = &(*this)(k, k);
        const int count = right - k;
        if (pivot != k) std::swap_ranges(own, own + count + 1, &(*this)(pivot, k));
        const double inverse = 1.0 / *own;
        if (!std::isfinite(inverse) || inverse == 0.0) return false;
        for (int i = k + 1; i <= below; ++i) {
            double* row = &(*this)(i, k);
            if (*row == 0.0) continue;
            const double factor = *row *= inverse;
            for (int j = 1; j <= count; ++j) row[j] -= factor * own[j];
        }
    }
    return true;
}

RBDYN_INLINE void BandMatrix::solve(std::span<double> x) {
    for (int k = 0; k < n_; ++k) {
        std::swap(x[at(k)], x[at(pivots_[at(k)])]);
        const int below = std::min(k + width_, n_ - 1);
        for (int i = k + 1; i <= below; ++i) x[at(i)] -= (*this)(i, k) * x[at(k)];
    }
    for (int i = n_ - 1; i >= 0; --i) {
        const double* row = &(*this)(i, i);
        const int count = std::min(2 * width_, n_ - 1 - i);
        for (int j = 1; j <= count; ++j) x[at(i)] -= row[j] * x[at(i + j)];
        x[at(i)] /= row[0];
    }
}

}  // namespace rbdyn::inline RBDYN_FORM
