// Events: what happened, when, to whom.
#pragma once

#include <cstdint>
#include <optional>
#include <ostream>
#include <string>
#include <string_view>
#include <vector>

#include "rbdyn/basics/direction.hpp"
#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/instant.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/event/keep.hpp"
#include "rbdyn/model/equations.hpp"

namespace rbdyn::inline RBDYN_FORM {

std::string_view name_of(EventKind kind);

std::string_view name_of(Direction direction);

/// Something that happened at a time [s], located to rounding error.
struct Event {
    double time = 0.0;
    EventKind kind = EventKind::watch;
    int subject = -1;                         // the body, by order of addition; -1: none
    std::string name;                         // of the watch or of the subject
    Direction direction = Direction::either;  // in which the watched quantity (slip, reaction, parameter) passed zero
    double impulse = 0.0;                     // N s, of an impact
    int contact = -1;                         // the contact, by order of addition; -1: none
    Vector3 push = Vector3::Zero();           // of a contact, the impulse on its first side, world axes [N s]
    Instant instant;                          // the time to more digits than a double holds
    std::string note = {};                    // what else is to be said of it; empty if nothing
    std::int64_t count = 1;                   // where only the last is kept: of those of its kind, name and subject
    double unsure = 0.0;  // what its time and the motion after it are short of, relative, that no two runs differ by
};

/// The order of two events of one instant.
bool comes_before(const Event& a, const Event& b);

std::ostream& operator<<(std::ostream& out, const Event& event);

/// Leaves the last event of each kind, name, subject and contact, in order of time, with their counts.
void keep_last_of_each(std::vector<Event>& events);

/// What is asked of the events of a run that is complete: hands them on, or leaves the last of each. `end`: events at
/// that time stay, for they end the run.
void settle(std::vector<Event>& events, const KeepEvents& wanted, std::optional<double> end);

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

std::string_view name_of(Status status);

/// What to do about it, in a sentence.
std::string_view advice(Status status);

}  // namespace rbdyn::inline RBDYN_FORM
