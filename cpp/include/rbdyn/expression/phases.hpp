// Phases without whole turns.
//
// A sine of a phase k (t + b) + c knows it to 2^-52 of k b + c, however near to zero t is: what moves so jumps by that
// wherever it is looked at anew. As k t and what k b + c is beside whole turns, which are taken off with 32 digits, the
// sine is the same and is known as the time is. A phase of the time since some start, k (t - start), is written the
// same way: it would be known better than the time, and sizes of rounding that are taken from it would be too small.
#pragma once

#include "rbdyn/basics/form.hpp"
#include "rbdyn/expression/function.hpp"
#include "rbdyn/expression/time_function.hpp"

namespace rbdyn::inline RBDYN_FORM {

/// A function of time whose phases have lost whole turns, and by how much time in the largest of these was ahead of the
/// time: who computes with it as it was written knows time to the rounding of that.
struct SmallPhases {
    Function function;
    double ahead = 0.0;  // s
};

/// The same function, with the same operations where no phase is written more than half a turn off.
SmallPhases small_phases(const Function& function);
TimeFunction with_small_phases(const TimeFunction& function);

}  // namespace rbdyn::inline RBDYN_FORM
