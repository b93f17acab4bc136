// What a program's values are made of: the rounding of a value is a few epsilon times its size here, whatever cancels
// in it.
//
// To first order, an operation passes on the sizes of its operands by its derivatives (N. J. Higham, Accuracy and
// Stability of Numerical Algorithms, 3.3). Time and the state are known to rounding of their own.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/expression/evaluate.hpp"
#include "rbdyn/expression/program.hpp"

namespace rbdyn::inline RBDYN_FORM {

class RoundingSizes : public Evaluator<double> {
public:
    explicit RoundingSizes(const Program& program);

    /// Values and their sizes at (t, x).
    void operator()(double t, std::span<const double> x) { (*this)(t, x, {}); }
    /// The same where each variable is known to the rounding of a size of its own, if that is larger than itself.
    void operator()(double t, std::span<const double> x, std::span<const double> known);

    /// Of an output.
    double size(int index) const { return sizes_[static_cast<std::size_t>(program_->output(index))]; }

private:
    double& of(int slot) { return sizes_[static_cast<std::size_t>(slot)]; }

    std::vector<double> sizes_;
};

}  // namespace rbdyn::inline RBDYN_FORM
