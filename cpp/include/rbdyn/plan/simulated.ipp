// Definitions of rbdyn/plan/simulated.hpp.
#pragma once

#include "rbdyn/plan/simulated.hpp"

#include <cstddef>
#include <string>
#include <vector>

#include "rbdyn/basics/error.hpp"
#include "rbdyn/curve/curve.hpp"
#include "rbdyn/model/point_laws.hpp"
#include "rbdyn/model/points.hpp"
#include "rbdyn/model/rigid_law.hpp"
#include "rbdyn/model/state_map.hpp"

namespace rbdyn::inline RBDYN_FORM::planning {

RBDYN_INLINE std::string listed(const std::vector<std::string>& words, const std::string& last) {
    std::string result;
    for (std::size_t i = 0; i < words.size(); ++i)
        result += (i == 0 ? "" : i + 1 == words.size() ? last : ", ") + words[i];
    return result;
}

RBDYN_INLINE std::string coordinates_of(const PointLaws& laws, int index) {
    const PointLaws::Body& b = laws.body(index);
    if (!laws.moves(index)) return "none, it stays as it starts";
    if (b.curve) return "parameter u of its " + b.curve->name();
    if (!b.rigid) return listed(Named(laws.map(), b.first, places).in) + " in the world";
    bool all = true;
    for (int k = 0; k < b.positions(); ++k) all = all && laws.map().is_simulated(b.first + k);
    if (all) return b.rigid->coordinates();
    std::vector<std::string> parts;
    int attitude = b.first;
    if (b.rigid->kind == RigidLaw::Kind::free) {
        attitude += 3;
        if (const Named place(laws.map(), b.first, places); !place.in.empty())
            parts.push_back("centre of mass " + listed(place.in));
    }
    if (const Named turn(laws.map(), attitude, attitudes, b.first + b.positions() - attitude); !turn.in.empty())
        parts.push_back(listed(turn.in) + " of its attitude");
    return listed(parts, "; ");
}

RBDYN_INLINE void leave_out_places(const PointLaws& laws, int index, std::vector<Omission>& omissions) {
    const PointLaws::Body& b = laws.body(index);
    std::vector<std::string> names, axes;
    for (int k = 0; k < 3; ++k) {
        const char* place = places[static_cast<std::size_t>(k)];
        const char* velocity = velocities[static_cast<std::size_t>(k)];
        if (!laws.map().is_simulated(b.first + k)) {
            names.insert(names.end(), {place, velocity});
            axes.push_back(place);
        } else if (!laws.map().is_simulated(b.first_rate + k)) {
            omissions.push_back(
                {std::string(velocity) + " of " + b.name, "stays at " + text(laws.map().start(b.first_rate + k)) +
                                                              "; a force along " + place + " brings it in"});
        }
    }
    if (!names.empty())
        omissions.push_back({listed(names) + " of " + b.name, "stay as they start; a force, velocity or start along " +
                                                                  listed(axes, " or ") + " brings them in"});
}

RBDYN_INLINE void leave_out_turns(const PointLaws& laws, int index, std::vector<Omission>& omissions) {
    const PointLaws::Body& b = laws.body(index);
    const bool is_free = b.rigid->kind == RigidLaw::Kind::free;
    const int skipped = is_free ? 3 : 0, first_turn = b.first_rate + skipped;
    const Named attitude(laws.map(), b.first + skipped, attitudes, b.positions() - skipped),
        turn(laws.map(), first_turn, turns);
    if (attitude.in.empty() && turn.in.empty()) {
        omissions.push_back({"rotation of " + b.name, std::string("no spin, and no moment about its ") +
                                                          (is_free ? "centre of mass" : "joint") +
                                                          "; either brings it in"});
        return;
    }
    std::vector<std::string> still = attitude.out;
    for (std::size_t k = 0; k < turn.out.size(); ++k) {
        if (turn.values[k] == 0.0) {
            still.push_back(turn.out[k]);
            continue;
        }
        const bool is_spin = b.rigid->follows_axis && turn.out[k] == turns[2];
        omissions.push_back({turn.out[k] + " of " + b.name,
                             "stays at " + text(turn.values[k]) +
                                 (is_spin ? ": nothing turns it about its axis of symmetry; a moment does"
                                          : ": a permanent rotation; a moment or another spin brings it in")});
    }
    if (!still.empty())
        omissions.push_back({listed(still) + " of " + b.name,
                             std::string(still.size() > 1 ? "stay as they start" : "stays as it starts") +
                                 "; a moment or a spin about another axis brings " +
                                 (still.size() > 1 ? "them in" : "it in")});
}

RBDYN_INLINE void leave_out_body(const PointLaws& laws, int index, std::vector<Omission>& omissions) {
    const PointLaws::Body& b = laws.body(index);
    const bool turns_freely = b.rigid && b.rigid->turns_freely();
    if (!laws.moves(index)) {
        const char* cause = b.curve        ? "a force along its rail or a speed"
                            : !b.rigid     ? "a force or a velocity"
                            : turns_freely ? "a force, a moment or a velocity"
                                           : "a load along its joint or a rate";
        omissions.push_back({"motion of " + b.name, std::string("it stays as it starts; ") + cause + " brings it in"});
        return;
    }
    if (b.may_fly) {
        omissions.push_back({"no variable of " + b.name, "it may leave its rail, and then be anywhere"});
        return;
    }
    if (b.curve) {
        if (!laws.map().is_simulated(b.first_rate))
            omissions.push_back({"u' of " + b.name, "stays at " + text(laws.map().start(b.first_rate)) +
                                                        "; a force along its rail brings it in"});
        return;
    }
    if (!b.rigid || b.rigid->kind == RigidLaw::Kind::free) leave_out_places(laws, index, omissions);
    if (turns_freely) {
        leave_out_turns(laws, index, omissions);
    } else if (b.rigid && !laws.map().is_simulated(b.first_rate)) {
        omissions.push_back({"rate of " + b.name, "stays at " + text(laws.map().start(b.first_rate)) +
                                                      "; a load along its joint brings it in"});
    }
}

RBDYN_INLINE void Simulated::take(const SceneModel& model) {
    for (int i = 0; i < model.bodies(); ++i) any_turns = any_turns || model.turns(i);
    if (!model.why_all().empty()) omissions.push_back({"no variable", model.why_all()});
}

RBDYN_INLINE void Simulated::take(const SceneModel& model, int body) {
    const PointLaws* laws = model.special();
    coordinates.push_back(model.name(body) + ": " +
                          (laws != nullptr ? coordinates_of(*laws, body) : model.coordinates(body)));
    if (laws != nullptr && model.why_all().empty()) leave_out_body(*laws, body, omissions);
}

}  // namespace rbdyn::inline RBDYN_FORM::planning
