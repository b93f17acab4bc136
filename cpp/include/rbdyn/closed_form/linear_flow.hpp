// Linear motion of any kind, x' = A x + b: damping that does not follow the stiffness, gyroscopic forces, matrices
// without a full set of eigenvectors.
//
// z = x - x(0) and a last variable that stays 1 obey z' = M z, M = [A, A x(0) + b; 0, 0]. exp(M t) is put together from
// E_k = exp(M 2^k h), one for each binary digit of t/h, and from a short series for what is left of t: h is a power of
// two, so nothing of the time is lost. E_0 is a series, the others are squares (Higham, "The Scaling and Squaring
// Method for the Matrix Exponential Revisited", SIAM J. Matrix Anal. Appl. 26, 2005), in 32 digits, made when a time
// first asks for them; each has half a unit more of error than twice the one before. Variables are scaled by powers of
// two so that rows and columns of M are of like size (Osborne, "On Pre-Conditioning of Matrices", J. ACM 7, 1960).
#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <limits>
#include <memory>
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
        std::vector<double> bounds;
        const std::vector<double> x = moved({since, 0.0}, &bounds);
        for (std::size_t i = 0; i < places_.size(); ++i)
            errors[at(places_[i])] += std::isfinite(x[i]) ? bounds[i] : std::numeric_limits<double>::infinity();
    }

    double fastest() const override { return fastest_; }

private:
    // of the norm of M h: a series of so many terms has 32 digits, one of doubles 12
    static constexpr double largest_step = 0.125;
    static constexpr int terms = 24, near_terms = 12;
    // after 2^100 steps nothing is left of 32 digits
    static constexpr int most_levels = 100;
    static constexpr double most_steps = 0x1p100;
    static std::size_t at(int i) { return static_cast<std::size_t>(i); }

    struct Level {
        WideMatrix power;    // its transpose, so that columns lie together
        SquareMatrix bound;  // of the error of each entry
    };

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

    /// x at a time, and bounds on what it is off if they are wanted.
    std::vector<double> moved(Instant since, std::vector<double>* bounds = nullptr) const {
        std::vector<DoubleDouble> z(at(n_)), next(z.size());
        z.back() = 1.0 / units_.back();
        if (bounds != nullptr) bounds->assign(z.size(), 0.0);
        double steps = std::trunc(since.hi / step_);
        if (!(steps < most_steps)) return std::vector<double>(z.size(), std::numeric_limits<double>::quiet_NaN());
        const Instant left = exact_sum(since.hi - steps * step_, since.lo);
        while (steps > 0.0) {
            const int k = std::ilogb(steps);
            steps -= std::ldexp(1.0, k);
            const Level& one = level(k);
            if (bounds != nullptr) *bounds = after(one, z, *bounds);
            std::fill(next.begin(), next.end(), DoubleDouble(0.0));
            for (int j = 0; j < n_; ++j) {
                const DoubleDouble factor = z[at(j)];
                for (int i = 0; i < n_; ++i) next[at(i)] += one.power(j, i) * factor;
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
        // of what the series adds, an eighth of the largest at most, and of the sum
        double largest = 0.0;
        for (const double change : sum) largest = std::max(largest, std::abs(change));
        for (std::size_t i = 0; i < start_.size(); ++i) {
            sum[i] = static_cast<double>(start_[i] + (z[i] + sum[i]) * units_[i]);
            if (bounds != nullptr)
                (*bounds)[i] = ((*bounds)[i] + std::numeric_limits<double>::epsilon() * largest) * units_[i];
        }
        return sum;
    }

    /// Bounds on the error of a product with z, which is off by so much itself.
    std::vector<double> after(const Level& one, const std::vector<DoubleDouble>& z,
                              const std::vector<double>& off) const {
        std::vector<double> result(z.size());
        for (int j = 0; j < n_; ++j)
            for (int i = 0; i < n_; ++i) {
                const double size = std::abs(z[at(j)].hi), entry = std::abs(one.power(j, i).hi);
                result[at(i)] += entry * (off[at(j)] + rounding() * size) + one.bound(j, i) * size;
            }
        return result;
    }

    const Level& level(int k) const {
        if (k >= ready_.load(std::memory_order_acquire)) {
            const std::lock_guard lock(mutex_);
            for (int next = ready_.load(std::memory_order_relaxed); next <= k; ++next) {
                levels_[at(next)] =
                    std::make_unique<const Level>(next == 0 ? first() : squared(*levels_[at(next - 1)]));
                ready_.store(next + 1, std::memory_order_release);
            }
        }
        return *levels_[at(k)];
    }

    /// exp(M h), in powers of M^4.
    [[gnu::cold]] Level first() const {
        WideMatrix powers[5] = {WideMatrix(n_), m_, WideMatrix(), WideMatrix(), WideMatrix()};
        for (int i = 0; i < n_; ++i) {
            powers[0](i, i) = 1.0;
            for (int j = 0; j < n_; ++j) powers[1](i, j) *= step_;
        }
        for (int p = 2; p < 5; ++p) powers[p] = product(powers[p - 1], powers[1]);
        DoubleDouble factorials[terms] = {1.0};
        for (int k = 1; k < terms; ++k) factorials[k] = factorials[k - 1] / static_cast<double>(k);
        WideMatrix sum(n_);
        SquareMatrix bound(n_);
        for (int row = terms / 4 - 1; row >= 0; --row) {
            if (row < terms / 4 - 1) sum = product(sum, powers[4]);
            for (int p = 0; p < 4; ++p)
                for (int i = 0; i < n_; ++i)
                    for (int j = 0; j < n_; ++j) {
                        sum(i, j) += powers[p](i, j) * factorials[4 * row + p];
                        // of some products and sums; what is zero stays so
                        if (row == 0) bound(i, j) += 4.0 * rounding() * std::abs(powers[p](i, j).hi);
                    }
        }
        return {std::move(sum), std::move(bound)};
    }

    [[gnu::cold]] Level squared(const Level& half) const {
        SquareMatrix sizes(n_), bound(n_);
        for (int i = 0; i < n_; ++i)
            for (int j = 0; j < n_; ++j) sizes(i, j) = std::abs(half.power(i, j).hi);
        for (int i = 0; i < n_; ++i)
            for (int k = 0; k < n_; ++k)
                for (int j = 0; j < n_; ++j)
                    bound(i, j) +=
                        sizes(i, k) * (half.bound(k, j) + rounding() * sizes(k, j)) + half.bound(i, k) * sizes(k, j);
        return {product(half.power, half.power), std::move(bound)};
    }
    /// Of a sum of products, relative to their sizes.
    double rounding() const { return 4.0 * n_ * 0x1p-104; }

    std::vector<int> places_;
    std::vector<DoubleDouble> start_;
    int n_;
    WideMatrix m_;  // transposed, scaled
    std::vector<double> units_;
    SquareMatrix near_;
    double fastest_ = 0.0, step_ = 1.0;
    mutable std::mutex mutex_;
    mutable std::atomic<int> ready_ = 0;
    mutable std::array<std::unique_ptr<const Level>, most_levels> levels_;
};

}  // namespace rbdyn
