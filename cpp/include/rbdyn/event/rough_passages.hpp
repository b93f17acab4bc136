// Where a function that has values only passes zero, though it may have poles, corners and infinite slopes, or begin
// where it is not finite.
//
// The interval is halved until the function is a polynomial on each part (series/fit.hpp). Towards a place where it is
// none the parts shrink geometrically, at the start of the interval and at what is not finite down to the resolution of
// time, elsewhere to 2^-12 of the interval; there its signs decide. Between two signs the bracket is closed: a function
// that grows as it closes has a pole there, which is no root, and its side is another one from there on.
//
// Invariant: a single instant at which the function is not finite does not matter; a stretch of them ends the search
// where it begins.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/series/fit.hpp"
#include "rbdyn/series/polynomial.hpp"
#include "rbdyn/series/roots.hpp"

namespace rbdyn::inline RBDYN_FORM {

class RoughPassages {
public:
    /// `value(x)`: the function on [0, 1]. `side()`: the side it is known to be on, 0 if none is. `fitted(q, lo, hi,
    /// miss)`: on [lo, hi] it is the polynomial q in (x - lo) / (hi - lo), to look for roots of, and misses that by
    /// `miss`. `passed(x, doubt, rising, is_pole)`: it changes its side at x. `finest`: what time does not resolve.
    /// Returns where it ceases to be finite, if it does.
    /// `blurred(x)`: its value where what it is made of is off by rounding.
    template <class Value, class Blurred, class Side, class Fitted, class Passed>
    std::optional<double> find(double finest, const Value& value, const Blurred& blurred, const Side& side,
                               const Fitted& fitted, const Passed& passed) {
        finest_ = std::max(finest, 0x1p-52);
        values_left_ = most_values;
        seen_ = -1.0;
        broken_.reset();
        const auto counted = [&](double x) {
            --values_left_;
            return value(x);
        };
        search(counted, blurred, side, fitted, passed, 0.0, 1.0, 0, {});
        return broken_;
    }

    /// Whether a function has a pole, and not a root or a jump, between a and b, where its signs are `known` and the
    /// other.
    template <class Value>
    static bool is_pole(const Value& value, double a, double b, int known, double finest) {
        return closed(value, a, b, known, finest).is_pole;
    }

private:
    using Fit = series::Fit;
    static constexpr double infinity = std::numeric_limits<double>::infinity();
    // 2^-12 of a step: events of a function with a corner are closer than that to it only by chance
    static constexpr int most_halvings = 12, most_halvings_at_singularity = 52;
    // of one step; a function that is no polynomial anywhere is looked at in a thousand parts
    static constexpr int most_values = 20000;
    // of the largest value: how well a fit holds, what may be a roughness of the function's own, and what is told from
    // zero
    static constexpr double holds = 1e-10, rough = 1e-6, resolved = 1e-12;
    static std::size_t at(int j) { return static_cast<std::size_t>(j); }

    /// How far a fit on a longer interval was from the function.
    struct Miss {
        double by = infinity, size = 1.0;
        int no_better = 0;
    };

    template <class Value, class Blurred, class Side, class Fitted, class Passed>
    void search(const Value& value, const Blurred& blurred, const Side& side, const Fitted& fitted,
                const Passed& passed, double lo, double hi, int depth, Miss before) {
        const auto place = [&](double x) { return lo + x * (hi - lo); };
        std::array<double, Fit::points> values;
        double size = 0.0;
        int finite = 0;
        for (int j = 0; j < Fit::points; ++j) {
            const double v = values[at(j)] = value(place(Fit::place(j)));
            if (!std::isfinite(v)) continue;
            ++finite;
            size = std::max(size, std::abs(v));
        }
        if (finite == 0) {
            // an instant, as far as its numbers can tell, or a stretch that begins between here and where it was finite
            // last
            if (hi - lo > 4.0 * finest_ && !std::isfinite(blurred(0.5 * (lo + hi))))
                broken_ = seen_ < 0.0 ? lo : edge(value, seen_, lo);
            return;
        }
        const bool is_finite = finite == Fit::points;
        Miss now{0.0, 0.0, 0};
        // a fit is known to parts of the largest value, and tells nothing where the function is much smaller
        const auto small =
            std::count_if(values.begin(), values.end(), [&](double v) { return std::abs(v) <= resolved * size; });
        const bool is_resolved = size == 0.0 || small < 2;
        series::Coefficients q{};
        if (is_finite && size > 0.0) {
            Fit::coefficients(values.data(), 1e-15 * size, q.data());
            for (int j = 0; j < Fit::checks; ++j) {
                const double error =
                    std::abs(value(place(Fit::check(j))) - series::value(q.data(), Fit::degree, Fit::check(j)));
                now.by = std::isnan(error) ? infinity : std::max(now.by, error);
            }
            // a function that is a polynomial soon comes nearer by far more than this, by its size or, where it grows
            // like a power, without
            now.size = size;
            const bool is_better = now.by * before.size <= 0.5 * before.by * size || now.by <= 0x1p-6 * before.by;
            now.no_better = before.no_better + (is_better ? 0 : 1);
        }
        const bool is_singular = !is_finite || lo == 0.0;
        const bool is_divisible = depth < (is_singular ? most_halvings_at_singularity : most_halvings) &&
                                  hi - lo > 2.0 * finest_ && values_left_ > 0;
        if (is_finite && (is_resolved || !is_divisible) &&
            (now.by <= holds * size || (now.no_better >= 2 && now.by <= rough * size))) {
            if (size > 0.0) fitted(q, lo, hi, now.by);
            seen_ = hi;
            return;
        }
        if (is_divisible) {
            const double middle = 0.5 * (lo + hi);
            search(value, blurred, side, fitted, passed, lo, middle, depth + 1, now);
            if (!broken_) search(value, blurred, side, fitted, passed, middle, hi, depth + 1, now);
            return;
        }
        // too short for more: signs alone
        for (int j = 0; j < Fit::points; ++j) {
            const double x = place(Fit::place(j)), v = values[at(j)];
            if (!std::isfinite(v)) continue;
            const int sign = v > 0.0 ? 1 : v < 0.0 ? -1 : 0, known = side();
            if (sign != 0 && sign != known) {
                if (known == 0 || seen_ < 0.0)
                    passed(x, 0.0, sign > 0, known == 0 || x > 0.0);
                else {
                    const Change c = closed(value, seen_, x, known, finest_);
                    passed(c.b, c.b - c.a, known < 0, c.is_pole);
                }
            }
            seen_ = x;
        }
    }

    /// Between a, where the function was finite, and b, where it is not: where it ceases to be.
    template <class Value>
    double edge(const Value& value, double a, double b) const {
        for (int k = 0; k < 60 && b - a > finest_; ++k) {
            const double middle = 0.5 * (a + b);
            (std::isfinite(value(middle)) ? a : b) = middle;
        }
        return a;
    }

    /// Where a function changes its sign, between a and b, and whether by a pole.
    struct Change {
        double a, b;
        bool is_pole;
    };
    /// Between a, on side `known` or zero, and b, on the other.
    template <class Value>
    static Change closed(const Value& value, double a, double b, int known, double finest) {
        double low = std::abs(value(a)), high = std::abs(value(b));
        // one of the two may be beside the pole from the first
        const double first = low > 0.0 ? std::min(low, high) : high, width = b - a, begin = a, end = b;
        for (int k = 0; k < 60 && b - a > finest; ++k) {
            const double middle = 0.5 * (a + b), v = value(middle);
            if (!std::isfinite(v)) return {middle, middle, true};
            if (v * known > 0.0) {
                a = middle;
                low = std::abs(v);
            } else {
                b = middle;
                high = std::abs(v);
            }
        }
        if (b - a <= 0x1p-6 * width) return {a, b, std::min(low, high) > 4.0 * first};
        // a bracket that could not be made much smaller is held against its surroundings
        const double away = 64.0 * (b - a);
        const double before = std::abs(value(std::max(a - away, std::min(begin, 0.0)))),
                     after = std::abs(value(std::min(b + away, std::max(end, 1.0))));
        return {a, b, std::min(low, high) > 2.0 * std::max(before, after)};
    }

    double finest_ = 0.0;
    double seen_ = -1.0;  // where the function was finite last; negative: nowhere so far
    int values_left_ = 0;
    std::optional<double> broken_;
};

}  // namespace rbdyn::inline RBDYN_FORM
