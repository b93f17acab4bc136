// Linear motion of any kind, x' = A x + b: damping that does not follow the stiffness, gyroscopic forces, matrices
// without a full set of eigenvectors.
//
// z = x - x(0) and a last variable that stays 1 obey z' = M z, M = [A, A x(0) + b; 0, 0]. exp(M t) is put together from
// E_k = exp(M 2^k h), one for each binary digit of t/h, and from a short series for what is left of t: h is a power of
// two, so nothing of the time is lost. E_0 is a series, the others are squares (Higham, "The Scaling and Squaring
// Method for the Matrix Exponential Revisited", SIAM J. Matrix Anal. Appl. 26, 2005), in 32 digits, made when a time
// first asks for them; each has twice the error of the one before. Variables are scaled by powers of
// two so that rows and columns of M are of like size (Osborne, "On Pre-Conditioning of Matrices", J. ACM 7, 1960), but
// where one way only leads from some to others: there is nothing to balance, and what is passed on is as large as what
// goes round at most.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <limits>
#include <mutex>
#include <span>
#include <vector>

#include "rbdyn/basics/dense.hpp"
#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/instant.hpp"
#include "rbdyn/closed_form/linear_block.hpp"
#include "rbdyn/closed_form/symmetric_modes.hpp"

namespace rbdyn::inline RBDYN_FORM {

class LinearFlow : public LinearBlock {
public:
    /// Of the variables `places` of a state: their matrix, x' at the start, and x there.
    [[gnu::cold]] LinearFlow(std::vector<int> places, const WideMatrix& a, const std::vector<DoubleDouble>& rates,
                             std::vector<DoubleDouble> start);

    void state(Instant since, std::span<double> x) const override;

    void add_errors(double since, std::span<double> errors) const override;

    double fastest() const override;

private:
    // of the norm of M h: a series of so many terms has 32 digits, one of doubles 12
    static constexpr double largest_step = 0.125;
    static constexpr int terms = 24, near_terms = 12;
    // after 2^100 steps nothing is left of 32 digits
    static constexpr int most_powers = 100;
    static constexpr double most_steps = 0x1p100, epsilon = std::numeric_limits<double>::epsilon();
    static std::size_t at(int i) { return static_cast<std::size_t>(i); }

    /// Scales of the variables: within a circle rows and columns are of like size, between them nothing is passed on
    /// that is larger. In other units of time they are the same but for a factor.
    [[gnu::cold]] void balance();
    /// Whether a variable depends on another one, through others too, or is it.
    bool depends(int i, int j) const { return depends_[at(i) * at(n_) + at(j)]; }
    [[gnu::cold]] void find_dependence();
    /// Variables that depend on each other, each such circle behind those that it depends on.
    [[gnu::cold]] std::vector<std::vector<int>> circles() const;
    /// Gives the size of what its variables pass to each other.
    [[gnu::cold]] double balance_circle(const std::vector<int>& circle);

    /// x at a time.
    std::vector<double> moved(Instant since) const;

    /// E_k, made if nobody has asked for it yet.
    const WideMatrix& power(int k) const;

    /// exp(M h), in powers of (M h)^4.
    [[gnu::cold]] WideMatrix series() const;

    std::vector<int> places_;
    std::vector<DoubleDouble> start_;
    int n_;
    WideMatrix m_;  // transposed, scaled
    std::vector<double> units_;
    SquareMatrix near_;
    std::vector<bool> depends_;
    double fastest_ = 0.0, step_ = 1.0;
    mutable std::mutex mutex_;
    mutable std::atomic<int> ready_ = 0;
    mutable std::array<WideMatrix, most_powers> powers_;  // transposed, so that columns lie together
};

}  // namespace rbdyn::inline RBDYN_FORM
