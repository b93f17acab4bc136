// Arc length by quadrature, and its inverse.
//
//   s(u) = integral of |r'| from u0 to u                                             (the s of eq. 7.8)
//
// The range is halved until the Gauss-Kronrod pair of each piece agrees; since |r'| is never negative nothing cancels,
// and relative errors of pieces are relative errors of the sum. A cusp, where |r'| has a corner, is closed in on by
// halving until its piece no longer counts.
//
// Accuracy: relative error about 1e-15 where |r'| itself is accurate; an error is thrown if 1e-12 is out of reach.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <string>
#include <vector>

#include "rbdyn/basics/error.hpp"
#include "rbdyn/basics/form.hpp"
#include "rbdyn/curve/axes.hpp"
#include "rbdyn/curve/point.hpp"

namespace rbdyn::inline RBDYN_FORM::curves {

/// A node of the rules and its weights in both; Gauss's rule has every other node.
struct RuleNode {
    double at, kronrod, gauss;
};

/// The half x >= 0 of the rules of 31 and 15 points (QUADPACK's qk31: Piessens, de Doncker-Kapenga, Ueberhuber and
/// Kahaner, 1983).
inline constexpr std::array<RuleNode, 16> rule_nodes{{
    {0, 0.10133000701479154, 0.20257824192556129},
    {0.10114206691871749, 0.10076984552387559, 0},
    {0.20119409399743451, 0.099173598721791961, 0.19843148532711158},
    {0.29918000715316884, 0.096642726983623681, 0},
    {0.39415134707756339, 0.093126598170825317, 0.18616100001556221},
    {0.4850818636402397, 0.088564443056211764, 0},
    {0.57097217260853883, 0.083080502823133021, 0.16626920581699392},
    {0.65099674129741703, 0.076849680757720376, 0},
    {0.72441773136017007, 0.069854121318728257, 0.13957067792615432},
    {0.79041850144246595, 0.062009567800670642, 0},
    {0.84820658341042721, 0.053481524690928088, 0.10715922046717194},
    {0.89726453234408188, 0.044589751324764879, 0},
    {0.93727339240070595, 0.035346360791375847, 0.070366047488108124},
    {0.96773907567913908, 0.02546084732671532, 0},
    {0.98799251802048538, 0.015007947329316122, 0.030753241996117269},
    {0.99800229869339707, 0.0053774798729233492, 0},
}};

/// Gauss and Kronrod rules of 15 and 31 points on [-1, 1], nodes in increasing order.
struct RulePair {
    static constexpr int points = 31;
    std::array<double, points> node, kronrod, gauss;  // gauss: weight, 0 at the nodes it has not
    std::array<double, points> at_end;                // values at x = 1 of Lagrange's polynomials of the nodes

    RulePair();
};

/// A part of the range with its integral and how far that is in doubt.
struct Piece {
    double begin, end, length, doubt;
};

/// The integral by the two rules. A corner of |r'| beyond the outermost node is seen by neither, so that the value at
/// each end is compared as well with what the nodes foretell.
template <class Speed>
Piece measured(const Speed& speed, double begin, double end) {
    static const RulePair rule;
    const double middle = begin + 0.5 * (end - begin), half = 0.5 * (end - begin);
    double fine = 0.0, coarse = 0.0, at_begin = 0.0, at_end = 0.0;
    for (std::size_t k = 0; k < RulePair::points; ++k) {
        const double value = speed(middle + half * rule.node[k]);
        fine += rule.kronrod[k] * value;
        coarse += rule.gauss[k] * value;
        at_end += rule.at_end[k] * value;
        at_begin += rule.at_end[RulePair::points - 1 - k] * value;
    }
    const double surprise = std::max(std::abs(at_begin - speed(begin)), std::abs(at_end - speed(end)));
    // the outermost node lies 0.002 before the end: a tenth is fifty times what a corner beyond it can do
    return {begin, end, half * fine, half * std::max(std::abs(fine - coarse), 0.1 * surprise)};
}

/// Signed integral of `speed` from u0 to u1, finite. `floor`: an error [m] that is rounding of the points themselves.
/// Throws Error if a relative accuracy of 1e-12 is not reached.
template <class Speed>
double arc_length(const Speed& speed, double u0, double u1, double floor, const std::string& name) {
    if (u1 < u0) return -arc_length(speed, u1, u0, floor, name);
    if (u0 == u1) return 0.0;
    // the 31-point rule is far better than its difference from the 15-point rule: at 1e-12 it is at rounding error
    constexpr double agreed = 1e-12;
    // what counts nothing in the sum, and a bound on the work: a cusp needs two pieces a halving, some 60 in all
    constexpr double negligible = 1e-17;
    constexpr int most_pieces = 20000;

    double length = 0.0, error = 0.0;
    std::vector<Piece> waiting{measured(speed, u0, u1)};
    double estimate = waiting.front().length;
    for (int pieces = 1; !waiting.empty(); ++pieces) {
        const Piece piece = waiting.back();
        waiting.pop_back();
        const double middle = piece.begin + 0.5 * (piece.end - piece.begin);
        const bool smooth = piece.doubt <= agreed * piece.length;
        const bool indivisible = !(piece.begin < middle && middle < piece.end);
        if (smooth || piece.doubt <= negligible * estimate + 1e-2 * floor || indivisible || pieces > most_pieces) {
            length += piece.length;
            // the pair's difference squared but for a half: the usual estimate (QUADPACK) for a smooth integrand
            if (smooth && piece.length > 0.0) {
                error += piece.length * std::pow(200.0 * piece.doubt / piece.length, 1.5);
            } else {
                error += piece.doubt;
            }
            continue;
        }
        const Piece left = measured(speed, piece.begin, middle), right = measured(speed, middle, piece.end);
        estimate += left.length + right.length - piece.length;
        waiting.push_back(right);
        waiting.push_back(left);
    }
    constexpr double demanded = 1e-12;
    if (std::isnan(error))
        throw Error(name + ": the arc length from " + text(u0) + " to " + text(u1) +
                    " is not known: some numbers on the way are not finite; measure shorter stretches");
    if (!(error <= demanded * length + floor))
        throw Error(name + ": the arc length from " + text(u0) + " to " + text(u1) + " is known to " + text(error) +
                    " m only; a relative error of " + text(demanded) + " is required: measure shorter stretches");
    return length;
}

/// A step of the parameter over which the curve goes about as far as `distance`, judged by its derivatives at u.
template <class Form>
double step_for(const Form& form, double u, double distance) {
    const CurvePoint<double> p = form.template own<double>(u);
    double step = std::numeric_limits<double>::infinity();
    const double speed = norm(p.first), bend = norm(p.second), turn = norm(form.third(u));
    // the smallest of the steps by which r', r'' and r''' alone would go the distance
    if (speed > 0.0) step = std::min(step, distance / speed);
    if (bend > 0.0) step = std::min(step, std::sqrt(2.0 * distance / bend));
    if (turn > 0.0) step = std::min(step, std::cbrt(6.0 * distance / turn));
    return std::isfinite(step) ? step : 1.0;
}

/// The parameter at the signed arc length s [m] from u0: a bracket, then Newton's steps kept inside it.
/// Throws InvalidInput if the curve ends before.
template <class Form>
double parameter_at(const Form& form, double u0, double s, const std::string& name) {
    constexpr double epsilon = std::numeric_limits<double>::epsilon();
    if (s == 0.0) return u0;
    const double sign = s > 0.0 ? 1.0 : -1.0, target = std::abs(s);
    const double last = s > 0.0 ? form.domain().end : form.domain().begin;
    const auto forward = [&](double from, double to) { return sign * form.length(from, to); };
    const auto limited = [&](double u) { return sign > 0.0 ? std::min(u, last) : std::max(u, last); };

    // a bracket: near has gone too short a way, far has gone far enough
    double near = u0, near_length = 0.0, far = u0, far_length = 0.0;
    for (double step = step_for(form, u0, target); far_length < target; step *= 2.0) {
        near = far;
        near_length = far_length;
        far = limited(near + sign * step);
        if (far == near) far = limited(std::nextafter(near, sign * std::numeric_limits<double>::infinity()));
        if (!std::isfinite(far)) throw Error(name + ": no parameter at the arc length " + text(s) + " m was found");
        far_length = near_length + forward(near, far);
        if (far != last || far_length >= target) continue;
        // the end itself, within rounding
        if (far_length >= target * (1.0 - 4.0 * epsilon)) return last;
        throw InvalidInput(name + ": arc length is " + text(s) + "; the curve ends " + text(sign * far_length) +
                           " m from parameter " + text(u0) + ": stay within");
    }

    const bool from_far = far_length - target < target - near_length;
    double u = from_far ? far : near, gone = from_far ? far_length : near_length;
    // halving alone would take about 60 steps from a bracket around a cusp, Newton takes 3 or 4 elsewhere
    for (int k = 0; k < 200; ++k) {
        const double speed = norm(form.template own<double>(u).first);
        double next = u - sign * (gone - target) / speed;
        if (std::abs(gone - target) <= epsilon * target)
            return std::isfinite(next) && sign * (next - near) >= 0.0 && sign * (far - next) >= 0.0 ? next : u;
        // a step below the spacing of numbers at u
        if (next == u) return u;
        const bool inside = sign * (next - near) > 0.0 && sign * (far - next) > 0.0;
        if (!inside) next = near + 0.5 * (far - near);
        if (next == near || next == far) return next;
        // from the near end, so that what is added is never more than the whole
        gone = near_length + forward(near, next);
        u = next;
        if (gone < target) {
            near = u;
            near_length = gone;
        } else {
            far = u;
        }
    }
    return u;
}

}  // namespace rbdyn::inline RBDYN_FORM::curves
