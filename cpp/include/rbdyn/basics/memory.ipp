// Definitions of rbdyn/basics/memory.hpp.
#pragma once

#include "rbdyn/basics/memory.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <fstream>
#include <optional>
#include <string>
#ifdef __unix__
#include <sys/resource.h>
#include <unistd.h>
#elif defined(__APPLE__)
#include <unistd.h>
#endif

namespace rbdyn::inline RBDYN_FORM {

namespace memory {

/// The number that a file begins with.
RBDYN_INLINE std::optional<double> number_in(const char* path) {
    std::ifstream file(path);
    double value = 0.0;
    if (file >> value) return value;
    return std::nullopt;
}

/// A line of Linux' /proc/meminfo or /proc/self/statm's like, in kB, as bytes.
RBDYN_INLINE std::optional<double> line_of(const char* path, const std::string& name) {
    std::ifstream file(path);
    for (std::string word; file >> word;) {
        double value = 0.0;
        if (word == name + ":" && file >> value) return 1024.0 * value;
    }
    return std::nullopt;
}

}  // namespace memory

RBDYN_INLINE std::optional<double> available_memory() {
    using memory::line_of, memory::number_in;
    std::optional<double> least = line_of("/proc/meminfo", "MemAvailable");
    const auto at_most = [&](std::optional<double> limit, std::optional<double> used) {
        if (limit && used) least = std::min(least.value_or(*limit), std::max(*limit - *used, 0.0));
    };
#if defined(_SC_PHYS_PAGES) && defined(_SC_PAGESIZE)
    if (const long pages = sysconf(_SC_PHYS_PAGES), size = sysconf(_SC_PAGESIZE); !least && pages > 0 && size > 0)
        least = static_cast<double>(pages) * static_cast<double>(size);
#endif
    at_most(number_in("/sys/fs/cgroup/memory.max"), number_in("/sys/fs/cgroup/memory.current"));
#ifdef __unix__
    if (rlimit limit{}; getrlimit(RLIMIT_AS, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY)
        at_most(static_cast<double>(limit.rlim_cur), line_of("/proc/self/status", "VmSize"));
#endif
    return least;
}

RBDYN_INLINE std::string bytes_text(double bytes) {
    static constexpr std::array<const char*, 6> units = {"B", "kB", "MB", "GB", "TB", "PB"};
    std::size_t unit = 0;
    for (; bytes >= 999.5 && unit + 1 < units.size(); ++unit) bytes /= 1000.0;
    char text[32];
    std::snprintf(text, sizeof text, bytes < 9.95 && unit > 0 ? "%.1f %s" : "%.0f %s", bytes, units[unit]);
    return text;
}

}  // namespace rbdyn::inline RBDYN_FORM
