// Definitions of rbdyn/trajectory/events.hpp.
#pragma once

#include "rbdyn/trajectory/events.hpp"

#include <optional>
#include <string>
#include <vector>

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE std::vector<double> Events::times(const std::string& kind_or_name,
                                               std::optional<BodyHandle> subject) const {
    std::vector<double> result;
    for (const Event& e : *this)
        if ((name_of(e.kind) == kind_or_name || e.name == kind_or_name) && (!subject || e.subject == subject->index))
            result.push_back(e.time);
    return result;
}

RBDYN_INLINE std::vector<double> Events::times(const std::string& kind_or_name, ContactHandle contact) const {
    std::vector<double> result;
    for (const Event& e : *this)
        if ((name_of(e.kind) == kind_or_name || e.name == kind_or_name) && e.contact == contact.index)
            result.push_back(e.time);
    return result;
}

}  // namespace rbdyn::inline RBDYN_FORM
