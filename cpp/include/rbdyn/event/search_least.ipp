// Definitions of rbdyn/event/search.hpp: guards that sink to zero and rise again.
//
// They touch zero like a square, so no root of theirs is passed, and rounding decides whether one is found. Where they
// are least is found instead, by the zero of their slope, and counts if they are all but zero there.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>

#include "rbdyn/event/event.hpp"
#include "rbdyn/event/record.hpp"
#include "rbdyn/event/search.hpp"
#include "rbdyn/series/polynomial.hpp"

namespace rbdyn::inline RBDYN_FORM {

template <class F>
std::optional<double> EventSearch::least_near(const F& exact, const double* c, double place) const {
    const double length = engine_.piece().length, few = 0.125 * length;
    double x = place;
    // zero of its slope
    for (int iteration = 0; iteration < 8 && c != nullptr; ++iteration) {
        double slope = 0.0, bend = 0.0;
        for (int k = degree_; k >= 1; --k) {
            if (k >= 2) bend = bend * x + k * (k - 1) * c[k];
            slope = slope * x + k * c[k];
        }
        const double step = -slope / bend;
        if (!(bend > 0.0) || !(std::abs(x + step - place) < few)) break;
        x += step;
        if (std::abs(step) <= 4.0 * epsilon * length) break;
    }
    if (exact(x) <= 1.0) return x;
    // its series does not reach so far: parabolas through values
    for (const double width : {1.0 / 32.0, 1e-3, 3e-5, 3e-5}) {
        const double h = width * length, low = exact(x - h), middle = exact(x), high = exact(x + h);
        const double step = 0.5 * h * (low - high) / (low - 2.0 * middle + high);
        if (!(std::abs(step) < 4.0 * h) || !(std::abs(x + step - place) < few)) return std::nullopt;
        x += step;
    }
    if (exact(x) <= 1.0) return x;
    return std::nullopt;
}

RBDYN_INLINE void EventSearch::seek_least(const Record& record, const Mode& mode, std::size_t g) {
    const Guard& guard = mode.equations->guards[g];
    const Piece& piece = engine_.piece();
    const double length = piece.length, near = 1e-6 * length;
    const auto exact = [&](double x) { return value_at(mode, guard, x, true) - guard.least; };
    const double* c = engine_.is_rough(static_cast<int>(g)) ? nullptr : engine_.guard(static_cast<int>(g));
    // a step that begins so near to it knows nothing of what comes; held against another run it shows
    constexpr double too_near = 100.0;
    if (is_alone_ && !((c != nullptr ? c[0] - guard.least : exact(0.0)) > too_near)) {
        found_.push_back({0.0, 0.0, 0.0, g, false});
        found_.back().breaks = true;
        return;
    }
    if (c != nullptr) {
        // what cannot sink by so much on the piece
        const auto size = [&](int k) { return std::abs(c[k]) * powers_[static_cast<std::size_t>(k)]; };
        double sinks = 0.0;
        for (int k = 1; k <= degree_; ++k) sinks += size(k);
        if (sinks < 0.99 * (c[0] - guard.least)) return;
        // a step that is long for the accuracy asked of it may be too long for the series
        if (!(size(degree_) + size(degree_ - 1) <= 1e-3 * sinks)) c = nullptr;
    }
    const auto value = [&](double x) { return c == nullptr ? exact(x) : series::value(c, degree_, x) - guard.least; };
    constexpr std::size_t few = 8, many = 32;
    const std::size_t samples = c != nullptr ? few : many;
    std::array<double, many + 1> values;
    const auto place = [&](std::size_t k) { return length * static_cast<double>(k) / static_cast<double>(samples); };
    double most = 0.0;
    for (std::size_t k = 0; k <= samples; ++k) most = std::max(most, values[k] = value(place(k)));
    for (std::size_t k = 0; k <= samples; ++k) {
        const bool is_low = (k == 0 || values[k] <= values[k - 1]) && (k == samples || values[k] < values[k + 1]);
        if (!is_low || !(values[k] <= 0.125 * most)) continue;
        const auto least = least_near(exact, c, place(k));
        if (!least || *least < -near || *least > length + near) continue;
        // at the end of one piece it is at the start of the next one, too
        const Instant at = piece.at(*least);
        const bool is_known = std::any_of(record.events.begin(), record.events.end(), [&](const Event& e) {
            return e.kind == guard.kind && e.name == guard.name && std::abs(e.instant - at) <= 2.0 * near * piece.unit;
        });
        if (!is_known) found_.push_back({*least / length, 0.0, 0.0, g, false});
    }
}

}  // namespace rbdyn::inline RBDYN_FORM
