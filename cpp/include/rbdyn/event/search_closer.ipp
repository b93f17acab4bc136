// Definitions of rbdyn/event/search.hpp: where rounding of a guard's polynomial hides what the guard does.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <memory>
#include <vector>

#include "rbdyn/engine/engine.hpp"
#include "rbdyn/event/closer_look.hpp"
#include "rbdyn/event/passages.hpp"
#include "rbdyn/event/search.hpp"
#include "rbdyn/model/equations.hpp"
#include "rbdyn/model/hybrid.hpp"
#include "rbdyn/series/fit.hpp"
#include "rbdyn/series/piece.hpp"
#include "rbdyn/series/polynomial.hpp"
#include "rbdyn/series/roots.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE void EventSearch::look_closer(const Mode& mode, const Guard& guard, double sign, double lo, double hi,
                                           const Passages::Arrival& arrival, bool fits) {
    if (passages_.leaves() == 0) return;
    // what touches zero at the end of the run and passes it a little later has not passed it
    if (arrival.late && passages_.passes_at_end() &&
        side_beyond({mode, guard, sign, lo, hi - lo}, arrival) == -passages_.side(1.0))
        passages_.drop_last();
    const std::vector<Passages::Stretch> hidden = passages_.hidden();
    for (const Passages::Stretch& s : hidden) {
        const Stretch stretch{mode, guard, sign, lo + s.lo * (hi - lo), (s.hi - s.lo) * (hi - lo)};
        const auto rounding = [&](double x) { return value_rounding(mode, guard, stretch.place(x)); };
        if (!(rounding(0.5) < 0.25 * passages_.rounding(0.5 * (s.lo + s.hi)))) continue;
        const auto find = [&](double a, double b, int side, Passages& passages) {
            return fits ? find_by_values(stretch, a, b, side, passages) : find_by_series(stretch, a, b, side, passages);
        };
        const auto value = [&](double x) { return value_on(stretch, x); };
        auto found = closer_(passages_.side(s.lo), fits ? 0 : CloserLook::deepest, finest() / stretch.width, find,
                             rounding, value);
        if (found && s.hi >= 1.0 && arrival.late && side_beyond(stretch, arrival) == -found->side)
            found->places.push_back({1.0, 0.0, 0.0});
        // beyond the stretch it is on the side it was known to be on, unless the piece ends first; a root of higher
        // multiplicity that is still one is known better by the terms of the piece
        if (!found || (s.hi < 1.0 && found->side != passages_.side(s.hi))) continue;
        const std::size_t known = passages_.count(s), seen = found->places.size();
        const bool may_be_more = std::ranges::any_of(found->hidden, [&](const Passages::Stretch& h) {
            return passages_.count({s.lo + h.lo * (s.hi - s.lo), s.lo + h.hi * (s.hi - s.lo)}) > 0;
        });
        if (seen > known || (!may_be_more && !(found->is_between && seen == known)))
            passages_.replace(s, found->places);
    }
}

RBDYN_INLINE double EventSearch::value_on(const Stretch& s, double x) {
    return s.sign * value_at(s.mode, s.guard, s.place(x) * engine_.piece().length, true);
}

RBDYN_INLINE CloserLook::Told EventSearch::find_by_series(const Stretch& s, double lo, double hi, int side,
                                                          Passages& passages) {
    if (!series_ || &series_->program() != &s.mode.equations->program)
        series_ = std::make_unique<SeriesOnPiece>(s.mode.equations->program, degree_);
    const double length = engine_.piece().length, width = hi - lo;
    series_->expand(engine_.piece(), s.place(lo) * length, width * s.width * length, s.mode.parameters);
    series::Coefficients q{};
    double check = 0.0;
    for (int k = 0; k <= degree_; ++k) {
        q[at(k)] = s.sign * series_->coefficients(s.guard.output)[k];
        check += 0.0 * q[at(k)];
    }
    if (check != 0.0) return CloserLook::Told::nothing;
    if (!series_->tells(s.guard.output)) return CloserLook::Told::not_so_far;
    // values tell what its terms have lost
    constexpr double much = 0.25, many = 16.0;
    for (const double x : {0.25, 0.5, 0.75, 1.0}) {
        const double value = value_on(s, lo + x * width);
        const double off = std::abs(series::value(q.data(), degree_, x) - value);
        if (off > much * std::abs(value) && off > many * value_rounding(s.mode, s.guard, s.place(lo + x * width)))
            return CloserLook::Told::not_so_far;
    }
    passages.find(
        q.data(), degree_, {.side = side}, [&](double* sizes) { series_->sizes(s.guard.output, sizes); },
        [&] { return value_on(s, hi); });
    return CloserLook::Told::all;
}

RBDYN_INLINE CloserLook::Told EventSearch::find_by_values(const Stretch& s, double lo, double hi, int side,
                                                          Passages& passages) {
    using series::Fit;
    const auto value = [&](double x) { return value_on(s, lo + x * (hi - lo)); };
    std::array<double, Fit::points> values;
    double size = 0.0, rounding = 0.0;
    for (int j = 0; j < Fit::points; ++j) {
        const double v = values[at(j)] = value(Fit::place(j));
        size = std::max(size, std::abs(v));
    }
    for (const double x : {lo, 0.5 * (lo + hi), hi})
        rounding = std::max(rounding, value_rounding(s.mode, s.guard, s.place(x)));
    series::Coefficients q{};
    Fit::coefficients(values.data(), std::max(1e-15 * size, 0.25 * rounding), q.data());
    double miss = 0.0;
    for (int j = 0; j < Fit::checks; ++j) {
        const double x = Fit::check(j);
        miss = std::max(miss, std::abs(value(x) - series::value(q.data(), Fit::degree, x)));
    }
    // what values miss a polynomial by is rounding that is not known otherwise, of what is called back
    if (!(miss <= std::max(1e-6 * size, rounding))) return CloserLook::Told::nothing;
    passages.find(
        q.data(), Fit::degree, {.side = side, .is_series = false},
        [&](double* sizes) { fit_sizes(q, miss, rounding, rounding, sizes); }, [&] { return values.back(); });
    return CloserLook::Told::all;
}

RBDYN_INLINE int EventSearch::side_beyond(const Stretch& s, const Passages::Arrival& arrival) {
    constexpr double many = 16.0, finest = 0x1p-40;
    const double length = engine_.piece().length;
    const auto value = [&](double x) { return s.sign * value_at(s.mode, s.guard, x * length, true); };
    const auto rounding = [&](double x) { return many * value_rounding(s.mode, s.guard, x); };
    const double late = *arrival.late, end = value(1.0), ahead = std::abs(value(1.0 + late) - end);
    if (end != 0.0 && !(std::abs(end) <= rounding(1.0) + ahead)) return 0;
    for (double more = late; more <= arrival.reach; more = std::max(2.0 * more, finest))
        if (const double after = value(1.0 + more); std::abs(after) > rounding(1.0 + more)) return after > 0.0 ? 1 : -1;
    return 0;
}

RBDYN_INLINE void EventSearch::sharpen(const Mode& mode, const Guard& guard, double sign, std::size_t first) {
    if (mode.equations->is_variable(guard)) return;
    // what a place is off by where the terms are not much larger than what they make up
    constexpr double sharp = 1024.0 * epsilon, aside = 0x1p-20;
    const auto value = [&](double x) { return sign * value_at(mode, guard, x * engine_.piece().length, true); };
    for (std::size_t i = first; i < found_.size(); ++i) {
        Found& f = found_[i];
        if (!(f.doubt > sharp * f.place)) continue;
        const double rounding = value_rounding(mode, guard, f.place);
        if (!(rounding < 0.25 * passages_.rounding(f.place))) continue;
        enclose(f, 0.0, 1.0, value);
        const double lo = std::max(f.place * (1.0 - aside), 0.0), hi = std::min(f.place * (1.0 + aside), 1.0);
        const double slope = (std::abs(value(hi) - value(lo)) - 2.0 * rounding) / (hi - lo);
        if (!(slope > 0.0)) continue;
        f.doubt = std::min(f.doubt, 4.0 * epsilon * f.place + rounding / slope);
        f.near = std::min(f.near, 16.0 * f.doubt);
    }
}

}  // namespace rbdyn::inline RBDYN_FORM
