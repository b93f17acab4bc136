// What the action of a watched function makes of a rigid body's coordinates.
#pragma once

#include <span>
#include <string>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/scene/watch.hpp"
#include "rbdyn/special/point_laws.hpp"
#include "rbdyn/special/rigid_loads.hpp"

namespace rbdyn::inline RBDYN_FORM {

/// Puts a new state of a body, where `now` is how it moves, into the state x. Throws InvalidInput for words that are
/// not its joint's, and for numbers that are no state.
void change_rigid(const StateChange& c, const PointLaws::Body& body, const RigidReport& now, const std::string& user,
                  std::span<double> x);

}  // namespace rbdyn::inline RBDYN_FORM
