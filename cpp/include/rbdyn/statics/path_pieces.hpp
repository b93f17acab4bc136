// A way along the one coordinate of a body (path_forces.hpp) in pieces on which the forces are polynomials: Taylor
// series about the middle of each piece.
//
// A piece is as long as its series holds to rounding, no longer than twice the one before, and ends where a case
// distinction of the forces changes. Lengths are halves and doubles of one another, so that powers of two in the units
// change nothing. Towards a branch point, as of |x|^(5/2), a pole or a step that doubles do not resolve, pieces become
// ever shorter: what is left of the way there, and as much behind it as has no series either, is a gap.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/expression/evaluate.hpp"
#include "rbdyn/expression/program.hpp"
#include "rbdyn/expression/series_evaluator.hpp"
#include "rbdyn/expression/series_sizes.hpp"
#include "rbdyn/series/polynomial.hpp"
#include "rbdyn/statics/path_budget.hpp"
#include "rbdyn/statics/path_forces.hpp"

namespace rbdyn::inline RBDYN_FORM {

namespace statics {

inline constexpr int order = 20;

/// Forces smaller than this are zero: the digits of their derivatives are beyond where doubles end.
inline constexpr double least_force = 0x1p-900;

/// The roots of c in [-1, 1] at which its sign changes, in increasing order.
std::vector<double> roots_about_middle(const double* c, int degree);

/// A stretch [middle - half, middle + half] of a rail, with the forces on it in powers of x = (u - middle)/half.
struct PathPiece {
    double middle = 0.0, half = 0.0;
    double effort = 0.0;                        // largest size of what Q is made of
    double rounding = 0.0;                      // what that of its own terms makes of Q, where that was asked for
    bool polynomial = false;                    // exact at any length, if no case distinction changes
    bool endless = false;                       // none can
    bool cut_below = false, cut_above = false;  // a case distinction changes at that end
    std::array<std::array<double, order + 1>, 3> output{};

    double begin() const { return middle - half; }
    double end() const { return middle + half; }
    double place(double x) const { return x == 1.0 ? end() : x == -1.0 ? begin() : middle + half * x; }
    double value(int k, double x) const { return series::value(output[static_cast<std::size_t>(k)].data(), order, x); }
    /// What rounding makes of Q.
    double noise() const { return 16.0 * std::numeric_limits<double>::epsilon() * effort; }
    /// The most Q can be on the piece.
    double bound() const;
    /// Whether Q at x may be zero: its powers are summed with their own rounding.
    bool may_vanish(double x) const;
};

/// What pieces leave out, from one to the next one on the way; and where case distinctions change in it.
struct PathGap {
    double from = 0.0, to = 0.0;
    std::vector<double> changes;
};

}  // namespace statics

/// Expands the forces along a rail. An evaluation of its own, not to be shared by threads.
class PathPieces {
public:
    explicit PathPieces(const PathForces& forces) : forces_(forces), formula_(forces.first_formula()) { resolve(); }

    /// Pieces from `from` towards `to` (which may be infinite), as many as the budget of `most` allows, until
    /// visit(piece) is false; what they leave out goes to pass(gap). Whether it came to `to`, or was told to stop
    /// before. `scale`: a length over which the forces change about `from`, if it is known to be longer than their
    /// series there. Throws InvalidInput where the forces are not finite.
    template <class Visit, class Pass>
    bool march(double from, double to, int most, Visit&& visit, Pass&& pass, double scale = 0.0) {
        const double way = to > from ? 1.0 : -1.0;
        // beside a zero or a border one that is resolved all the same
        constexpr double shortest = 0x1p-12;
        double half = std::min(0.5 * std::abs(to - from), std::max(natural(from), shortest * std::abs(from)));
        statics::PathBudget budget(most, std::max(half, scale));
        statics::PathGap gap;
        bool cut = false, is_open = false;
        const auto open = [&] {
            if (!is_open) gap = {from, from, {}};
            is_open = true;
        };
        const auto close = [&] {
            gap.to = from;
            if (is_open) pass(std::as_const(gap));
            is_open = false;
        };
        while (budget.is_left() && from != to) {
            const double left = 0.5 * std::abs(to - from);
            const bool is_last = half >= left;
            double reach = std::min(half, left);
            const double least = closest(from, budget.longest());
            while (!expand(from + way * reach, reach) && reach > least) half = reach *= 0.5;
            if (!holds_) {
                open();
                const auto beyond = leapt(from, way, to, least, budget.longest());
                // what was not looked for before is not asked for now
                if (!beyond && budget.is_extended()) break;
                if (!beyond) refuse(from, way, reach);
                from = *beyond;
                half = piece_.half;
                cut = false;
                budget.leap();
                continue;
            }
            // a change of formula on the way ends the piece; that of its new middle may change before
            bool ends_at_cut = false;
            double next = is_last && reach == left ? to : from + way * 2.0 * reach;
            for (double change = first_change(way); change < 1.0; change = first_change(way)) {
                const double place = piece_.middle + way * piece_.half * change;
                const double shorter = 0.5 * std::abs(place - from);
                if (!(shorter < piece_.half)) break;
                ends_at_cut = true;
                next = place;
                expand(from + way * shorter, shorter);
            }
            // where the formula before the change has no series at its end, as near to that as may be
            if (ends_at_cut && !holds_) {
                half = 0.5 * piece_.half;
                if (half > least) continue;
                open();
                gap.changes.push_back(next);
                from = next;
                half = budget.longest();
                cut = false;
                continue;
            }
            // one at the very end is none on the way
            ends_at_cut = ends_at_cut || changes_at(next, piece_.half);
            close();
            (way > 0.0 ? piece_.cut_below : piece_.cut_above) = cut;
            (way > 0.0 ? piece_.cut_above : piece_.cut_below) = ends_at_cut;
            cut = ends_at_cut;
            budget.take(piece_.half, piece_.output[PathForces::along][0]);
            const double growth = stretch_;
            if (!visit(std::as_const(piece_))) return true;
            from = next;
            if (growth >= 2.0) half = 2.0 * std::max(reach, 0.5 * half);
        }
        close();
        return from == to;
    }
    template <class Visit>
    bool march(double from, double to, int most, Visit&& visit) {
        return march(from, to, most, std::forward<Visit>(visit), [](const statics::PathGap&) {});
    }

    /// The forces about u, in units of `half`; for the derivatives at u itself.
    const statics::PathPiece& about(double u, double half);

    /// What the coefficients of Q looked at last are sums of.
    std::array<double, statics::order + 1> sizes();
    /// What rounding makes of Q on that piece: of a difference of terms more than of what is left of it.
    double rounding();

    /// A power of two of the parameter over which the forces change about u.
    double natural(double u);

    /// The same of what they are beside u, where there is no series.
    double scale_of_values(double u);

    /// What rounding makes of Q at u, in a gap of some width.
    double noise_at(double u, double width);

    /// Of forces that are polynomials there: how many times that length is to be doubled to the widest over which they
    /// change. Beside a zero or a border it is no longer than the way there.
    int doublings(double u);

    /// Whether one formula of the forces goes over to another one at u, at the end of a piece.
    bool changes_at(double u, double half);

    /// Where one goes over to another one between two places, if it does.
    std::optional<double> change_between(double low, double high);

private:
    static double power_of_two(double x);
    /// How near a place pieces of some length come: to few of its own roundings, and at zero to what values have to
    /// tell.
    static double closest(double u, double longest) { return std::max(1e-13 * std::abs(u), 0x1p-60 * longest); }
    /// Where pieces may begin again behind a place without one, looked for in steps that double; the piece that holds
    /// there is the last one looked at. None where the forces are not finite.
    std::optional<double> leapt(double from, double way, double to, double least, double longest);
    bool has_values(double u);
    /// On which sides of the case distinctions of the formula in use a place is.
    std::vector<double> sides(double u);
    [[noreturn]] void refuse(double from, double way, double reach);
    /// The least unit in which a power that is rounding beside the largest one, though more than that of its own terms,
    /// is as large as that; 0 if there is none.
    double hidden();
    /// As near places of a piece are told apart, in halves of it.
    static double resolved(double middle, double half) {
        return 64.0 * std::numeric_limits<double>::epsilon() * std::max(1.0, std::abs(middle) / half);
    }
    void resolve();

    /// The formula that is right at u.
    void choose(double u);

    /// Whether a series is a polynomial: zero from some order on, and the last term before that no rounding.
    bool ends(int output);

    int guards() const { return formula_.guards + static_cast<int>(formula_.program.switches().size()); }

    /// Makes the piece about a middle; whether its series holds.
    bool expand(double middle, double half);

    /// What that of places makes of it.
    double rounding_of_place() const;

    /// Where on the way through the piece a case distinction changes first, x in (-1, 1]; 1 if none does.
    double first_change(double way) const;

    const PathForces& forces_;
    PathForces::Formula formula_;
    std::unique_ptr<SeriesEvaluator> series_;
    std::unique_ptr<Evaluator<double>> values_;
    std::unique_ptr<SeriesSizes> sizes_;
    statics::PathPiece piece_;
    bool is_finite_ = true, holds_ = false;
    double stretch_ = 0.0;  // how much longer the piece could be
    double ratio_ = 0.0;    // where the terms of a polynomial are equal
};

}  // namespace rbdyn::inline RBDYN_FORM
