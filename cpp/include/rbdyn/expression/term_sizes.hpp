// Sizes of the terms that make up the coefficients of a series: the rounding of a coefficient is epsilon times its size
// here, or a little more, whatever cancels in it.
//
// To first order, an operation passes on the sizes of its operands by its derivatives (Higham, Accuracy and Stability
// of Numerical Algorithms, 3.3), a few operations deep; from there on a coefficient is as large as its terms. A state
// variable's coefficients are those of its rate. Time is known to epsilon t: what is a function of time alone is known
// to that times its rate, however many operations it takes, and t - start too, which loses nothing in doubles.
#pragma once

#include <array>
#include <cstddef>
#include <utility>
#include <vector>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/expression/program.hpp"
#include "rbdyn/expression/series_evaluator.hpp"

namespace rbdyn::inline RBDYN_FORM {

class TermSizes {
public:
    static constexpr int max_order = 40;
    using Sizes = std::array<double, max_order + 1>;

    // a guard, the forces in it, what these are made of
    static constexpr int few = 3;
    // as far as the call stack of a small thread reaches
    static constexpr int many = 100;

    /// Of a series whose coefficients 0 .. order are known; `depth`: operations looked back.
    TermSizes(const SeriesEvaluator& series, int order, int depth = few);

    /// Of the coefficients 0 .. order of a slot.
    Sizes operator()(int slot) { return sizes(slot, depth_); }

private:
    static std::size_t at(int k) { return static_cast<std::size_t>(k); }

    double first(int slot) const { return series_.coefficients(slot)[0]; }
    Sizes own(int slot) const;

    /// Of a function of time alone: at least t times those of its rate.
    void allow_for_time(int slot, Sizes& s) const;

    /// sum += weight * |a| * |b|, as series.
    void add_product(Sizes& sum, double weight, const Sizes& a, const Sizes& b) const;

    Sizes sizes(int slot, int deep);

    /// Adds to the sizes of a result those of the operands.
    void pass_on(const Instruction& i, int slot, int deep, Sizes& s);

    void add(Sizes& s, const Sizes& other, double factor) const;

    const SeriesEvaluator& series_;
    const Program& program_;
    int order_, depth_;
    std::vector<std::pair<int, Sizes>> known_;  // by slot
};

}  // namespace rbdyn::inline RBDYN_FORM
