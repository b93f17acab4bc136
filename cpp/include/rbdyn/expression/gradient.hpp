// The exact derivatives of one output of a program with respect to all that it depends on, by going back through what
// it is made of (the adjoint, or reverse, mode of differentiation: A. Griewank, A. Walther, Evaluating Derivatives,
// SIAM 2008): as much work as that is, however many variables there are.
#pragma once

#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/expression/evaluate.hpp"
#include "rbdyn/expression/program.hpp"

namespace rbdyn::inline RBDYN_FORM {

class GradientEvaluator : public Evaluator<double> {
public:
    explicit GradientEvaluator(const Program& program);

    /// As Evaluator::magnitude(), without a search.
    double magnitude(int output) const;

    /// d output / d x[i] of the last evaluation, as (i, derivative) for all i it depends on; time is one more variable,
    /// the last.
    const std::vector<std::pair<int, double>>& gradient(int output);

private:
    void add(int slot, double adjoint);
    void go_back(const Instruction& i);

    std::vector<int> maker_;          // of each slot the instruction that makes it; -1: none
    std::vector<double> adjoints_;    // of slots, zero between calls
    std::vector<bool> is_due_;        // of instructions
    std::vector<int> due_, touched_;  // a heap of instructions, the last first; inputs that have adjoints
    std::vector<std::pair<int, double>> gradient_;
};

}  // namespace rbdyn::inline RBDYN_FORM
