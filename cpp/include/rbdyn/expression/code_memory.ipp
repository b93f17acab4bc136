// Definitions of rbdyn/expression/code_memory.hpp.
#pragma once

#include "rbdyn/expression/code_memory.hpp"

#include <cstdint>
#include <cstring>
#include <optional>
#include <span>

#ifdef RBDYN_WRITES_MACHINE_CODE
#include <sys/mman.h>
#endif

namespace rbdyn::inline RBDYN_FORM {

#ifdef RBDYN_WRITES_MACHINE_CODE

RBDYN_INLINE bool CodeMemory::is_built() { return true; }
RBDYN_INLINE bool CodeMemory::is_usable() { return __builtin_cpu_supports("avx2"); }

RBDYN_INLINE std::optional<CodeMemory> CodeMemory::of(std::span<const std::uint8_t> bytes) {
    void* start = mmap(nullptr, bytes.size(), PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    if (start == MAP_FAILED) return std::nullopt;
    CodeMemory memory(start, bytes.size());
    std::memcpy(start, bytes.data(), bytes.size());
    if (mprotect(start, bytes.size(), PROT_READ | PROT_EXEC) != 0) return std::nullopt;
    return memory;
}

RBDYN_INLINE CodeMemory::~CodeMemory() {
    if (start_ != nullptr) munmap(start_, size_);
}

#else

RBDYN_INLINE bool CodeMemory::is_built() { return false; }
RBDYN_INLINE bool CodeMemory::is_usable() { return false; }
RBDYN_INLINE std::optional<CodeMemory> CodeMemory::of(std::span<const std::uint8_t>) { return std::nullopt; }
RBDYN_INLINE CodeMemory::~CodeMemory() = default;

#endif

}  // namespace rbdyn::inline RBDYN_FORM
