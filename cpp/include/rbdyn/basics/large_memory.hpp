// Memory for lists that are larger than the caches: it begins with a line of a cache, and where a system has pages that
// are larger than usual it is asked for those, so that a program that goes through all of it looks up fewer addresses.
#pragma once

#include <cstddef>
#include <new>
#include <vector>

#ifdef __linux__
#include <sys/mman.h>
#endif

#include "rbdyn/basics/form.hpp"

namespace rbdyn::inline RBDYN_FORM {

template <class T>
struct LargeAllocator {
    using value_type = T;
    static constexpr std::size_t line = 64, page = 1U << 21;
    /// Of less than a few large pages, what is rounded up would count.
    static constexpr std::size_t large = 2 * page;

    LargeAllocator() = default;
    template <class Other>
    LargeAllocator(const LargeAllocator<Other>&) {}

    static std::align_val_t alignment(std::size_t count) {
        return std::align_val_t{count * sizeof(T) < large ? line : page};
    }
    T* allocate(std::size_t count) {
        void* const start = ::operator new(count * sizeof(T), alignment(count));
#ifdef MADV_HUGEPAGE
        // advice, no more: a system without such pages goes on with others
        if (count * sizeof(T) >= large) madvise(start, count * sizeof(T) / page * page, MADV_HUGEPAGE);
#endif
        return static_cast<T*>(start);
    }
    void deallocate(T* start, std::size_t count) { ::operator delete(start, alignment(count)); }

    friend bool operator==(const LargeAllocator&, const LargeAllocator&) { return true; }
};

template <class T>
using LargeVector = std::vector<T, LargeAllocator<T>>;

}  // namespace rbdyn::inline RBDYN_FORM
