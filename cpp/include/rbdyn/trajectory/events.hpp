// The events of a run.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/event/event.hpp"
#include "rbdyn/scene/handles.hpp"

namespace rbdyn::inline RBDYN_FORM {

/// The events of a run, in order of time.
class Events : public std::vector<Event> {
public:
    using std::vector<Event>::vector;
    explicit Events(std::vector<Event> events) : std::vector<Event>(std::move(events)) {}

    /// Times of the events of a kind or name, of one body if given.
    std::vector<double> times(const std::string& kind_or_name, std::optional<BodyHandle> subject = std::nullopt) const;
    /// The same of one contact.
    std::vector<double> times(const std::string& kind_or_name, ContactHandle contact) const;
};

}  // namespace rbdyn::inline RBDYN_FORM
