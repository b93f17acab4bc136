// A value that its copies share until one of them is changed.
#pragma once

#include <atomic>
#include <memory>

#include "rbdyn/basics/form.hpp"

namespace rbdyn::inline RBDYN_FORM {

/// Copies may be read, changed and let go by any thread each; one of them is for one thread at a time, like any value.
template <class T>
class Shared {
public:
    Shared() = default;
    // a move copies: what was moved from stays what it was
    Shared(const Shared&) = default;
    Shared& operator=(const Shared&) = default;

    const T& operator*() const {
        static const T none{};
        return value_ ? *value_ : none;
    }
    const T* operator->() const { return &**this; }
    /// Its own from here on, to be changed before it is copied again.
    T& change() {
        if (!value_) {
            value_ = std::make_shared<T>();
        } else if (value_.use_count() > 1) {
            value_ = std::make_shared<T>(*value_);
        } else {
            // after all that those who let it go have read
            std::atomic_thread_fence(std::memory_order_acquire);
        }
        return *value_;
    }
    bool operator==(const Shared& other) const { return value_ == other.value_ || **this == *other; }

private:
    std::shared_ptr<T> value_;
};

}  // namespace rbdyn::inline RBDYN_FORM
