// The numbers of a joint that watched functions ask for, by which of its coordinates or of their rates they are.
#pragma once

#include "rbdyn/basics/form.hpp"
#include "rbdyn/mechanics/joint/law.hpp"
#include "rbdyn/scene/watch.hpp"

namespace rbdyn::inline RBDYN_FORM {

namespace mechanics {

inline bool is_of_joint(Quantity q) {
    return q == Quantity::angle || q == Quantity::displacement || q == Quantity::rate ||
           q == Quantity::displacement_rate || q == Quantity::angles || q == Quantity::rates;
}

/// A number of a joint that is_of_joint(): `coordinate(k)` and `rate(k)` give those of its own, of a driven one the
/// first of each.
template <class Coordinate, class Rate>
auto joint_number(const JointLaw& joint, const Observable& o, const Coordinate& coordinate, const Rate& rate) {
    const bool is_planar = joint.as<PlanarLaw>() != nullptr, slides_too = joint.as<CylindricalLaw>() != nullptr;
    switch (o.quantity) {
        case Quantity::angle: return coordinate(is_planar ? 2 : 0);
        case Quantity::displacement: return coordinate(slides_too ? 1 : 0);
        case Quantity::rate: return rate(is_planar ? 2 : 0);
        case Quantity::displacement_rate: return rate(1);
        case Quantity::angles: return coordinate(o.component);
        default: return rate(o.component);
    }
}

}  // namespace mechanics

}  // namespace rbdyn::inline RBDYN_FORM
