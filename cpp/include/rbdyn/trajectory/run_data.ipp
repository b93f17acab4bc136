// Definitions of rbdyn/trajectory/run_data.hpp.
#pragma once

#include "rbdyn/trajectory/run_data.hpp"

#include <cstddef>
#include <memory>
#include <utility>
#include <vector>

#include "rbdyn/event/record.hpp"
#include "rbdyn/model/hybrid.hpp"
#include "rbdyn/plan/plan.hpp"
#include "rbdyn/scene/parts.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE std::pair<std::shared_ptr<const RunData>, int> part_of(const std::shared_ptr<const RunData>& run,
                                                                    std::vector<SceneParts::Place> SceneParts::*things,
                                                                    int index) {
    if (run->parts.empty()) return {run, index};
    const auto [part, place] = (*run->plan.apart.*things)[static_cast<std::size_t>(index)];
    if (part < 0) return {run, index};
    return {{run, &run->parts[static_cast<std::size_t>(part)]}, place};
}

RBDYN_INLINE Moment::Moment(const RunData& data, double t, Side side)
    : mode(mode_at(data.record, t, side)), x(state_at(data.record, t, side)) {}

RBDYN_INLINE const Mode& Moment::mode_at(const Record& record, double t, Side side) {
    const auto index = entry_at(record, t, side);
    return index ? record.mode(*index) : record.modes.front();
}

}  // namespace rbdyn::inline RBDYN_FORM
