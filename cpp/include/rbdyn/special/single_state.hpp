// Where a body is and how it moves, in numbers of any type: what every law says of it. A law knows the rest.
#pragma once

#include <cstddef>
#include <memory>
#include <memory_resource>
#include <new>
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

/// Of all bodies of a scene, of whatever types their laws make, one behind the other in memory of their own.
template <class S>
class SingleStates {
public:
    SingleStates() = default;
    SingleStates(SingleStates&&) = default;
    SingleStates& operator=(SingleStates&&) = delete;
    ~SingleStates() { clear(); }

    SingleState<S>& operator[](std::size_t body) const { return *all_[body]; }
    void reserve(std::size_t bodies) { all_.reserve(bodies); }
    void clear() {
        for (SingleState<S>* state : all_) std::destroy_at(state);
        all_.clear();
    }
    template <class State, class... Given>
    State& add(Given&&... given) {
        void* const place = memory_->allocate(sizeof(State), alignof(State));
        State* const state = new (place) State(std::forward<Given>(given)...);
        all_.push_back(state);
        return *state;
    }

private:
    std::unique_ptr<std::pmr::monotonic_buffer_resource> memory_ =
        std::make_unique<std::pmr::monotonic_buffer_resource>();
    std::vector<SingleState<S>*> all_;
};

}  // namespace rbdyn::inline RBDYN_FORM
