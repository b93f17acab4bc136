// A run as Python holds it: the motion, and the handles it can be asked with.
#pragma once

#include <memory>
#include <rbdyn/trajectory/trajectory.hpp>

#include "handles.hpp"

namespace binding {

struct BoundTrajectory {
    rbdyn::Trajectory run;
    std::shared_ptr<const Handles> handles;
};

}  // namespace binding
