// Watched functions of Python's: what they are called with, and what becomes of them.
#pragma once

#include <optional>
#include <rbdyn/scene/recorded_action.hpp>
#include <string>
#include <utility>
#include <vector>

#include "handles.hpp"

namespace binding {

inline const Words<rbdyn::Direction> directions = {
    {"either", rbdyn::Direction::either}, {"rising", rbdyn::Direction::rising}, {"falling", rbdyn::Direction::falling}};

/// Recorded if it can be and `trace` is not false, else called back.
rbdyn::WatchFunction watched_function(const py::object& f, const BoundScene& scene, std::optional<bool> trace,
                                      const std::string& user);
/// "record", "stop", or a function that changes the state.
rbdyn::WatchAction action_of(const py::object& action, const BoundScene& scene, const std::string& name);

/// The function that an action calls in Python, if it does.
std::optional<py::object> called_action(const rbdyn::WatchAction& action);
/// The same recorded, as it can be written; none, and the reason, where it cannot be.
std::optional<rbdyn::RecordedAction> recorded_action(const py::object& action, const BoundScene& scene,
                                                     const std::string& name, std::string& reason);

/// The one number that a watched function returns, recorded, and in numbers. Throws InvalidInput for anything else.
rbdyn::Expression one_expression(const py::object& returned, const std::string& user);
double one_number(const py::object& returned, const std::string& user);

/// A recorded watched function as data, and from it.
py::tuple watch_data(const rbdyn::WatchFunction& function, const std::string& user);
rbdyn::WatchFunction watch_from(const py::handle& data);

}  // namespace binding
