// Surfaces: what points are held on, and what bodies touch.
#pragma once

#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/vector.hpp"

namespace rbdyn::inline RBDYN_FORM {

/// A plane through a point [m], its normal of any length.
struct Plane {
    Vector3 normal{0, 0, 1};
    Vector3 point = Vector3::Zero();

    bool operator==(const Plane&) const = default;
    void validate() const;
};

}  // namespace rbdyn::inline RBDYN_FORM
