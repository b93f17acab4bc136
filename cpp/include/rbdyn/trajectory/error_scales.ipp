// Definitions of rbdyn/trajectory/error_scales.hpp.
#pragma once

#include "rbdyn/trajectory/error_scales.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>

#include "rbdyn/basics/vector.hpp"
#include "rbdyn/model/equations.hpp"
#include "rbdyn/model/hybrid.hpp"
#include "rbdyn/model/observed.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE std::vector<double> ErrorScales::numbers() const {
    std::vector<double> all;
    for (const Scale& s : scales_)
        all.insert(all.end(), {s.low[0], s.low[1], s.low[2], s.high[0], s.high[1], s.high[2], s.size, s.whole, s.drive,
                               s.held, s.is_position ? 1.0 : 0.0, static_cast<double>(s.alike), s.from, s.gyration});
    return all;
}

RBDYN_INLINE ErrorScales ErrorScales::of(std::span<const double> numbers) {
    ErrorScales result;
    for (std::size_t i = 0; i + numbers_each <= numbers.size(); i += numbers_each) {
        const auto n = numbers.subspan(i, numbers_each);
        Scale& s = result.scales_.emplace_back();
        s.low = {n[0], n[1], n[2]};
        s.high = {n[3], n[4], n[5]};
        s.size = n[6];
        s.whole = n[7];
        s.drive = n[8];
        s.held = static_cast<float>(n[9]);
        s.is_position = n[10] != 0.0;
        const double alike = n[11] >= 0.0 && n[11] < static_cast<double>(kinds) ? n[11] : -1.0;
        s.alike = static_cast<Alike>(static_cast<int>(alike));
        s.from = n[12];
        s.gyration = n[13];
    }
    return result;
}

RBDYN_INLINE void ErrorScales::widen(std::span<const Observed> seen) {
    // where a body flies less is seen of it than on its rail
    if (scales_.size() < seen.size()) scales_.resize(seen.size());
    for (std::size_t k = 0; k < seen.size(); ++k) {
        Scale& s = scales_[k];
        const Observed& o = seen[k];
        s.low = lesser(s.low, o.value);
        s.high = greater(s.high, o.value);
        s.size = std::max({s.size, safe_norm(o.value), o.size});
        s.whole = std::max(s.whole, o.whole);
        s.from = std::max(s.from, o.from);
        s.gyration = o.gyration;
        s.drive = std::max(s.drive, o.drive);
        s.held = std::max(s.held, o.held);
        s.is_position = o.is_position;
        s.alike = o.alike;
    }
}

RBDYN_INLINE void ErrorScales::settle(double wanted, double span) {
    constexpr double nothing = 1e3 * std::numeric_limits<double>::epsilon();
    std::array<double, kinds> largest{}, farthest{};
    double strongest = 0.0;  // of what drives velocities
    std::array<int, kinds> count{};
    double way = 0.0;  // of a body's place
    for (std::size_t k = 0; k < scales_.size(); ++k) {
        Scale& s = scales_[k];
        s.scale = s.is_position ? safe_norm(s.high - s.low) : s.size;
        if (s.is_position) way = s.scale;
        // a body that hardly turns, by the angular velocity that follows its axes: by how far its points go
        if (s.gyration > 0.0) {
            std::size_t next = k;
            while (next < scales_.size() && scales_[next].gyration > 0.0) ++next;
            const double turn = next < scales_.size() ? scales_[next].size * span : s.size;
            s.scale = std::min(s.size, std::max(turn, way / s.gyration));
        }
        // a body that moves by rounding alone does not move; a reaction that is rounding of the forces is none
        s.is_any = s.scale > nothing * std::max(s.whole, s.from);
        // nor has it a velocity, where that is no more than what rounding of its forces makes in that time
        if (s.drive > 0.0 && &s != scales_.data() && !(&s)[-1].is_any && s.scale <= nothing * s.drive * span)
            s.is_any = false;
        if (s.alike == Alike::nothing) continue;
        const auto kind = static_cast<std::size_t>(s.alike);
        ++count[kind];
        largest[kind] = std::max(largest[kind], s.scale);
        farthest[kind] = std::max({farthest[kind], s.whole, s.from});
        strongest = std::max(strongest, s.drive);
    }
    // digits that positions have lost are lost to all else
    constexpr auto place = static_cast<std::size_t>(Alike::place);
    const double share = least_share(wanted, largest[place] > 0.0 ? farthest[place] / largest[place] : 1.0);
    // rounding of places x is rounding of the accelerations a that they drive, and of velocities by what these make of
    // it in the time sqrt(x / a) in which they change places: as the same units in the last place of sqrt(a x)
    constexpr auto velocity = static_cast<std::size_t>(Alike::velocity);
    const double pace = std::sqrt(strongest * farthest[place]);
    for (Scale& s : scales_) {
        const auto kind = static_cast<std::size_t>(s.alike);
        if (s.alike == Alike::nothing || count[kind] < 2) continue;
        s.scale = std::max(s.scale, share * largest[kind]);
        if (kind == velocity && largest[kind] > 0.0)
            s.scale = std::max(s.scale, least_share(wanted, pace / largest[kind]) * largest[kind]);
    }
    // what is held is zero, and all that is seen of it an error
    constexpr double rounding = 1e-9;
    for (Scale& s : scales_)
        if (s.scale <= std::max(rounding, wanted) * s.held) s.scale = s.held;
}

RBDYN_INLINE double ErrorScales::relative(std::size_t what, double difference) const {
    const Scale& s = scales_[what];
    return s.is_any ? difference / s.scale : 0.0;
}

RBDYN_INLINE double ErrorScales::rounding() const {
    const int most = most_rounded();
    return most >= 0 ? rounding_of(static_cast<std::size_t>(most)) : 0.0;
}

RBDYN_INLINE int ErrorScales::most_rounded() const {
    int most = -1;
    double worst = 0.0;
    for (std::size_t k = 0; k < scales_.size(); ++k)
        if (const double one = rounding_of(k); one > worst) {
            worst = one;
            most = static_cast<int>(k);
        }
    return most;
}

RBDYN_INLINE double ErrorScales::rounding_of(std::size_t what) const {
    const Scale& s = scales_[what];
    return s.is_any ? std::numeric_limits<double>::epsilon() * s.whole / s.scale : 0.0;
}

}  // namespace rbdyn::inline RBDYN_FORM
