// Definitions of rbdyn/until_stopped.hpp.
#pragma once

#include "rbdyn/until_stopped.hpp"

#include <algorithm>
#include <vector>

#include "rbdyn/basics/error.hpp"
#include "rbdyn/event/keep.hpp"
#include "rbdyn/options.hpp"

namespace rbdyn::inline RBDYN_FORM::simulating {

RBDYN_INLINE void require_stop(bool may_stop) {
    if (!may_stop)
        throw InvalidInput(
            "simulate: until is inf, and nothing can stop the run; give a time in s, or watch for what is to stop it, "
            "with "
            "action \"stop\"");
}

RBDYN_INLINE SimulateOptions lasting(SimulateOptions options, double span) {
    options.until = options.start + span;
    std::erase_if(options.keep.times, [&](double t) { return t > options.until; });
    return options;
}

RBDYN_INLINE SimulateOptions looking(SimulateOptions options) {
    constexpr double rough = 1e-6;
    options.rtol = std::max(options.rtol.value_or(rough), rough);
    options.error = SimulateOptions{}.error;
    options.keep = {.what = Keep::What::end};
    options.events = {.what = KeepEvents::What::last};
    return options;
}

}  // namespace rbdyn::inline RBDYN_FORM::simulating
