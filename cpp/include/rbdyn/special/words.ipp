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
#include "rbdyn/model/equations.hpp"
#include "rbdyn/model/hybrid.hpp"
#include "rbdyn/model/state_map.hpp"
#include "rbdyn/special/bead_law.hpp"
#include "rbdyn/special/single_law.hpp"
#include "rbdyn/special/special_model.hpp"

namespace rbdyn::inline RBDYN_FORM::planning {

RBDYN_INLINE std::string listed(const std::vector<std::string>& words, const std::string& last) {
    std::string result;
    for (std::size_t i = 0; i < words.size(); ++i)
        result += (i == 0 ? "" : i + 1 == words.size() ? last : ", ") + words[i];
    return result;
}

RBDYN_INLINE void leave_out_places(const SingleLaw& law, const StateMap& map, std::vector<Omission>& omissions) {
    std::vector<std::string> names, axes;
    for (int k = 0; k < 3; ++k) {
        const char* place = places[static_cast<std::size_t>(k)];
        const char* velocity = velocities[static_cast<std::size_t>(k)];
        if (!map.is_simulated(law.first + k)) {
            names.insert(names.end(), {place, velocity});
            axes.push_back(place);
        } else if (!map.is_simulated(law.first_rate + k)) {
            omissions.push_back(
                {std::string(velocity) + " of " + law.name,
                 "stays at " + text(map.start(law.first_rate + k)) + "; a force along " + place + " brings it in"});
        }
    }
    if (!names.empty())
        omissions.push_back(
            {listed(names) + " of " + law.name,
             "stay as they start; a force, velocity or start along " + listed(axes, " or ") + " brings them in"});
}

RBDYN_INLINE std::vector<std::string> guards_of(const SpecialModel& model) {
    std::vector<std::string> lines;
    std::set<std::string> known;  // of a long chain there are as many as it has masses
    for (const signed char slip : {static_cast<signed char>(1), sticks, flies}) {
        std::vector<signed char> slips(static_cast<std::size_t>(model.bodies()), slip);
        if (slip == flies)
            for (int i = 0; i < model.bodies(); ++i) slips[static_cast<std::size_t>(i)] = model.laws().body(i).freest();
        for (const Guard& guard : model.equations(slips).guards) {
            std::string line = guard.subject >= 0 ? model.laws().body(guard.subject).name + ": " : std::string();
            switch (guard.kind) {
                case EventKind::reverse: line += "its slip through zero (reverse, stick)"; break;
                case EventKind::slip: line += "the static limit while it sticks (slip)"; break;
                case EventKind::normal_zero: line += "its normal reaction through zero (normal-zero)"; break;
                case EventKind::rail_end: line += "an end of its rail (rail-end)"; break;
                case EventKind::detach:
                    line += "what its rail, which pushes along " +
                            curves::vector_text(model.laws().bead(guard.subject).pushes_along()) +
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
