// Definitions of rbdyn/event/event.hpp.
#pragma once

#include "rbdyn/event/event.hpp"

#include <array>
#include <cstddef>
#include <map>
#include <optional>
#include <ostream>
#include <string_view>
#include <tuple>
#include <utility>
#include <vector>

#include "rbdyn/basics/direction.hpp"
#include "rbdyn/basics/error.hpp"
#include "rbdyn/model/equations.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE std::string_view name_of(EventKind kind) {
    static constexpr std::array<std::string_view, 13> names = {
        "watch", "reverse", "stick", "slip",         "normal-zero", "rail-end", "detach",
        "land",  "impact",  "rest",  "accumulation", "switch",      "singular"};
    return names[static_cast<std::size_t>(kind)];
}

RBDYN_INLINE std::string_view name_of(Direction direction) {
    return direction == Direction::rising ? "rising" : direction == Direction::falling ? "falling" : "either";
}

RBDYN_INLINE bool comes_before(const Event& a, const Event& b) {
    return std::tie(a.kind, a.name, a.subject) < std::tie(b.kind, b.name, b.subject);
}

RBDYN_INLINE std::ostream& operator<<(std::ostream& out, const Event& event) {
    out << "t = " << text(event.time) << " s  " << name_of(event.kind);
    if (!event.name.empty()) out << "  (" << event.name << ")";
    if (!event.note.empty()) out << "  " << event.note;
    return out;
}

RBDYN_INLINE void keep_last_of_each(std::vector<Event>& events) {
    std::map<std::tuple<EventKind, int, int, std::string_view>, std::size_t> last;
    const auto key = [](const Event& e) { return std::tuple(e.kind, e.subject, e.contact, std::string_view(e.name)); };
    std::vector<bool> stays(events.size(), false);
    for (std::size_t i = 0; i < events.size(); ++i) {
        const auto [place, is_first] = last.try_emplace(key(events[i]), i);
        if (!is_first) {
            stays[place->second] = false;
            events[i].count += events[place->second].count;
            place->second = i;
        }
        stays[i] = true;
    }
    std::vector<Event> kept;
    for (std::size_t i = 0; i < events.size(); ++i)
        if (stays[i]) kept.push_back(events[i]);
    events = std::move(kept);
}

RBDYN_INLINE void settle(std::vector<Event>& events, const KeepEvents& wanted, std::optional<double> end) {
    if (wanted.keeps_all()) return;
    if (!wanted.each) return keep_last_of_each(events);
    for (const Event& e : events) wanted.each(e);
    std::erase_if(events, [&](const Event& e) { return !end || e.time != *end; });
}

RBDYN_INLINE std::string_view name_of(Status status) {
    static constexpr std::array<std::string_view, 7> names = {"reached end", "stopped by event", "stopped by user",
                                                              "step limit",  "not finite",       "accuracy not reached",
                                                              "inconsistent"};
    return names[static_cast<std::size_t>(status)];
}

RBDYN_INLINE std::string_view advice(Status status) {
    static constexpr std::array<std::string_view, 7> sentences = {
        "The motion is complete.",
        "The motion ended where the scene says it does; the last event tells where.",
        "The motion up to here is kept; run again from the last state to go on.",
        "Raise max_steps, shorten the time span, or ask for less accuracy if the motion is fast by nature. Steps that "
        "get ever shorter and would be far too many end so too, long before max_steps: look at what happens there.",
        "A force, curve, drive, watched function or rate of a variable is not finite at the end of this run; look "
        "there.",
        "The motion is certain up to certain_until; ask for less accuracy, or stop there.",
        "No smooth motion satisfies the laws at the end of this run; look at the friction, "
        "constraints, driven joints and forces there."};
    return sentences[static_cast<std::size_t>(status)];
}

}  // namespace rbdyn::inline RBDYN_FORM
