// A run as Python holds it: the motion, and the handles it can be asked with.
#pragma once

#include <memory>
#include <optional>
#include <rbdyn/trajectory/trajectory.hpp>
#include <variant>

#include "handles.hpp"

namespace binding {

struct BoundTrajectory {
    rbdyn::Trajectory run;
    std::shared_ptr<const Handles> handles;
};

struct BoundEvent {
    rbdyn::Event event;
    std::optional<std::variant<BodyHandle, ContactHandle>> subject;
};

/// From "after" or "before"; the first is what is meant where nothing is said.
rbdyn::Side side_of(const SideName& side);
SideName after();

}  // namespace binding
