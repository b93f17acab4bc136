// A state that lies within its mode.
#pragma once

#include <limits>
#include <span>
#include <vector>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/model/hybrid.hpp"

namespace rbdyn::inline RBDYN_FORM {

/// A state that lies within its mode, by case distinctions too: one at the edge of the mode, where rounding may
/// have put it beyond, is moved by a time that is rounding.
struct Within {
    double t;
    std::vector<double> moved;
    std::span<const double> x;

    /// How far a state may be moved that is reported, over the time in which it changes: more would show.
    static constexpr double unseen = 0x1p-40;

    /// `most`: no farther than this, over the time in which the state changes; beyond it the state stays.
    Within(const Mode& mode, double time, std::span<const double> state,
           double most = std::numeric_limits<double>::infinity());

private:
    /// The time in which a state changes by as much as it is.
    static double time_of(const std::vector<double>& x, const std::vector<double>& slope, double t);
};

}  // namespace rbdyn::inline RBDYN_FORM
