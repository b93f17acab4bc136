// Definitions of rbdyn/special/words.hpp.
#pragma once

#include "rbdyn/special/words.hpp"

#include <cstddef>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "rbdyn/basics/error.hpp"
#include "rbdyn/curve/checks.hpp"
#include "rbdyn/curve/curve.hpp"
#include "rbdyn/curve/one_side.hpp"
#include "rbdyn/model/equations.hpp"
#include "rbdyn/model/hybrid.hpp"
#include "rbdyn/model/state_map.hpp"
#include "rbdyn/special/point_laws.hpp"
#include "rbdyn/special/points.hpp"
#include "rbdyn/special/rigid_law.hpp"

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

RBDYN_INLINE std::vector<std::string> guards_of(const PointsModel& model) {
    std::vector<std::string> lines;
    std::set<std::string> known;  // of a long chain there are as many as it has masses
    for (const signed char slip : {static_cast<signed char>(1), sticks, flies}) {
        std::vector<signed char> slips(static_cast<std::size_t>(model.bodies()), slip);
        if (slip == flies)
            for (int i = 0; i < model.bodies(); ++i)
                if (!model.laws().body(i).may_fly) slips[static_cast<std::size_t>(i)] = 1;
        for (const Guard& guard : model.equations(slips).guards) {
            std::string line = guard.subject >= 0 ? model.laws().body(guard.subject).name + ": " : std::string();
            switch (guard.kind) {
                case EventKind::reverse: line += "its slip through zero (reverse, stick)"; break;
                case EventKind::slip: line += "the static limit while it sticks (slip)"; break;
                case EventKind::normal_zero: line += "its normal reaction through zero (normal-zero)"; break;
                case EventKind::rail_end: line += "an end of its rail (rail-end)"; break;
                case EventKind::detach:
                    line += "what its rail, which pushes along " +
                            curves::vector_text(model.laws().body(guard.subject).one_side->normal()) +
                            " where it starts, would have to pull (detach)";
                    break;
                case EventKind::singular: line += "a place of its rail without a tangent (ends the run)"; break;
                case EventKind::land: line += "its way back to the rail (land)"; break;
                case EventKind::watch: line += "\"" + guard.name + "\" (watch)"; break;
                case EventKind::switching:
                    if (guard.name.empty()) {
                        line += "a change from one formula to the next (no event)";
                        break;
                    }
                    [[fallthrough]];
                default: line += guard.name + " through zero (switch)"; break;
            }
            if (known.insert(line).second) lines.push_back(std::move(line));
        }
    }
    return lines;
}

}  // namespace rbdyn::inline RBDYN_FORM::planning
