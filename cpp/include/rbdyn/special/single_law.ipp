// Definitions of rbdyn/special/single_law.hpp.
#pragma once

#include "rbdyn/special/single_law.hpp"

#include <memory>
#include <optional>
#include <span>

#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/model/equations.hpp"
#include "rbdyn/model/state_map.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE Vector3Of<DoubleDouble> SingleLaw::point(const std::optional<Vector3>& /*given*/) const { return {}; }

RBDYN_INLINE bool SingleLaw::takes_numbers(const StateMap& map) const {
    return fixed_velocity() >= 0 && map.is_simulated(fixed_variable());
}

RBDYN_INLINE bool SingleLaw::moves(const StateMap& map) const {
    for (int k = 0; k < positions(); ++k)
        if (map.is_simulated(first + k)) return true;
    for (int k = 0; k < velocities(); ++k)
        if (map.is_simulated(first_rate + k)) return true;
    return false;
}

RBDYN_INLINE bool SingleLaw::turns(const StateMap& map) const {
    for (int k = first_turn(); k < positions(); ++k)
        if (map.is_simulated(first + k)) return true;
    return false;
}

RBDYN_INLINE Matrix3 SingleLaw::rail_turn(double /*t*/) const { return Matrix3::Identity(); }

RBDYN_INLINE std::unique_ptr<const Projection> SingleLaw::projection(std::span<const double> /*x*/,
                                                                     std::span<const double> /*low*/) const {
    return nullptr;
}

}  // namespace rbdyn::inline RBDYN_FORM
