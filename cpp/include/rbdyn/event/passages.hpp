// Where a guard passes zero on a piece: its polynomial's changes of sign, but for those that rounding makes.
//
// Between two roots a guard rises to some height; one that is nothing but the rounding of its own terms is no lobe of
// the motion, and the roots beside it are none, or one. So what touches zero does not pass it, what begins at zero
// leaves it to the side of its first lobe, and what stays at zero passes nothing, whatever the step.
//
// Conventions: the guard is q on (0, 1]; its rounding at x is at most the sum of noise_k x^k.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <vector>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/series/polynomial.hpp"
#include "rbdyn/series/roots.hpp"

namespace rbdyn::inline RBDYN_FORM {

class Passages {
public:
    /// How a guard comes to a piece.
    struct Arrival {
        int side = 0;                               // it has been on; 0: not known
        bool at_zero = false;                       // what the piece begins with is known to be zero
        std::optional<double> zero = std::nullopt;  // the value known to be zero, if that may be what it begins with
        bool by_rounding = false;                   // it is zero only as far as can be told
        double within = 0.0;                        // up to there it is not told from the zero it begins with
        double gap = 0.0;                           // between the last piece and this one
        std::optional<double> late = std::nullopt;  // how far beyond 1 is met at 1: the run ends there
        double reach = 0x1p-4;                      // how far beyond 1 the polynomial holds
        double dips = 1.0;                          // so many roundings below zero it has but touched it
        bool is_series = true;                      // cut off, so that its last terms say what it leaves out
    };
    /// Where it passes zero, how far from there it cannot tell itself from zero, and how far another one of its zero,
    /// computed apart, may be.
    struct Place {
        double x, doubt, near;
    };
    /// A part of (0, 1].
    struct Stretch {
        double lo, hi;
    };

    /// More than 1: what is taken for rounding, in units of the rounding of a guard's terms.
    void set_looseness(double looseness) { looseness_ = looseness; }

    /// `sizes(double*)`: of the terms of the coefficients, asked for where rounding may matter. `at_end()`: the guard
    /// itself at 1.
    template <class Sizes, class AtEnd>
    void find(const double* q, int degree, const Arrival& a, const Sizes& sizes, const AtEnd& at_end) {
        places_.clear();
        roots_.clear();
        has_noise_ = false;
        degree_ = degree;
        std::copy_n(q, degree + 1, q_.begin());
        bool at_zero = a.at_zero;
        if (!at_zero && a.zero) {
            weigh(sizes, a);
            at_zero = std::abs(q[0] - *a.zero) <= 16.0 * noise_[0];
        }
        is_at_zero_ = at_zero;
        off_ = at_zero && a.by_rounding ? 2.0 * q[0] : 0.0;
        if (at_zero) q_[0] = 0.0;
        int first = 0;
        while (first <= degree && q_[at(first)] == 0.0) ++first;
        leaves_ = first > degree ? 0 : q_[at(first)] > 0.0 ? 1 : -1;
        leaves_from_ = 0.0;
        if (leaves_ == 0) return;
        finder_.find(q_.data() + first, degree - first, roots_);
        // far from zero at the end of the run, too
        const bool ends = !a.late || std::abs(value(1.0)) > 1e-3 * series::value_of_sizes(q_.data(), degree_, 1.0);
        if (a.within == 0.0 && roots_.empty() && finder_.multiple().empty() && leaves_ == a.side && ends && !cancels())
            return;
        if (!has_noise_) weigh(sizes, a);
        at_start_ = at_zero ? a.within : noise_[0];
        keep_lobes(a, at_end);
    }

    /// The side it leaves its beginning to; 0: it is rounding all along.
    int leaves() const { return leaves_; }
    /// From where on it is more than rounding on that side.
    double leaves_from() const { return leaves_from_; }
    /// In order; its side changes at each.
    const std::vector<Place>& places() const { return places_; }

    /// Stretches within (0, 1] in which it comes so near to zero that rounding of its polynomial hides what it does
    /// there; at both ends it is more than that.
    const std::vector<Stretch>& hidden();
    /// What rounding of the polynomial is worth at x.
    double rounding(double x) const { return noise(x, false); }
    /// Its side at x by the places before it.
    int side(double x) const;
    /// Whether the last place is the end, and to take that for none.
    bool passes_at_end() const { return !places_.empty() && places_.back().x >= 1.0; }
    void drop_last() { places_.pop_back(); }
    /// Places on a stretch.
    std::size_t count(const Stretch& s) const;
    /// Puts what a closer look found on a stretch, places on [0, 1] of it, in place of what is there.
    void replace(const Stretch& s, const std::vector<Place>& closer);

    /// The first place, up to `end`, where what was searched last comes so near to zero and turns back that rounding,
    /// its own and what it made of the motion so far, decides whether it passes.
    template <class Sizes>
    std::optional<double> touch(const Arrival& a, const Sizes& sizes, double end) {
        if (degree_ < 2 || series::slope_bounds(q_.data(), degree_).exclude_zero()) return std::nullopt;
        series::Coefficients slope;
        for (int k = 0; k < degree_; ++k) slope[at(k)] = (k + 1) * q_[at(k + 1)];
        turns_.clear();
        finder_.find(slope.data(), degree_ - 1, turns_);
        for (const double x : turns_) {
            if (x >= end) break;
            if (!has_noise_) weigh(sizes, a);
            if (std::abs(value(x)) <= near * noise(x, false)) return x;
        }
        return std::nullopt;
    }

private:
    static constexpr double epsilon = std::numeric_limits<double>::epsilon();
    // rounding of the motion so far, in units of that of a guard's terms
    static constexpr double near = 32.0;
    // of zeros that are computed apart, in the same units
    static constexpr double apart = 16.0;
    static std::size_t at(int k) { return static_cast<std::size_t>(k); }

    template <class Sizes>
    void weigh(const Sizes& sizes, const Arrival& a) {
        sizes(noise_.data());
        for (int k = 0; k <= degree_; ++k)
            noise_[at(k)] = 4.0 * epsilon * looseness_ * std::max(noise_[at(k)], std::abs(q_[at(k)]));
        noise_[0] = std::max({noise_[0], a.gap, a.within});
        // what a series leaves out is less than its last terms
        if (a.is_series && degree_ > 1)
            noise_[at(degree_)] += std::max(std::abs(q_[at(degree_)]), 0.1 * std::abs(q_[at(degree_ - 1)]));
        has_noise_ = true;
    }

    static bool is_on(const Stretch& s, const Place& p);
    double value(double x) const { return series::value(q_.data(), degree_, x); }
    double noise(double x, bool at_start) const;
    /// The sign at x; 0: rounding, so many times.
    int sign(double x, bool at_start = false, double times = 1.0) const;

    /// The side of the guard between two roots, or a root and an end; 0: it is rounding everywhere there. Not by the
    /// number of roots: one of a pair that touch may be lost.
    int lobe(double a, double b, double times = 1.0) const;

    /// Whether its terms cancel somewhere to so much less that their rounding, which may be more than that of what is
    /// left of them, may hide a zero that no root tells of.
    bool cancels();

    template <class AtEnd>
    void keep_lobes(const Arrival& a, const AtEnd& at_end) {
        const std::size_t count = roots_.size();
        int now = 0;
        std::size_t since = 0;  // the root that ends the last lobe
        leaves_ = 0;
        leaves_from_ = 0.0;
        const auto pass = [&](int side, std::size_t before) {
            if (now == 0) {
                leaves_ = side;
                if (before > 0) leaves_from_ = before <= count ? roots_[before - 1] : 1.0;
            } else if (side != now) {
                // of several roots with nothing between them the middle one
                add(before > since ? roots_[(since + before - 1) / 2] : 1.0);
            }
            now = side;
            since = before;
        };
        for (std::size_t i = 0; i <= count; ++i) {
            const int side = lobe(i == 0 ? 0.0 : roots_[i - 1], i == count ? 1.0 : roots_[i]);
            if (side < 0 && i < count && a.dips > 1.0 && lobe(i == 0 ? 0.0 : roots_[i - 1], roots_[i], a.dips) == 0)
                continue;
            if (side != 0) pass(side, i);
        }
        if (a.late && now != 0)
            if (const int after = beyond(*a.late, a.reach, at_end); after != 0) pass(after, count);
    }

    /// The side beyond the end of the run; 0: not to be told.
    template <class AtEnd>
    int beyond(double late, double reach, const AtEnd& at_end) {
        const double end = value(1.0);
        int after = sign(1.0 + late);
        // rounding there: the next side that is none
        for (double more = std::max(late, 0x1p-40); after == 0 && more <= reach; more *= 2.0) after = sign(1.0 + more);
        if (after == 0 || sign(1.0) != after) return after;
        // the series is cut off sooner than the state's: the guard itself decides, on its way to zero
        const double ahead = value(1.0 + late) - end;
        if (ahead * after > 0.0 || !(std::abs(end) <= 1e-3 * noise(1.0, false) / (4.0 * epsilon * looseness_)))
            return after;
        const double itself = at_end();
        return std::abs(itself) <= noise(1.0, false) + std::abs(ahead) ? -after : after;
    }

    /// Adds a passage; it cannot be told from places where the guard is rounding.
    void add(double x);

    series::RootFinder finder_;
    std::vector<double> roots_, turns_;
    std::vector<Place> places_;
    std::vector<Stretch> hidden_;
    series::Coefficients q_{}, noise_{};
    int degree_ = 0, leaves_ = 0;
    double looseness_ = 1.0, at_start_ = 0.0, leaves_from_ = 0.0;
    double off_ = 0.0;  // a lobe at the start of the other side is none up to this: what turns back there
    bool has_noise_ = false, is_at_zero_ = false;
};

}  // namespace rbdyn::inline RBDYN_FORM
