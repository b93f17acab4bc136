// Joints and rails whose motion is a function of time.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/expression/function.hpp"
#include "rbdyn/mechanics/joint/rail.hpp"
#include "rbdyn/mechanics/tree.hpp"
#include "rbdyn/scene/rigid_motion.hpp"

namespace rbdyn::inline RBDYN_FORM::mechanics {

/// Whether a function of time may become infinite or no number, jump or have a corner.
inline bool may_break(const Function& f) {
    for (std::int32_t n = 0; n < f.size(); ++n) switch (f.node(n).operation) {
            case Operation::divide:
            case Operation::square_root:
            case Operation::logarithm:
            case Operation::log1p:
            case Operation::artanh:
            case Operation::power:
            case Operation::raise:
            case Operation::norm:
            case Operation::angle:
            case Operation::sign:
            case Operation::select:
            case Operation::whole:
            case Operation::call: return true;
            default: break;
        }
    return false;
}

/// The motion of a joint that is driven and moves; none of others.
inline const DrivenLaw* driven(const Node& n) {
    const DrivenLaw* law = n.joint.as<DrivenLaw>();
    return law != nullptr && !law->way.is_constant() ? law : nullptr;
}

/// A rail that moves as a function of time says.
inline const RailLaw* moved(const Node& n) {
    const RailLaw* law = n.joint.rail();
    return law != nullptr && law->motion.present() ? law : nullptr;
}

/// All numbers of a placement, or of its rate.
template <class S>
std::array<S, 12> numbers_of(const RigidPlacement<S>& p) {
    std::array<S, 12> all{p.row[0][0], p.row[0][1], p.row[0][2], p.row[1][0], p.row[1][1], p.row[1][2],
                          p.row[2][0], p.row[2][1], p.row[2][2], S(0.0),      S(0.0),      S(0.0)};
    for (int k = 0; k < 3; ++k) all[static_cast<std::size_t>(9 + k)] = p.displacement[k];
    return all;
}

/// What is no number or infinite of the motion of a rail and its rates; none if nothing is.
inline std::optional<double> not_finite(const RailLaw& rail, double t) {
    for (const auto& part : {rail.motion.at(t), rail.motion.rate(t), rail.motion.second(t)})
        for (const double value : numbers_of<double>(part))
            if (!std::isfinite(value)) return value;
    return std::nullopt;
}

}  // namespace rbdyn::inline RBDYN_FORM::mechanics
