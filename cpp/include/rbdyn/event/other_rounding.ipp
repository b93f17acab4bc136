// Definitions of rbdyn/event/search.hpp and rbdyn/event/driver.hpp: a run that rounds the other way where events are.
//
// Two runs that are compared take other steps and other neighbours of each constant. Where a motion has hardly any
// steps, as of a ball that flies from wall to wall, they would round alike all the same, and agree on what rounding has
// made of the motion. So one of them takes its events as much later or sooner as the rounding of what is watched leaves
// open, and goes on from the other neighbours of what an event has changed.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>

#include "rbdyn/basics/instant.hpp"
#include "rbdyn/event/driver.hpp"
#include "rbdyn/event/search.hpp"
#include "rbdyn/model/equations.hpp"
#include "rbdyn/series/piece.hpp"
#include "rbdyn/series/roots.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE bool EventSearch::is_up(std::int64_t n) {
    // as if by chance, for rounding is so: what always went one way would add up, by turns it would cancel (the mixing
    // of bits of S. Vigna's splitmix64)
    std::uint64_t bits = (static_cast<std::uint64_t>(n) + 1) * 0x9e3779b97f4a7c15u;
    bits = (bits ^ bits >> 30) * 0xbf58476d1ce4e5b9u;
    bits = (bits ^ bits >> 27) * 0x94d049bb133111ebu;
    return (bits >> 63) != 0;
}

RBDYN_INLINE double EventSearch::otherwise(const Mode& mode, std::size_t g, double place) {
    const Guard& guard = mode.equations->guards[g];
    // what is held and passes its limit by little begins to slip as much sooner or later as forces are rounded
    const auto slope_at = [&] {
        const double* c = engine_.guard(static_cast<int>(g));
        double slope = 0.0;
        for (int k = degree_; k >= 1; --k) slope = slope * place + k * c[k];
        return slope;
    };
    if (rounds_otherwise_ && guard.kind == EventKind::slip && guard.output >= 0 && fired_.size() == 1 &&
        is_passed_barely(mode, guard, place, slope_at())) {
        const double size = value_rounding(mode, guard, place / engine_.piece().length) / (4.0 * epsilon),
                     late = epsilon * size / std::abs(slope_at());
        const double moved = is_up(roundings_++) ? place + late : place - late;
        return moved > 0.0 && moved < engine_.piece().length ? moved : place;
    }
    // what is only noted changes no motion
    const bool is_gap = guard.contact >= 0 && guard.kind == EventKind::land,
               changes = guard.watch >= 0 && guard.role == GuardRole::mode;
    if (!rounds_otherwise_ || guard.output < 0 || !(is_gap || changes)) return place;
    // what comes together stays together
    if (fired_.size() > 1) return place;
    const Piece& piece = engine_.piece();
    const double slope = slope_at();
    // one rounding of its terms: of those that change, where it begins at a zero that is known
    series::Coefficients sizes;
    engine_.guard_sizes(static_cast<int>(g), sizes.data());
    double size = 0.0;
    for (int k = degree_; k >= 1; --k) size = (size + sizes[static_cast<std::size_t>(k)]) * place;
    if (!handled(g)) size += sizes[0];
    const double late = 0.5 * epsilon * size / std::abs(slope);
    // bounces that are so low that they are known no better are followed in ways of their own (search_low.ipp)
    constexpr double most = 0x1p-30;
    if (!(late <= most * place)) return place;
    return std::min(is_up(roundings_++) ? place + late : place - late, piece.length);
}

RBDYN_INLINE void Driver::round_otherwise(std::span<const double> before) {
    constexpr double infinity = std::numeric_limits<double>::infinity();
    for (const VariableGroup& group : now_.mode.equations->groups) {
        if (group.is_position) continue;
        for (int k = group.first; k < group.first + group.count; ++k) {
            const auto i = static_cast<std::size_t>(k);
            double &x = now_.x[i], &low = now_.low[i];
            // what turns back, or stops, is not rounded
            if (x == before[i] || x == -before[i] || x == 0.0) continue;
            const bool is_above = low != 0.0 ? low > 0.0 : EventSearch::is_up(roundings_++);
            const double other = std::nextafter(x, is_above ? infinity : -infinity);
            if (low != 0.0) low -= other - x;
            x = other;
        }
    }
}

}  // namespace rbdyn::inline RBDYN_FORM
