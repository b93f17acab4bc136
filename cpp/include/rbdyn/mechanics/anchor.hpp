// A point that something holds: of a body of a tree, or of the world.
#pragma once

#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/double_double_vector.hpp"
#include "rbdyn/basics/form.hpp"

namespace rbdyn::inline RBDYN_FORM {

namespace mechanics {

/// A point of a body, from its P in its axes; or of the world.
struct Anchor {
    int body = -1;
    Vector3Of<DoubleDouble> point{};

    bool operator==(const Anchor&) const = default;
};

}  // namespace mechanics

}  // namespace rbdyn::inline RBDYN_FORM
