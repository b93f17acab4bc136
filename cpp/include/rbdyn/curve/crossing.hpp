// Where a path, polynomials in time, first crosses a plane curve from one side to the other: a bead that flies lands.
//
//   P(tau) = (x(tau), y(tau)), 0 <= tau <= length;   gap = (P - r(u)) . n,   n = b x t, b the third own axis
//
// The path's time is halved until each part either misses the boxes of the curve or passes, in a chord's length or so,
// graphs eta = f(xi) over chords (curve/cover.hpp); there the gap along eta,
//   G(tau) = eta(tau) - f(xi(tau)),
// has the sign and the zeros of the gap, with their multiplicity, and is a polynomial whose roots are all found
// (series/roots.hpp). A crossing is finished by Newton's method on the curve itself, P(tau) = r(u).
//
// Contract: the first tau in (0, length] where the gap goes through zero away from the allowed side. Touching without
// crossing is no landing. The contact that a bead has just left is divided out with its multiplicity: 2, or more if the
// coefficient of tau^2 is rounding. tau = 0 is returned where nothing is left to find because the path begins by going
// through: a contact at the start, just left or within rounding, whose first coefficient points to the wrong side.
// A path that is known to some doubt only, as that of a method whose polynomial misses the motion by more than
// rounding, leaves such a contact to the side of its first lobe that is more than the doubt. A crossing within rounding
// after the end is met at the end. A path that starts on the wrong side lands only after it has come back. Of two
// crossings closer than 2^-30 of a part's length, either is returned. Where the curve bends by a jump (a knot with a
// slope of its own), what the path has just left is the stretch it enters. The work is bounded; if it was not enough,
// complete() is false and what was not looked at counts as free of curve. A power of two as change of units changes no
// bit but the scale.
#pragma once

#include <cstddef>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/curve/cover.hpp"
#include "rbdyn/curve/curve.hpp"
#include "rbdyn/curve/gap.hpp"
#include "rbdyn/series/roots.hpp"

namespace rbdyn::inline RBDYN_FORM::curves {

/// A path in the plane of a curve, own axes: x = sum_k x[k] tau^k, degree at most max_path_degree.
struct Flight {
    const double* x;
    const double* y;
    int degree;
    double length;
    const double* doubt = nullptr;  // by power of tau, what x and y are known to; none: rounding
};

/// Where a flight ends on a curve.
struct Landing {
    double tau, u;
};

class LandingFinder {
public:
    explicit LandingFinder(Curve curve, double period = 0.0) : cover_(std::move(curve), period) {}

    /// `side`: 1 if the bead may be where the gap is positive, -1 where it is negative. `last`: the parameter where the
    /// bead was last on the curve; the result's turn of a closed curve is that of `last`, counted from the beginning of
    /// the domain. `just_left`: the path begins there, with gap and first derivative of the gap zero within rounding.
    std::optional<Landing> first_landing(const Flight& path, int side, double last, bool just_left);

    /// The parameter of the place of the curve nearest to a point that is on it but for rounding, in own axes; the turn
    /// of a closed curve is that of `last`. It does not depend on what was looked for before.
    double parameter_at(double x, double y, double last);

    /// Whether the last search looked everywhere.
    bool complete() const { return complete_; }
    const CurveCover& cover() const { return cover_; }

private:
    static constexpr double epsilon = std::numeric_limits<double>::epsilon();
    // parts of the path reach a little over each other, so that rounding hides no crossing between them
    static constexpr double overlap = 0x1p-30;
    // a graph is used this far from its middle, and answers for crossings this far
    static constexpr double reach = 1.6, window = 1.0 + 0x1p-30;
    static constexpr int max_depth = 50, max_visits = 20000;

    using Path = PathCoefficients;

    /// The turn of a closed curve that a parameter is on, as a sum for parameters of its domain.
    double turn_of(double u) const;

    /// The path on [0, 1], coefficients at the end that are `negligible` against the motion left out; false if it does
    /// not move or is not finite.
    bool scale(const Flight& path, double negligible);

    static Box bounding(const double* x, const double* y, int degree);

    /// The path on [from, from + width], as polynomials on [0, 1].
    void part(double from, double width, Path& x, Path& y) const;

    /// Looks at the path on [begin, begin + width] for crossings of the stretches nodes_[first .. last).
    void search(double begin, double width, int depth, std::size_t first, std::size_t last);

    /// Keeps what of a stretch the part of the path may meet; `divide` if the path is too long for it.
    void meet(int node, const Box& box, const Path& x, const Path& y, bool& divide);

    /// Looks for crossings of one graph by a part of the path; false if the part is too long to tell.
    bool examine(const CurveCover::Stretch& stretch, const Path& x, const Path& y, double from, double width,
                 bool is_last);

    /// How many of the roots behind a contact just left end lobes that are no more than doubt of the path. `gap(s)`: on
    /// the part of the path, that has this width and begins with it.
    template <class Value>
    std::size_t within_doubt(const Graph& g, double width, const Value& gap) const;

    /// The parameter of the contact if it lies in a stretch or next to it; otherwise not a number.
    double contact_near(const CurveCover::Stretch& s) const;

    /// The parameter on the curve itself for a place on a chord.
    double parameter(const Graph& g, const CurveCover::Stretch& s, double xi) const;

    /// Takes a crossing as the landing if none is earlier. `exact`: it is well across the curve, and not so near the
    /// contact that places are too rough; `doubt`: how far it is in doubt, in parts of `width`.
    void offer(const CurveCover::Stretch& s, Landing found, bool exact, double width, double doubt);

    CurveCover cover_;
    Path x_, y_, doubt_;  // the path on [0, 1], and what it is known to
    int degree_ = 0;
    double side_ = 1.0, contact_ = 0.0, turn_ = 0.0;
    bool just_left_ = false, in_doubt_ = false, complete_ = true;
    int visits_ = 0;
    Landing best_{};
    std::vector<int> nodes_;
    std::vector<double> roots_;
    series::RootFinder finder_;
};

}  // namespace rbdyn::inline RBDYN_FORM::curves
