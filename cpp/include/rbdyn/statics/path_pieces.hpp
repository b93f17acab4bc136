// A way along the one coordinate of a body (path_forces.hpp) in pieces on which the forces are polynomials: Taylor
// series about the middle of each piece.
//
// A piece is as long as its series holds to rounding, no longer than twice the one before, and ends where a case
// distinction of the forces changes. Lengths are halves and doubles of one another, so that powers of two in the units
// change nothing.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "rbdyn/expression/series_evaluator.hpp"
#include "rbdyn/expression/series_sizes.hpp"
#include "rbdyn/series/roots.hpp"
#include "rbdyn/series/step_length.hpp"
#include "rbdyn/statics/path_forces.hpp"

namespace rbdyn {

namespace statics {

inline constexpr int order = 20;

/// The roots of c in [-1, 1] at which its sign changes, in increasing order.
inline std::vector<double> roots_about_middle(const double* c, int degree) {
    series::RootFinder finder;
    std::vector<double> right, left, all;
    std::array<double, order + 2> mirrored{};
    for (int k = 0; k <= degree; ++k) mirrored[static_cast<std::size_t>(k)] = k % 2 == 0 ? c[k] : -c[k];
    finder.find(mirrored.data(), degree, left);
    finder.find(c, degree, right);
    for (std::size_t k = left.size(); k-- > 0;) all.push_back(-left[k]);
    if (c[0] == 0.0) all.push_back(0.0);
    all.insert(all.end(), right.begin(), right.end());
    return all;
}

/// A stretch [middle - half, middle + half] of a rail, with the forces on it in powers of x = (u - middle)/half.
struct PathPiece {
    double middle = 0.0, half = 0.0;
    double effort = 0.0;                        // largest size of what Q is made of
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
    double bound() const {
        double sum = 0.0;
        for (const double c : output[PathForces::along]) sum += std::abs(c);
        return sum;
    }
    /// Whether Q at x may be zero: its powers are summed with their own rounding.
    bool may_vanish(double x) const {
        return std::abs(value(PathForces::along, x)) <=
               std::max(noise(), 64.0 * std::numeric_limits<double>::epsilon() * bound());
    }
};

}  // namespace statics

/// Expands the forces along a rail. An evaluation of its own, not to be shared by threads.
class PathPieces {
public:
    explicit PathPieces(const PathForces& forces) : forces_(forces), formula_(forces.first_formula()) { resolve(); }

    /// Pieces from `from` towards `to` (which may be infinite), at most `most` of them, until visit(piece) is false.
    /// A place where the forces have no series is left out. Throws InvalidInput where they are not finite.
    template <class Visit>
    void march(double from, double to, int most, Visit&& visit) {
        const double way = to > from ? 1.0 : -1.0;
        double half = 0.5 * std::min(std::abs(to - from), 2.0 * natural(from));
        bool cut = false;
        int closer = 0;
        for (int count = 0; count < most && from != to; ++count) {
            const double left = 0.5 * std::abs(to - from);
            const bool is_last = half >= left;
            double reach = std::min(half, left);
            const double least = 1e-13 * std::max(std::abs(from), half);
            for (;;) {
                if (expand(from + way * reach, reach)) break;
                if (reach <= least) break;
                reach *= 0.5;
                half = reach;
            }
            if (reach <= least && !holds_) {
                if (!is_finite_)
                    throw InvalidInput(forces_.name() + ": at " + forces_.coordinate() + " " + text(piece_.middle) +
                                       " " + forces_.not_finite(piece_.middle) +
                                       " is not finite; it must be wherever the body can come");
                from += way * std::max(2.0 * reach, 4.0 * least);
                if (std::isfinite(to) && way * (to - from) <= 0.0) return;
                cut = true;
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
            // where the formula before the change has no series at its end, close to that
            if (ends_at_cut && !holds_ && closer < most_closer) {
                ++closer;
                half = 0.5 * piece_.half;
                continue;
            }
            if (ends_at_cut) closer = 0;
            (way > 0.0 ? piece_.cut_below : piece_.cut_above) = cut;
            (way > 0.0 ? piece_.cut_above : piece_.cut_below) = ends_at_cut;
            cut = ends_at_cut;
            if (!visit(piece_)) return;
            from = next;
            if (stretch_ >= 2.0) half = 2.0 * std::max(reach, 0.5 * half);
        }
    }

    /// The forces about u, in units of `half`; for the derivatives at u itself.
    const statics::PathPiece& about(double u, double half) {
        expand(u, half);
        return piece_;
    }

    /// What the coefficients of Q looked at last are sums of.
    std::array<double, statics::order + 1> sizes() {
        (*sizes_)(*series_);
        std::array<double, statics::order + 1> result;
        std::copy_n(sizes_->output(PathForces::along), statics::order + 1, result.begin());
        return result;
    }

    /// A power of two of the parameter over which the forces change about u.
    double natural(double u) {
        double unit = 1.0;
        if (u != 0.0) unit = power_of_two(std::abs(u));
        // measured in units near it
        for (int attempt = 0; attempt < 40; ++attempt) {
            expand(u, unit);
            if (!is_finite_) {
                unit *= 0x1p-24;
                continue;
            }
            double scale = std::isfinite(stretch_) ? stretch_ : ratio_;
            if (!(scale > 0.0) || !std::isfinite(scale)) return unit;
            if (scale > 1.0 / 64.0 && scale < 64.0) return unit * power_of_two(scale);
            unit *= power_of_two(std::clamp(scale, 0x1p-24, 0x1p24));
        }
        return unit;
    }

private:
    // halvings of the way to a change of formula: the rest is a hundredth of it
    static constexpr int most_closer = 6;

    static double power_of_two(double x) {
        int exponent = 0;
        std::frexp(x, &exponent);
        return std::ldexp(1.0, exponent - 1);
    }
    void resolve() {
        series_ = std::make_unique<SeriesEvaluator>(formula_.program, statics::order);
        series_->set_parameters(formula_.parameters);
        values_ = std::make_unique<Evaluator<double>>(formula_.program);
        values_->set_parameters(formula_.parameters);
        sizes_ = std::make_unique<SeriesSizes>(formula_.program, statics::order);
        sizes_->set_parameters(formula_.parameters);
    }

    /// The formula that is right at u.
    void choose(double u) {
        if (formula_.is_smooth) return;
        if (formula_.guards > 0) {
            (*values_)(0.0, std::span<const double>(&u, 1));
            bool is_right = true;
            for (int k = 0; k < formula_.guards; ++k)
                is_right = is_right && values_->output(formula_.outputs + k) > 0.0;
            if (!is_right) {
                formula_ = forces_.formula(u);
                resolve();
            }
        }
        statics::set_signs(formula_.program, formula_.parameters, std::span<const double>(&u, 1));
        series_->set_parameters(formula_.parameters);
        values_->set_parameters(formula_.parameters);
        sizes_->set_parameters(formula_.parameters);
    }

    /// Whether a series is a polynomial: zero from some order on, and the last term before that no rounding.
    bool ends(int output) {
        const double* c = series_->output(output);
        int last = statics::order;
        while (last > 0 && c[last] == 0.0) --last;
        if (last > statics::order - 4) return false;
        (*sizes_)(*series_);
        return std::abs(c[last]) > 64.0 * last * std::numeric_limits<double>::epsilon() * sizes_->output(output)[last];
    }

    int guards() const { return formula_.guards + static_cast<int>(formula_.program.switches().size()); }

    /// Makes the piece about a middle; whether its series holds.
    bool expand(double middle, double half) {
        choose(middle);
        series_->begin(0.0, 1.0);
        series_->set_input(0, 0, middle);
        series_->set_input(0, 1, half);
        for (int k = 2; k <= statics::order; ++k) series_->set_input(0, k, 0.0);
        for (int k = 0; k <= statics::order; ++k) series_->advance(k);
        piece_ = {};
        piece_.middle = middle;
        piece_.half = half;
        is_finite_ = true;
        const int outputs = formula_.outputs, all = outputs + guards();
        for (int j = 0; j < all; ++j)
            for (int k = 0; k <= statics::order; ++k) is_finite_ = is_finite_ && std::isfinite(series_->output(j)[k]);
        for (int j = 0; j < outputs; ++j)
            std::copy_n(series_->output(j), statics::order + 1, piece_.output[static_cast<std::size_t>(j)].begin());
        piece_.effort = forces_.effort(middle);
        is_finite_ = is_finite_ && std::isfinite(piece_.effort);
        stretch_ = std::numeric_limits<double>::infinity();
        ratio_ = std::numeric_limits<double>::infinity();
        holds_ = false;
        if (!is_finite_) return false;
        for (int j = 0; j < all; ++j) {
            const double* c = series_->output(j);
            std::array<double, statics::order + 1> size;
            for (int k = 0; k <= statics::order; ++k) size[static_cast<std::size_t>(k)] = std::abs(c[k]);
            const double e = piece_.effort;
            const double scale = j >= outputs ? size[0] : j == PathForces::hold ? e * e : e;
            double length = std::exp2(series::log_step(size.data(), statics::order, std::max(scale, size[0]), -53.0));
            if (std::isfinite(length) && j < outputs && ends(j)) length = std::numeric_limits<double>::infinity();
            stretch_ = std::min(stretch_, length);
            // of a polynomial: where its first two terms are equal, those that are not rounding
            const double largest = *std::max_element(size.begin(), size.end());
            const double least = 64.0 * std::numeric_limits<double>::epsilon() * std::max(scale, largest);
            int first = -1;
            for (int k = 0; k <= statics::order; ++k) {
                const double c_k = size[static_cast<std::size_t>(k)];
                if (!(c_k > least)) continue;
                if (first >= 0)
                    ratio_ = std::min(ratio_, std::pow(size[static_cast<std::size_t>(first)] / c_k, 1.0 / (k - first)));
                else
                    first = k;
            }
        }
        piece_.polynomial = std::isinf(stretch_);
        piece_.endless = piece_.polynomial && guards() == 0;
        holds_ = stretch_ >= 1.0;
        // what the middle does not know of shows at the ends
        for (const double x : {-1.0, 1.0}) {
            if (!holds_) break;
            const double u = middle + half * x;
            const double e = forces_.effort(u);
            piece_.effort = std::max(piece_.effort, e);
            (*values_)(0.0, std::span<const double>(&u, 1));
            if (!std::isfinite(e)) continue;  // a formula that ends here
            holds_ = std::abs(values_->output(PathForces::along) - piece_.value(PathForces::along, x)) <=
                     1e-11 * piece_.effort;
        }
        return holds_;
    }

    /// Where on the way through the piece a case distinction changes first, x in (-1, 1]; 1 if none does.
    double first_change(double way) const {
        double first = 1.0;
        const double resolved =
            64.0 * std::numeric_limits<double>::epsilon() * std::max(1.0, std::abs(piece_.middle) / piece_.half);
        for (int j = formula_.outputs; j < formula_.outputs + guards(); ++j) {
            const double* c = series_->output(j);
            for (const double x : statics::roots_about_middle(c, statics::order))
                if (way * x > -1.0 + resolved && way * x < first - resolved) first = way * x;
            // the middle itself, within rounding
            double size = 0.0;
            for (int k = 1; k <= statics::order; ++k) size += std::abs(c[k]);
            if (std::abs(c[0]) <= resolved * size && resolved < first) first = 0.0;
        }
        return first;
    }

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

}  // namespace rbdyn
