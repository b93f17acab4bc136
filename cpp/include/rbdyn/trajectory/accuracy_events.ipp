// Definitions of rbdyn/trajectory/accuracy.hpp: events of two runs, one by one.
#pragma once

#include "rbdyn/trajectory/accuracy.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

#include "rbdyn/basics/sort_few.hpp"
#include "rbdyn/event/event.hpp"
#include "rbdyn/event/record.hpp"
#include "rbdyn/model/hybrid.hpp"
#include "rbdyn/trajectory/strike_order.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE std::vector<double> AccuracyCheck::limits_of(const Record& r) {
    std::vector<double> limits;
    for (const Event& event : r.events)
        if (event.kind == EventKind::accumulation && event.contact >= 0) limits.push_back(event.time);
    return limits;
}

RBDYN_INLINE std::vector<Event> AccuracyCheck::in_order(const Record& r, const std::vector<double>& limits,
                                                        double start) const {
    std::vector<Event> events;
    for (const Event& event : r.events)
        if (!is_last_bounce(event, limits, start, last_bounces)) events.push_back(event);
    for (std::size_t first = 0, last = 0; first < events.size(); first = last) {
        for (last = first + 1; last < events.size(); ++last)
            if (events[last].time - events[last - 1].time > wanted_ * (events[last].time - start)) break;
        sort_few(std::span(events).subspan(first, last - first), comes_before);
    }
    return events;
}

RBDYN_INLINE bool AccuracyCheck::differ(const std::vector<Event>& a, std::size_t i, const std::vector<Event>& b,
                                        std::size_t j) {
    if (i >= a.size() || j >= b.size()) return true;
    return a[i].kind != b[j].kind || a[i].subject != b[j].subject || a[i].name != b[j].name;
}

RBDYN_INLINE bool AccuracyCheck::is_graze(const std::vector<Event>& events, std::size_t i, double start) const {
    if (i + 1 >= events.size()) return false;
    const Event &a = events[i], &b = events[i + 1];
    if (a.kind != EventKind::stick || b.kind != EventKind::slip || a.subject != b.subject) return false;
    // what other events are of is no body, or has no friction
    return !model_.holds_what_touches(a.subject) && b.time - a.time <= std::sqrt(wanted_) * (a.time - start);
}

RBDYN_INLINE bool AccuracyCheck::is_last_bounce(const Event& event, const std::vector<double>& limits, double start,
                                                double near) {
    if (event.contact < 0) return false;
    const bool is_limit = event.kind == EventKind::accumulation;
    if (!is_limit && event.kind != EventKind::impact && event.kind != EventKind::land &&
        event.kind != EventKind::detach)
        return false;
    // in corners bounces on one surface that end are followed by less on another, which end, too
    const auto limit =
        is_limit ? std::ranges::upper_bound(limits, event.time) : std::ranges::lower_bound(limits, event.time);
    // however late the motion begins
    const double time = std::max(event.time - start, std::abs(event.time));
    return limit != limits.end() && *limit - event.time <= near * time;
}

RBDYN_INLINE void AccuracyCheck::skip_graze(const std::vector<Event>& ours, std::size_t& i, Comparison& result) {
    result.grazes.push_back(ours[i++]);
    result.grazes.push_back(ours[i++]);
}

}  // namespace rbdyn::inline RBDYN_FORM
