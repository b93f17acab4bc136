// Events: what happened, when, to whom.
#pragma once

#include <array>
#include <ostream>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

#include "rbdyn/basics/error.hpp"
#include "rbdyn/basics/instant.hpp"
#include "rbdyn/model/equations.hpp"

namespace rbdyn {

inline std::string_view name_of(EventKind kind) {
    static constexpr std::array<std::string_view, 13> names = {
        "watch", "reverse", "stick", "slip",         "normal-zero", "rail-end", "detach",
        "land",  "impact",  "rest",  "accumulation", "switch",      "singular"};
    return names[static_cast<std::size_t>(kind)];
}

inline std::string_view name_of(Direction direction) {
    return direction == Direction::rising ? "rising" : direction == Direction::falling ? "falling" : "either";
}

/// Something that happened at a time [s], located to rounding error.
struct Event {
    double time = 0.0;
    EventKind kind = EventKind::watch;
    int subject = -1;                         // the body, by order of addition; -1: none
    std::string name;                         // of the watch or of the subject
    Direction direction = Direction::either;  // in which the watched quantity (slip, reaction, parameter) passed zero
    double impulse = 0.0;                     // N s, of an impact
    Instant instant;                          // the time to more digits than a double holds
};

/// The order of two events of one instant.
inline bool comes_before(const Event& a, const Event& b) {
    return std::tie(a.kind, a.name, a.subject) < std::tie(b.kind, b.name, b.subject);
}

inline std::ostream& operator<<(std::ostream& out, const Event& event) {
    out << "t = " << text(event.time) << " s  " << name_of(event.kind);
    if (!event.name.empty()) out << "  (" << event.name << ")";
    return out;
}

/// How a run ended.
enum class Status {
    reached_end,
    stopped_by_event,
    stopped_by_user,
    step_limit,
    not_finite,
    accuracy_not_reached,
    inconsistent
};

inline std::string_view name_of(Status status) {
    static constexpr std::array<std::string_view, 7> names = {"reached end", "stopped by event", "stopped by user",
                                                              "step limit",  "not finite",       "accuracy not reached",
                                                              "inconsistent"};
    return names[static_cast<std::size_t>(status)];
}

/// What to do about it, in a sentence.
inline std::string_view advice(Status status) {
    static constexpr std::array<std::string_view, 7> sentences = {
        "The motion is complete.",
        "The motion ended where the scene says it does; the last event tells where.",
        "The motion up to here is kept; run again from the last state to go on.",
        "Raise max_steps, shorten the time span, or ask for less accuracy if the motion is fast by nature.",
        "A force, curve, drive or watched function is not finite at the end of this run; look at the scene there.",
        "The motion is certain up to certain_until; ask for less accuracy, or stop there.",
        "No smooth motion satisfies the laws at the end of this run; look at the friction and forces there."};
    return sentences[static_cast<std::size_t>(status)];
}

}  // namespace rbdyn
