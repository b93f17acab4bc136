// The parts of a scene: bodies that nothing joins, each part a scene of its own that is solved apart.
//
// Two bodies are joined by a joint, a coupling or a constraint between them and by a recorded watched function that
// asks for both. Nobody knows what a function that is called back looks at, nor what an action that changes the state
// does: one of them joins all bodies. Functions of time, numbers that several bodies share and integrals of the user's,
// which are looked at when the motion is known, join nothing. A function of the time alone is watched with the first
// body.
#pragma once

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/scene/handles.hpp"
#include "rbdyn/scene/scene.hpp"

namespace rbdyn::inline RBDYN_FORM {

struct SceneParts {
    struct Part {
        Scene scene;                // without integrals
        std::vector<int> bodies;    // by order of addition, as the rest of it
        std::vector<int> contacts;  // of the whole
    };
    /// Where something of the scene is; a coupling that does nothing may be in no part (-1).
    struct Place {
        int part = -1, index = -1;
    };

    std::vector<Part> parts;  // in the order of their first bodies; none if there is one only
    std::vector<Place> bodies, loads, couplings, constraints, contacts;
    std::string joined_by;  // the watched function that keeps together what else falls apart; empty if none does

    [[gnu::cold]] explicit SceneParts(const Scene& scene);

private:
    static std::size_t at(int i) { return static_cast<std::size_t>(i); }

    static bool looks_at_all(const Scene::Watch& w);
    int part_of(const End& end) const { return body_of(end) < 0 ? -1 : bodies[at(body_of(end))].part; }

    template <class T>
    void put(std::vector<Place>& places, int part, std::vector<T> Scene::*things, T thing) {
        put(places, part, parts[at(part)].scene.*things, std::move(thing));
    }
    template <class T>
    void put(std::vector<Place>& places, int part, Shared<std::vector<T>> Scene::*things, T thing) {
        put(places, part, (parts[at(part)].scene.*things).change(), std::move(thing));
    }
    template <class T>
    static void put(std::vector<Place>& places, int part, std::vector<T>& all, T thing) {
        places.push_back({part, static_cast<int>(all.size())});
        all.push_back(std::move(thing));
    }

    /// For every body the first of those it is joined to by couplings and by functions that say what they ask for.
    [[gnu::cold]] static std::vector<int> joined(const Scene& scene);
};

}  // namespace rbdyn::inline RBDYN_FORM
