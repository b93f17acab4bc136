// A run as Python holds it: the motion, and the handles it can be asked with.
#pragma once

#include <algorithm>
#include <memory>
#include <optional>
#include <rbdyn/trajectory/trajectory.hpp>
#include <string>
#include <variant>
#include <vector>

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

inline BoundEvent bound(const rbdyn::Event& e, const Handles& handles) {
    if (e.contact >= 0) return {e, handles.contacts[static_cast<std::size_t>(e.contact)]};
    if (e.subject < 0) return {e, std::nullopt};
    return {e, handles.bodies[static_cast<std::size_t>(e.subject)]};
}

/// Events as Python has them, of what has no bodies: watched functions by their names alone.
py::object events_object(const rbdyn::Events& events, const std::vector<std::string>& watches);

/// States at a time or at an array of times, f(t, side) a list of `count` numbers; these come last.
template <class F>
Vectors states_over(const ArrayLike& times, int count, const char* user, F&& f) {
    const Array t = doubles(times, user, "time");
    std::vector<py::ssize_t> shape(t.shape(), t.shape() + t.ndim());
    shape.push_back(count);
    py::array_t<double> result(shape);
    double* out = result.mutable_data();
    const double* in = t.data();
    const py::ssize_t size = t.size();
    unlocked([&] {
        for (py::ssize_t i = 0; i < size; ++i) {
            out = std::ranges::copy(f(in[i]), out).out;
            if (i % 64 == 0) rbdyn::Interruption::point();
        }
    });
    return py::reinterpret_borrow<Vectors>(result);
}

/// From "after" or "before"; the first is what is meant where nothing is said.
rbdyn::Side side_of(const SideName& side);
SideName after();

}  // namespace binding
