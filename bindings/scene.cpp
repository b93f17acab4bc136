// The scene and its handles.
#include <algorithm>
#include <atomic>
#include <utility>
#include <variant>

#include "handles.hpp"

namespace binding {

using rbdyn::Free, rbdyn::FreeStart, rbdyn::Particle, rbdyn::Rail, rbdyn::RailStart, rbdyn::Scene;

namespace {

Handle new_handle(Handle::Of of, int index, std::string name) {
    static std::atomic<std::uint64_t> last{0};
    return {of, index, ++last, std::move(name)};
}

/// Throws TypeError for a keyword that is not among `allowed`.
void require_keywords(const py::kwargs& given, const std::vector<std::string>& allowed, const std::string& joint) {
    for (const auto& item : given) {
        const auto key = item.first.cast<std::string>();
        if (std::find(allowed.begin(), allowed.end(), key) != allowed.end()) continue;
        std::string list;
        for (const std::string& a : allowed) list += (list.empty() ? "" : ", ") + a;
        throw py::type_error("Scene.add: unexpected keyword \"" + key + "\"; a particle " + joint + " starts with " +
                             list);
    }
}

BodyHandle add(BoundScene& self, const Particle& body, const std::variant<Free, Rail>& joint,
               const std::optional<std::string>& name, const py::kwargs& initial) {
    if (name && name->empty()) throw InvalidInput("Scene.add: name is empty; give a name, or none");
    const std::string called = name.value_or("");
    const std::string object = called.empty() ? "Scene.add" : called;
    const auto optional = [&](const char* key) -> std::optional<double> {
        if (!initial.contains(key) || initial[key].is_none()) return std::nullopt;
        return number(initial[key], object, key);
    };
    rbdyn::BodyHandle added;
    if (std::holds_alternative<Free>(joint)) {
        require_keywords(initial, {"position", "velocity"}, "that is free");
        FreeStart start;
        if (initial.contains("position")) start.position = vector3(initial["position"], object, "position");
        if (initial.contains("velocity")) start.velocity = vector3(initial["velocity"], object, "velocity");
        added = self.scene.add(body, Free{}, start, called);
    } else {
        require_keywords(initial, {"parameter", "arc_length", "speed"}, "on a rail");
        const RailStart start{optional("parameter"), optional("arc_length"), optional("speed").value_or(0.0)};
        added = self.scene.add(body, std::get<Rail>(joint), start, called);
    }
    const std::string& given = self.scene.bodies()[static_cast<std::size_t>(added.index)].name;
    return self.handles.bodies.emplace_back(BodyHandle{new_handle(Handle::Of::body, added.index, given)});
}

rbdyn::End end_of(const BoundScene& self, const py::object& end, const char* which) {
    if (py::isinstance<Handle>(end)) return self.handles.body(end.cast<const Handle&>(), "Scene.connect");
    return vector3(end, "Scene.connect", which);
}

CouplingHandle connect(BoundScene& self, const rbdyn::Spring& coupling, const ArrayLike& a, const ArrayLike& b) {
    const auto added = self.scene.connect(coupling, end_of(self, a, "a"), end_of(self, b, "b"));
    const std::string name = "spring " + std::to_string(added.index + 1);
    return self.handles.couplings.emplace_back(CouplingHandle{new_handle(Handle::Of::coupling, added.index, name)});
}

LoadHandle apply(BoundScene& self, const std::variant<rbdyn::Drag, rbdyn::Force>& load, const Handle& handle) {
    const rbdyn::BodyHandle body = self.handles.body(handle, "Scene.apply");
    const auto added = std::visit([&](const auto& l) { return self.scene.apply(l, body); }, load);
    const char* kind = std::holds_alternative<rbdyn::Force>(load) ? "force " : "drag ";
    return self.handles.loads.emplace_back(
        LoadHandle{new_handle(Handle::Of::load, added.index, kind + std::to_string(added.index + 1))});
}

}  // namespace

void bind_scene(py::module_& m) {
    py::class_<Handle>(m, "Handle", R"(What a scene returns for a body, a load or a coupling it has taken.

Good for its scene, for copies of that scene and for their runs; equal only to itself.)")
        .def_readonly("name", &Handle::name)
        .def("__eq__", [](const Handle& a,
                          const py::object& b) { return py::isinstance<Handle>(b) && a == b.cast<const Handle&>(); })
        .def("__hash__", [](const Handle& h) { return h.id; })
        .def("__copy__", [](const py::object& self) { return self; })
        .def(
            "__deepcopy__", [](const py::object& self, const py::dict&) { return self; }, py::arg("memo"))
        .def("__repr__", [](const Handle& h) { return "<Handle: " + h.name + ">"; });

    py::class_<BodyHandle, Handle>(m, "BodyHandle", "The handle of a body; run[handle] is a BodyMotion.");
    py::class_<LoadHandle, Handle>(m, "LoadHandle", "The handle of a load.");
    py::class_<CouplingHandle, Handle>(m, "CouplingHandle", "The handle of a coupling; run[handle] is a SpringMotion.");

    py::class_<BoundScene>(m, "Scene",
                           R"(What there is, as data: bodies with their joints, loads, couplings, a uniform field.

Everything is checked on entry. A run copies its scene; later changes do not touch that run.)")
        .def(py::init([](const std::optional<ArrayLike>& gravity) {
                 if (!gravity) return BoundScene{};
                 return BoundScene{Scene(vector3(*gravity, "Scene", "gravity")), {}};
             }),
             py::arg("gravity") = py::none(), "gravity: uniform field (3,) [m/s^2], world axes; none by default.")
        .def_property(
            "gravity", [](const BoundScene& s) { return py::array_t<double>(3, s.scene.gravity().data()); },
            [](BoundScene& s, const ArrayLike& gravity) { s.scene.set_gravity(vector3(gravity, "Scene", "gravity")); },
            "Uniform field (3,) [m/s^2], world axes. Assign a whole vector to change it.")
        .def_property_readonly(
            "bodies", [](const BoundScene& s) { return s.handles.bodies; },
            "Handles of the bodies, in order of addition.")
        .def_property_readonly(
            "loads", [](const BoundScene& s) { return s.handles.loads; }, "Handles of the loads, in order of addition.")
        .def_property_readonly(
            "couplings", [](const BoundScene& s) { return s.handles.couplings; },
            "Handles of the couplings, in order of addition.")
        .def("add", &add, py::arg("body"), py::arg_v("joint", std::variant<Free, Rail>(Free{}), "Free()"),
             py::kw_only(), py::arg("name") = py::none(),
             R"(Adds a body with the joint to the ground, and its initial state in the joint's words.

Free(): position, velocity (3,) [m], [m/s], world axes. Rail(): parameter or arc_length [m], one of them, and speed =
ds/dt [m/s]. Zero by default. Returns a handle. Raises InvalidInput for numbers that break a rule, TypeError for
another keyword.)")
        .def("connect", &connect, py::arg("coupling"), py::arg("a"), py::arg("b"),
             R"(Joins two ends: handles of bodies, or one of them a point of the world (3,) [m]. Returns a handle.)")
        .def("apply", &apply, py::arg("load"), py::arg("handle"), "Applies a load to a body. Returns a handle.")
        .def("__copy__", [](const BoundScene& s) { return BoundScene(s); })
        .def(
            "__deepcopy__", [](const BoundScene& s, const py::dict&) { return BoundScene(s); }, py::arg("memo"))
        .def("__repr__", [](const BoundScene& s) {
            const auto count = [](std::size_t n, const char* one, const char* several) {
                return std::to_string(n) + " " + (n == 1 ? one : several);
            };
            return "<Scene: gravity " + list_text(s.scene.gravity()) + ", " +
                   count(s.handles.bodies.size(), "body", "bodies") + ", " +
                   count(s.handles.loads.size(), "load", "loads") + ", " +
                   count(s.handles.couplings.size(), "coupling", "couplings") + ">";
        });
}

}  // namespace binding
