// Definitions of rbdyn/system/system.hpp.
#pragma once

#include "rbdyn/system/system.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "rbdyn/basics/error.hpp"
#include "rbdyn/expression/numbers.hpp"
#include "rbdyn/expression/own_function.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE System::System(OwnFunction f, std::vector<double> start, std::vector<std::string> names)
    : f_(std::move(f)), start_(std::move(start)), names_(std::move(names)) {
    const int n = count(start_);
    for (int i = 0; i < n; ++i)
        require(std::isfinite(start_[static_cast<std::size_t>(i)]), "System", "x0[" + std::to_string(i) + "]",
                start_[static_cast<std::size_t>(i)], "a state is finite");
    // what steps and errors are made of, powers of a tolerance times a state, are numbers too
    constexpr double most = 1e250;
    const auto largest =
        std::max_element(start_.begin(), start_.end(), [](double a, double b) { return std::abs(a) < std::abs(b); });
    require(std::abs(*largest) < most, "System", "x0[" + std::to_string(largest - start_.begin()) + "]", *largest,
            "a state is below 1e250 in size; give it in larger units");
    require(f_.inputs() == 1 + n, "System", "count of inputs of f", f_.inputs(),
            "it takes the time and " + std::to_string(n) + " variables, as many as x0 has");
    require(f_.outputs() == n, "System", "count of results of f", f_.outputs(),
            "it gives the rates of " + std::to_string(n) + " variables, as many as x0 has");
    if (names_.empty()) return;
    require(names_.size() == start_.size(), "System", "count of names", static_cast<double>(names_.size()),
            "there is one for each of the " + std::to_string(n) + " variables, or none");
    for (auto name = names_.begin(); name != names_.end(); ++name) {
        if (name->empty()) throw InvalidInput("System: a name is empty; variables are found by their names");
        require_no_zero("System", *name);
        if (std::find(names_.begin(), name, *name) != name)
            throw InvalidInput("System: there are two variables named \"" + *name + "\"; names differ");
    }
}

RBDYN_INLINE int System::count(const std::vector<double>& start) {
    if (start.empty())
        throw InvalidInput("System: x0 has 0 numbers; it is the state to start in, one number a variable");
    return static_cast<int>(start.size());
}

RBDYN_INLINE std::string System::name(int variable) const {
    return names_.empty() ? "x[" + std::to_string(variable) + "]" : names_[static_cast<std::size_t>(variable)];
}

RBDYN_INLINE int System::place(const std::string& name) const {
    const auto found = std::find(names_.begin(), names_.end(), name);
    if (found != names_.end()) return static_cast<int>(found - names_.begin());
    std::string list;
    for (const std::string& known : names_) list += (list.empty() ? "\"" : ", \"") + known + "\"";
    throw InvalidInput("System: there is no variable named \"" + name + "\"; " +
                       (list.empty() ? "its variables have no names: give names=" : "there are " + list));
}

RBDYN_INLINE System System::from(std::vector<double> start) const {
    require(start.size() == start_.size(), "System", "count of numbers of a state", static_cast<double>(start.size()),
            "it has " + std::to_string(variables()) + " variables");
    System result(f_, std::move(start), names_);
    result.watches_ = watches_;
    return result;
}

RBDYN_INLINE void System::watch(std::string name, OwnFunction function, StateWatchOptions options) {
    if (name.empty()) throw InvalidInput("watch: name is empty; events are found by the name of their watch");
    require_no_zero("watch", name);
    for (const Watch& w : watches_)
        if (w.name == name) throw InvalidInput("watch: there is one named \"" + name + "\" already; names differ");
    const std::string user = "watch \"" + name + "\"";
    require(function.inputs() == 1 + variables(), user, "count of inputs of its function", function.inputs(),
            "it takes the time and " + std::to_string(variables()) + " variables");
    require(function.outputs() == 1, user, "count of results of its function", function.outputs(), "it gives one");
    if (options.action.kind == WatchAction::Kind::change && !options.action.change)
        throw InvalidInput(user + ": its action changes the state and has no function; give one as its change");
    watches_.push_back({std::move(name), std::move(function), std::move(options)});
}

RBDYN_INLINE System System::frozen() const {
    System result = *this;
    result.f_ = f_.frozen();
    for (Watch& w : result.watches_) w.function = w.function.frozen();
    return result;
}

RBDYN_INLINE GivenNumbers System::numbers() const {
    GivenNumbers numbers;
    if (f_.function()) f_.give(numbers);
    for (const Watch& w : watches_)
        if (w.function.function()) w.function.give(numbers);
    return numbers;
}

RBDYN_INLINE bool System::calls_python() const {
    const auto is_python = [](const OwnFunction& f) { return f.callback() && f.callback()->is_python; };
    return is_python(f_) || std::any_of(watches_.begin(), watches_.end(), [&](const Watch& w) {
               return is_python(w.function) || w.options.action.change;
           });
}

RBDYN_INLINE std::int64_t System::python_calls() const {
    const auto calls = [](const OwnFunction& f) {
        return f.callback() && f.callback()->is_python ? f.callback()->calls.load() : 0;
    };
    std::int64_t sum = calls(f_);
    for (const Watch& w : watches_) sum += calls(w.function);
    return sum;
}

}  // namespace rbdyn::inline RBDYN_FORM
