// Definitions of rbdyn/closed_form/linear_flow.hpp.
#pragma once

#include "rbdyn/closed_form/linear_flow.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstddef>
#include <limits>
#include <mutex>
#include <span>
#include <utility>
#include <vector>

#include "rbdyn/basics/dense.hpp"
#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/instant.hpp"
#include "rbdyn/closed_form/symmetric_modes.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE LinearFlow::LinearFlow(std::vector<int> places, const WideMatrix& a,
                                    const std::vector<DoubleDouble>& rates, std::vector<DoubleDouble> start)
    : places_(std::move(places)), start_(std::move(start)), n_(a.size() + 1), m_(n_), units_(at(n_), 1.0), near_(n_) {
    for (int j = 0; j < n_ - 1; ++j) {
        for (int i = 0; i < n_ - 1; ++i) m_(j, i) = a(i, j);
        m_(n_ - 1, j) = rates[at(j)];
    }
    find_dependence();
    balance();
    for (int j = 0; j < n_; ++j)
        for (int i = 0; i < n_; ++i) m_(j, i) *= units_[at(j)] / units_[at(i)];
    for (int i = 0; i < n_; ++i) {
        double sum = 0.0;
        for (int j = 0; j < n_; ++j) {
            near_(i, j) = m_(j, i).hi;
            sum += std::abs(near_(i, j));
        }
        fastest_ = std::max(fastest_, sum);
    }
    int exponent = 0;
    std::frexp(fastest_, &exponent);
    step_ = std::ldexp(largest_step, -exponent);
}

RBDYN_INLINE void LinearFlow::state(Instant since, std::span<double> x) const {
    const std::vector<double> z = moved(since);
    for (std::size_t i = 0; i < places_.size(); ++i) x[at(places_[i])] = z[i];
}

RBDYN_INLINE void LinearFlow::add_errors(double since, std::span<double> errors) const {
    const std::vector<double> x = moved({since, 0.0});
    std::vector<double> sizes;
    for (std::size_t i = 0; i < places_.size(); ++i) {
        const double z = std::abs(x[i] - start_[i].hi) / units_[i];
        sizes.push_back(std::isfinite(z) ? z : std::numeric_limits<double>::infinity());
    }
    sizes.push_back(1.0 / units_.back());
    // the products come to as many roundings as there are steps; then the series is rounded, a term most
    const double relative = since < step_ ? 0.0 : 16.0 * n_ * 0x1p-104 * (1.0 + since / step_),
                 length = std::min(since, step_);
    for (int i = 0; i < n_ - 1; ++i) {
        double term = 0.0, largest = 0.0;
        for (int j = 0; j < n_; ++j) {
            term += std::abs(near_(i, j)) * length * sizes[at(j)];
            if (depends(i, j)) largest = std::max(largest, sizes[at(j)]);
        }
        errors[at(places_[at(i)])] += (relative * largest + epsilon * term) * units_[at(i)];
    }
}

RBDYN_INLINE double LinearFlow::fastest() const { return fastest_; }

RBDYN_INLINE void LinearFlow::find_dependence() {
    depends_.resize(at(n_) * at(n_));
    for (int i = 0; i < n_; ++i)
        for (int j = 0; j < n_; ++j) depends_[at(i) * at(n_) + at(j)] = i == j || m_(j, i).hi != 0.0;
    for (int k = 0; k < n_; ++k)
        for (int i = 0; i < n_; ++i)
            for (int j = 0; depends(i, k) && j < n_; ++j)
                if (depends(k, j)) depends_[at(i) * at(n_) + at(j)] = true;
}

RBDYN_INLINE std::vector<std::vector<int>> LinearFlow::circles() const {
    struct Group {
        long below;
        std::vector<int> members;
    };
    std::vector<Group> all;
    for (int i = 0; i < n_; ++i) {
        Group circle{0, {}};
        for (int j = 0; j < n_; ++j) {
            circle.below += depends(i, j) ? 1 : 0;
            if (depends(i, j) && depends(j, i)) circle.members.push_back(j);
        }
        if (circle.members.front() == i) all.push_back(std::move(circle));
    }
    // who depends on another depends on more than that one does
    std::ranges::stable_sort(all, {}, &Group::below);
    std::vector<std::vector<int>> result;
    for (Group& circle : all) result.push_back(std::move(circle.members));
    return result;
}

RBDYN_INLINE double LinearFlow::balance_circle(const std::vector<int>& circle) {
    constexpr int most_sweeps = 20;
    const auto sizes = [&](int i) {
        double row = 0.0, column = 0.0;
        for (const int j : circle) {
            if (j == i) continue;
            row += std::abs(m_(j, i).hi) * units_[at(j)] / units_[at(i)];
            column += std::abs(m_(i, j).hi) * units_[at(i)] / units_[at(j)];
        }
        return std::pair(row, column);
    };
    bool changes = true;
    for (int sweep = 0; changes && sweep < most_sweeps; ++sweep) {
        changes = false;
        for (const int i : circle) {
            const auto [row, column] = sizes(i);
            if (row == 0.0 || column == 0.0) continue;
            const int shift = static_cast<int>(std::lround(0.5 * std::log2(row / column)));
            changes = changes || shift != 0;
            units_[at(i)] = std::ldexp(units_[at(i)], shift);
        }
    }
    double usual = 0.0;
    for (const int i : circle) {
        const auto [row, column] = sizes(i);
        usual = std::max({usual, std::abs(m_(i, i).hi), std::min(row, column)});
    }
    return usual;
}

RBDYN_INLINE void LinearFlow::balance() {
    const std::vector<std::vector<int>> all = circles();
    std::vector<int> circle_of(at(n_));
    double usual = 0.0;
    for (std::size_t c = 0; c < all.size(); ++c) {
        for (const int i : all[c]) circle_of[at(i)] = static_cast<int>(c);
        usual = std::max(usual, balance_circle(all[c]));
    }
    if (usual == 0.0) usual = 1.0;
    const auto scale = [&](const std::vector<int>& circle, double by) {
        for (const int i : circle) units_[at(i)] = std::ldexp(units_[at(i)], std::ilogb(by));
    };
    const auto share = [&](int i, int j) { return std::abs(m_(j, i).hi) * units_[at(j)] / units_[at(i)]; };
    // what comes into a circle comes to the size of the others; then what is passed on to less than that may be larger
    for (const std::vector<int>& circle : all) {
        double most = 0.0;
        for (const int i : circle) {
            double sum = 0.0;
            for (int j = 0; j < n_; ++j)
                if (circle_of[at(j)] != circle_of[at(i)]) sum += share(i, j);
            most = std::max(most, sum);
        }
        if (most > 0.0) scale(circle, most / usual);
    }
    for (auto circle = all.rbegin(); circle != all.rend(); ++circle) {
        double most = 0.0;
        for (const int j : *circle)
            for (int i = 0; i < n_; ++i)
                if (circle_of[at(i)] != circle_of[at(j)]) most = std::max(most, share(i, j));
        if (most > 0.0 && most < usual) scale(*circle, usual / most);
    }
}

RBDYN_INLINE std::vector<double> LinearFlow::moved(Instant since) const {
    std::vector<DoubleDouble> z(at(n_)), next(z.size());
    z.back() = 1.0 / units_.back();
    double steps = std::trunc(since.hi / step_);
    if (!(steps < most_steps)) return std::vector<double>(z.size(), std::numeric_limits<double>::quiet_NaN());
    const Instant left = exact_sum(since.hi - steps * step_, since.lo);
    while (steps > 0.0) {
        const int k = std::ilogb(steps);
        steps -= std::ldexp(1.0, k);
        const WideMatrix& e = power(k);
        std::fill(next.begin(), next.end(), DoubleDouble(0.0));
        for (int j = 0; j < n_; ++j) {
            const DoubleDouble factor = z[at(j)];
            for (int i = 0; i < n_; ++i) next[at(i)] += e(j, i) * factor;
        }
        std::swap(z, next);
    }
    std::vector<double> term(at(n_)), following(at(n_)), sum(at(n_));
    for (std::size_t i = 0; i < z.size(); ++i) term[i] = z[i].hi;
    for (int k = 1; k <= near_terms; ++k) {
        for (int i = 0; i < n_; ++i) {
            double product = 0.0;
            for (int j = 0; j < n_; ++j) product += near_(i, j) * term[at(j)];
            following[at(i)] = product * left.hi / k;
            sum[at(i)] += following[at(i)];
        }
        std::swap(term, following);
    }
    for (std::size_t i = 0; i < start_.size(); ++i)
        sum[i] = static_cast<double>(start_[i] + (z[i] + sum[i]) * units_[i]);
    return sum;
}

RBDYN_INLINE const WideMatrix& LinearFlow::power(int k) const {
    if (k >= ready_.load(std::memory_order_acquire)) {
        const std::lock_guard lock(mutex_);
        for (int next = ready_.load(std::memory_order_relaxed); next <= k; ++next) {
            powers_[at(next)] = next == 0 ? series() : product(powers_[at(next - 1)], powers_[at(next - 1)]);
            ready_.store(next + 1, std::memory_order_release);
        }
    }
    return powers_[at(k)];
}

RBDYN_INLINE WideMatrix LinearFlow::series() const {
    std::vector<WideMatrix> powers(5, WideMatrix(n_));
    for (int i = 0; i < n_; ++i) {
        powers[0](i, i) = 1.0;
        for (int j = 0; j < n_; ++j) powers[1](i, j) = m_(i, j) * step_;
    }
    for (std::size_t p = 2; p < 5; ++p) powers[p] = product(powers[p - 1], powers[1]);
    DoubleDouble factorials[terms] = {1.0};
    for (int k = 1; k < terms; ++k) factorials[k] = factorials[k - 1] / static_cast<double>(k);
    WideMatrix sum(n_);
    for (int first = terms - 4; first >= 0; first -= 4) {
        if (first < terms - 4) sum = product(sum, powers[4]);
        for (int p = 0; p < 4; ++p)
            for (int i = 0; i < n_; ++i)
                for (int j = 0; j < n_; ++j) sum(i, j) += powers[at(p)](i, j) * factorials[first + p];
    }
    return sum;
}

}  // namespace rbdyn::inline RBDYN_FORM
