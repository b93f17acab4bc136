// What the Taylor coefficients of a program's outputs are sums of: the rounding of a coefficient is a few epsilon times
// the sum of the sizes of its terms, whatever is left of them.
//
// Sums are taken of sizes, through all of them that lie one in another. Of any other instruction, products included,
// the size is that of its result, and what its operands are differences of counts as far as it changes the result: so
// powers of a difference are known to rounding of the difference, however small they are. Where `functions_round`, what
// a function makes of the rounding of its argument counts too: sin(x + 3) where it is zero, and its slope in 1 + cos x
// where that touches zero.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/expression/program.hpp"
#include "rbdyn/expression/program_weights.hpp"
#include "rbdyn/expression/series_evaluator.hpp"

namespace rbdyn::inline RBDYN_FORM {

class SeriesSizes {
public:
    /// For coefficients 0 .. order.
    SeriesSizes(const Program& program, int order, bool functions_round = false);

    void set_parameters(std::span<const double> parameters) { program_->set_parameters(parameters, scalars_); }

    /// Of what a series evaluator holds.
    void operator()(const SeriesEvaluator& series);

    /// Coefficients 0 .. order of an output.
    const double* output(int index) const;

private:
    double* of(int slot) { return sizes_.data() + static_cast<std::ptrdiff_t>(slot) * row_; }

    void combine(const Instruction& i, const SeriesEvaluator& series);

    const Program* program_;
    int row_;
    bool functions_round_;
    std::vector<double> sizes_, scalars_;
};

}  // namespace rbdyn::inline RBDYN_FORM
