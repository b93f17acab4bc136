// What is done with what was taken.
#pragma once

#include "rbdyn/rbdyn.hpp"

namespace rbdyn::fuzz {

/// Plans a scene and runs it for a short while; what the run says of itself must hold.
void use(const Scene& scene);
/// Asks a run for what it has.
void ask(const Trajectory& run);

}  // namespace rbdyn::fuzz
