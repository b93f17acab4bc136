// Taylor series whose steps end where the equations in long double say: for motions that multiply the rounding of
// doubles by more than the error asked for leaves.
//
// On a step p is the polynomial of the series in doubles, and what is missing, e = x - p, some 1e-16 of it, follows
// from
//     e' = f(p + e) - p',   e = what the state in doubles was short of, at the start
// by collocation at Gauss's points (Hairer, Norsett, Wanner, Solving Ordinary Differential Equations I, II.7), f and p
// in long double with the constants of 32 digits that the program has. So p need be known to doubles only, and e to
// three digits. The state goes on as a sum of two doubles; pieces are those of the series.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/instant.hpp"
#include "rbdyn/engine/engine.hpp"
#include "rbdyn/engine/taylor.hpp"
#include "rbdyn/expression/evaluate.hpp"
#include "rbdyn/model/equations.hpp"

namespace rbdyn::inline RBDYN_FORM {

class RefinedTaylorEngine : public TaylorEngine {
public:
    using TaylorEngine::TaylorEngine;

    void start(const Equations& equations, std::span<const double> parameters, Instant t,
               std::span<const double> x) override;

    StepStatus step(double limit) override;

    void rest(double tau, std::span<const double> x, std::span<double> low) const override;

    void recall(std::span<const double> memory) override;

private:
    using Real = long double;

    // exact for polynomials of degree 19: of a series of order 24, whose last terms are 1e-17 of it, to two digits more
    static constexpr std::size_t points = 10;
    // each iteration gains the factor (step times rates) / its number
    static constexpr int most_iterations = 12;

    /// Gauss's points on [0, 1], and weights of the integrals to each of them and to 1.
    struct Rule {
        std::array<Real, points> at;
        std::array<std::array<Real, points>, points + 1> weight;

        Rule();
        static std::pair<Real, Real> legendre(Real x);
    };
    static const Rule& rule();

    static std::size_t index(int i) { return static_cast<std::size_t>(i); }

    void set_parameters();

    /// Of the polynomial from the start of the step.
    Real increment(std::size_t i, double tau) const;

    /// What is missing at a part of the step: through its values at the start and at the points.
    Real missing(std::size_t i, Real part) const;

    /// What the last step is short of at its end. Returns whether it was found: it settles, and is rounding.
    bool find_missing(std::span<const double> before);

    /// Whether what is missing is of the size of rounding; else it is no smooth step: a spring met its anchor, say.
    bool is_rounding() const;

    bool is_refined_ = false;  // the last step
    const Equations* equations_ = nullptr;
    std::optional<Evaluator<Real>> evaluator_;
    std::vector<Real> value_, slope_, missing_, residual_, end_, state_;
};

}  // namespace rbdyn::inline RBDYN_FORM
