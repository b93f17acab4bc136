// Definitions of rbdyn/trajectory/events.hpp.
#pragma once

#include "rbdyn/trajectory/events.hpp"

#include <algorithm>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "rbdyn/basics/error.hpp"
#include "rbdyn/event/event.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE Events Events::among(std::vector<std::string> names) && {
    names_ = std::make_shared<const std::vector<std::string>>(std::move(names));
    return std::move(*this);
}

RBDYN_INLINE void Events::require_known(const std::string& kind_or_name) const {
    if (!names_ || std::find(names_->begin(), names_->end(), kind_or_name) != names_->end()) return;
    for (const Event& e : *this)
        if (e.name == kind_or_name) return;
    std::string kinds;
    for (int i = 0; i <= static_cast<int>(EventKind::singular); ++i) {
        const std::string_view kind = name_of(static_cast<EventKind>(i));
        if (kind == kind_or_name) return;
        kinds += (i == 0 ? "" : ", ") + std::string(kind);
    }
    throw InvalidInput("Events: \"" + kind_or_name + "\" is no name in this run and no kind of event; the kinds are " +
                       kinds);
}

RBDYN_INLINE std::vector<double> Events::times(const std::string& kind_or_name,
                                               std::optional<BodyHandle> subject) const {
    require_known(kind_or_name);
    std::vector<double> result;
    for (const Event& e : *this)
        if ((name_of(e.kind) == kind_or_name || e.name == kind_or_name) && (!subject || e.subject == subject->index))
            result.push_back(e.time);
    return result;
}

RBDYN_INLINE std::vector<double> Events::times(const std::string& kind_or_name, ContactHandle contact) const {
    require_known(kind_or_name);
    std::vector<double> result;
    for (const Event& e : *this)
        if ((name_of(e.kind) == kind_or_name || e.name == kind_or_name) && e.contact == contact.index)
            result.push_back(e.time);
    return result;
}

}  // namespace rbdyn::inline RBDYN_FORM
