// Where a body is and how it moves, in numbers of any type: what every law says of it. A law knows the rest.
#pragma once

#include <memory>
#include <utility>
#include <vector>

#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/vector.hpp"

namespace rbdyn::inline RBDYN_FORM {

/// Of a particle; the place of a rigid body is that of its centre of mass. In the view.
template <class S>
struct SingleState {
    Vector3Of<S> r, v;

    SingleState() = default;
    SingleState(const Vector3Of<S>& place, const Vector3Of<S>& velocity) : r(place), v(velocity) {}
    virtual ~SingleState() = default;
    SingleState(const SingleState&) = default;
    SingleState& operator=(const SingleState&) = default;

    /// Place and velocity of a point of it, given as SingleLaw::point() does.
    virtual std::pair<Vector3Of<S>, Vector3Of<S>> motion_of(const Vector3Of<DoubleDouble>& /*point*/) const {
        return {r, v};
    }
};

/// Of all bodies of a scene.
template <class S>
using SingleStates = std::vector<std::unique_ptr<SingleState<S>>>;

}  // namespace rbdyn::inline RBDYN_FORM
