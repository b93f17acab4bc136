// Definitions of rbdyn/file/schema.hpp.
#pragma once

#include "rbdyn/file/schema.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <tuple>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "rbdyn/file/described.hpp"
#include "rbdyn/file/place.hpp"
#include "rbdyn/file/start.hpp"
#include "rbdyn/file/values.hpp"
#include "rbdyn/scene/scene.hpp"

namespace rbdyn::inline RBDYN_FORM::file::schemas {

/// What is said once and referred to.
struct Definitions {
    Json all = Json::object();

    template <class F>
    Json once(std::string name, F&& make) {
        std::replace(name.begin(), name.end(), ' ', '_');
        if (!all.contains(name)) {
            all[name] = nullptr;  // what refers to itself ends
            Json made = make();
            all[name] = std::move(made);
        }
        return {{"$ref", "#/$defs/" + name}};
    }
};

RBDYN_INLINE Json any_of(std::vector<Json> kinds) { return {{"anyOf", std::move(kinds)}}; }
RBDYN_INLINE Json list_of(Json item) { return {{"type", "array"}, {"items", std::move(item)}}; }
RBDYN_INLINE Json list_of(Json item, std::size_t size) {
    return {{"type", "array"}, {"items", std::move(item)}, {"minItems", size}, {"maxItems", size}};
}
RBDYN_INLINE Json object_of(Json properties, std::vector<std::string> needed) {
    Json object = {{"type", "object"}, {"properties", std::move(properties)}};
    if (!needed.empty()) object["required"] = std::move(needed);
    object["additionalProperties"] = false;
    return object;
}
RBDYN_INLINE Json word(std::string_view text) { return {{"const", std::string(text)}}; }
RBDYN_INLINE Json whole() { return {{"type", "integer"}, {"minimum", 0}}; }
RBDYN_INLINE Json lines_like(const char* pattern) { return list_of({{"type", "string"}, {"pattern", pattern}}); }

// --- one overload a kind of type, as put() and take() have them ---

RBDYN_INLINE Json of(Tag<double>, Definitions& d) {
    return d.once("number", [] { return any_of({{{"type", "number"}}, {{"enum", {"inf", "-inf", "nan"}}}}); });
}
RBDYN_INLINE Json of(Tag<bool>, Definitions&) { return {{"type", "boolean"}}; }
RBDYN_INLINE Json of(Tag<std::string>, Definitions&) { return {{"type", "string"}}; }
RBDYN_INLINE Json of(Tag<int>, Definitions& d) {
    return d.once("name of a body", [] { return Json{{"type", "string"}}; });
}
RBDYN_INLINE Json of(Tag<DoubleDouble>, Definitions& d) {
    const Json number = of(Tag<double>(), d);
    return d.once("number of 32 digits", [&] { return any_of({number, list_of(number, 2)}); });
}
RBDYN_INLINE Json of(Tag<Given>, Definitions& d) {
    const Json number = of(Tag<double>(), d);
    return d.once("number or parameter", [&] {
        return any_of({number, object_of({{"parameter", whole()}}, {"parameter"})});
    });
}
RBDYN_INLINE Json of(Tag<Function>, Definitions& d) {
    return d.once("function", [] {
        return object_of(
            {{"inputs", whole()}, {"operations", lines_like("^n[0-9]+ = ")}, {"results", lines_like("^n[0-9]+$")}},
            {"inputs", "operations", "results"});
    });
}
RBDYN_INLINE Json of(Tag<Domain>, Definitions& d) { return list_of(of(Tag<double>(), d), 2); }
RBDYN_INLINE Json of(Tag<Vector3>, Definitions& d) { return list_of(of(Tag<double>(), d), 3); }
RBDYN_INLINE Json of(Tag<Vector3Of<DoubleDouble>>, Definitions& d) { return list_of(of(Tag<DoubleDouble>(), d), 3); }
RBDYN_INLINE Json of(Tag<Matrix3Of<DoubleDouble>>, Definitions& d) {
    return list_of(of(Tag<Vector3Of<DoubleDouble>>(), d), 3);
}
RBDYN_INLINE Json of(Tag<TimeFunction>, Definitions& d) {
    return any_of({of(Tag<double>(), d), of(Tag<Function>(), d)});
}
RBDYN_INLINE Json of(Tag<RigidMotion>, Definitions& d) { return of(Tag<Function>(), d); }
RBDYN_INLINE Json of(Tag<Attitude>, Definitions& d);
RBDYN_INLINE Json of(Tag<Curve>, Definitions& d);
RBDYN_INLINE Json of(Tag<End>, Definitions& d) {
    Json end = object_of({{"body", of(Tag<int>(), d)}, {"point", of(Tag<Vector3>(), d)}}, {});
    end["minProperties"] = 1;
    return end;
}
RBDYN_INLINE Json of(Tag<WatchFunction>, Definitions& d);
template <class T>
requires std::is_enum_v<T> Json of(Tag<T>, Definitions&) {
    Json words = Json::array();
    for (const std::string_view one : WordsOf<T>::words) words.push_back(std::string(one));
    return {{"enum", std::move(words)}};
}
template <class T>
requires requires { Described<T>::kind; }
Json of(Tag<T>, Definitions& d);
template <class... Kinds>
Json of(Tag<std::variant<Kinds...>>, Definitions& d);
template <class T>
Json of(Tag<std::optional<T>>, Definitions& d) {
    return of(Tag<T>(), d);
}
template <class T, std::size_t count>
Json of(Tag<std::array<T, count>>, Definitions& d) {
    return list_of(of(Tag<T>(), d), count);
}
template <class T>
Json of(Tag<std::vector<T>>, Definitions& d) {
    return list_of(of(Tag<T>(), d));
}
template <class T>
Json of(Tag<std::map<int, T>>, Definitions& d) {
    return {
        {"type", "object"}, {"patternProperties", {{"^[0-9]+$", of(Tag<T>(), d)}}}, {"additionalProperties", false}};
}

/// The fields of a class behind those that are there.
template <class T>
Json with_fields(Json properties, std::vector<std::string> needed, Definitions& d) {
    std::apply(
        [&](const auto&... field) {
            [[maybe_unused]] const auto add = [&](const auto& f) {
                using Value = std::decay_t<decltype(std::declval<T&>().*(f.member))>;
                properties[std::string(f.key)] = of(Tag<Value>(), d);
                if (f.is_needed) needed.emplace_back(f.key);
            };
            (add(field), ...);
        },
        Described<T>::fields);
    return object_of(std::move(properties), std::move(needed));
}
template <class T>
using PartsOf = decltype(parts_of(std::declval<const T&>()));

template <class T>
requires requires { Described<T>::kind; }
Json of(Tag<T>, Definitions& d) {
    return d.once(std::string(Described<T>::kind), [&] { return with_fields<PartsOf<T>>(Json::object(), {}, d); });
}

/// One of several kinds, in an object that has these fields besides.
template <class... Kinds>
Json beside(Tag<std::variant<Kinds...>>, Definitions& d, const Json& others, const std::vector<std::string>& needed) {
    Json all = Json::array();
    const auto add = [&]<class Kind>(Tag<Kind>) {
        Json properties = {{"kind", word(Described<Kind>::kind)}};
        properties.update(others);
        std::vector<std::string> required = {"kind"};
        required.insert(required.end(), needed.begin(), needed.end());
        all.push_back(with_fields<PartsOf<Kind>>(std::move(properties), std::move(required), d));
    };
    (add(Tag<Kinds>()), ...);
    return {{"oneOf", std::move(all)}};
}
template <class... Kinds>
Json of(Tag<std::variant<Kinds...>> tag, Definitions& d) {
    return beside(tag, d, Json::object(), {});
}

RBDYN_INLINE Json of(Tag<Attitude>, Definitions& d) {
    return any_of({list_of(of(Tag<DoubleDouble>(), d), 4), of(Tag<EulerAngles>(), d)});
}
RBDYN_INLINE Json of(Tag<Curve>, Definitions& d) {
    return d.once("any curve", [&] { return of(Tag<CurveKinds::Kind>(), d); });
}
RBDYN_INLINE Json asked(Definitions& d) {
    return d.once("asked for", [&] {
        return object_of({{"quantity", of(Tag<Quantity>(), d)},
                          {"body", of(Tag<int>(), d)},
                          {"coupling", whole()},
                          {"component", whole()}},
                         {"quantity"});
    });
}
RBDYN_INLINE Json of(Tag<WatchFunction>, Definitions& d) {
    return d.once("watched function", [&] {
        return object_of({{"asks", list_of(asked(d))}, {"function", of(Tag<Function>(), d)}}, {"asks", "function"});
    });
}

RBDYN_INLINE Json scene(Definitions& d) {
    const Json text = of(Tag<std::string>(), d), number = of(Tag<double>(), d), body = of(Tag<int>(), d),
               end = of(Tag<End>(), d), vector = of(Tag<Vector3>(), d), watched = of(Tag<WatchFunction>(), d);
    const Json parameter = object_of({{"name", text}, {"value", number}}, {"name", "value"});
    const Json placed = object_of({{"name", text},
                                   {"body", of(Tag<AnyBody>(), d)},
                                   {"joint", of(Tag<Joint>(), d)},
                                   {"parent", body},
                                   {"start", with_fields<Start>(Json::object(), {}, d)}},
                                  {"name", "body", "joint"});
    const Json constraint =
        object_of({{"name", text}, {"constraint", of(Tag<Constraint>(), d)}, {"a", end}, {"b", end}},
                  {"name", "constraint", "a"});
    const Json contact = object_of({{"name", text},
                                    {"a", of(Tag<ContactPart>(), d)},
                                    {"b", of(Tag<ContactSurface>(), d)},
                                    {"friction", of(Tag<Coulomb>(), d)},
                                    {"restitution", number},
                                    {"gone", of(Tag<bool>(), d)}},
                                   {"name", "a", "b", "restitution"});
    const Json changed = object_of({{"body", body}, {"word", text}}, {"body", "word"});
    const Json action =
        object_of({{"changes", list_of(changed)}, {"asks", list_of(asked(d))}, {"function", of(Tag<Function>(), d)}},
                  {"changes", "asks", "function"});
    const Json watch = object_of({{"name", text},
                                  {"function", watched},
                                  {"direction", of(Tag<Direction>(), d)},
                                  {"action", any_of({{{"enum", {"record", "stop"}}}, action})}},
                                 {"name", "function", "direction", "action"});
    return object_of({{"$schema", text},
                      {"format", word(scene_format)},
                      {"version", {{"const", scene_version}}},
                      {"gravity", vector},
                      {"parameters", list_of(parameter)},
                      {"bodies", list_of(placed)},
                      {"loads", list_of(beside(Tag<Load>(), d, {{"on", body}, {"at", vector}}, {"on"}))},
                      {"couplings", list_of(beside(Tag<Coupling>(), d, {{"a", end}, {"b", end}}, {"a", "b"}))},
                      {"constraints", list_of(constraint)},
                      {"contacts", list_of(contact)},
                      {"watches", list_of(watch)},
                      {"integrals", list_of(object_of({{"name", text}, {"function", watched}}, {"name", "function"}))}},
                     {"format", "version", "gravity"});
}

}  // namespace rbdyn::inline RBDYN_FORM::file::schemas

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE std::string scene_schema() {
    using file::Json;
    file::schemas::Definitions definitions;
    const Json scene = file::schemas::scene(definitions);
    Json whole = {{"$schema", "https://json-schema.org/draft/2020-12/schema"}, {"title", "rbdyn scene"}};
    whole.update(scene);
    whole["$defs"] = std::move(definitions.all);
    return file::printed(whole);
}

}  // namespace rbdyn::inline RBDYN_FORM
