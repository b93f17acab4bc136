// Runs a program in truncated Taylor series of 32 digits: for the few steps whose series in doubles lose too many.
//
// Where a series divides by another one that nearly vanishes at a distance d from where it begins, its coefficient k
// carries rounding times d^-k, though the quotient itself may be smooth there; a step of length h past that place
// multiplies rounding by (h / d)^order. The recurrences are those of series_evaluator.hpp, one slot after the other: a
// step of a linkage of ten bodies takes milliseconds.
#pragma once

#include <span>
#include <vector>

#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/form.hpp"
#include "rbdyn/expression/program.hpp"
#include "rbdyn/expression/series_evaluator.hpp"

namespace rbdyn::inline RBDYN_FORM {

class WideSeries {
public:
    /// Of orders 0 .. order. Functions that are called back have no series (Program::has_calls).
    WideSeries(const Program& program, int order);

    /// Of constants all their digits.
    void set_parameters(std::span<const double> parameters);

    /// Coefficients 0 .. order of the inputs, of which output i is the derivative of input i, and of every other slot.
    void expand(double t, double unit, std::span<const DoubleDouble> x);

    /// An input at a place, in units.
    DoubleDouble input(int variable, double tau) const;

    /// All coefficients, rounded.
    void give(SeriesEvaluator& series) const;

private:
    DoubleDouble* slot(int index) { return storage_.data() + index * (order_ + 1); }
    const DoubleDouble* slot(int index) const { return storage_.data() + index * (order_ + 1); }

    /// Coefficient k of every slot but the inputs.
    void advance(int k);
    void compute(const Instruction& i, int k);
    DoubleDouble combined(const Instruction& i, int k) const;
    void norm(const Instruction& i, int k);

    const Program* program_;
    int order_;
    std::vector<DoubleDouble> storage_, scalars_;
    std::vector<int> valuations_;
};

}  // namespace rbdyn::inline RBDYN_FORM
