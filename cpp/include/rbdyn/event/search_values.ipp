// Definitions of rbdyn/event/search.hpp: guards that have no series, by their values.
#pragma once

#include "rbdyn/event/search.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

#include "rbdyn/basics/direction.hpp"
#include "rbdyn/engine/engine.hpp"
#include "rbdyn/event/passages.hpp"
#include "rbdyn/event/rough_passages.hpp"
#include "rbdyn/expression/evaluate.hpp"
#include "rbdyn/model/equations.hpp"
#include "rbdyn/model/hybrid.hpp"
#include "rbdyn/series/fit.hpp"
#include "rbdyn/series/piece.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE void EventSearch::fit_sizes(const series::Coefficients& q, double miss, double begin, double end,
                                         double* sizes) {
    for (int k = 0; k <= series::Fit::degree; ++k) sizes[k] = std::abs(q[static_cast<std::size_t>(k)]);
    sizes[0] = std::max(sizes[0], begin / (4.0 * epsilon));
    // an error that is zero at 0 has a slope there; and it is seen at few places
    sizes[1] = std::max(sizes[1], std::max(64.0 * miss, end) / (4.0 * epsilon));
}

RBDYN_INLINE double EventSearch::finest() const {
    const Piece& piece = engine_.piece();
    return 4.0 * epsilon * std::abs(piece.at(piece.length).hi) / piece.duration();
}

RBDYN_INLINE void EventSearch::seek_by_values(const Mode& mode, const Guard& guard, std::size_t g, double sign,
                                              bool fresh, bool is_last) {
    using series::Fit;
    const Piece& piece = engine_.piece();
    // its values tell whether what was reached where the mode began is passed
    if (fresh && guard.watch >= 0) watched(guard).reached = 0;
    if (guard.watch >= 0) watched(guard).within = 0.0;
    const auto value = [&](double x) { return sign * value_at(mode, guard, x * piece.length, true); };
    // the side so far, with what was already found on this piece
    const auto side = [&] {
        for (std::size_t i = found_.size(); i-- > 0;)
            if (found_[i].guard == g) return found_[i].rising ? 1 : -1;
        return side_of(guard);
    };
    const auto fitted = [&](const series::Coefficients& q, double lo, double hi, double miss) {
        Passages::Arrival arrival{.side = side(), .reach = 0x1p-2, .is_series = false};
        if (lo == 0.0) know_zero(guard, g, fresh, q[0] > 0.0 ? 1 : q[0] < 0.0 ? -1 : 0, arrival);
        if (is_last && hi == 1.0)
            arrival.late = (slack_ + epsilon * std::abs(piece.at(piece.length).hi)) / ((hi - lo) * piece.duration());
        double rounding = 0.0;
        passages_.find(
            q.data(), Fit::degree, arrival,
            [&](double* sizes) {
                const double begin = value_rounding(mode, guard, lo), end = value_rounding(mode, guard, hi);
                rounding = std::max(begin, end);
                fit_sizes(q, miss, begin, end, sizes);
            },
            [&] { return value(hi); });
        if (guard.is_watched() || is_distinction(guard)) look_closer(mode, guard, sign, lo, hi, arrival, true);
        const std::size_t before = found_.size();
        take(guard, g, fresh && lo == 0.0, lo, hi, arrival.side);
        for (std::size_t i = before; i < found_.size(); ++i) improve(found_[i], q, lo, hi, value, rounding);
    };
    const auto passed = [&](double x, double doubt, bool rising, bool is_pole) {
        stays_[g] = false;
        if (side() == 0 && side_of(guard) == 0 && is_pole) {
            side_of(guard) = rising ? 1 : -1;
            return;
        }
        // a mode ends where its sign does, by a pole too
        found_.push_back({x, doubt, 16.0 * doubt, g, rising, is_pole && guard.is_watched()});
    };
    const auto blurred = [&](double x) { return blurred_value(mode, guard, x * piece.length); };
    if (const auto end = rough_.find(finest(), value, blurred, side, fitted, passed)) {
        Found f{*end, 0.0, 0.0, g, false};
        f.breaks = true;
        found_.push_back(f);
    }
}

RBDYN_INLINE double EventSearch::blurred_value(const Mode& mode, const Guard& guard, double place) {
    constexpr double aside = 8.0 * epsilon;
    const Piece& piece = engine_.piece();
    double result = std::numeric_limits<double>::quiet_NaN();
    for (const double sign : {1.0, -1.0}) {
        if (std::isfinite(result)) break;
        state_.resize(static_cast<std::size_t>(piece.variables));
        piece.state(place, state_);
        for (double& v : state_) v += sign * aside * std::abs(v);
        const double t = piece.at(place).hi;
        if (guard.output < 0) {
            result = model_.guard_value(guard, mode, t, state_);
        } else {
            Evaluator<double> values(mode.equations->program);
            values.set_parameters(mode.parameters);
            values(t, state_);
            result = values.output(guard.output);
        }
    }
    return result;
}

RBDYN_INLINE bool EventSearch::passed_pole(const Mode& mode, const Guard& guard, double begins) {
    const double length = engine_.piece().length;
    const auto value = [&](double x) { return value_at(mode, guard, x * length, true); };
    for (double back = std::max(finest(), 0x1p-50); back <= 4.0; back *= 4.0)
        if (const double before = value(-back); before * begins < 0.0)
            return RoughPassages::is_pole(value, -back, 0.0, before > 0.0 ? 1 : -1, finest());
    return false;
}

RBDYN_INLINE double EventSearch::value_at(const Mode& mode, const Guard& guard, double place, bool by_piece) {
    if (guard.output >= 0) return evaluated(mode, place, by_piece).output(guard.output);
    const Piece& piece = engine_.piece();
    state_.resize(static_cast<std::size_t>(piece.variables));
    engine_.state(place, state_);
    return model_.guard_value(guard, mode, piece.at(place).hi, state_);
}

}  // namespace rbdyn::inline RBDYN_FORM
