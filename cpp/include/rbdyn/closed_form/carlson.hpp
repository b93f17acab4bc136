// Carlson's symmetric elliptic integral of the first kind in numbers of 32 digits,
//   R_F(x, y, z) = 1/2 int_0^inf dt / sqrt((t+x)(t+y)(t+z)),
// from which Legendre's follow without cancellation: K(m) = R_F(0, 1-m, 1), F = s R_F(c^2, 1 - m s^2, 1).
//
// Source: duplication, DLMF 19.26.18 and 19.36.1 (B. C. Carlson, "Numerical computation of real or complex elliptic
// integrals", 1995). Relative error about 1e-31.
#pragma once

#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/form.hpp"

namespace rbdyn::inline RBDYN_FORM::elliptic {

/// Of arguments that are not negative; infinite where two of them are zero.
[[gnu::cold]] DoubleDouble carlson_f(DoubleDouble x, DoubleDouble y, DoubleDouble z);

/// The common limit of arithmetic and geometric means of a, b >= 0; K(m) = pi/2 over that of 1 and sqrt(1 - m).
DoubleDouble arithmetic_geometric_mean(DoubleDouble a, DoubleDouble b);

}  // namespace rbdyn::inline RBDYN_FORM::elliptic
