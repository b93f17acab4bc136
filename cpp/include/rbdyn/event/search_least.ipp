// Definitions of rbdyn/event/search.hpp: guards that sink to zero and rise again.
//
// They touch zero like a square, so no root of theirs is passed, and rounding decides whether one is found. Their own
// root has a sign, and a series where they have one: it passes zero where they touch it, and all its zeros are found,
// of two that a step passes both. Where a series does not tell, they are least at the zero of their slope. Either
// counts if they are all but zero there.
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

template <class F>
double EventSearch::sharpened(const F& exact, double place, double apart) const {
    const double length = engine_.piece().length, h = 3e-4 * length, few = 0.1 * h;
    if (apart < 8.0 * h) return place;
    const auto vertex = [&](double x, double aside) {
        const double low = exact(x - aside), middle = exact(x), high = exact(x + aside);
        return x + 0.5 * aside * (low - high) / (low - 2.0 * middle + high);
    };
    const double about = vertex(place, h);
    if (!(std::abs(about - place) < few)) return place;
    // what is no parabola is of fourth order then
    const double x = (4.0 * vertex(about, 0.5 * h) - vertex(about, h)) / 3.0;
    const double off = std::abs(x - place);
    // a root that is as near as values tell may be nearer than they do
    return off > 1e-10 * length && off < few && exact(x) <= 1.0 ? x : place;
}

RBDYN_INLINE void EventSearch::seek_least(const Record& record, const Mode& mode, std::size_t g) {
    const Guard& guard = mode.equations->guards[g];
    const double length = engine_.piece().length;
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
        if (seek_roots(record, mode, g, c)) return;
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
        if (const auto least = least_near(exact, c, place(k)))
            add_least(record, mode, g, sharpened(exact, *least, length), 0.0);
    }
}

RBDYN_INLINE bool EventSearch::seek_roots(const Record& record, const Mode& mode, std::size_t g, const double* c) {
    const Guard& guard = mode.equations->guards[g];
    const double length = engine_.piece().length;
    // on a little more than the piece, for one may end there
    constexpr double reach = 1.0 + near_least;
    series::Coefficients root;
    double power = 1.0, last = 0.0;
    for (int k = 0; k <= degree_; ++k, power *= reach * length) {
        double sum = k == 0 ? c[0] - guard.least : c[k] * power;
        for (int j = 1; j < k; ++j) sum -= root[static_cast<std::size_t>(j)] * root[static_cast<std::size_t>(k - j)];
        if (k == 0 && !(sum > 0.0)) return false;
        root[static_cast<std::size_t>(k)] = k == 0 ? std::sqrt(sum) : 0.5 * sum / root[0];
        if (k >= degree_ - 1) last += std::abs(root[static_cast<std::size_t>(k)]);
    }
    if (!(last <= 1e-3 * root[0])) return false;
    roots_.clear();
    // or it began there
    if (const double since = root[0] / root[1]; root[1] > 0.0 && since <= near_least) roots_.push_back(-since);
    root_finder_.find(root.data(), degree_, roots_);
    const auto exact = [&](double x) { return value_at(mode, guard, x, true) - guard.least; };
    for (std::size_t i = 0; i < roots_.size(); ++i) {
        const double x = roots_[i], place = roots_[i] *= reach * length;
        // what the series leaves out and its rounding, over its slope
        double slope = 0.0;
        for (int k = degree_; k >= 1; --k) slope = slope * x + k * root[static_cast<std::size_t>(k)];
        const double rounding = 64.0 * epsilon * series::value_of_sizes(root.data(), degree_, std::abs(x)),
                     doubt = std::min((last + rounding) / std::abs(slope), near_least);
        double apart = length;
        if (i > 0) apart = place - roots_[i - 1];
        if (i + 1 < roots_.size()) apart = std::min(apart, roots_[i + 1] * reach * length - place);
        if (series::value(c, degree_, place) - guard.least <= 1.0 || exact(place) <= 1.0) {
            add_least(record, mode, g, sharpened(exact, place, apart), doubt);
            continue;
        }
        // a series that is cut off early is off there
        const auto least = least_near(exact, c, place);
        if (least && std::abs(*least - place) < 0.25 * apart)
            add_least(record, mode, g, sharpened(exact, *least, apart), doubt);
    }
    return true;
}

RBDYN_INLINE void EventSearch::add_least(const Record& record, const Mode& mode, std::size_t g, double place,
                                         double doubt) {
    const auto& guards = mode.equations->guards;
    const Guard& guard = guards[g];
    const Piece& piece = engine_.piece();
    const double length = piece.length, near = near_least * length;
    if (place < -near || place > length + near) return;
    const auto is_same = [&](const auto& other) { return other.kind == guard.kind && other.name == guard.name; };
    // at the end of one piece it is at the start of the next one, too
    const Instant at = piece.at(place);
    if (std::any_of(record.events.begin(), record.events.end(),
                    [&](const Event& e) { return is_same(e) && std::abs(e.instant - at) <= 2.0 * near * piece.unit; }))
        return;
    // what cannot be told apart is one passage, of each name once
    constexpr double few = 64.0 * epsilon;
    double shared = place / length;
    for (const Found& f : found_) {
        if (guards[f.guard].kind != guard.kind || !(std::abs(f.place - shared) <= f.doubt + doubt + few)) continue;
        if (is_same(guards[f.guard])) return;
        shared = f.place;
    }
    found_.push_back({shared, doubt, 0.0, g, false});
}

}  // namespace rbdyn::inline RBDYN_FORM
