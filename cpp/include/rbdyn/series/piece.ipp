// Definitions of rbdyn/series/piece.hpp.
#pragma once

#include "rbdyn/series/piece.hpp"

#include <cstddef>
#include <span>

#include "rbdyn/series/polynomial.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE const double* Piece::variable(int i) const {
    return coefficients + static_cast<std::ptrdiff_t>(i) * (stride > 0 ? stride : order + 1);
}

RBDYN_INLINE void Piece::state(double tau_, std::span<double> x) const {
    for (int i = 0; i < variables; ++i) x[static_cast<std::size_t>(i)] = series::value(variable(i), order, tau_);
}

}  // namespace rbdyn::inline RBDYN_FORM
