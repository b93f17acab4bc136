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
    const auto hide = [&](double lo, double hi) {
        const double middle = 0.5 * (lo + hi);
        double away = std::max(0.5 * (hi - lo), 4.0 * epsilon * middle);
        const auto rounds = [&](double x) { return sign(x) == 0; };
        while (away < middle && (rounds(middle - away) || rounds(middle + away))) away *= 2.0;
        if (!(away < middle) || middle - away >= 1.0) return;
        hidden_.push_back({middle - away, std::min(middle + away, 1.0)});
    };
    if (finder_.multiple().empty() && roots_.size() < 2) return hidden_;
    if (!has_noise_) return hidden_;
    for (const auto& flat : finder_.multiple()) hide(flat.lo, flat.hi);
    for (std::size_t i = 1; i < roots_.size(); ++i)
        if (lobe(roots_[i - 1], roots_[i]) == 0) hide(roots_[i - 1], roots_[i]);
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

RBDYN_INLINE int Passages::side(double x) const {
    const auto before = std::count_if(places_.begin(), places_.end(), [&](const Place& p) { return p.x <= x; });
    return before % 2 == 0 ? leaves_ : -leaves_;
}

RBDYN_INLINE std::size_t Passages::count(const Stretch& s) const {
    return static_cast<std::size_t>(
        std::count_if(places_.begin(), places_.end(), [&](const Place& p) { return p.x >= s.lo && p.x <= s.hi; }));
}

RBDYN_INLINE void Passages::replace(const Stretch& s, const std::vector<Place>& closer) {
    std::erase_if(places_, [&](const Place& p) { return p.x >= s.lo && p.x <= s.hi; });
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
    return std::abs(g) <= times * noise(x, at_start) ? 0 : g > 0.0 ? 1 : -1;
}

RBDYN_INLINE int Passages::lobe(double a, double b) const {
    for (const double part : {0.5, 0.75, 0.25, 0.9375, 0.0625})
        if (const int side = sign(a + part * (b - a), a == 0.0); side != 0) return side;
    if (a == 0.0 && sign(0.0, true) != 0) return sign(0.0, true);
    return b == 1.0 ? sign(1.0, a == 0.0) : 0;
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
