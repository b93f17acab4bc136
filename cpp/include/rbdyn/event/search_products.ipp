// Definitions of rbdyn/event/search.hpp: watched functions that are products, by their factors.
#pragma once

#include <cstddef>
#include <functional>
#include <numeric>
#include <span>
#include <vector>

#include "rbdyn/event/search.hpp"
#include "rbdyn/model/equations.hpp"

namespace rbdyn::inline RBDYN_FORM {

/// The side of a product by those of its factors, 0 of one that is zero.
inline int side_of_product(std::span<const int> sides) {
    return std::accumulate(sides.begin(), sides.end(), 1, std::multiplies<>());
}

RBDYN_INLINE EventSearch::Factors EventSearch::factors_of(const std::vector<Guard>& guards, std::size_t g) {
    Factors result{g, 1};
    if (guards[g].watch < 0) return result;
    while (result.first > 0 && guards[result.first - 1].watch == guards[g].watch) --result.first;
    while (g + 1 < guards.size() && guards[g + 1].watch == guards[g].watch) ++g;
    result.count = g + 1 - result.first;
    return result;
}

RBDYN_INLINE int& EventSearch::product_of(const std::vector<Guard>& guards, const Factors& factors) {
    return watched(guards[factors.first]).product;
}

RBDYN_INLINE int EventSearch::passes(const std::vector<Guard>& guards, const Factors& factors,
                                     std::span<const int> sides) {
    const int side = side_of_product(sides);
    int& known = product_of(guards, factors);
    const int before = known;
    if (side != 0) known = side;
    return side == 0 || before == 0 || side == before ? 0 : side;
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
    std::vector<int> sides;
    for (std::size_t g = factors.first; g < factors.first + factors.count; ++g)
        sides.push_back(stays_[g] ? 0 : watched(guards[g]).side);
    int& known = product_of(guards, factors);
    const auto is_of = [&](const Found& f) {
        return f.guard >= factors.first && f.guard < factors.first + factors.count && !f.breaks;
    };
    // a factor goes over to its side
    const auto turn = [&](Found& f) {
        int& own = sides[f.guard - factors.first];
        own = f.rising ? 1 : -1;
        f.product = side_of_product(sides);
        f.product_rises = f.product > 0;
        // one that has reached zero, and stays there
        if (stays_[f.guard]) own = 0;
    };
    // what begins with the piece is one: factors that go over to their sides, and those that leave zero where they came
    // from, another one having passed meanwhile
    const int begins = side_of_product(sides);
    Found* first = nullptr;
    for (Found& f : found_) {
        if (!is_of(f) || f.place > 0.0) continue;
        turn(f);
        f.is_silent = true;
        first = &f;
    }
    const int now = first != nullptr ? first->product : begins;
    if (known == 0) known = now;
    int side = known;
    const bool goes_over = now != 0 && now != side;
    if (first != nullptr) first->is_silent = !goes_over;
    if (goes_over) side = now;
    Found* last = nullptr;
    int before_last = side;
    for (Found& f : found_) {
        if (!is_of(f) || !(f.place > 0.0)) continue;
        turn(f);
        int before = side;
        // at the place of the last one, as far as either is known
        if (last != nullptr && last->guard != f.guard && f.place - last->place <= last->doubt + f.doubt) {
            last->is_silent = true;
            last->product = f.product;
            before = before_last;
            last = nullptr;
        } else {
            last = &f;
        }
        f.is_silent = f.product == 0 || f.product == before;
        before_last = side;
        if (f.product != 0) side = f.product;
    }
    if (!goes_over || first != nullptr) return;
    found_.insert(found_.begin(), Found{0.0, 0.0, 0.0, factors.first, watched(guards[factors.first]).side > 0});
    found_.front().product = now;
    found_.front().product_rises = now > 0;
}

}  // namespace rbdyn::inline RBDYN_FORM
