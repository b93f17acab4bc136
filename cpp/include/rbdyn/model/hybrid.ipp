// Definitions of rbdyn/model/hybrid.hpp.
#pragma once

#include "rbdyn/model/hybrid.hpp"

#include <algorithm>
#include <cstddef>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "rbdyn/expression/program.hpp"
#include "rbdyn/model/equations.hpp"
#include "rbdyn/series/piece.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE Mode HybridModel::undecided() const { return {}; }

RBDYN_INLINE std::vector<double> HybridModel::start_rest() const { return {}; }

RBDYN_INLINE std::vector<double> HybridModel::winding(double /*t*/, std::span<const double> /*x*/) const { return {}; }

RBDYN_INLINE void HybridModel::wind(const Piece& /*piece*/, double /*length*/, std::vector<double>& /*winding*/) const {
}

RBDYN_INLINE void HybridModel::observe(const Mode& mode, double /*t*/, std::span<const double> x,
                                       std::vector<Observed>& observed) const {
    observed.clear();
    for (const VariableGroup& group : mode.equations->groups)
        for (int first = group.first; first < group.first + group.count; first += 3) {
            Observed o;
            o.is_position = group.is_position;
            for (int i = first; i < std::min(first + 3, group.first + group.count); ++i)
                o.value[i - first] = x[static_cast<std::size_t>(i)];
            o.whole = o.value.norm();
            observed.push_back(o);
        }
}

RBDYN_INLINE bool HybridModel::holds_what_touches(int /*subject*/) const { return false; }

RBDYN_INLINE double HybridModel::guard_value(const Guard& /*guard*/, const Mode& /*mode*/, double /*t*/,
                                             std::span<const double> /*x*/) const {
    return std::numeric_limits<double>::quiet_NaN();
}

RBDYN_INLINE std::string HybridModel::impossible(const Mode& /*mode*/, double /*t*/,
                                                 std::span<const double> /*x*/) const {
    return {};
}

RBDYN_INLINE std::string HybridModel::not_finite(const Mode& /*mode*/, double /*t*/,
                                                 std::span<const double> /*x*/) const {
    return {};
}

RBDYN_INLINE std::string HybridModel::grown(const Mode& /*before*/, double /*t0*/, std::span<const double> /*x0*/,
                                            const Mode& /*mode*/, double /*t*/, std::span<const double> /*x*/) const {
    return {};
}

RBDYN_INLINE Slope HybridModel::slope(const Mode&, double /*t*/, std::span<const double> /*x*/,
                                      std::span<double> /*slope*/, std::span<double> /*bend*/) const {
    return {};
}

}  // namespace rbdyn::inline RBDYN_FORM
