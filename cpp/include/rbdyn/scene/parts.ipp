// Definitions of rbdyn/scene/parts.hpp.
#pragma once

#include "rbdyn/scene/parts.hpp"

#include <algorithm>
#include <numeric>
#include <utility>
#include <variant>
#include <vector>

#include "rbdyn/scene/couplings.hpp"
#include "rbdyn/scene/handles.hpp"
#include "rbdyn/scene/scene.hpp"
#include "rbdyn/scene/watch.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE SceneParts::SceneParts(const Scene& scene) {
    const std::vector<int> heads = joined(scene);
    const auto is_head = [&](int i) { return heads[at(i)] == i; };
    const auto count = static_cast<int>(heads.size());
    int several = 0;
    for (int i = 0; i < count; ++i) several += is_head(i);
    if (several < 2) return;
    for (const Scene::Watch& w : scene.watches())
        if (joined_by.empty() && looks_at_all(w)) joined_by = w.name;
    if (!joined_by.empty()) return;
    parts.resize(at(several));
    int next = 0;
    for (int i = 0; i < count; ++i) {
        bodies.push_back({is_head(i) ? next++ : bodies[at(heads[at(i)])].part, 0});
        Part& part = parts[at(bodies.back().part)];
        bodies.back().index = static_cast<int>(part.bodies.size());
        part.bodies.push_back(i);
        Scene::Body& added = part.scene.bodies_.change().emplace_back(scene.bodies()[at(i)]);
        if (added.parent >= 0) added.parent = bodies[at(added.parent)].index;
    }
    for (Part& part : parts) {
        part.scene.gravity_ = scene.gravity_;
        part.scene.origin_ = scene.origin_;
    }
    for (Scene::AppliedLoad load : scene.loads_) {
        const auto [part, body] = bodies[at(load.body)];
        load.body = body;
        put(loads, part, &Scene::loads_, std::move(load));
    }
    const auto renumber = [&](End& end) {
        if (BodyHandle* body = std::get_if<BodyHandle>(&end); body != nullptr && body->index >= 0)
            body->index = bodies[at(body->index)].index;
        if (BodyPoint* point = std::get_if<BodyPoint>(&end)) point->body = bodies[at(point->body)].index;
    };
    for (Scene::Connection c : scene.connections()) {
        const int a = part_of(c.a), b = part_of(c.b);
        if (a >= 0 && b >= 0 && a != b) {
            couplings.emplace_back();
            continue;
        }
        for (End* end : {&c.a, &c.b}) renumber(*end);
        put(couplings, std::max(a, b), &Scene::connections_, std::move(c));
    }
    for (Scene::Held c : scene.constraints_) {
        const int a = part_of(c.a), b = part_of(c.b);
        for (End* end : {&c.a, &c.b}) renumber(*end);
        put(constraints, std::max(a, b), &Scene::constraints_, std::move(c));
    }
    for (Scene::Touch c : scene.contacts_) {
        const int part = bodies[at(body_of(c.a))].part;
        const auto renumbered = [&](auto& side) {
            std::visit(
                [&](auto& s) {
                    if constexpr (requires { s.index; })
                        s.index = bodies[at(s.index)].index;
                    else if constexpr (requires { s.body; })
                        s.body = bodies[at(s.body)].index;
                },
                side);
        };
        renumbered(c.a);
        renumbered(c.b);
        parts[at(part)].contacts.push_back(static_cast<int>(contacts.size()));
        put(contacts, part, &Scene::contacts_, std::move(c));
    }
    for (const Scene::Watch& w : scene.watches_) {
        int part = 0;
        std::vector<Observable> asked = w.function.arguments();
        for (Observable& o : asked) {
            if (o.quantity == Quantity::time) continue;
            const Place place = (is_of_coupling(o.quantity) ? couplings : bodies)[at(o.subject)];
            part = place.part;
            o.subject = place.index;
        }
        parts[at(part)].scene.watches_.push_back({w.name, {w.function.function(), std::move(asked)}, w.options});
    }
}

RBDYN_INLINE bool SceneParts::looks_at_all(const Scene::Watch& w) {
    return !w.function.is_recorded() || w.options.action.kind == WatchAction::Kind::change;
}

RBDYN_INLINE std::vector<int> SceneParts::joined(const Scene& scene) {
    std::vector<int> heads(scene.bodies().size());
    std::iota(heads.begin(), heads.end(), 0);
    const auto head = [&](int i) {
        while (heads[at(i)] != i) i = heads[at(i)] = heads[at(heads[at(i)])];
        return i;
    };
    const auto join = [&](int a, int b) {
        if (a < 0 || b < 0) return;
        const auto [first, second] = std::minmax({head(a), head(b)});
        heads[at(second)] = first;
    };
    for (int i = 0; i < static_cast<int>(heads.size()); ++i) join(i, scene.bodies()[at(i)].parent);
    for (const Scene::Held& c : scene.constraints()) join(body_of(c.a), body_of(c.b));
    for (const Scene::Touch& c : scene.contacts()) join(body_of(c.a), body_of(c.b));
    for (const Scene::Connection& c : scene.connections())
        if (is_present(c.coupling)) join(body_of(c.a), body_of(c.b));
    for (const Scene::Watch& w : scene.watches()) {
        int first = -1;
        const auto look_at = [&](int body) {
            join(first, body);
            first = std::max(first, body);
        };
        for (const Observable& o : w.function.arguments()) {
            if (o.quantity == Quantity::time) continue;
            if (!is_of_coupling(o.quantity)) {
                look_at(o.subject);
                continue;
            }
            const Scene::Connection& c = scene.connections()[at(o.subject)];
            look_at(body_of(c.a));
            look_at(body_of(c.b));
        }
    }
    for (int i = 0; i < static_cast<int>(heads.size()); ++i) heads[at(i)] = head(i);
    return heads;
}

}  // namespace rbdyn::inline RBDYN_FORM
