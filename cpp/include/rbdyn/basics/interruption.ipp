// Definitions of rbdyn/basics/interruption.hpp.
#pragma once

#include "rbdyn/basics/interruption.hpp"

#include <chrono>
#include <cstdint>
#include <functional>
#include <utility>

namespace rbdyn::inline RBDYN_FORM {

namespace interrupting {

/// The innermost of this thread.
RBDYN_INLINE Interruption*& present() {
    static thread_local Interruption* one = nullptr;
    return one;
}

constexpr std::int64_t interval = 50'000'000;  // ns

RBDYN_INLINE std::int64_t now() {
    using namespace std::chrono;
    return duration_cast<nanoseconds>(steady_clock::now().time_since_epoch()).count();
}

}  // namespace interrupting

RBDYN_INLINE Interruption::Interruption(std::function<void()> ask)
    : ask_(std::move(ask)), outer_(std::exchange(interrupting::present(), this)), asked_(interrupting::now()) {}

RBDYN_INLINE Interruption::~Interruption() { interrupting::present() = outer_; }

RBDYN_INLINE void Interruption::point() {
    Interruption* const one = interrupting::present();
    if (one != nullptr) one->look();
}

RBDYN_INLINE bool Interruption::has_ended() {
    const Interruption* const one = interrupting::present();
    return one != nullptr && one->has_ended_;
}

RBDYN_INLINE void Interruption::look() {
    if (interrupting::now() - asked_ < interrupting::interval) return;
    has_ended_ = true;
    ask_();
    has_ended_ = false;
    asked_ = interrupting::now();
}

}  // namespace rbdyn::inline RBDYN_FORM
