// A run as Python holds it: the motion, and the handles it can be asked with.
#pragma once

#include <algorithm>
#include <memory>
#include <optional>
#include <rbdyn/trajectory/trajectory.hpp>
#include <string>
#include <utility>
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

/// Events as Python has them, with the handles they name.
struct BoundEvents {
    std::shared_ptr<const rbdyn::Events> events;  // of a run, which they keep
    std::shared_ptr<const Handles> handles;

    BoundEvents(const BoundTrajectory& r) : events(r.run.data(), &r.run.events()), handles(r.handles) {}
    BoundEvents(rbdyn::Events all, Handles known)
        : events(std::make_shared<const rbdyn::Events>(std::move(all))),
          handles(std::make_shared<Handles>(std::move(known))) {}

    const rbdyn::Events& list() const { return *events; }
    BoundEvent at(std::size_t i) const { return bound(list()[i], *handles); }
};
/// Of what has no bodies: watched functions by their names alone.
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

/// A pair of vectors at each time, as a named tuple of python/rbdyn/frames.py.
template <class Pair, class F>
Pair pair_over(const ArrayLike& t, F&& f) {
    std::vector<std::pair<Vector3, Vector3>> kept;
    const auto first = over(t, "Trajectory", "time", [&](double x) { return kept.emplace_back(f(x)).first; });
    auto next = kept.cbegin();
    const auto second = over(t, "Trajectory", "time", [&](double) { return (next++)->second; });
    return Pair(py::make_tuple(first, second));
}
template <class Named, class F>
Named pair_over(const char* name, const ArrayLike& t, F&& f) {
    return Named(py::module_::import("rbdyn.frames").attr(name)(*pair_over<py::tuple>(t, f)));
}

/// From "after" or "before"; the first is what is meant where nothing is said.
rbdyn::Side side_of(const SideName& side);
SideName after();

// the parts of bind_trajectory()
void bind_events(py::module_& m);
void bind_statistics(py::module_& m);
void bind_motions(py::module_& m);
/// run[handle] of a body, its point, a coupling, a constraint, a contact, a watched function.
void bind_motion_of(py::class_<BoundTrajectory>& run);

}  // namespace binding
