// Definitions of rbdyn/model/equations.hpp.
#pragma once

#include "rbdyn/model/equations.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/expression/program.hpp"
#include "rbdyn/expression/recorder.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE double least_share(double wanted, double size) {
    // of four sums or products, and something over for all else that errs
    constexpr double rounding = 4.5 * std::numeric_limits<double>::epsilon();
    return std::min(1.0, std::max(wanted, rounding * std::max(size, 1.0) / wanted));
}

RBDYN_INLINE void Projection::refine(std::vector<DoubleDouble>& /*x*/, double /*t*/) const {}
RBDYN_INLINE bool Projection::refine_beside(std::vector<DoubleDouble>& /*x*/, double /*t*/,
                                            const std::vector<DoubleDouble>& /*there*/, double /*then*/) const {
    return false;
}

RBDYN_INLINE Projection::Off Projection::off(std::span<const double> /*x*/, std::span<const double> /*low*/,
                                             double /*t*/) const {
    return {};
}

RBDYN_INLINE int Projection::positions() const { return 0; }

RBDYN_INLINE bool Projection::makes_up_for_rounding() const { return false; }

RBDYN_INLINE const Switch* Equations::switch_of(const Guard& guard) const {
    const int index = guard.output - program.outputs();
    return index >= 0 ? &program.switches()[static_cast<std::size_t>(index)] : nullptr;
}

RBDYN_INLINE std::optional<std::uint64_t> Equations::surface_of(const Guard& guard) const {
    if (guard.sliding >= 0 || guard.output < 0) return std::nullopt;
    if (guard.branch >= 0) {
        const Branch& b = branches[static_cast<std::size_t>(guard.branch)];
        return b.is_select ? std::optional(b.surface) : std::nullopt;
    }
    const Switch* s = switch_of(guard);
    return s != nullptr && !s->is_norm ? std::optional(s->surface) : std::nullopt;
}

RBDYN_INLINE bool Equations::is_variable(const Guard& guard) const {
    return guard.output >= 0 && program.output(guard.output) < program.inputs();
}

}  // namespace rbdyn::inline RBDYN_FORM
