// How far a truncated Taylor series may be used.
//
// Source: Jorba and Zou, Experimental Mathematics 14 (2005) 99-117, sec. 3: the step from the last coefficients.
#pragma once

#include <cstddef>

#include "rbdyn/basics/form.hpp"

namespace rbdyn::inline RBDYN_FORM::series {

/// log2 x within 0.09, enough for a step length, from the bits of x; -infinity for 0.
double rough_log2(double x);

/// log2 a/b within 0.09 for finite a, b > 0: the same bits in all units that differ by powers of two.
double rough_log2_ratio(double a, double b);

/// 2^x within 6 percent, the inverse of rough_log2(); x of any size.
double rough_exp2(double x);

/// size[k] = max(size[k], |c[k]|), k = 0 .. order.
void widen(double* size, const double* c, int order);

/// The same of several series, each `stride` behind the last one, from zero on: the bits that one after the other
/// gives.
void sizes(double* size, const double* c, std::ptrdiff_t stride, int count, int order);

/// Counts as zero: close to where doubles end they lose their digits.
inline constexpr double least_size = 0x1p-960;

/// log2 of the longest step on which a series whose coefficients 0 .. p have given sizes is cut off below a tolerance
/// (its log2) times `scale`, or times the motion within the step where that is larger; infinite for a polynomial of low
/// degree, which is exact at any length. Only ratios of sizes enter, so units do not. p >= 4.
double log_step(const double* size, int p, double scale, double log_tolerance);

}  // namespace rbdyn::inline RBDYN_FORM::series
