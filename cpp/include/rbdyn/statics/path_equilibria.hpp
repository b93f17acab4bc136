// Every place where one bead stays at rest on its rail, or one rigid body on its hinge or slide, with all that is fixed
// to it.
//
// Smooth rail: the zeros of Q = F.r' (eq. 7.16), stable where U(s) has a strict maximum, that is where the first
// derivative of Q that is not zero is of odd order and negative. Rough rail: the intervals where hold >= 0
// (path_forces.hpp). A zero of Q where r' is zero (a cusp) is none. Where a force jumps from one sign to the other
// across zero, the corner of U between is an equilibrium too. A bead that is only pressed against an end of its rail
// is in none.
//
// The rail is searched all along if it has two ends, for one round if it is closed; else on both sides of a place, as
// far as 32 stretches on which one Taylor series holds go, each up to twice as long as the one before, and those more
// that forces of polynomials take from beside a zero or a border to where all of them show. A hinge is
// searched for one turn; with a torsion spring, whose moment in the end outgrows all that repeats itself, as far as
// there can be any. One with a torque of its angle that is another one after a turn is searched as a path without ends.
// Where this takes more pieces than are kept the list would lack some: it is refused, unless a place was asked for.
// Accuracy: rounding of Q over its slope. Zeros nearer than rounding lets them be told apart count as one.
//
// Beside a branch point, where no series holds, values decide: signs of Q on both sides, which come as near to it as
// doubles do.
//
// Where Q is rounding beside the forces on a stretch, that is one of equilibria only if its formula ends with it: a
// force that goes on smoothly to more than rounding is zero at single places (identity theorem). Those are what the
// derivatives say if the signs of Q on both sides agree; if they do not, the whole stretch is one equilibrium, not
// decided.
#pragma once

#include <cstddef>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/scene/scene.hpp"
#include "rbdyn/statics/equilibrium.hpp"
#include "rbdyn/statics/path_forces.hpp"
#include "rbdyn/statics/path_pieces.hpp"
#include "rbdyn/statics/path_zero.hpp"

namespace rbdyn::inline RBDYN_FORM {

class PathEquilibria {
public:
    /// `scene`: as of PathForces. `place`: about where a path without ends is searched, and, if that is `asked` for,
    /// one of too many pieces. Throws InvalidInput for one of too many pieces otherwise.
    PathEquilibria(const Scene& scene, double place, bool asked);

    std::vector<Equilibrium> find();

private:
    using Piece = statics::PathPiece;
    using Gap = statics::PathGap;
    using Interval = std::pair<double, double>;
    static constexpr double epsilon = std::numeric_limits<double>::epsilon();
    static constexpr auto along = static_cast<std::size_t>(PathForces::along);

    /// A zero of Q.
    struct Point {
        double u = 0.0, half = 0.0;
        bool stable = false, pushed = true;
        double slope = 0.0;         // dQ/du of a simple zero
        int order = 1;              // 0: not decided; of a corner: corner
        double radius = 0.0;        // within which rounding leaves it
        int before = 0, after = 0;  // signs of Q beside it, if known
    };
    // what a corner does the forces on both sides say, not a series of one of them: it counts before zeros of any order
    static constexpr int corner = statics::order + 1;
    /// Where Q is rounding, at several places one after the other; the signs of Q where it goes on smoothly.
    struct Stretch {
        double from = 0.0, to = 0.0;
        int places = 1, before = 0, after = 0;
        bool goes_on() const { return places > 2 && (before != 0 || after != 0); }
        /// One in it: zero, where it has that, and where doubles come nearest to what a force is zero at.
        double place() const { return from <= 0.0 && to >= 0.0 ? 0.0 : from + 0.5 * (to - from); }
        bool has(double u) const { return u >= from && u <= to; }
    };

    /// Whether a turn of a hinge changes nothing but the moment of its torsion springs.
    bool repeats();
    /// Where the torsion springs of a hinge have no moment together, and how far from there anything else can be as
    /// strong: all else repeats itself after a turn.
    std::pair<double, double> wound();
    /// The angle of a hinge in (-pi, pi]; of one that stays wherever it is, that of the start.
    void turn_back(Equilibrium& e) const;

    void walk(bool asked);
    /// Where a piece is rounding: a zero of high order has no sign that shows within a twentieth of the piece, one of
    /// lower order is told by the roots unless it is at an end or in the middle.
    static std::vector<double> flat_places(const Piece& p);
    /// Where Q may be zero on a piece, those places among them.
    static std::vector<double> zeros_of(const Piece& p);
    /// Halves a piece as long as the forces about its zeros of Q are small beside what they are elsewhere on it: there
    /// its polynomial knows them to few digits.
    void refine(const Piece& p, int depth, std::vector<Piece>& path);
    /// Whether the forces are the same on the whole piece, within rounding.
    bool is_same_all_along(const Piece& p) const;
    /// Whether what is the same on a piece is so as far as is searched, where it is looked at.
    bool is_same_beyond(const Piece& p, double way) const;
    /// Whether a piece is as long as the way there from a place where series end lets it be.
    static bool is_as_the_way(const Piece& p, double from);
    /// What rounding makes of hold, somewhere; of Q^2 where hold is its difference from nearly the same.
    double hold_noise(const Piece& p) const;
    double hold_noise(const Piece& p, double x) const;
    static bool adjoin(double end, const Piece& p);

    // --- zeros of Q ---

    void find_points();

    /// Whether Q on a piece is more than the rounding of its own terms.
    bool is_felt(const Piece& p);
    /// Those that go on smoothly at an end, and so are no equilibria all along.
    std::vector<Stretch> find_stretches() const;
    /// Keeps the zeros of a stretch if they and the signs beside it agree; else all of it is one that is not decided.
    void judge(const Stretch& stretch);
    /// A stretch on which a force underflows that is more than that on both sides: a zero of too high an order for
    /// doubles.
    bool underflows(const Stretch& stretch);

    /// The end of a piece where the formula changes that is the place x, if it is one.
    static std::optional<double> cut_end(const Piece& piece, double x, double near);
    /// Takes a zero found on a piece, to rounding.
    void add(const Piece& piece, double x);
    /// Takes a zero near u, looked at in units of `half`, if there is one.
    void add_near(double u, double half);
    void add_zero(const statics::PathZero& zero, double u, double half);
    /// A jump across zero between two pieces, where the formula changes.
    void add_jump(const Piece& before, const Piece& after);
    /// A zero where the formula of the force changes.
    void add_corner(double u, double half);
    bool is_pushed(double u);
    /// Whether a rail that holds one side pushes with nothing, within rounding: what the bead does off it is not looked
    /// at here.
    bool may_leave(double u);

    // --- zeros of Q where it has no series (path_gaps.ipp) ---

    /// A value of Q in a gap, its sign 0 within rounding.
    struct Sample {
        double u = 0.0, q = 0.0;
        int sign = 0;
    };
    class Sampler;
    void find_in_gaps();
    /// The gaps in order, those that meet as one.
    std::vector<Gap> joined_gaps() const;
    /// Where Q is looked at in a gap, in order.
    static std::vector<double> places_in(const Gap& gap);
    void find_in(const Gap& gap);
    /// Of places between which Q is rounding the one where a case distinction changes, or zero, or the middle.
    static double center_of(const Gap& gap, double from, double to);
    /// Whether the force q is more than at a place farther from a pole: there it grows beyond all bounds; at a jump it
    /// is the same.
    bool grows_from(Sampler& values, double beside, double q) const;
    /// A zero or a jump between two places on which Q has other signs, if it is no pole.
    void add_between(Sampler& values, const Sample& before, const Sample& after, const Gap& gap);
    void add_in_gap(double u, int before, int after, double width);

    // --- intervals ---

    void find_held();
    /// A zero of an output near u, by Newton's method.
    double polished(double u, const Piece& piece, int output);

    void extend(std::vector<Interval>& intervals, std::size_t i);
    /// Flat intervals that end beside a change of formula, to that.
    void reach_changes();
    /// Intervals to the ends of the rail: those of a curve without end go on if the forces do, those of a closed curve
    /// across its seam.
    void finish(std::vector<Interval>& intervals);
    double in_window(double u) const;
    /// The same place of a closed curve, in an interval if it lies there.
    double shifted(const Interval& i, double u) const;
    bool inside(const std::vector<Interval>& intervals, double u) const;

    /// The equilibria of an interval as one: its middle; of one that friction holds the zero of Q nearest to it, if
    /// there is one.
    Equilibrium resting(const Interval& i, bool stable) const;

    // parts of a piece within which a zero is at its end
    static constexpr double at_end = 1e-9;
    // some seconds; each way about a place asked for, if there are more; and each way on a path without end
    static constexpr int most_pieces = 40000, most_about = 2000, most_stretches = 32;
    // a zero where the forces vanish too is closed in on so far, which leaves its piece longer than rounding of u
    static constexpr int most_halvings = 24;

    PathForces forces_;
    PathPieces pieces_;
    double place_;
    double low_ = 0.0, high_ = 0.0, round_ = 0.0;
    std::vector<Piece> path_;
    std::vector<Gap> gaps_;
    std::vector<Point> points_;
    std::vector<Interval> flat_, held_, hidden_;
    std::vector<double> felt_;  // middles of pieces in flat_ on which Q is small, but more than rounding of its terms
    std::vector<std::pair<double, int>> ends_;  // of held intervals, as the pieces have them
};

}  // namespace rbdyn::inline RBDYN_FORM
