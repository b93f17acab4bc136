// The scene and its handles.
#include <algorithm>
#include <atomic>
#include <random>
#include <utility>
#include <variant>

#include "watch.hpp"

namespace binding {

using rbdyn::Free, rbdyn::FreeStart, rbdyn::Particle, rbdyn::Rail, rbdyn::RailStart, rbdyn::Scene;

namespace {

Handle new_handle(Handle::Of of, int index, std::string name) {
    // from a start of its own in every process, so that handles of unpickled scenes meet no others
    static std::atomic<std::uint64_t> last{[] {
        std::random_device device;
        return (static_cast<std::uint64_t>(device()) << 32) ^ device();
    }()};
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

// the first of them can be made from nothing, as Python's arguments must
using AnyLoad = std::variant<rbdyn::Drag, rbdyn::Force, rbdyn::Lorentz, rbdyn::Potential>;

rbdyn::Load load_from(const AnyLoad& load) {
    return std::visit([](const auto& l) { return rbdyn::Load(l); }, load);
}

LoadHandle apply(BoundScene& self, const AnyLoad& load, const Handle& handle) {
    const rbdyn::BodyHandle body = self.handles.body(handle, "Scene.apply");
    const auto added = self.scene.apply(load_from(load), body);
    const char* kinds[] = {"drag ", "force ", "Lorentz force ", "potential "};
    return self.handles.loads.emplace_back(
        LoadHandle{new_handle(Handle::Of::load, added.index, kinds[load.index()] + std::to_string(added.index + 1))});
}

WatchHandle watch(BoundScene& self, const std::string& name, const py::object& function, const std::string& direction,
                  const ActionName& action, std::optional<bool> trace) {
    rbdyn::WatchOptions options;
    options.direction = one_of(direction, directions, "Scene.watch", "direction");
    options.action = action_of(action, self, name);
    const auto added =
        self.scene.watch(name, watched_function(function, self, trace, "watch \"" + name + "\""), options);
    return self.handles.watches.emplace_back(WatchHandle{new_handle(Handle::Of::watch, added.index, name)});
}

/// Handles as data: what they are of is where they stand.
template <class H>
py::list data_of(const std::vector<H>& handles) {
    py::list result;
    for (const H& h : handles) result.append(py::make_tuple(h.id, h.name));
    return result;
}
template <class H>
std::vector<H> handles_from(const py::handle& data, Handle::Of of) {
    std::vector<H> result;
    for (const py::handle item : data) {
        const auto pair = item.cast<std::pair<std::uint64_t, std::string>>();
        result.push_back(H{{of, static_cast<int>(result.size()), pair.first, pair.second}});
    }
    return result;
}

py::tuple data(const BoundScene& s) {
    py::list bodies, loads, couplings, watches, integrals;
    for (const Scene::Body& b : s.scene.bodies()) {
        const py::object start = b.rail() != nullptr ? py::object(py::make_tuple(b.parameter, b.speed))
                                                     : py::make_tuple(to_python(b.position), to_python(b.velocity));
        bodies.append(py::make_tuple(b.particle, b.joint, start, b.name));
    }
    for (const auto& l : s.scene.loads()) loads.append(py::make_tuple(l.load, l.body));
    const auto end = [](const rbdyn::End& e) -> py::object {
        if (const auto* body = std::get_if<rbdyn::BodyHandle>(&e)) return py::int_(body->index);
        return to_python(std::get<Vector3>(e));
    };
    for (const auto& c : s.scene.connections())
        couplings.append(py::make_tuple(std::get<rbdyn::Spring>(c.coupling), end(c.a), end(c.b)));
    for (const auto& w : s.scene.watches()) {
        if (w.options.action.change)
            throw py::type_error("Scene: the action of watch \"" + w.name +
                                 "\" is a function of Python's own, and a scene "
                                 "with one cannot be pickled");
        const char* action = w.options.action.kind == rbdyn::WatchAction::Kind::stop ? "stop" : "record";
        watches.append(py::make_tuple(w.name, watch_data(w.function, "watch \"" + w.name + "\""),
                                      word_for(w.options.direction, directions), action));
    }
    for (const auto& i : s.scene.integrals())
        integrals.append(py::make_tuple(i.name, watch_data(i.function, "integral \"" + i.name + "\"")));
    return py::make_tuple(to_python(s.scene.gravity()), bodies, loads, couplings, watches, integrals,
                          py::make_tuple(data_of(s.handles.bodies), data_of(s.handles.loads),
                                         data_of(s.handles.couplings), data_of(s.handles.watches)));
}

BoundScene scene_from(const py::tuple& d) {
    BoundScene s{Scene(vector3(d[0], "Scene", "gravity")), {}};
    for (const py::handle item : d[1]) {
        const auto b = item.cast<py::tuple>();
        const auto particle = b[0].cast<Particle>();
        const auto start = b[2].cast<py::tuple>();
        const auto name = b[3].cast<std::string>();
        if (py::isinstance<Rail>(b[1]))
            s.scene.add(particle, b[1].cast<const Rail&>(),
                        {.parameter = start[0].cast<double>(), .speed = start[1].cast<double>()}, name);
        else
            s.scene.add(particle, Free{}, {vector3(start[0], name, "position"), vector3(start[1], name, "velocity")},
                        name);
    }
    for (const py::handle item : d[2]) {
        const auto l = item.cast<py::tuple>();
        s.scene.apply(load_from(l[0].cast<AnyLoad>()), rbdyn::BodyHandle{l[1].cast<int>()});
    }
    const auto end = [](const py::object& e) -> rbdyn::End {
        if (py::isinstance<py::int_>(e)) return rbdyn::BodyHandle{e.cast<int>()};
        return vector3(e, "Scene.connect", "end");
    };
    for (const py::handle item : d[3]) {
        const auto c = item.cast<py::tuple>();
        s.scene.connect(c[0].cast<rbdyn::Spring>(), end(c[1]), end(c[2]));
    }
    for (const py::handle item : d[4]) {
        const auto w = item.cast<py::tuple>();
        rbdyn::WatchOptions options;
        options.direction = one_of(w[2].cast<std::string>(), directions, "Scene.watch", "direction");
        if (w[3].cast<std::string>() == "stop") options.action.kind = rbdyn::WatchAction::Kind::stop;
        s.scene.watch(w[0].cast<std::string>(), watch_from(w[1]), options);
    }
    for (const py::handle item : d[5]) {
        const auto i = item.cast<py::tuple>();
        s.scene.integral(i[0].cast<std::string>(), watch_from(i[1]));
    }
    const auto handles = d[6].cast<py::tuple>();
    s.handles = {handles_from<BodyHandle>(handles[0], Handle::Of::body),
                 handles_from<LoadHandle>(handles[1], Handle::Of::load),
                 handles_from<CouplingHandle>(handles[2], Handle::Of::coupling),
                 handles_from<WatchHandle>(handles[3], Handle::Of::watch)};
    return s;
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
    const auto pickled = [](auto& type, auto of) {
        using H = typename std::decay_t<decltype(type)>::type;
        type.def(py::pickle([](const H& h) { return py::make_tuple(h.index, h.id, h.name); },
                            [of](const py::tuple& d) {
                                return H{{of, d[0].cast<int>(), d[1].cast<std::uint64_t>(), d[2].cast<std::string>()}};
                            }));
    };

    py::class_<BodyHandle, Handle> body(m, "BodyHandle", "The handle of a body; run[handle] is a BodyMotion.");
    py::class_<LoadHandle, Handle> load(m, "LoadHandle", "The handle of a load.");
    py::class_<CouplingHandle, Handle> coupling(m, "CouplingHandle",
                                                "The handle of a coupling; run[handle] is a SpringMotion.");
    py::class_<WatchHandle, Handle> watched(m, "WatchHandle",
                                            "The handle of a watched function; run[handle] is a Watched.");
    pickled(body, Handle::Of::body);
    pickled(load, Handle::Of::load);
    pickled(coupling, Handle::Of::coupling);
    pickled(watched, Handle::Of::watch);

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
        .def("watch", &watch, py::arg("name"), py::arg("function"), py::kw_only(), py::arg("direction") = "either",
             py::arg("action") = "record", py::arg("trace") = py::none(),
             R"(Watches a function of the motion: where it passes zero is an event of kind "watch". Returns a handle.

function: function(now) -> number, with now.time [s] and now[handle].quantity for position, velocity, acceleration, force
(all (3,), world axes), kinetic_energy; on a rail reaction, parameter, speed, tangential_force; of a spring length and
force. It is recorded, so that its zeros are found on its Taylor series, each one; what cannot be recorded is called back
with numbers, and its zeros are located but not certain (trace as for Force).

direction: "rising", "falling" or "either". action: "record" it, "stop" the run there, or a function of now (numbers) that
changes the state: it returns {handle: {"velocity": ...}}, in the joint's own words as add() takes them.

run[handle].value(t) is its value. Raises InvalidInput for a name that is taken, or a quantity that is not there.)")
        .def(
            "integral",
            [](BoundScene& self, const std::string& name, const py::object& function) {
                self.scene.integral(name, watched_function(function, self, true, "integral \"" + name + "\""));
            },
            py::arg("name"), py::arg("function"),
            R"(A first integral of one's own: function(now) as for watch(). run.drift[name] says how far it departs from its value
at the start, relative to its largest size.)")
        .def("__eq__",
             [](const BoundScene& a, const py::object& b) {
                 return py::isinstance<BoundScene>(b) && a.scene == b.cast<const BoundScene&>().scene;
             })
        .def(py::pickle(&data, &scene_from))
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
                   count(s.handles.couplings.size(), "coupling", "couplings") +
                   (s.handles.watches.empty() ? "" : ", " + count(s.handles.watches.size(), "watch", "watches")) + ">";
        });
}

}  // namespace binding
