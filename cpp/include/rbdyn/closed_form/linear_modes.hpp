// Coupled oscillators by their normal modes: q'' = f - K q - D q', with K symmetric in coordinates q_i s_i and
// D = a + b K.
//
// With s K s^-1 = V diag(k) V^T each y = V^T s (q - q(0)) is a linear oscillator (linear_oscillator.hpp) that starts
// from zero, y'' = V^T s (f - K q(0)) - k y - (a + b k) y'. Counted from the start no distance from the origin is
// rounded. Values, shapes, forces and starts have 32 digits, so a frequency is right for as many turns as there are.
#pragma once

#include <algorithm>
#include <cstddef>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/instant.hpp"
#include "rbdyn/closed_form/linear_block.hpp"
#include "rbdyn/closed_form/linear_oscillator.hpp"
#include "rbdyn/closed_form/symmetric_modes.hpp"

namespace rbdyn::inline RBDYN_FORM {

class LinearModes : public LinearBlock {
public:
    /// What the coordinates have to be multiplied by for a stiffness matrix that is symmetric then, and that.
    struct Symmetric {
        std::vector<DoubleDouble> scales;
        WideMatrix matrix;
    };
    /// None if there are no such numbers.
    [[gnu::cold]] static std::optional<Symmetric> symmetric(const WideMatrix& k);

    /// a and b of D = a + b K; none if D is no such matrix.
    [[gnu::cold]] static std::optional<std::pair<DoubleDouble, DoubleDouble>> proportional(const WideMatrix& d,
                                                                                           const WideMatrix& k);

    /// Of the variables `positions` and `velocities`. `pull`: f - K q(0), `start`, `rates`: q and q' at the start.
    [[gnu::cold]] LinearModes(std::vector<int> positions, std::vector<int> velocities, const Symmetric& s,
                              std::shared_ptr<const SymmetricModes> modes,
                              const std::pair<DoubleDouble, DoubleDouble>& damping,
                              const std::vector<DoubleDouble>& pull, std::vector<DoubleDouble> start,
                              const std::vector<DoubleDouble>& rates);

    void state(Instant since, std::span<double> x) const override;

    void add_errors(double since, std::span<double> errors) const override;

    double fastest() const override;

    Range range(std::span<const double> weights) const override;

private:
    static constexpr double epsilon = std::numeric_limits<double>::epsilon();
    // numbers of 32 digits that are as good as equal, after a quotient or two
    static constexpr double same = 0x1p-98;
    static std::size_t at(int i) { return static_cast<std::size_t>(i); }

    /// Where a mode that starts from zero stays: its energy about the rest never grows; unlimited where it may.
    static Range swing(double stiffness, double damping, double force, double rate);

    /// What an error of a stiffness makes of the phase: t/2w, or t^2/2 while that is less.
    static double late_by(double rate, double t) { return 0.5 * t * std::min(t, 1.0 / rate); }

    std::vector<int> positions_, velocities_;
    std::vector<DoubleDouble> start_;
    std::vector<double> shapes_;  // mode by mode
    std::vector<LinearOscillator> modes_;
    std::vector<Range> ranges_, rate_ranges_;  // of the modes and of their rates
    double value_error_;
};

}  // namespace rbdyn::inline RBDYN_FORM
