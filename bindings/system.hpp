// First-order systems of one's own, as verbs take them.
#pragma once

#include <rbdyn/system/system_run.hpp>

#include "binding.hpp"

namespace binding {

/// A system and f as it was given.
struct BoundSystem {
    rbdyn::System system;
    UserFunction f;
};

/// The same from another state: an array, or a mapping of names or places to numbers.
rbdyn::System started(const rbdyn::System& system, const py::object& initial, const std::string& user);

}  // namespace binding
