// A function of the user's that could not be recorded, called back with numbers.
//
// It has no derivatives and no Taylor series: engines that need them cannot run it, and its events are located from
// its values alone.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "rbdyn/basics/form.hpp"

namespace rbdyn::inline RBDYN_FORM {

/// A function of some numbers with some results, opaque. What it throws passes through the engines unchanged.
struct Callback {
    std::string name;    // as the user knows it
    std::string reason;  // why it is called back: what could not be recorded, and where
    int inputs = 0, outputs = 0;
    std::function<void(const double* x, double* y)> function;
    bool is_python = false;  // runs in Python's interpreter
    mutable std::atomic<std::int64_t> calls{0};

    void operator()(const double* x, double* y) const;
};

/// A callback that is one. Throws InvalidInput if there is none, or no function in it. `object`: what it is given to.
std::shared_ptr<const Callback> callable(std::shared_ptr<const Callback> callback, const std::string& object);

}  // namespace rbdyn::inline RBDYN_FORM
