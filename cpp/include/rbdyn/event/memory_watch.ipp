// Definitions of rbdyn/event/memory_watch.hpp.
#pragma once

#include "rbdyn/event/memory_watch.hpp"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <utility>

#include "rbdyn/basics/error.hpp"
#include "rbdyn/basics/memory.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE MemoryWatch::MemoryWatch(Warn warn, double copies)
    : warn_(std::move(warn)), copies_(copies), next_(warn_ ? first : std::numeric_limits<std::int64_t>::max()) {}

RBDYN_INLINE void MemoryWatch::look(std::int64_t steps, const Record& record, double t, double until,
                                    std::int64_t max_steps) {
    const double once = static_cast<double>(record.events.size() * sizeof(Event)), events = copies_ * once,
                 bytes = record.bytes() - once + events;
    // what it grew by since the last look, and how often that will be so
    const bool is_known = steps_ > 0;
    const double since = is_known ? t_ : record.start, took = t - since;
    const double grown = bytes - bytes_, by_events = events - events_;
    const double rows =
        std::min((until - t) / took, static_cast<double>(max_steps - steps) /
                                         static_cast<double>(std::max<std::int64_t>(steps - steps_, 1)));
    const double needed = bytes + grown * rows;
    steps_ = steps;
    next_ = 2 * steps;
    bytes_ = bytes;
    events_ = events;
    t_ = t;
    // the last piece alone is larger or smaller as it happens
    constexpr double trifle = 1e5;
    const bool grows = is_known && bytes > trifle && grown > steadily * bytes;
    const std::optional<double> available = grows && needed > little ? available_memory() : std::nullopt;
    const bool is_much = available && needed > share * (*available + bytes);
    if (!std::exchange(was_much_, is_much) || !is_much) return;
    next_ = std::numeric_limits<std::int64_t>::max();
    warn_("simulate: what this run keeps takes " + bytes_text(bytes) + " at t = " + text(t) + " s and would take " +
          bytes_text(needed) + " at t = " + text(t + rows * took) + " s; " + bytes_text(*available) +
          " of memory are free. " +
          (by_events > 0.5 * grown
               ? "Events are most of it: with rtol, keep \"end\" and events \"last\" it does not grow"
               : "With keep \"end\", or the times that are wanted, it does not grow but by events"));
}

}  // namespace rbdyn::inline RBDYN_FORM
