// The time of a call that is too short to be timed alone.
#pragma once

#include <algorithm>
#include <chrono>

namespace timing {

/// Microseconds of f(i): the least of several batches of `count` calls.
template <class Function>
double microseconds(int count, Function f, int batches = 51) {
    double best = 1e300;
    for (int batch = 0; batch < batches; ++batch) {
        const auto start = std::chrono::steady_clock::now();
        for (int i = 0; i < count; ++i) f(i);
        best = std::min(best, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count() / count);
    }
    return best * 1e6;
}

}  // namespace timing
