// The time that a thread computes for: what a price is measured in, so that others on the machine are not in it.
#pragma once

#include <ctime>

#include "rbdyn/basics/form.hpp"

namespace rbdyn::inline RBDYN_FORM {

/// Processor time of this thread [s]; of the process where the system does not tell them apart.
inline double processor_seconds() {
#ifdef CLOCK_THREAD_CPUTIME_ID
    timespec now{};
    if (clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now) == 0)
        return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
#endif
    return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

}  // namespace rbdyn::inline RBDYN_FORM
