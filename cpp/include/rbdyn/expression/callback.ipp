// Definitions of rbdyn/expression/callback.hpp.
#pragma once

#include "rbdyn/expression/callback.hpp"

#include <atomic>

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE void Callback::operator()(const double* x, double* y) const {
    calls.fetch_add(1, std::memory_order_relaxed);
    function(x, y);
}

}  // namespace rbdyn::inline RBDYN_FORM
