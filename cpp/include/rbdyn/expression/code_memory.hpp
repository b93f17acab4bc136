// Memory of machine code: written first and run after, never both at a time.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/series/lanes.hpp"

#if defined(RBDYN_MACHINE_CODE) && defined(RBDYN_WIDE_LANES) && defined(__linux__) && defined(__LP64__)
#define RBDYN_WRITES_MACHINE_CODE 1
#endif

namespace rbdyn::inline RBDYN_FORM {

class CodeMemory {
public:
    // bytes of one program: a share of the second cache, where its numbers are too
    static constexpr std::size_t most = 1U << 18;

    /// Whether this library can make any code (its CMake option RBDYN_MACHINE_CODE).
    static bool is_built();
    /// And this processor can run it.
    static bool is_usable();
    /// With these bytes, ready to be run; none where a system forbids it.
    static std::optional<CodeMemory> of(std::span<const std::uint8_t> bytes);
    CodeMemory(CodeMemory&& other) noexcept : start_(std::exchange(other.start_, nullptr)), size_(other.size_) {}
    CodeMemory& operator=(CodeMemory&&) = delete;
    ~CodeMemory();

    std::size_t size() const { return size_; }
    void* start() const { return start_; }

private:
    CodeMemory(void* start, std::size_t size) : start_(start), size_(size) {}

    void* start_;
    std::size_t size_;
};

}  // namespace rbdyn::inline RBDYN_FORM
