// Eigenvalues and eigenvectors of symmetric matrices in 32 digits.
//
// From those in doubles by iterative refinement (Ogita and Aishima, "Iterative refinement for symmetric eigenvalue
// decomposition", Japan J. Indust. Appl. Math. 35, 2018): with S = X^T A X and R = 1 - X^T X the vectors X + X E,
//     E_ij = (S_ij + l_j R_ij) / (l_j - l_i),   l_i = S_ii / (1 - R_ii),
// have twice the digits. Where that quotient is no small angle the values are as good as equal for the digits so far:
// such vectors are turned among themselves, as the eigenvectors of what is left of S beside its mean. Equal values keep
// any vectors at right angles to each other.
#pragma once

#include <cstddef>
#include <vector>

#include "rbdyn/basics/dense.hpp"
#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/form.hpp"

namespace rbdyn::inline RBDYN_FORM {

using WideMatrix = SquareMatrixOf<DoubleDouble>;

struct SymmetricModes {
    std::vector<DoubleDouble> values;
    WideMatrix vectors;  // columns
    double error = 0.0;  // bound on that of each value, what is below it is zero
};

namespace refining {

inline std::size_t at(int i) { return static_cast<std::size_t>(i); }

/// Turns vectors whose values are the same so far: `group`, columns of x.
[[gnu::cold]] void turn(WideMatrix& x, const WideMatrix& s, const WideMatrix& r,
                        const std::vector<DoubleDouble>& values, const std::vector<int>& group);

/// The sum over k of a(k, i) b(k, j), for j from i on.
WideMatrix across(const WideMatrix& a, const WideMatrix& b);

}  // namespace refining

[[gnu::cold]] SymmetricModes symmetric_modes(const WideMatrix& a);

}  // namespace rbdyn::inline RBDYN_FORM
