// How far series may be used where some of their terms are hidden: where a program has functions whose coefficients say
// nothing, where a step begins, of what they are on it.
//
// The last coefficients of a series tell how long a step may be if what they are beside its first ones is all there is.
// Functions that grow by many powers of ten are not of that kind: an exponential or a hyperbolic tangent (a bell far
// ahead has no coefficients yet, or such as go on growing beyond the last one), a power of more than the order (t^30 at
// 0 has no coefficients at all), the inverse of what falls nearly to zero (1 / (1 + ((x - 5) / w)^2), w = 1e-8). Of an
// exponential whose argument changes by U the terms beyond order p are, of the whole, what a Poisson distribution of
// mean U has beyond p: 3e-4 for U = p / 2 = 14, so that the last coefficient counts wherever what is left out does. By
// so many e-folds, then, such a function may change in a step, or by more as long as it stays negligible.
//
// Only for programs that have such functions; what other programs compute is told by their coefficients.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/instant.hpp"
#include "rbdyn/expression/program.hpp"
#include "rbdyn/expression/series_evaluator.hpp"

namespace rbdyn::inline RBDYN_FORM {

class HiddenTerms {
public:
    /// Of series whose coefficients 0 .. order are known, of all outputs, or of those given.
    HiddenTerms(const Program& program, int order);
    HiddenTerms(const Program& program, int order, std::span<const int> outputs);

    /// Whether no function of the program hides terms.
    bool none() const { return no_pulses() && inverses_.empty() && products_.empty(); }
    /// Whether none is likely to have a pulse so narrow that one who evaluates it along a step may miss it.
    bool no_pulses() const { return arguments_.empty() && steep_.empty(); }

    /// The slots that it looks at, some of them more than once.
    std::vector<int> slots() const;

    /// How much of a length, in the unit of the series, hides no terms.
    double held(const SeriesEvaluator& series, double length) const;
    /// No pulses.
    double held_pulses(const SeriesEvaluator& series, double length) const;

private:
    /// What multiplies by exp(rate * change of the slot), or of its logarithm where it is a power.
    struct Argument {
        Code code;
        int slot;
        double rate;
    };
    struct Factors {
        int a, b;
        int place_a, place_b;  // among those of all products, in the order in which they come up
    };
    /// Of a slot to the power -rate: of a sum with a constant part, the product of these weights, that keeps it from
    /// zero. What has none is as large where a step begins as anywhere, but for poles, and these are seen.
    struct Inverse {
        int slot;
        double rate;
        std::vector<int> constants;
    };

    static std::vector<int> all_outputs(const Program& program);
    /// Of each slot: whether one of some outputs is made of it.
    static std::vector<bool> needed(const Program& program, std::span<const int> outputs);
    /// Of each slot: what power of the motion, or of time, it may be; and the slot that it is a product of, with itself
    /// and others.
    struct Powers {
        std::vector<double> degree;
        std::vector<int> base;
    };
    static Powers powers(const Program& program);
    /// Of each slot: the constant part of the sum that it is, or of those that it is a product of.
    static std::vector<std::vector<int>> constants(const Program& program);

    /// Shortens a length until all items hold; what hides at any length is left as it is.
    template <class Item>
    double shortened(const SeriesEvaluator& series, std::span<const Item> items, double length) const;
    bool holds(const SeriesEvaluator& series, const Argument& argument, double length) const;
    bool holds(const SeriesEvaluator& series, const Factors& factors, double length) const;
    double held_products(const SeriesEvaluator& series, double length) const;
    bool holds(const SeriesEvaluator& series, const Inverse& inverse, double length) const;
    /// The least value of a polynomial on [0, length], positive at 0: that of 16 places and of what turns between them.
    double least(const double* c, double length) const;

    static std::size_t at(int k) { return static_cast<std::size_t>(k); }

    // e-folds below which a function does not matter: 1e-87
    static constexpr double negligible = 200.0;

    // a term so near to the last is beyond it once a motion has integrated it twice, and that of what is joined to it
    static constexpr int integrations = 4;

    int order_, visible_;
    double most_;  // e-folds within a step
    std::vector<Argument> arguments_;
    std::vector<Factors> products_;
    std::vector<Inverse> inverses_, steep_;  // of high powers
};

/// The same for engines that have no series: the equations, expanded to a low order where a step begins.
class HiddenAhead {
public:
    explicit HiddenAhead(const Program& program);

    bool none() const { return series_ == nullptr; }
    void set_parameters(std::span<const double> parameters, Program::Rounding rounding = Program::Rounding::nearest);

    /// How much of a length [s] from (t, x) on hides no pulse.
    double held(Instant t, std::span<const double> x, double length);

private:
    static constexpr int order = 8;

    HiddenTerms hidden_;
    std::unique_ptr<SeriesEvaluator> series_;
};

}  // namespace rbdyn::inline RBDYN_FORM
