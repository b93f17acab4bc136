// Definitions of rbdyn/file/described.hpp.
#pragma once

#include "rbdyn/file/described.hpp"

#include <algorithm>
#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "rbdyn/basics/error.hpp"
#include "rbdyn/expression/callback.hpp"

namespace rbdyn::inline RBDYN_FORM::file {

RBDYN_INLINE Json put(int body, Writing& w) { return w.bodies[static_cast<std::size_t>(body)]; }

RBDYN_INLINE int take(const Place& p, Tag<int>) {
    const std::vector<std::string>& all = p.reading().bodies;
    const auto found = std::find(all.begin(), all.end(), p.text());
    if (found == all.end()) p.refuse("it is the name of a body of this scene that stands before it");
    return static_cast<int>(found - all.begin());
}

RBDYN_INLINE Json put(const Domain& domain, Writing& w) {
    return Json::array({put(domain.begin, w), put(domain.end, w)});
}

RBDYN_INLINE Domain take(const Place& p, Tag<Domain>) {
    p.require_size(2);
    return {p.at(0).number(), p.at(1).number()};
}

RBDYN_INLINE Json put(const Attitude& attitude, Writing& w) {
    if (attitude.given_angles()) return put(*attitude.given_angles(), w);
    const Quaternion& q = attitude.quaternion();
    const QuaternionOf<DoubleDouble>& exact = attitude.exact();
    // four doubles if they say all of it
    if (const Attitude again(q); again == attitude && again.quaternion() == q)
        return put(std::array<double, 4>{q.w, q.x, q.y, q.z}, w);
    return put(std::array<DoubleDouble, 4>{exact.w, exact.x, exact.y, exact.z}, w);
}

RBDYN_INLINE Attitude take(const Place& p, Tag<Attitude>) {
    if (p.value().is_object()) {
        const auto angles = take(p, Tag<EulerAngles>());
        return p.located([&] { return Attitude(angles); });
    }
    const auto q = take(p, Tag<std::array<DoubleDouble, 4>>());
    const bool is_plain = std::all_of(q.begin(), q.end(), [](const DoubleDouble& x) { return x.lo == 0.0; });
    return p.located([&] {
        if (is_plain) return Attitude(Quaternion{q[0].hi, q[1].hi, q[2].hi, q[3].hi});
        return Attitude(QuaternionOf<DoubleDouble>{q[0], q[1], q[2], q[3]});
    });
}

RBDYN_INLINE Json put(const Curve& curve, Writing& w) { return put(curve.kind(), w); }

RBDYN_INLINE Curve take(const Place& p, Tag<Curve>) {
    const auto kind = take(p, Tag<CurveKinds::Kind>());
    return p.located([&] { return std::visit([](const auto& one) { return Curve(one); }, kind); });
}

RBDYN_INLINE Json put(const TimeFunction& f, Writing& w) {
    return f.function() ? put(f.function(), w) : put(f.constant(), w);
}

RBDYN_INLINE TimeFunction take(const Place& p, Tag<TimeFunction>) {
    if (!p.value().is_object()) return p.number();
    Function f = function_from(p);
    if (f.inputs() != 1 || f.outputs() != 1) p.complain("it is a function of the time with one result");
    return {std::move(f)};
}

RBDYN_INLINE Json put(const RigidMotion& motion, Writing& w) { return put(motion.function(), w); }

RBDYN_INLINE RigidMotion take(const Place& p, Tag<RigidMotion>) {
    return p.located([&] { return RigidMotion(function_from(p)); });
}

RBDYN_INLINE Json put(const End& end, Writing& w) {
    Json object = Json::object();
    if (const int body = body_of(end); body >= 0) object["body"] = put(body, w);
    if (const auto* point = std::get_if<BodyPoint>(&end)) object["point"] = put(point->point, w);
    if (const auto* point = std::get_if<Vector3>(&end)) object["point"] = put(*point, w);
    return object;
}

RBDYN_INLINE End take(const Place& p, Tag<End>) {
    p.require_known({"body", "point"});
    const auto named = p.find("body"), placed = p.find("point");
    if (!named && !placed) p.complain("it has a body, a point or both");
    const BodyHandle body{named ? take(*named, Tag<int>()) : -1};
    if (!placed) return body;
    const auto point = take(*placed, Tag<Vector3>());
    if (named) return body.point(point);
    return point;
}

namespace watches {

/// What a function of the motion asks for.
RBDYN_INLINE Json asked_to(const std::vector<Observable>& asked, Writing& w) {
    Json asks = Json::array();
    for (const Observable& o : asked) {
        Json one = {{"quantity", put(o.quantity, w)}};
        if (is_of_coupling(o.quantity))
            one["coupling"] = o.subject;
        else if (o.quantity != Quantity::time)
            one["body"] = put(o.subject, w);
        if (components_of(o.quantity) > 1) one["component"] = o.component;
        asks.push_back(std::move(one));
    }
    return asks;
}

RBDYN_INLINE std::vector<Observable> asked_from(const Place& asks) {
    std::vector<Observable> asked;
    for (std::size_t i = 0; i < asks.size(); ++i) {
        const Place one = asks.at(i);
        Observable o{take(one.at("quantity"), Tag<Quantity>())};
        const int count = components_of(o.quantity);
        std::vector<std::string_view> known = {"quantity"};
        if (is_of_coupling(o.quantity)) {
            known.emplace_back("coupling");
            o.subject = static_cast<int>(one.at("coupling").integer(0, 1'000'000'000));
        } else if (o.quantity != Quantity::time) {
            known.emplace_back("body");
            o.subject = take(one.at("body"), Tag<int>());
        }
        if (count > 1) {
            known.emplace_back("component");
            o.component = static_cast<int>(one.at("component").integer(0, count - 1));
        }
        one.require_known(known);
        asked.push_back(o);
    }
    return asked;
}

}  // namespace watches

RBDYN_INLINE Json put(const WatchFunction& f, Writing& w) {
    if (!f.is_recorded()) refuse_called_back("watched function", *f.counter());
    return {{"asks", watches::asked_to(f.arguments(), w)}, {"function", put(f.function(), w)}};
}

RBDYN_INLINE WatchFunction take(const Place& p, Tag<WatchFunction>) {
    p.require_known({"asks", "function"});
    std::vector<Observable> asked = watches::asked_from(p.at("asks"));
    Function f = function_from(p.at("function"));
    if (f.outputs() != 1 || f.inputs() != static_cast<int>(asked.size()))
        p.complain("its function has one result and as many inputs as it asks for");
    return {std::move(f), std::move(asked)};
}

RBDYN_INLINE Json put(const RecordedAction& action, Writing& w) {
    Json words = Json::array();
    for (const RecordedAction::Word& one : action.words())
        words.push_back({{"body", put(one.body, w)}, {"word", one.word}});
    return {{"changes", std::move(words)},
            {"asks", watches::asked_to(action.asked(), w)},
            {"function", put(action.function(), w)}};
}

RBDYN_INLINE RecordedAction take(const Place& p, Tag<RecordedAction>) {
    p.require_known({"changes", "asks", "function"});
    const Place changes = p.at("changes");
    std::vector<RecordedAction::Word> words;
    for (std::size_t i = 0; i < changes.size(); ++i) {
        const Place one = changes.at(i);
        one.require_known({"body", "word"});
        words.push_back({take(one.at("body"), Tag<int>()), one.at("word").text()});
    }
    std::vector<Observable> asked = watches::asked_from(p.at("asks"));
    Function f = function_from(p.at("function"));
    return p.located([&] { return RecordedAction(std::move(f), std::move(asked), std::move(words)); });
}

RBDYN_INLINE void refuse_called_back(const std::string& who, const Callback& callback) {
    const std::string name = callback.name.empty() ? "a function" : "function \"" + callback.name + "\"";
    throw InvalidInput(who + ": " + name + " is called back" +
                       (callback.reason.empty() ? "" : " (" + callback.reason + ")") +
                       ", and only what is recorded can be saved or pickled; write it so that it can be recorded");
}

}  // namespace rbdyn::inline RBDYN_FORM::file
