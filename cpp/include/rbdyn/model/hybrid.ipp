// Definitions of rbdyn/model/hybrid.hpp.
#pragma once

#include "rbdyn/model/hybrid.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "rbdyn/expression/evaluate.hpp"
#include "rbdyn/expression/program.hpp"
#include "rbdyn/model/equations.hpp"
#include "rbdyn/model/observed.hpp"
#include "rbdyn/series/piece.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE Mode HybridModel::undecided() const { return {}; }

RBDYN_INLINE std::vector<double> HybridModel::start_rest() const { return {}; }

RBDYN_INLINE std::vector<double> HybridModel::winding(double /*t*/, std::span<const double> /*x*/) const { return {}; }

RBDYN_INLINE void HybridModel::wind(const Piece& /*piece*/, double /*length*/, std::vector<double>& /*winding*/) const {
}

RBDYN_INLINE Mode HybridModel::next_with_rest(const Mode& mode, std::span<const int> fired, double t,
                                              std::span<double> x, std::span<double> rest,
                                              std::span<const double> /*largest*/,
                                              std::vector<Happening>& happenings) const {
    const std::vector<double> reached(x.begin(), x.end());
    Mode after = next(mode, fired, t, x, happenings);
    for (std::size_t i = 0; i < rest.size(); ++i)
        if (x[i] != reached[i]) rest[i] = 0.0;
    return after;
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
            o.whole = safe_norm(o.value);
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

RBDYN_INLINE std::string HybridModel::rate_name(int /*variable*/) const { return "a force or torque"; }

RBDYN_INLINE std::string HybridModel::grown(const Mode& /*before*/, double /*t0*/, std::span<const double> /*x0*/,
                                            const Mode& /*mode*/, double /*t*/, std::span<const double> /*x*/) const {
    return {};
}

RBDYN_INLINE Slope HybridModel::slope(const Mode& mode, double t, std::span<const double> x, std::span<double> slope,
                                      std::span<double> bend) const {
    Evaluator<double> rates(mode.equations->program);
    rates.set_parameters(mode.parameters);
    rates(t, x);
    Slope result{.is_known = true};
    double size = 0.0, fastest = 0.0;
    for (std::size_t i = 0; i < x.size(); ++i) {
        slope[i] = rates.output(static_cast<int>(i));
        bend[i] = 0.0;
        if (!std::isfinite(slope[i])) return {};
        size = std::max(size, std::abs(x[i]));
        fastest = std::max(fastest, std::abs(slope[i]));
    }
    if (fastest > 0.0 && size > 0.0) result.pace = size / fastest;
    return result;
}

}  // namespace rbdyn::inline RBDYN_FORM
