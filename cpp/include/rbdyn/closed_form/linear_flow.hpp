// Linear motion of any kind, x' = A x + b: damping that does not follow the stiffness, gyroscopic forces, matrices
// without a full set of eigenvectors.
//
// z = x - x(0) and a last variable that stays 1 obey z' = M z, M = [A, A x(0) + b; 0, 0]. exp(M t) is put together from
// E_k = exp(M 2^k h), one for each binary digit of t/h, and from a short series for what is left of t: h is a power of
// two, so nothing of the time is lost. E_0 is a series, the others are squares (Higham, "The Scaling and Squaring
// Method for the Matrix Exponential Revisited", SIAM J. Matrix Anal. Appl. 26, 2005), in 32 digits, made when a time
// first asks for them; each has twice the error of the one before. Variables are scaled by powers of
// two so that rows and columns of M are of like size (Osborne, "On Pre-Conditioning of Matrices", J. ACM 7, 1960).
#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <limits>
#include <mutex>
#include <span>
#include <utility>
#include <vector>

#include "rbdyn/closed_form/linear_block.hpp"
#include "rbdyn/closed_form/symmetric_modes.hpp"

namespace rbdyn {

class LinearFlow : public LinearBlock {
public:
    /// Of the variables `places` of a state: their matrix, x' at the start, and x there.
    [[gnu::cold]] LinearFlow(std::vector<int> places, const WideMatrix& a, const std::vector<DoubleDouble>& rates,
                             std::vector<DoubleDouble> start)
        : places_(std::move(places)),
          start_(std::move(start)),
          n_(a.size() + 1),
          m_(n_),
          units_(at(n_), 1.0),
          near_(n_) {
        for (int j = 0; j < n_ - 1; ++j) {
            for (int i = 0; i < n_ - 1; ++i) m_(j, i) = a(i, j);
            m_(n_ - 1, j) = rates[at(j)];
        }
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

    void state(Instant since, std::span<double> x) const override {
        const std::vector<double> z = moved(since);
        for (std::size_t i = 0; i < places_.size(); ++i) x[at(places_[i])] = z[i];
    }

    void add_errors(double since, std::span<double> errors) const override {
        const std::vector<double> x = moved({since, 0.0});
        std::vector<double> sizes;
        for (std::size_t i = 0; i < places_.size(); ++i) {
            const double z = std::abs(x[i] - start_[i].hi) / units_[i];
            sizes.push_back(std::isfinite(z) ? z : std::numeric_limits<double>::infinity());
        }
        sizes.push_back(1.0 / units_.back());
        // the products come to as many roundings as there are steps; then the series is rounded, a term most
        const double relative = 16.0 * n_ * 0x1p-104 * (1.0 + since / step_),
                     rounded = relative * *std::max_element(sizes.begin(), sizes.end());
        for (int i = 0; i < n_ - 1; ++i) {
            double term = 0.0;
            for (int j = 0; j < n_; ++j) term += std::abs(near_(i, j)) * step_ * sizes[at(j)];
            errors[at(places_[at(i)])] += (rounded + epsilon * term) * units_[at(i)];
        }
    }

    double fastest() const override { return fastest_; }

private:
    // of the norm of M h: a series of so many terms has 32 digits, one of doubles 12
    static constexpr double largest_step = 0.125;
    static constexpr int terms = 24, near_terms = 12;
    // after 2^100 steps nothing is left of 32 digits
    static constexpr int most_powers = 100;
    static constexpr double most_steps = 0x1p100, epsilon = std::numeric_limits<double>::epsilon();
    static std::size_t at(int i) { return static_cast<std::size_t>(i); }

    /// Scales of the variables: rows and columns of like size, as far as both are there.
    [[gnu::cold]] void balance() {
        constexpr int most_sweeps = 20;
        const auto sizes = [&](int i) {
            double row = 0.0, column = 0.0;
            for (int j = 0; j < n_; ++j) {
                if (j == i) continue;
                row += std::abs(m_(j, i).hi) * units_[at(j)] / units_[at(i)];
                column += std::abs(m_(i, j).hi) * units_[at(i)] / units_[at(j)];
            }
            return std::pair(row, column);
        };
        bool changes = true;
        for (int sweep = 0; changes && sweep < most_sweeps; ++sweep) {
            changes = false;
            for (int i = 0; i < n_; ++i) {
                const auto [row, column] = sizes(i);
                if (row == 0.0 || column == 0.0) continue;
                const int shift = static_cast<int>(std::lround(0.5 * std::log2(row / column)));
                changes = changes || shift != 0;
                units_[at(i)] = std::ldexp(units_[at(i)], shift);
            }
        }
        double usual = 0.0;
        for (int i = 0; i < n_; ++i) {
            const auto [row, column] = sizes(i);
            usual = std::max({usual, std::abs(m_(i, i).hi), std::min(row, column)});
        }
        if (usual == 0.0) usual = 1.0;
        // what nothing depends on, and what depends on nothing, comes to the size of the others
        for (int i = 0; i < n_; ++i) {
            const auto [row, column] = sizes(i);
            if (row > 0.0 && column == 0.0) units_[at(i)] = std::ldexp(units_[at(i)], std::ilogb(row / usual));
            if (column > 0.0 && row == 0.0) units_[at(i)] = std::ldexp(units_[at(i)], std::ilogb(usual / column));
        }
    }

    /// x at a time.
    std::vector<double> moved(Instant since) const {
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

    /// E_k, made if nobody has asked for it yet.
    const WideMatrix& power(int k) const {
        if (k >= ready_.load(std::memory_order_acquire)) {
            const std::lock_guard lock(mutex_);
            for (int next = ready_.load(std::memory_order_relaxed); next <= k; ++next) {
                powers_[at(next)] = next == 0 ? series() : product(powers_[at(next - 1)], powers_[at(next - 1)]);
                ready_.store(next + 1, std::memory_order_release);
            }
        }
        return powers_[at(k)];
    }

    /// exp(M h), in powers of (M h)^4.
    [[gnu::cold]] WideMatrix series() const {
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

    std::vector<int> places_;
    std::vector<DoubleDouble> start_;
    int n_;
    WideMatrix m_;  // transposed, scaled
    std::vector<double> units_;
    SquareMatrix near_;
    double fastest_ = 0.0, step_ = 1.0;
    mutable std::mutex mutex_;
    mutable std::atomic<int> ready_ = 0;
    mutable std::array<WideMatrix, most_powers> powers_;  // transposed, so that columns lie together
};

}  // namespace rbdyn
