// Definitions of rbdyn/event/passages.hpp.
#pragma once

#include "rbdyn/event/passages.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "rbdyn/series/polynomial.hpp"
#include "rbdyn/series/roots.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE const std::vector<Passages::Stretch>& Passages::hidden() {
    hidden_.clear();
    // terms of terms may be larger than those that sizes tell of
    constexpr double loose = 256.0;
    const auto rounds = [&](double x) { return sign(x, false, loose) == 0; };
    const auto hide = [&](double lo, double hi) {
        const double middle = 0.5 * (lo + hi);
        double below = std::max(0.5 * (hi - lo), 4.0 * epsilon * middle), above = below;
        while (below < middle && rounds(middle - below)) below *= 2.0;
        while (middle + above < 1.0 && rounds(middle + above)) above *= 2.0;
        if (middle - below >= 1.0) return;
        // from where it begins, if that is more than rounding
        const bool from_start = !(below < middle);
        if (from_start && (is_at_zero_ || sign(0.0, true) == 0)) return;
        hidden_.push_back({from_start ? 0.0 : middle - below, std::min(middle + above, 1.0)});
    };
    if (!has_noise_) return hidden_;
    for (const auto& flat : finder_.multiple()) hide(flat.lo, flat.hi);
    for (std::size_t i = 1; i < roots_.size(); ++i)
        if (lobe(roots_[i - 1], roots_[i]) == 0) hide(roots_[i - 1], roots_[i]);
    if (rounds(1.0)) hide(1.0 - 8.0 * epsilon, 1.0);
    if (degree_ > 2 && cancels()) {
        series::Coefficients slope;
        for (int k = 0; k < degree_; ++k) slope[at(k)] = (k + 1) * q_[at(k + 1)];
        series::RootFinder finder;
        finder.find(slope.data(), degree_ - 1, turns_);
        for (const double x : turns_)
            if (rounds(x)) hide(x, x);
    }
    std::sort(hidden_.begin(), hidden_.end(), [](const Stretch& a, const Stretch& b) { return a.lo < b.lo; });
    // those that overlap are one
    std::size_t kept = 0;
    for (const Stretch& s : hidden_) {
        if (kept > 0 && s.lo <= hidden_[kept - 1].hi)
            hidden_[kept - 1].hi = std::max(hidden_[kept - 1].hi, s.hi);
        else
            hidden_[kept++] = s;
    }
    hidden_.resize(kept);
    return hidden_;
}

RBDYN_INLINE bool Passages::cancels() {
    turns_.clear();
    // powers of less than six show it by the roots of their polynomials
    constexpr double many = 32.0, few = 0x1p-20;
    constexpr int least = 6, most_octaves = 256;
    const auto size = [&](double x) { return series::value_of_sizes(q_.data(), degree_, x); };
    double high = 0.0;
    for (int k = least; k <= degree_; ++k) high += std::abs(q_[at(k)]);
    if (!(high > 0x1p-6 * std::abs(q_[1]))) return false;
    // wherever the terms are more than what it begins with, however long the piece is
    int first = 0;
    while (first < degree_ && q_[at(first)] == 0.0) ++first;
    const auto begins = [&](double x) { return std::abs(q_[at(first)]) * std::pow(x, first); };
    double octave = 1.0;
    for (int k = 0; k < most_octaves && size(octave) > many * begins(octave); ++k, octave *= 0.5)
        for (const double part : {1.0, 0.875, 0.75, 0.625})
            if (const double x = part * octave; std::abs(value(x)) <= few * size(x)) turns_.push_back(x);
    return !turns_.empty();
}

RBDYN_INLINE int Passages::side(double x) const {
    const auto before = std::count_if(places_.begin(), places_.end(), [&](const Place& p) { return p.x <= x; });
    return before % 2 == 0 ? leaves_ : -leaves_;
}

RBDYN_INLINE bool Passages::is_on(const Stretch& s, const Place& p) {
    // one at the end may lie beyond it, by its doubt
    return p.x >= s.lo && (p.x <= s.hi || s.hi >= 1.0);
}

RBDYN_INLINE std::size_t Passages::count(const Stretch& s) const {
    return static_cast<std::size_t>(
        std::count_if(places_.begin(), places_.end(), [&](const Place& p) { return is_on(s, p); }));
}

RBDYN_INLINE void Passages::replace(const Stretch& s, const std::vector<Place>& closer) {
    std::erase_if(places_, [&](const Place& p) { return is_on(s, p); });
    const double width = s.hi - s.lo;
    for (const Place& p : closer) places_.push_back({s.lo + p.x * width, p.doubt * width, p.near * width});
    std::sort(places_.begin(), places_.end(), [](const Place& a, const Place& b) { return a.x < b.x; });
}

RBDYN_INLINE double Passages::noise(double x, bool at_start) const {
    const double rest = degree_ > 0 ? series::value(noise_.data() + 1, degree_ - 1, x) * x : 0.0;
    return rest + (at_start ? at_start_ : noise_[0]);
}

RBDYN_INLINE int Passages::sign(double x, bool at_start, double times) const {
    const double g = value(x);
    if (at_start && g * off_ < 0.0 && std::abs(g) <= std::abs(off_)) return 0;
    return std::abs(g) <= times * noise(x, at_start) ? 0 : g > 0.0 ? 1 : -1;
}

RBDYN_INLINE int Passages::lobe(double a, double b, double times) const {
    // what begins at zero and stays valid may sink first: how far, those say who know all that it is made of
    if (times > 1.0 && a == 0.0 && is_at_zero_) return 0;
    for (const double part : {0.5, 0.75, 0.25, 0.9375, 0.0625})
        if (const int side = sign(a + part * (b - a), a == 0.0, times); side != 0) return side;
    if (a == 0.0 && sign(0.0, true, times) != 0) return sign(0.0, true, times);
    return b == 1.0 ? sign(1.0, a == 0.0, times) : 0;
}

RBDYN_INLINE void Passages::add(double x) {
    double doubt = 4.0 * epsilon * x;
    while (doubt < x && (sign(x - doubt) == 0 || sign(x + doubt) == 0)) doubt *= 2.0;
    // as far for a simple root, much less for one of a power
    double about = doubt;
    while (about < apart * doubt &&
           (about >= x || sign(x - about, false, apart) == 0 || sign(x + about, false, apart) == 0))
        about *= 2.0;
    places_.push_back({x, std::min(doubt, x), about});
}

}  // namespace rbdyn::inline RBDYN_FORM
