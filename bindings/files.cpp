// Scenes as data: texts of files, and the handles that a scene has.
#include "files.hpp"
#include "watch.hpp"

#include <algorithm>
#include <atomic>
#include <random>
#include <rbdyn/file/disk.hpp>
#include <rbdyn/file/scene_file.hpp>
#include <rbdyn/file/schema.hpp>
#include <utility>
#include <variant>

namespace binding {

namespace {

/// Handles as data: what they are of is where they stand.
template <class H>
py::list data_of(const std::vector<H>& handles) {
    py::list result;
    for (const H& h : handles) result.append(py::make_tuple(h.id, h.name));
    return result;
}
template <class H>
std::vector<H> handles_from(const py::handle& data, Handle::Of of, std::size_t count) {
    std::vector<H> result;
    for (const py::handle item : data) {
        const auto pair = item.cast<std::pair<std::uint64_t, std::string>>();
        result.push_back(H{{of, static_cast<int>(result.size()), pair.first, pair.second}});
    }
    if (result.size() != count)
        throw InvalidInput("Scene: its data have " + std::to_string(result.size()) + " handles of what there are " +
                           std::to_string(count) + "; they are of another scene");
    return result;
}

}  // namespace

Handle new_handle(Handle::Of of, int index, std::string name) {
    // from a start of its own in every process, so that handles of unpickled scenes meet no others
    static std::atomic<std::uint64_t> last{[] {
        std::random_device device;
        return (static_cast<std::uint64_t>(device()) << 32) ^ device();
    }()};
    return {of, index, ++last, std::move(name)};
}

bool has_coupling_named(const BoundScene& scene, const std::string& name) {
    const auto& couplings = scene.handles.couplings;
    return scene.handles.taken.contains(name) &&
           std::any_of(couplings.begin(), couplings.end(), [&](const auto& c) { return c.name == name; });
}

CouplingHandle add_coupling(BoundScene& self, int index) {
    Handles& handles = self.handles;
    for (; handles.looked_at < handles.bodies.size(); ++handles.looked_at)
        handles.taken.insert(handles.bodies[handles.looked_at].name);
    const auto& coupling = self.scene.connections()[static_cast<std::size_t>(index)].coupling;
    int number = index;
    std::string name;
    do name = std::string(kind_of(coupling)) + " " + std::to_string(++number);
    while (!handles.taken.insert(name).second);
    return handles.couplings.emplace_back(CouplingHandle{new_handle(Handle::Of::coupling, index, name)});
}

LoadHandle add_load(BoundScene& self, int index) {
    const char* kinds[] = {"force ",  "potential ",      "Lorentz force ", "drag ",
                           "torque ", "torsion spring ", "joint torque ",  "joint force "};
    const auto& load = self.scene.loads()[static_cast<std::size_t>(index)].load;
    return self.handles.loads.emplace_back(
        LoadHandle{new_handle(Handle::Of::load, index, kinds[load.index()] + std::to_string(index + 1))});
}

BoundScene bound(rbdyn::Scene scene) {
    BoundScene s{std::move(scene), {}};
    const auto add = [](auto& handles, Handle::Of of, const auto& things) {
        using H = typename std::decay_t<decltype(handles)>::value_type;
        for (const auto& thing : things)
            handles.push_back(H{new_handle(of, static_cast<int>(handles.size()), thing.name)});
    };
    add(s.handles.bodies, Handle::Of::body, s.scene.bodies());
    add(s.handles.watches, Handle::Of::watch, s.scene.watches());
    add(s.handles.constraints, Handle::Of::constraint, s.scene.constraints());
    add(s.handles.contacts, Handle::Of::contact, s.scene.contacts());
    for (int i = 0; i < static_cast<int>(s.scene.connections().size()); ++i) add_coupling(s, i);
    for (int i = 0; i < static_cast<int>(s.scene.loads().size()); ++i) add_load(s, i);
    return s;
}

py::typing::Dict<py::str, Handle> handles_by_name(const BoundScene& s) {
    py::typing::Dict<py::str, Handle> result;
    const auto add = [&](const auto& handles) {
        for (const auto& h : handles)
            if (!result.contains(h.name)) result[py::str(h.name)] = py::cast(h);
    };
    add(s.handles.bodies);
    add(s.handles.watches);
    add(s.handles.constraints);
    add(s.handles.contacts);
    add(s.handles.couplings);
    add(s.handles.loads);
    return result;
}

std::vector<py::object> parameters_of(const BoundScene& s) {
    std::vector<py::object> result;
    for (const rbdyn::Parameter& p : rbdyn::text_and_parameters(s.scene).second) result.push_back(parameter_object(p));
    return result;
}

py::tuple handles_state(const Handles& handles) {
    return py::make_tuple(data_of(handles.bodies), data_of(handles.loads), data_of(handles.couplings),
                          data_of(handles.watches), data_of(handles.constraints), data_of(handles.contacts));
}

Handles handles_from_state(const py::tuple& state, const rbdyn::Scene& scene) {
    if (state.size() != 6) throw InvalidInput("Scene: its data have no handles of six kinds");
    return {handles_from<BodyHandle>(state[0], Handle::Of::body, scene.bodies().size()),
            handles_from<LoadHandle>(state[1], Handle::Of::load, scene.loads().size()),
            handles_from<CouplingHandle>(state[2], Handle::Of::coupling, scene.connections().size()),
            handles_from<WatchHandle>(state[3], Handle::Of::watch, scene.watches().size()),
            handles_from<ConstraintHandle>(state[4], Handle::Of::constraint, scene.constraints().size()),
            handles_from<ContactHandle>(state[5], Handle::Of::contact, scene.contacts().size())};
}

rbdyn::Scene as_data(const BoundScene& s, py::list* imported) {
    rbdyn::Scene data = s.scene;
    for (int i = 0; i < static_cast<int>(s.scene.watches().size()); ++i) {
        const auto& watch = s.scene.watches()[static_cast<std::size_t>(i)];
        const auto action = called_action(watch.options.action);
        if (!action) continue;
        const auto is_found = [&](bool in_program) {
            return imported != nullptr &&
                   py::module_::import("rbdyn.imported").attr("can_be")(*action, in_program).cast<bool>();
        };
        const auto import = [&] {
            imported->append(py::make_tuple(i, *action));
            data.act({i}, {});
        };
        // what a module has is itself, elsewhere too; what is recorded is no longer a function of Python's; what the
        // program has is found by its own processes
        std::string reason;
        if (is_found(false))
            import();
        else if (auto recorded = recorded_action(*action, s, watch.name, reason))
            data.act({i}, {rbdyn::WatchAction::Kind::change, *std::move(recorded)});
        else if (is_found(true))
            import();
        else
            throw InvalidInput("the action of watch \"" + watch.name + "\" is a function that is called back (" +
                               reason +
                               "), and only what is recorded can be saved or pickled, or, to be pickled, what is "
                               "imported from a module");
    }
    return data;
}

py::tuple scene_state(const BoundScene& s) {
    try {
        py::list imported;
        const auto [text, parameters] = rbdyn::text_and_parameters(as_data(s, &imported));
        // as objects: what is pickled with them keeps them
        py::list objects;
        for (const rbdyn::Parameter& p : parameters) objects.append(parameter_object(p));
        if (imported.empty()) return py::make_tuple(text, objects, handles_state(s.handles));
        return py::make_tuple(text, objects, handles_state(s.handles), imported);
    } catch (const InvalidInput& e) {
        // as everything that cannot be pickled
        throw py::type_error(e.what());
    }
}

BoundScene scene_from_state(const py::tuple& state) {
    if (state.size() != 3 && state.size() != 4) throw InvalidInput("Scene: its data are not those of a scene");
    const auto text = state[0].cast<std::string>();
    const auto parameters = state[1].cast<std::vector<rbdyn::Parameter>>();
    rbdyn::Scene scene = unlocked([&] { return rbdyn::scene_from(text, "scene", parameters); });
    Handles handles = handles_from_state(state[2].cast<py::tuple>(), scene);
    BoundScene result{std::move(scene), std::move(handles)};
    if (state.size() == 3) return result;
    for (const py::handle item : state[3].cast<py::list>()) {
        const auto [index, action] = item.cast<std::pair<int, py::object>>();
        if (index < 0 || index >= static_cast<int>(result.scene.watches().size()))
            throw InvalidInput("Scene: its data have an action of a watch that it has not");
        const std::string name = result.scene.watches()[static_cast<std::size_t>(index)].name;
        result.scene.act({index}, action_of(action, result, name));
    }
    return result;
}

void bind_files(py::module_& m) {
    m.def(
        "_scene_text", [](const BoundScene& s) { return rbdyn::text_of(as_data(s, nullptr)); }, py::arg("scene"));
    m.def(
        "_scene_from",
        [](const std::string& text, const std::string& document) {
            return unlocked([&] { return bound(rbdyn::scene_from(text, document)); });
        },
        py::arg("text"), py::arg("document"));
    m.def("_scene_schema", &rbdyn::scene_schema);
    // why it was not written; a pipe may keep it waiting for one who reads
    m.def(
        "_trouble_writing",
        [](const py::bytes& path, const py::bytes& content) {
            const std::string place = path;
            const std::string_view text = content;
            const py::gil_scoped_release others;
            return rbdyn::file::trouble_writing(place, text);
        },
        py::arg("path"), py::arg("content"));
}

}  // namespace binding
