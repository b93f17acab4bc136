// What stays as it starts: the variables of a scene that need not be simulated.
//
// The largest set of variables whose rates are zero, exactly and at every time, while they are what they start with:
// all are taken for constants, those whose recorded rates do not fold to zero are variables after all, and so on until
// none is left to leave. A particle loses what is across the plane of its start and its loads, a body without moment
// and spin its rotation, one at rest in balance all it has.
//
// Recorded as a function, so that both sides of every case distinction count. Beads that may stick or leave their rails
// are simulated whole: in flight they may be anywhere, and that covers the rail.
#pragma once

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "rbdyn/model/point_equations.hpp"

namespace rbdyn {

/// Which variables stay as they start, as long as no action of the user's changes them; and why that cannot be told, if
/// so.
struct Staying {
    std::vector<bool> variables;
    std::string unknown = {};
};

[[gnu::cold]] inline Staying what_stays(const PointLaws& laws) {
    const auto at = [](int i) { return static_cast<std::size_t>(i); };
    std::vector<bool> stays(at(laws.variables()), true);
    std::vector<signed char> slip;
    for (const PointLaws::Body& b : laws.bodies()) {
        slip.push_back(b.may_fly ? flies : 1);
        if (!b.rough && !b.may_fly) continue;
        for (int k = 0; k < b.positions(); ++k) stays[at(b.first + k)] = stays[at(b.first_rate + k)] = false;
    }
    const std::vector<double> start = laws.start();
    for (bool has_changed = true; has_changed;) {
        has_changed = false;
        if (std::find(stays.begin(), stays.end(), true) == stays.end()) break;
        const StateMap map(start, stays);
        std::vector<double> x(at(map.size()));
        map.gather(start, x);
        Recorder r(Recorder::Purpose::function);
        r.follow(0.0, x, {});
        EquationsWriter write(r, 0);
        const std::vector<Expression> rates = write_points(r, write, laws, map, {}, slip).rates;
        if (!r.branches().empty())
            return {std::vector<bool>(stays.size(), false), "a curve in pieces shows only the one its bead is on"};
        for (int i = 0; i < laws.variables(); ++i) {
            if (!stays[at(i)] || rates[at(i)].is_zero()) continue;
            stays[at(i)] = false;
            has_changed = true;
        }
    }
    return {std::move(stays)};
}

}  // namespace rbdyn
