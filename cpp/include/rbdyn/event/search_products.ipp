// Definitions of rbdyn/event/search.hpp: watched functions that are products, by their factors.
#pragma once

#include <cstddef>
#include <vector>

#include "rbdyn/event/search.hpp"
#include "rbdyn/model/equations.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE EventSearch::Factors EventSearch::factors_of(const std::vector<Guard>& guards, std::size_t g) {
    Factors result{g, 1};
    if (guards[g].watch < 0) return result;
    while (result.first > 0 && guards[result.first - 1].watch == guards[g].watch) --result.first;
    while (g + 1 < guards.size() && guards[g + 1].watch == guards[g].watch) ++g;
    result.count = g + 1 - result.first;
    return result;
}

RBDYN_INLINE int EventSearch::product_side(const std::vector<Guard>& guards, const Factors& factors) {
    int side = 1;
    for (std::size_t g = factors.first; g < factors.first + factors.count; ++g) side *= watched(guards[g]).side;
    return side;
}

RBDYN_INLINE void EventSearch::multiply_sides(const std::vector<Guard>& guards) {
    for (Found& f : found_) f.product_rises = f.rising;
    for (std::size_t g = 0; g + 1 < guards.size(); ++g) {
        const Factors factors = factors_of(guards, g);
        if (factors.count > 1) multiply_sides(guards, factors);
        g = factors.first + factors.count - 1;
    }
}

RBDYN_INLINE void EventSearch::multiply_sides(const std::vector<Guard>& guards, const Factors& factors) {
    const auto is_of = [&](const Found& f) {
        return f.guard >= factors.first && f.guard < factors.first + factors.count && !f.breaks;
    };
    std::vector<int> sides;
    for (std::size_t g = factors.first; g < factors.first + factors.count; ++g)
        sides.push_back(watched(guards[g]).side);
    const auto product = [&] {
        int side = 1;
        for (const int s : sides) side *= s;
        return side;
    };
    Found* last = nullptr;
    for (Found& f : found_) {
        if (!is_of(f)) continue;
        sides[f.guard - factors.first] = f.rising ? 1 : -1;
        const int side = product();
        f.product_rises = side > 0;
        f.is_silent = side == 0;
        // at the place of the last one, as far as either is known
        if (last != nullptr && last->guard != f.guard && f.place - last->place <= last->doubt + f.doubt) {
            last->is_silent = f.is_silent = true;
            last = nullptr;
        } else {
            last = &f;
        }
    }
}

}  // namespace rbdyn::inline RBDYN_FORM
