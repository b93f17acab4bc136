// Definitions of rbdyn/basics/interruption.hpp.
#pragma once

#include "rbdyn/basics/interruption.hpp"

#include <algorithm>
#include <functional>
#include <utility>

namespace rbdyn::inline RBDYN_FORM {

namespace interrupting {

/// The innermost of this thread.
RBDYN_INLINE Interruption*& present() {
    static thread_local Interruption* one = nullptr;
    return one;
}

}  // namespace interrupting

RBDYN_INLINE Interruption::Interruption(std::function<void()> ask)
    : ask_(std::move(ask)), outer_(std::exchange(interrupting::present(), this)) {}

RBDYN_INLINE Interruption::~Interruption() { interrupting::present() = outer_; }

RBDYN_INLINE void Interruption::point() {
    Interruption* const one = interrupting::present();
    if (one != nullptr && ++one->points_ >= one->stride_) one->look();
}

RBDYN_INLINE void Interruption::look() {
    constexpr int longest = 4096;
    const Clock::time_point now = Clock::now();
    // a tenth of the interval between two looks
    stride_ = now - looked_ > interval / 10 ? std::max(stride_ / 4, 1) : std::min(2 * stride_, longest);
    points_ = 0;
    looked_ = now;
    if (now - asked_ < interval) return;
    ask_();
    asked_ = looked_ = Clock::now();
}

}  // namespace rbdyn::inline RBDYN_FORM
