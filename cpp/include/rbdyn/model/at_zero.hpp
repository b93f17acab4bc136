// Whether a function of the motion is zero at a state, but for rounding: that of its own terms, of the state it is
// computed from, and of the time at which that was read. So a motion that is begun where another one had an event
// begins there, and one that starts at a parameter of pi starts at pi.
#pragma once

#include <limits>
#include <span>
#include <vector>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/expression/gradient.hpp"
#include "rbdyn/model/hybrid.hpp"

namespace rbdyn::inline RBDYN_FORM {

/// Of the outputs of a mode's equations at one (t, x), which are evaluated once.
class AtZero {
public:
    AtZero(const Mode& mode, double t, std::span<const double> x);

    /// As is_zero_at().
    bool operator()(int output, double few = 8.0 * std::numeric_limits<double>::epsilon());

    /// How far from zero an output is that is zero, by so much of the size of all numbers.
    double size(int output);

private:
    GradientEvaluator f_;
    double t_;
    std::vector<double> x_;
};

/// Of an output of a mode's equations at (t, x). `few`: the relative error of all numbers, by default half a unit in
/// the last place, times a few for what is computed from them before they get here (a speed along a rail is divided by
/// |r'|).
bool is_zero_at(const Mode& mode, double t, std::span<const double> x, int output,
                double few = 8.0 * std::numeric_limits<double>::epsilon());

/// The sizes of what an output at (t, x) is made of: its terms and theirs, the state and the time, as far as they
/// change it. Its rounding is epsilon times that, or a little more, but for what is called back.
double size_of_terms(const Mode& mode, double t, std::span<const double> x, int output);

/// Whether an output is zero whatever the motion near (t, x): a level at zero in its formula, as max(x, 0) has one.
bool is_level_at(const Mode& mode, double t, std::span<const double> x, int output);

}  // namespace rbdyn::inline RBDYN_FORM
