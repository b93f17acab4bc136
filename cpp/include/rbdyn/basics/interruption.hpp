// How what takes long and has no monitor (options.hpp) is ended: states of rest, work, lengths, values at many times.
//
// It asks at its points whether to go on. Where nobody wants to know, that is a comparison; else the clock is read, and
// a question put every 50 ms, as far as the points lie no further apart. What does less than a clock takes to be read
// (20 ns) has a point every so many times.
#pragma once

#include <cstdint>
#include <functional>

#include "rbdyn/basics/form.hpp"

namespace rbdyn::inline RBDYN_FORM {

/// As long as it lives, computations of its thread call a function now and then; what that throws ends them.
class Interruption {
public:
    explicit Interruption(std::function<void()> ask);
    ~Interruption();
    Interruption(const Interruption&) = delete;
    Interruption& operator=(const Interruption&) = delete;

    /// A point where a computation may be ended: throws what the function does.
    static void point();
    /// Whether the innermost function of this thread has ended a computation: what is thrown then is nobody's to keep.
    static bool has_ended();

private:
    void look();

    std::function<void()> ask_;
    Interruption* outer_;
    std::int64_t asked_;  // when [ns]: what asks for a clock's header is read by all that has points
    bool has_ended_ = false;
};

}  // namespace rbdyn::inline RBDYN_FORM
