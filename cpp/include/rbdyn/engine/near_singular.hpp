// Where near a step of a series constraints lose rank, and how long the step may be for that.
//
// There a pivot of what is solved has a double zero, in time, or nearly so; the motion is smooth on its branch. Begun
// at a distance d from that place coefficient k of a series carries rounding times d^-k, so that a step of length h
// over it multiplies rounding by (h / d)^order. Such steps are expanded with 32 digits (wide_series.hpp); and none ends
// close to the place, where the branch that the constraints alone tell is known to rounding over the distance.
#pragma once

#include <complex>
#include <vector>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/expression/series_evaluator.hpp"
#include "rbdyn/model/equations.hpp"

namespace rbdyn::inline RBDYN_FORM {

class NearSingular {
public:
    explicit NearSingular(const Equations& equations);

    /// Whether no constraint of these equations may lose rank.
    bool none() const { return pivots_.empty(); }

    /// Zeros of pivots about where a step of a length begins, real or nearly so, in the unit of the series.
    std::vector<std::complex<double>> places(const SeriesEvaluator& series, int order, double length) const;

    /// A length on which the series of the pivots tell where they vanish, and that they do.
    double told(const SeriesEvaluator& series, int order, double length, double log_tolerance) const;

    /// Whether doubles lose digits on a step that begins so far from them.
    static bool loses_digits(const std::vector<std::complex<double>>& places, double length);
    /// The length of a step that ends beside them; its end may be given, then it is only not too long.
    static double clear_of(const std::vector<std::complex<double>>& places, double length, bool is_given);

private:
    std::vector<int> pivots_;  // outputs: a pivot over what counts as none, less 1
};

}  // namespace rbdyn::inline RBDYN_FORM
