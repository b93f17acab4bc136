// Definitions of rbdyn/file/scene_file.hpp.
#pragma once

#include "rbdyn/file/scene_file.hpp"

#include <array>
#include <cmath>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/error.hpp"
#include "rbdyn/basics/interruption.hpp"
#include "rbdyn/file/described.hpp"
#include "rbdyn/file/disk.hpp"
#include "rbdyn/file/place.hpp"
#include "rbdyn/file/start.hpp"
#include "rbdyn/file/values.hpp"
#include "rbdyn/scene/scene.hpp"

namespace rbdyn::inline RBDYN_FORM::file {

/// The words of a body's joint, and what a scene has of it as them and back.
struct Starting {
    using Names = std::vector<std::string_view>;

    static std::vector<double> list(const Vector3& v) { return {v[0], v[1], v[2]}; }
    static Vector3 vector(const std::vector<double>& v) {
        return v.empty() ? Vector3::Zero() : Vector3(v[0], v[1], v[2]);
    }
    static std::array<double, 2> pair(const std::vector<double>& v) {
        return v.empty() ? std::array<double, 2>{} : std::array<double, 2>{v[0], v[1]};
    }

    static Names words(const Particle&, const Free&) { return {"position", "velocity"}; }
    static Names words(const Particle&, const Rail&) { return {"parameter", "speed"}; }
    static Names words(const RigidBody&, const Free&) {
        return {"position", "velocity", "attitude", "angular_velocity", "angular_velocity_world"};
    }
    static Names words(const RigidBody&, const Spherical&) {
        return {"attitude", "angular_velocity", "angular_velocity_world"};
    }
    static Names words(const RigidBody&, const Revolute&) { return {"angle", "rate"}; }
    static Names words(const RigidBody&, const Prismatic&) { return {"displacement", "rate"}; }
    static Names words(const RigidBody&, const Universal&) { return {"angles", "rates"}; }
    static Names words(const RigidBody&, const Cylindrical&) {
        return {"angle", "rate", "displacement", "displacement_rate"};
    }
    static Names words(const RigidBody&, const Planar&) { return {"position", "velocity", "angle", "rate"}; }
    static Names words(const RigidBody&, const Fixed&) { return {}; }

    static Start of(const Scene::Body& b) {
        Start s;
        const auto& q = b.coordinates;
        const auto& v = b.rates;
        if (std::holds_alternative<Free>(b.joint)) {
            s.position = list(b.position);
            s.velocity = list(b.velocity);
        } else if (b.rail() != nullptr) {
            s.parameter = {b.parameter, b.parameter_rest};
            s.speed = b.speed;
        } else if (std::holds_alternative<Revolute>(b.joint)) {
            s.angle = b.parameter;
            s.rate = b.speed;
        } else if (std::holds_alternative<Prismatic>(b.joint)) {
            s.displacement = b.parameter;
            s.rate = b.speed;
        } else if (std::holds_alternative<Universal>(b.joint)) {
            s.angles = {q[0], q[1]};
            s.rates = {v[0], v[1]};
        } else if (std::holds_alternative<Cylindrical>(b.joint)) {
            s.angle = q[0];
            s.displacement = q[1];
            s.rate = v[0];
            s.displacement_rate = v[1];
        } else if (std::holds_alternative<Planar>(b.joint)) {
            s.position = {q[0], q[1]};
            s.velocity = {v[0], v[1]};
            s.angle = q[2];
            s.rate = v[2];
        }
        if (!std::holds_alternative<Fixed>(b.joint)) {
            s.attitude = b.attitude;
            s.angular_velocity = b.angular_velocity;
            if (b.angular_velocity_world) s.angular_velocity_world = list(*b.angular_velocity_world);
        }
        return s;
    }

    static FreeStart as(const Start& s, const Particle&, const Free&) {
        return {vector(s.position), vector(s.velocity)};
    }
    static RailStart as(const Start& s, const Particle&, const Rail&) {
        return {.parameter = s.parameter.hi, .speed = s.speed};
    }
    static BodyStart as(const Start& s, const RigidBody&, const Free&) {
        return {vector(s.position), vector(s.velocity)};
    }
    static SphericalStart as(const Start&, const RigidBody&, const Spherical&) { return {}; }
    static RevoluteStart as(const Start& s, const RigidBody&, const Revolute&) { return {s.angle, s.rate}; }
    static PrismaticStart as(const Start& s, const RigidBody&, const Prismatic&) { return {s.displacement, s.rate}; }
    static UniversalStart as(const Start& s, const RigidBody&, const Universal&) { return {s.angles, s.rates}; }
    static CylindricalStart as(const Start& s, const RigidBody&, const Cylindrical&) {
        return {s.angle, s.rate, s.displacement, s.displacement_rate};
    }
    static PlanarStart as(const Start& s, const RigidBody&, const Planar&) {
        return {pair(s.position), pair(s.velocity), s.angle, s.rate};
    }
    static FixedStart as(const Start&, const RigidBody&, const Fixed&) { return {}; }
};

RBDYN_INLINE Json body_to(const Scene::Body& b, Writing& w) {
    Json start = Json::object();
    put_fields(start, Starting::of(b), w);
    Json object = {{"name", b.name}, {"body", put(AnyBody(b.body), w)}, {"joint", put(b.joint, w)}};
    if (b.parent >= 0) object["parent"] = put(b.parent, w);
    if (!start.empty()) object["start"] = std::move(start);
    return object;
}

/// The start of a body, of which the words are known.
RBDYN_INLINE Start start_from(const Place& p, const Starting::Names& words, std::size_t dimension) {
    p.require_known(words);
    const auto start = take_fields<Start>(p);
    for (const auto& [key, list] : {std::pair("position", &start.position), std::pair("velocity", &start.velocity)})
        if (!list->empty() || p.find(key)) p.at(key).require_size(dimension);
    if (const auto world = p.find("angular_velocity_world")) world->require_size(3);
    return start;
}

RBDYN_INLINE void add_body(Scene& scene, const Place& p) {
    p.require_known({"name", "body", "joint", "parent", "start"});
    const std::string& name = p.at("name").text();
    const auto body = take(p.at("body"), Tag<AnyBody>());
    const auto joint = take(p.at("joint"), Tag<Joint>());
    BodyHandle parent;
    if (const auto place = p.find("parent")) parent.index = take(*place, Tag<int>());
    p.located([&] {
        std::visit(
            [&](const auto& one, const auto& held) {
                if constexpr (requires { Starting::words(one, held); }) {
                    const std::size_t dimension = std::holds_alternative<Planar>(joint) ? 2 : 3;
                    const auto at = p.find("start");
                    const Start start = at ? start_from(*at, Starting::words(one, held), dimension) : Start{};
                    auto given = Starting::as(start, one, held);
                    given.parent = parent;
                    const BodyHandle added = scene.add(one, held, given, name);
                    if (!std::holds_alternative<Fixed>(joint)) {
                        for (int i = 0; i < 3; ++i)
                            require(std::isfinite(start.angular_velocity[i].hi) &&
                                        std::isfinite(start.angular_velocity[i].lo),
                                    name, "angular_velocity", start.angular_velocity[i].hi, "it is finite, in rad/s");
                        std::optional<Vector3> world;
                        if (!start.angular_velocity_world.empty())
                            world = Starting::vector(start.angular_velocity_world);
                        scene.start_turning(added, start.attitude, start.angular_velocity, world);
                    }
                    require(std::abs(start.parameter.lo) <= 1e-15 * std::abs(start.parameter.hi), name,
                            "rest of the parameter", start.parameter.lo,
                            "it is what the parameter is short of 32 digits");
                    scene.start_beyond(added, start.parameter.lo);
                } else {
                    throw InvalidInput("a particle has the joints free and rail, a rigid body all but rail");
                }
            },
            body, joint);
    });
    p.reading().bodies.push_back(name);
}

RBDYN_INLINE Json scene_to(const Scene& scene, Writing& w) {
    for (const Scene::Body& b : scene.bodies()) w.bodies.push_back(b.name);
    Json lists = Json::object();
    const auto add = [&](const char* key, Json one) { lists[key].push_back(std::move(one)); };
    for (const Scene::Body& b : scene.bodies()) add("bodies", body_to(b, w));
    for (const Scene::AppliedLoad& l : scene.loads()) {
        Json one = put(l.load, w);
        one["on"] = put(l.body, w);
        if (l.at) one["at"] = put(*l.at, w);
        add("loads", std::move(one));
    }
    const auto joined = [&](Json one, const End& a, const End& b) {
        one["a"] = put(a, w);
        one["b"] = put(b, w);
        return one;
    };
    for (const Scene::Connection& c : scene.connections()) add("couplings", joined(put(c.coupling, w), c.a, c.b));
    for (const Scene::Held& c : scene.constraints()) {
        Json one = {{"name", c.name}, {"constraint", put(c.constraint, w)}, {"a", put(c.a, w)}};
        // without it the world itself
        if (!(c.b == End(BodyHandle{}))) one["b"] = put(c.b, w);
        add("constraints", std::move(one));
    }
    for (const Scene::Touch& c : scene.contacts()) {
        Json one = {{"name", c.name}, {"a", put(c.a, w)}, {"b", put(c.b, w)}};
        if (c.options.friction) one["friction"] = put(*c.options.friction, w);
        one["restitution"] = put(c.options.restitution, w);
        if (c.is_gone) one["gone"] = true;
        add("contacts", std::move(one));
    }
    for (const Scene::Watch& watch : scene.watches()) {
        const RecordedAction* action = w.has_actions ? recorded(watch.options.action) : nullptr;
        if (w.has_actions && watch.options.action.change && action == nullptr)
            throw InvalidInput("the action of watch \"" + watch.name +
                               "\" is a function that is called back, and only what is recorded can be saved or "
                               "pickled; \"record\" and \"stop\" can");
        add("watches", {{"name", watch.name},
                        {"function", put(watch.function, w)},
                        {"direction", put(watch.options.direction, w)},
                        {"action", action != nullptr ? put(*action, w) : put(watch.options.action.kind, w)}});
    }
    for (const Scene::Integral& i : scene.integrals())
        add("integrals", {{"name", i.name}, {"function", put(i.function, w)}});
    Json json = {
        {"format", std::string(scene_format)}, {"version", scene_version}, {"gravity", put(scene.gravity(), w)}};
    for (std::size_t i = 0; i < w.parameters.cells.size(); ++i)
        json["parameters"].push_back({{"name", w.parameters.cells[i].name()}, {"value", w.parameters.values[i]}});
    for (auto& [key, list] : lists.items()) json[key] = std::move(list);
    return json;
}

/// f(place) of each element of a list, if there is one.
template <class F>
void for_each_in(const Place& whole, std::string_view key, const F& f) {
    const auto list = whole.find(key);
    if (!list) return;
    for (std::size_t i = 0; i < list->size(); ++i) {
        Interruption::point();
        const Place one = list->at(i);
        one.located([&] { f(one); });
    }
}

RBDYN_INLINE Scene scene_from(const Json& json, const std::string& document, const std::vector<Parameter>& parameters) {
    Reading reading{document};
    const Place whole(json, "", reading);
    if (const auto format = whole.find("format");
        !format || !format->value().is_string() || format->text() != scene_format)
        whole.complain("it is no scene: its \"format\" would be \"" + std::string(scene_format) + "\"");
    if (const Place version = whole.at("version"); version.integer(1, 1'000'000) != scene_version)
        version.refuse("this version of the library reads " + std::to_string(scene_version));
    whole.require_known({"$schema", "format", "version", "gravity", "parameters", "bodies", "loads", "couplings",
                         "constraints", "contacts", "watches", "integrals"});
    const Place gravity = whole.at("gravity");
    Scene scene = gravity.located([&] { return Scene(take(gravity, Tag<Vector3>())); });
    for_each_in(whole, "parameters", [&](const Place& p) {
        p.require_known({"name", "value"});
        reading.parameters.emplace_back(p.at("value").number(), p.at("name").text());
    });
    if (!parameters.empty() && parameters.size() != reading.parameters.size())
        whole.complain("it has " + std::to_string(reading.parameters.size()) + " parameters, and " +
                       std::to_string(parameters.size()) + " are given to take their place");
    if (!parameters.empty()) reading.parameters = parameters;
    for_each_in(whole, "bodies", [&](const Place& p) { add_body(scene, p); });
    const auto handle = [](const Place& p) { return BodyHandle{take(p, Tag<int>())}; };
    for_each_in(whole, "loads", [&](const Place& p) {
        std::optional<Vector3> at;
        if (const auto place = p.find("at")) at = take(*place, Tag<Vector3>());
        scene.apply(take_beside(p, Tag<Load>(), {"on", "at"}), handle(p.at("on")), at);
    });
    for_each_in(whole, "couplings", [&](const Place& p) {
        scene.connect(take_beside(p, Tag<Coupling>(), {"a", "b"}), take(p.at("a"), Tag<End>()),
                      take(p.at("b"), Tag<End>()));
    });
    for_each_in(whole, "constraints", [&](const Place& p) {
        p.require_known({"name", "constraint", "a", "b"});
        std::optional<End> b;
        if (const auto place = p.find("b")) b = take(*place, Tag<End>());
        scene.constrain(take(p.at("constraint"), Tag<Constraint>()), take(p.at("a"), Tag<End>()), b,
                        p.at("name").text());
    });
    for_each_in(whole, "contacts", [&](const Place& p) {
        p.require_known({"name", "a", "b", "friction", "restitution", "gone"});
        ContactOptions options;
        if (const auto place = p.find("friction")) options.friction = take(*place, Tag<Coulomb>());
        options.restitution = p.at("restitution").number();
        const auto contact = scene.contact(take(p.at("a"), Tag<ContactPart>()), take(p.at("b"), Tag<ContactSurface>()),
                                           options, p.at("name").text());
        if (const auto place = p.find("gone"); place && take(*place, Tag<bool>())) scene = scene.without(contact);
    });
    for_each_in(whole, "watches", [&](const Place& p) {
        p.require_known({"name", "function", "direction", "action"});
        WatchOptions options{take(p.at("direction"), Tag<Direction>())};
        if (const Place action = p.at("action"); action.value().is_object()) {
            RecordedAction change = take(action, Tag<RecordedAction>());
            for (const Observable& o : change.asked()) scene.require_observable(o, "action");
            options.action = {WatchAction::Kind::change, std::move(change)};
        } else {
            options.action.kind = take(action, Tag<WatchAction::Kind>());
            if (options.action.kind == WatchAction::Kind::change)
                action.refuse("what changes the state is an object, with what it changes and a function");
        }
        scene.watch(p.at("name").text(), take(p.at("function"), Tag<WatchFunction>()), options);
    });
    for_each_in(whole, "integrals", [&](const Place& p) {
        p.require_known({"name", "function"});
        scene.integral(p.at("name").text(), take(p.at("function"), Tag<WatchFunction>()));
    });
    return scene;
}

}  // namespace rbdyn::inline RBDYN_FORM::file

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE std::string text_of(const Scene& scene) { return text_and_parameters(scene).first; }

RBDYN_INLINE std::pair<std::string, std::vector<Parameter>> text_and_parameters(const Scene& scene) {
    file::Writing writing;
    std::string text = file::printed(file::scene_to(scene, writing));
    // of a run each number is what it was when that started
    std::vector<Parameter> parameters;
    for (std::size_t i = 0; i < writing.parameters.cells.size(); ++i) {
        const Parameter& p = writing.parameters.cells[i];
        const double value = writing.parameters.values[i];
        parameters.push_back(p.value() == value ? p : Parameter(value, p.name()));
    }
    return {std::move(text), std::move(parameters)};
}

RBDYN_INLINE std::string text_without_actions(const Scene& scene) {
    file::Writing writing;
    writing.has_actions = false;
    return file::printed(file::scene_to(scene, writing));
}

RBDYN_INLINE Scene scene_from(std::string_view text, const std::string& document,
                              const std::vector<Parameter>& parameters) {
    return file::scene_from(file::parsed(text, document), document, parameters);
}

RBDYN_INLINE void save(const Scene& scene, const std::string& path) { file::write_file(path, text_of(scene)); }

RBDYN_INLINE Scene load_scene(const std::string& path) { return scene_from(file::read_file(path), path); }

}  // namespace rbdyn::inline RBDYN_FORM
