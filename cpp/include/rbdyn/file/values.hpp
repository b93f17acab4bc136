// How values of each type stand in a file: written by put(), read by take<T>(), and checked on the way.
//
// A class that describes itself (Described, described.hpp) is an object with a field for each of its numbers; a variant
// is an object whose "kind" says which of its classes it is. Fields that are what they are by default are left out.
#pragma once

#include <array>
#include <charconv>
#include <cmath>
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

#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/double_double_vector.hpp"
#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/expression/function.hpp"
#include "rbdyn/expression/given.hpp"
#include "rbdyn/file/functions.hpp"
#include "rbdyn/file/place.hpp"

namespace rbdyn::inline RBDYN_FORM::file {

/// A field of a class: its name in files, where it is in the class, and whether it must be there.
template <class C, class T>
struct Field {
    std::string_view key;
    T C::*member;
    bool is_needed;
};
template <class C, class T>
constexpr Field<C, T> need(std::string_view key, T C::*member) {
    return {key, member, true};
}
/// One that is left out where it is as usually<T>().
template <class C, class T>
constexpr Field<C, T> usual(std::string_view key, T C::*member) {
    return {key, member, false};
}

/// What a field is that is left out.
template <class T>
T usually() {
    if constexpr (std::is_same_v<T, Vector3>)
        return Vector3::Zero();
    else
        return T{};
}

/// What a class is in files: its `kind` and its `fields`. One whose numbers are its own has `Parts` that have them,
/// parts(const T&) and T made(Parts).
template <class T>
struct Described;
/// The words of an enumeration, in its order.
template <class T>
struct WordsOf;

template <class T>
struct Tag {};

// --- one overload of put and take a kind of type ---

inline Json put(double x, Writing&) {
    if (std::isfinite(x)) return x;
    return std::isnan(x) ? "nan" : x > 0.0 ? "inf" : "-inf";
}
inline Json put(bool x, Writing&) { return x; }
inline Json put(const std::string& x, Writing&) { return x; }
inline Json put(const DoubleDouble& x, Writing& w) {
    if (x.lo == 0.0) return put(x.hi, w);
    return Json::array({put(x.hi, w), put(x.lo, w)});
}
inline Json put(const Given& x, Writing& w) {
    if (!x.varies()) return put(x.now(), w);
    return {{"parameter", w.index_of(x.parameter(), x.now())}};
}
inline Json put(const Function& f, Writing& w) { return f ? function_to(f, w) : Json(nullptr); }
template <class T>
requires std::is_enum_v<T> Json put(T x, Writing&) {
    return std::string(WordsOf<T>::words[static_cast<std::size_t>(x)]);
}
template <class T>
requires requires { Described<T>::kind; }
Json put(const T& x, Writing& w);
template <class... Kinds>
Json put(const std::variant<Kinds...>& x, Writing& w);
template <class T>
Json put(const std::optional<T>& x, Writing& w) {
    return x ? put(*x, w) : Json(nullptr);
}
inline Json put(const Vector3& v, Writing& w) { return Json::array({put(v[0], w), put(v[1], w), put(v[2], w)}); }
inline Json put(const Vector3Of<DoubleDouble>& v, Writing& w) {
    return Json::array({put(v[0], w), put(v[1], w), put(v[2], w)});
}
inline Json put(const Matrix3Of<DoubleDouble>& m, Writing& w) {
    Json rows = Json::array();
    for (int i = 0; i < 3; ++i) rows.push_back(Json::array({put(m(i, 0), w), put(m(i, 1), w), put(m(i, 2), w)}));
    return rows;
}
template <class T, std::size_t count>
Json put(const std::array<T, count>& all, Writing& w) {
    Json list = Json::array();
    for (const T& x : all) list.push_back(put(x, w));
    return list;
}
template <class T>
Json put(const std::vector<T>& all, Writing& w) {
    Json list = Json::array();
    for (const T& x : all) list.push_back(put(x, w));
    return list;
}
template <class T>
Json put(const std::map<int, T>& all, Writing& w) {
    Json object = Json::object();
    for (const auto& [key, x] : all) object[std::to_string(key)] = put(x, w);
    return object;
}

inline double take(const Place& p, Tag<double>) { return p.number(); }
inline bool take(const Place& p, Tag<bool>) { return p.flag(); }
inline std::string take(const Place& p, Tag<std::string>) { return p.text(); }
inline DoubleDouble take(const Place& p, Tag<DoubleDouble>) {
    if (!p.value().is_array()) return p.number();
    p.require_size(2);
    return {p.at(0).number(), p.at(1).number()};
}
inline Given take(const Place& p, Tag<Given>) {
    if (!p.value().is_object()) return p.number();
    p.require_known({"parameter"});
    const auto& all = p.reading().parameters;
    return all[static_cast<std::size_t>(p.at("parameter").integer(0, static_cast<long>(all.size()) - 1))];
}
inline Function take(const Place& p, Tag<Function>) { return function_from(p); }
template <class T>
requires std::is_enum_v<T> T take(const Place& p, Tag<T>) {
    const auto& words = WordsOf<T>::words;
    std::string list;
    for (std::size_t i = 0; i < words.size(); ++i) {
        if (p.value().is_string() && p.text() == words[i]) return static_cast<T>(i);
        list += (list.empty() ? "\"" : ", \"") + std::string(words[i]) + "\"";
    }
    p.refuse("it is one of " + list);
}
template <class T>
requires requires { Described<T>::kind; }
T take(const Place& p, Tag<T>);
template <class... Kinds>
std::variant<Kinds...> take(const Place& p, Tag<std::variant<Kinds...>>);
template <class T>
std::optional<T> take(const Place& p, Tag<std::optional<T>>) {
    if (p.value().is_null()) return std::nullopt;
    return take(p, Tag<T>());
}
template <class V, class T = std::decay_t<decltype(std::declval<V>()[0])>>
requires std::is_same_v<V, Vector3> || std::is_same_v<V, Vector3Of<DoubleDouble>> V take(const Place& p, Tag<V>) {
    p.require_size(3);
    V v;
    for (int i = 0; i < 3; ++i) v[i] = take(p.at(static_cast<std::size_t>(i)), Tag<T>());
    return v;
}
inline Matrix3Of<DoubleDouble> take(const Place& p, Tag<Matrix3Of<DoubleDouble>>) {
    p.require_size(3);
    Matrix3Of<DoubleDouble> m;
    for (int i = 0; i < 3; ++i) {
        const auto row = take(p.at(static_cast<std::size_t>(i)), Tag<Vector3Of<DoubleDouble>>());
        for (int j = 0; j < 3; ++j) m(i, j) = row[j];
    }
    return m;
}
template <class T, std::size_t count>
std::array<T, count> take(const Place& p, Tag<std::array<T, count>>) {
    p.require_size(count);
    std::array<T, count> all;
    for (std::size_t i = 0; i < count; ++i) all[i] = take(p.at(i), Tag<T>());
    return all;
}
template <class T>
std::vector<T> take(const Place& p, Tag<std::vector<T>>) {
    std::vector<T> all;
    for (std::size_t i = 0; i < p.size(); ++i) all.push_back(take(p.at(i), Tag<T>()));
    return all;
}
template <class T>
std::map<int, T> take(const Place& p, Tag<std::map<int, T>>) {
    if (!p.value().is_object()) p.refuse("it is an object, of values by whole numbers");
    std::map<int, T> all;
    for (const auto& [key, value] : p.value().items()) {
        int index = 0;
        const char* end = key.data() + key.size();
        if (std::from_chars(key.data(), end, index).ptr != end || key.empty()) p.refuse("its names are whole numbers");
        all.emplace(index, take(Place(value, p.path() + "." + key, p.reading()), Tag<T>()));
    }
    return all;
}

/// Adds the fields of a class to an object, after what is there.
template <class T>
void put_fields(Json& object, const T& x, Writing& w) {
    std::apply(
        [&](const auto&... field) {
            [[maybe_unused]] const auto put_one = [&](const auto& f) {
                Json value = put(x.*(f.member), w);
                // by its text, which tells 0 from -0
                using Value = std::decay_t<decltype(x.*(f.member))>;
                if (!f.is_needed && value.dump() == put(usually<Value>(), w).dump()) return;
                object[std::string(f.key)] = std::move(value);
            };
            (put_one(field), ...);
        },
        Described<T>::fields);
}

/// And reads them; `others`: what else the object may have.
template <class T>
T take_fields(const Place& p, std::vector<std::string_view> others = {}) {
    T x{};
    std::apply(
        [&](const auto&... field) {
            others.insert(others.end(), {field.key...});
            p.require_known(others);
            [[maybe_unused]] const auto take_one = [&](const auto& f) {
                using Value = std::decay_t<decltype(x.*(f.member))>;
                if (f.is_needed)
                    x.*(f.member) = take(p.at(f.key), Tag<Value>());
                else if (const auto found = p.find(f.key))
                    x.*(f.member) = take(*found, Tag<Value>());
            };
            (take_one(field), ...);
        },
        Described<T>::fields);
    return x;
}

/// What a class is made of in files.
template <class T>
auto parts_of(const T& x) {
    if constexpr (requires { Described<T>::parts(x); })
        return Described<T>::parts(x);
    else
        return x;
}
template <class T>
T whole_from(const Place& p, std::vector<std::string_view> others = {}) {
    using Parts = decltype(parts_of(std::declval<const T&>()));
    auto parts = take_fields<Parts>(p, std::move(others));
    if constexpr (std::is_same_v<Parts, T>)
        return parts;
    else
        return p.located([&] { return Described<T>::made(std::move(parts)); });
}

template <class T>
requires requires { Described<T>::kind; }
Json put(const T& x, Writing& w) {
    Json object = Json::object();
    put_fields(object, parts_of(x), w);
    return object;
}
template <class T>
requires requires { Described<T>::kind; }
T take(const Place& p, Tag<T>) { return whole_from<T>(p); }

template <class... Kinds>
Json put(const std::variant<Kinds...>& x, Writing& w) {
    return std::visit(
        [&](const auto& one) {
            Json object = {{"kind", std::string(Described<std::decay_t<decltype(one)>>::kind)}};
            put_fields(object, parts_of(one), w);
            return object;
        },
        x);
}
/// One of several kinds, in an object that may have other fields, too.
template <class... Kinds>
std::variant<Kinds...> take_beside(const Place& p, Tag<std::variant<Kinds...>>, std::vector<std::string_view> others) {
    const Place kind = p.at("kind");
    others.emplace_back("kind");
    std::optional<std::variant<Kinds...>> found;
    const auto try_one = [&]<class Kind>(Tag<Kind>) {
        if (!found && kind.text() == Described<Kind>::kind) found = whole_from<Kind>(p, others);
    };
    (try_one(Tag<Kinds>()), ...);
    if (found) return *std::move(found);
    std::string list;
    ((list += (list.empty() ? "\"" : ", \"") + std::string(Described<Kinds>::kind) + "\""), ...);
    kind.refuse("it is one of " + list);
}
template <class... Kinds>
std::variant<Kinds...> take(const Place& p, Tag<std::variant<Kinds...>> tag) {
    return take_beside(p, tag, {});
}

}  // namespace rbdyn::inline RBDYN_FORM::file
