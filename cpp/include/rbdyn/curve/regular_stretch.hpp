// The stretch of a curve around a parameter on which its tangent is known to be defined, found as it is asked for.
//
// Where r' = 0 (a cusp, or a parameter that stands still), jumps (a corner) or has no end (a slope that becomes
// vertical), the motion along a curve has no law by its parameter, though series in time may well go on through such a
// point: at a cusp that is reached without speed u grows evenly with time. So where a bead is about to go is looked at
// beforehand.
//
// On [a, b] with the middle m and the half h, r' does not vanish and keeps its size if |r'(m)| > 2 h max |r''|, r'' at
// a, m and b; it does not jump if it changes from a to b by no more than these allow, or by less than 1e-9 of itself.
// Else the interval is halved. A singular point is where halving ends at the spacing of numbers.
// A corner that a case distinction makes is met as the event that it is, too: between places that are looked at there
// may be two that make up for each other.
// Invariant: what has been looked at once is not looked at again.
#pragma once

#include <optional>
#include <utility>
#include <vector>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/curve/curve.hpp"
#include "rbdyn/curve/point.hpp"

namespace rbdyn::inline RBDYN_FORM::curves {

class RegularStretch {
public:
    RegularStretch(Curve curve, double u) : curve_(std::move(curve)), domain_(curve_.domain()), low_(u), high_(u) {}

    const Curve& curve() const { return curve_; }

    /// Begins anew around a parameter that motion along the curve has not led to.
    void include(double u);

    /// The nearest parameter, if any, in [low, high] beyond which the curve is singular, going from where it is regular
    /// already: of its next singular point above, or below.
    std::optional<double> end_above(double high);
    std::optional<double> end_below(double low);

    /// The largest |r''| / |r'| that has been seen.
    double sharpness() const { return sharpness_; }

private:
    /// All of a closed curve.
    bool is_round() const { return curve_.closed() && high_ - low_ >= curve_.period(); }

    /// Goes from `known` to a parameter, as far as the curve is regular.
    void extend(double to, double& known, std::optional<double>& end);

    bool is_regular(double a, double b);
    /// r', |r'| and |r''|.
    struct Rates {
        Vector3 first;
        double speed, bend;
    };
    Rates rates(double u);

    Curve curve_;
    Domain domain_;
    double low_, high_, sharpness_ = 0.0;
    std::optional<double> below_, above_;
};

/// Parameters of a curve next to its singular points, those around u: all over it, or within 32 units of its parameter
/// where it has no end; the first few hundred.
std::vector<double> singular_points(const Curve& curve, double u);

}  // namespace rbdyn::inline RBDYN_FORM::curves
