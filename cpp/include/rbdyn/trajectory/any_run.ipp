// Definitions of rbdyn/trajectory/any_run.hpp.
#pragma once

#include "rbdyn/trajectory/any_run.hpp"

#include <iomanip>
#include <sstream>
#include <string>

#include "rbdyn/event/event.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE std::string error_in_words(const AnyRun& run) {
    if (run.error()) {
        std::ostringstream error;
        error << std::setprecision(2) << *run.error();
        return "estimated global error " + error.str();
    }
    // what broke off was held against no second run, whatever was asked for
    const bool is_whole = run.status() == Status::reached_end || run.status() == Status::stopped_by_event;
    return std::string("no estimate of the global error") + (is_whole ? " (rtol)" : "");
}

}  // namespace rbdyn::inline RBDYN_FORM
