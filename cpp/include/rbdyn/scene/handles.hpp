// Handles: what a scene gives back for a thing it has taken, by order of addition.
#pragma once

#include <variant>

#include "rbdyn/basics/vector.hpp"

namespace rbdyn {

/// A body of a scene.
struct BodyHandle {
    int index = -1;
    bool operator==(const BodyHandle&) const = default;
};
/// A load of a scene.
struct LoadHandle {
    int index = -1;
    bool operator==(const LoadHandle&) const = default;
};
/// A coupling of a scene.
struct CouplingHandle {
    int index = -1;
    bool operator==(const CouplingHandle&) const = default;
};
/// A watched function of a scene.
struct WatchHandle {
    int index = -1;
    bool operator==(const WatchHandle&) const = default;
};

/// An end of a coupling: a body, or a point of the world.
using End = std::variant<BodyHandle, Vector3>;

}  // namespace rbdyn
