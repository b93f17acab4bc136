// The events of a run.
#pragma once

#include <memory>
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

    /// The same, of what has these names: their times are asked for by no others, or by a kind.
    Events among(std::vector<std::string> names) &&;

    /// Times of the events of a kind or name, of one body if given; none of what did not happen. Throws InvalidInput
    /// for what is neither a kind of event nor a name in the run.
    std::vector<double> times(const std::string& kind_or_name, std::optional<BodyHandle> subject = std::nullopt) const;
    /// The same of one contact.
    std::vector<double> times(const std::string& kind_or_name, ContactHandle contact) const;

private:
    void require_known(const std::string& kind_or_name) const;

    std::shared_ptr<const std::vector<std::string>> names_;  // none: nobody knows them
};

}  // namespace rbdyn::inline RBDYN_FORM
