// Phases without whole turns.
//
// A sine of a phase k (t + b) + c knows it to 2^-52 of k b + c, however near to zero t is: what moves so jumps by that
// wherever it is looked at anew. Counted from the time at which a motion begins, and without whole turns, which are
// taken off with 32 digits, the sine is the same and is known as the time since then is.
#pragma once

#include "rbdyn/basics/form.hpp"
#include "rbdyn/expression/function.hpp"

namespace rbdyn::inline RBDYN_FORM {

/// A function of time whose phases have lost whole turns, and by how much time in the largest of these was ahead of the
/// time since the start: who computes with it as it was written knows time to the rounding of that.
struct SmallPhases {
    Function function;
    double ahead = 0.0;  // s
};

/// The same function, with the same operations where no phase is written more than half a turn off, or is no more than
/// that at the start.
SmallPhases small_phases(const Function& function, double start);

}  // namespace rbdyn::inline RBDYN_FORM
