// The parts of a scene: bodies that nothing joins, each part a scene of its own that is solved apart.
//
// Two bodies are joined by a coupling between them and by a recorded watched function that asks for both. Nobody knows
// what a function that is called back looks at, nor what an action that changes the state does: one of them joins all
// bodies. Functions of time, numbers that several bodies share and integrals of the user's, which are looked at when
// the motion is known, join nothing. A function of the time alone is watched with the first body.
#pragma once

#include <algorithm>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

#include "rbdyn/scene/scene.hpp"

namespace rbdyn {

struct SceneParts {
    struct Part {
        Scene scene;              // without integrals
        std::vector<int> bodies;  // by order of addition, as the rest of it
    };
    /// Where something of the scene is; a coupling that does nothing may be in no part (-1).
    struct Place {
        int part = -1, index = -1;
    };

    std::vector<Part> parts;  // in the order of their first bodies; none if there is one only
    std::vector<Place> bodies, loads, couplings;
    std::string joined_by;  // the watched function that keeps together what else falls apart; empty if none does

    [[gnu::cold]] explicit SceneParts(const Scene& scene) {
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
            part.scene.bodies_.push_back(scene.bodies_[at(i)]);
        }
        for (Part& part : parts) part.scene.gravity_ = scene.gravity_;
        for (Scene::AppliedLoad load : scene.loads_) {
            const auto [part, body] = bodies[at(load.body)];
            load.body = body;
            put(loads, part, &Scene::loads_, std::move(load));
        }
        for (Scene::Connection c : scene.connections_) {
            const int a = part_of(c.a), b = part_of(c.b);
            if (a >= 0 && b >= 0 && a != b) {
                couplings.emplace_back();
                continue;
            }
            for (End* end : {&c.a, &c.b}) {
                if (BodyHandle* body = std::get_if<BodyHandle>(end)) body->index = bodies[at(body->index)].index;
                if (BodyPoint* point = std::get_if<BodyPoint>(end)) point->body = bodies[at(point->body)].index;
            }
            put(couplings, std::max(a, b), &Scene::connections_, std::move(c));
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

private:
    static std::size_t at(int i) { return static_cast<std::size_t>(i); }

    static bool looks_at_all(const Scene::Watch& w) {
        return !w.function.is_recorded() || w.options.action.kind == WatchAction::Kind::change;
    }
    int part_of(const End& end) const { return body_of(end) < 0 ? -1 : bodies[at(body_of(end))].part; }

    template <class T>
    void put(std::vector<Place>& places, int part, std::vector<T> Scene::*things, T thing) {
        std::vector<T>& all = parts[at(part)].scene.*things;
        places.push_back({part, static_cast<int>(all.size())});
        all.push_back(std::move(thing));
    }

    /// For every body the first of those it is joined to by couplings and by functions that say what they ask for.
    [[gnu::cold]] static std::vector<int> joined(const Scene& scene) {
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
};

}  // namespace rbdyn
