// Definitions of rbdyn/trajectory/work.hpp.
#pragma once

#include "rbdyn/trajectory/work.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

#include "rbdyn/basics/error.hpp"
#include "rbdyn/basics/instant.hpp"
#include "rbdyn/event/event.hpp"
#include "rbdyn/event/record.hpp"
#include "rbdyn/model/equations.hpp"
#include "rbdyn/scene/scene.hpp"
#include "rbdyn/scene/watch.hpp"
#include "rbdyn/trajectory/run_data.hpp"

namespace rbdyn::inline RBDYN_FORM::working {

RBDYN_INLINE void refuse_missing(double t0, double t1) {
    throw InvalidInput("Trajectory: work from " + text(t0) + " to " + text(t1) +
                       " s is asked for, and this run did not keep the motion between (keep=); use keep \"all\"");
}

RBDYN_INLINE bool covers(const Record& record, double t0, double t1) {
    constexpr double epsilon = std::numeric_limits<double>::epsilon();
    const auto& entries = record.entries();
    if (entries.empty()) return false;
    const double slack = 8.0 * epsilon * std::max({std::abs(t0), std::abs(t1), std::abs(record.end.hi)});
    double reached = t0;
    for (std::size_t i = record.find(t0, Side::after); i < entries.size() && reached < t1 - slack; ++i) {
        if (entries[i].start.hi > reached + slack) return false;
        reached = std::max(reached, (entries[i].start + entries[i].length * entries[i].unit).hi);
    }
    return reached >= t1 - slack;
}

RBDYN_INLINE std::vector<double> jumps(const RunData& run, double t0, double t1) {
    if (run.statistics.events != static_cast<std::int64_t>(run.record.events.size()))
        throw InvalidInput(
            "Trajectory: work is asked for, and this run did not keep its events (events=), at which "
            "velocities jump; use events \"all\"");
    std::vector<double> times;
    const auto changes = [&](const Event& e) {
        if (e.kind == EventKind::land || e.kind == EventKind::impact) return true;
        if (e.kind != EventKind::watch) return false;
        const auto& watches = run.scene.watches();
        return std::any_of(watches.begin(), watches.end(), [&](const Scene::Watch& w) {
            return w.name == e.name && w.options.action.kind == WatchAction::Kind::change;
        });
    };
    for (const Event& e : run.record.events)
        if (e.time > t0 && e.time < t1 && changes(e) && (times.empty() || times.back() != e.time))
            times.push_back(e.time);
    return times;
}

}  // namespace rbdyn::inline RBDYN_FORM::working
