// Scenes as data, and the handles that a scene has: of what it was given, or made anew for one that was read.
#pragma once

#include <string>
#include <vector>

#include "handles.hpp"

namespace binding {

/// A handle that is equal to no other.
Handle new_handle(Handle::Of of, int index, std::string name);
bool has_coupling_named(const BoundScene& scene, const std::string& name);
/// The handles of a coupling and of a load that a scene has just taken.
CouplingHandle add_coupling(BoundScene& self, int index);
LoadHandle add_load(BoundScene& self, int index);

/// A scene with new handles.
BoundScene bound(rbdyn::Scene scene);
py::typing::Dict<py::str, Handle> handles_by_name(const BoundScene& s);
std::vector<py::object> parameters_of(const BoundScene& s);

/// For pickling: the text of its file, its parameters and its handles.
py::tuple scene_state(const BoundScene& s);
BoundScene scene_from_state(const py::tuple& state);
/// Handles by kind: (number, name) each; for a scene that has so many.
py::tuple handles_state(const Handles& handles);
Handles handles_from_state(const py::tuple& state, const rbdyn::Scene& scene);

}  // namespace binding
