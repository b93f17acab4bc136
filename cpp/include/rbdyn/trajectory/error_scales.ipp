// Definitions of rbdyn/trajectory/error_scales.hpp.
#pragma once

#include "rbdyn/trajectory/error_scales.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>
#include <span>

#include "rbdyn/basics/vector.hpp"
#include "rbdyn/model/equations.hpp"
#include "rbdyn/model/hybrid.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE void ErrorScales::widen(std::span<const Observed> seen) {
    scales_.resize(seen.size());
    for (std::size_t k = 0; k < seen.size(); ++k) {
        Scale& s = scales_[k];
        const Observed& o = seen[k];
        s.low = lesser(s.low, o.value);
        s.high = greater(s.high, o.value);
        s.size = std::max({s.size, o.value.norm(), o.size});
        s.whole = std::max(s.whole, o.whole);
        s.drive = std::max(s.drive, o.drive);
        s.is_position = o.is_position;
        s.alike = o.alike;
    }
}

RBDYN_INLINE void ErrorScales::settle(double wanted, double span) {
    constexpr double nothing = 1e3 * std::numeric_limits<double>::epsilon();
    std::array<double, kinds> largest{}, farthest{};
    std::array<int, kinds> count{};
    for (Scale& s : scales_) {
        s.scale = s.is_position ? (s.high - s.low).norm() : s.size;
        // a body that moves by rounding alone does not move; a reaction that is rounding of the forces is none
        s.is_any = s.scale > nothing * s.whole;
        // nor has it a velocity, where that is no more than what rounding of its forces makes in that time
        if (s.drive > 0.0 && &s != scales_.data() && !(&s)[-1].is_any && s.scale <= nothing * s.drive * span)
            s.is_any = false;
        if (s.alike == Alike::nothing) continue;
        const auto kind = static_cast<std::size_t>(s.alike);
        ++count[kind];
        largest[kind] = std::max(largest[kind], s.scale);
        farthest[kind] = std::max(farthest[kind], s.whole);
    }
    // digits that positions have lost are lost to all else
    constexpr auto place = static_cast<std::size_t>(Alike::place);
    const double share = least_share(wanted, largest[place] > 0.0 ? farthest[place] / largest[place] : 1.0);
    for (Scale& s : scales_) {
        const auto kind = static_cast<std::size_t>(s.alike);
        if (s.alike != Alike::nothing && count[kind] > 1) s.scale = std::max(s.scale, share * largest[kind]);
    }
}

RBDYN_INLINE double ErrorScales::relative(std::size_t what, double difference) const {
    const Scale& s = scales_[what];
    return s.is_any ? difference / s.scale : 0.0;
}

RBDYN_INLINE double ErrorScales::rounding() const {
    double worst = 0.0;
    for (const Scale& s : scales_)
        if (s.is_any) worst = std::max(worst, std::numeric_limits<double>::epsilon() * s.whole / s.scale);
    return worst;
}

}  // namespace rbdyn::inline RBDYN_FORM
