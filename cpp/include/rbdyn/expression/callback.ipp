// Definitions of rbdyn/expression/callback.hpp.
#pragma once

#include "rbdyn/expression/callback.hpp"

#include <atomic>
#include <memory>
#include <string>
#include <utility>

#include "rbdyn/basics/error.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE void Callback::operator()(const double* x, double* y) const {
    calls.fetch_add(1, std::memory_order_relaxed);
    function(x, y);
}

RBDYN_INLINE std::shared_ptr<const Callback> callable(std::shared_ptr<const Callback> callback,
                                                      const std::string& object) {
    if (!callback)
        throw InvalidInput(object + ": there is no callback; it was empty, or moved from. Give one with a function");
    if (!callback->function) throw InvalidInput(object + ": its callback has no function; give it one");
    return callback;
}

}  // namespace rbdyn::inline RBDYN_FORM
