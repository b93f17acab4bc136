// What verbs that run scenes share: they run without Python's lock, look for Ctrl-C and show progress.
#pragma once

#include <chrono>
#include <exception>
#include <optional>
#include <rbdyn/options.hpp>
#include <rbdyn/simulate.hpp>
#include <string>
#include <variant>

#include "run.hpp"

namespace binding {

/// Asked by what runs whether to go on: takes Python's lock now and then, to show progress and to ask whether a signal
/// has come. What Python raises there stops the run, and is kept.
class Watch {
public:
    // runs within runs that callbacks may start: each takes some ten kilobytes of the stack
    static constexpr int most_nested = 20;

    explicit Watch(const py::object& progress);
    Watch(const Watch&) = delete;
    Watch& operator=(const Watch&) = delete;
    /// With the lock held.
    ~Watch();

    /// Without the lock, with the fraction that is done.
    bool goes_on(double fraction);
    /// With the lock held: asks for signals, shows the fraction done.
    void look(double fraction);
    /// Of a run from `start` to `until`.
    rbdyn::Monitor monitor(double start, double until) {
        return [this, start, until](double t) { return goes_on((t - start) / (until - start)); };
    }
    /// Shows Python a RuntimeWarning; where warnings are errors, it stops the run.
    rbdyn::Warn warn() {
        return [this](const std::string& sentence) { say(sentence); };
    }
    const std::optional<py::error_already_set>& raised() const { return raised_; }

    /// With the lock held: what Python raised is raised again, with `run` on it.
    template <class Run = BoundTrajectory>
    void raise_if_raised(const std::optional<Run>& run) {
        if (!raised_) return;
        if (run && PyObject_SetAttrString(raised_->value().ptr(), "run", py::cast(*run).ptr()) != 0) PyErr_Clear();
        throw py::error_already_set(*raised_);
    }

private:
    void say(const std::string& sentence);

    using Clock = std::chrono::steady_clock;
    // far below the second within which Ctrl-C is obeyed, far above the time that taking the lock needs
    static constexpr auto interval = std::chrono::milliseconds(50);

    py::object show_;
    std::optional<py::error_already_set> raised_;
    Clock::time_point last_ = Clock::now();
};

/// What of events is kept: "all", "last", or a function that is called with each.
rbdyn::KeepEvents events_of(const py::object& events, const std::shared_ptr<const Handles>& handles);

using KeepLike = std::variant<std::string, ArrayLike>;

rbdyn::Keep keep_of(const KeepLike& keep);

/// What simulate() is asked for, but for its monitor.
rbdyn::SimulateOptions options_of(double until, double start, std::optional<double> error, std::optional<double> rtol,
                                  const std::string& engine, const KeepLike& keep, std::int64_t max_steps);

/// Whether functions in Python are called at every step: then the lock is kept, which makes that cheap.
bool calls_python(const rbdyn::Scene& scene);

/// An error of the library with the run it left behind.
template <class Run>
py::object error_with(const Run& run, const char* type_name, const std::string& message) {
    const py::object raised = py::module_::import("rbdyn.errors").attr(type_name)(message);
    raised.attr("run") = py::cast(run);
    return raised;
}

/// What a function of the user's threw, unchanged but for the run it broke off.
py::object failure_of(const std::exception_ptr& thrown, const py::object& run);

/// What went wrong with an attempt, with its run: an error of the library, or what a function of the user's threw. None
/// if nothing did.
template <class Attempt, class Run>
py::object failure_of(const Attempt& attempt, const Run& run) {
    using Outcome = rbdyn::simulating::Outcome;
    switch (attempt.outcome) {
        case Outcome::good: return py::none();
        case Outcome::inaccurate: return error_with(run, "AccuracyError", attempt.message);
        case Outcome::broken: return error_with(run, "IntegrationError", attempt.message);
        case Outcome::thrown: break;
    }
    return failure_of(attempt.thrown, py::cast(run));
}

/// Raises it.
[[noreturn]] void raise(const py::object& error);

/// What a verb that runs a scene many times makes of it, without Python's lock where no function needs it; an error of
/// a run carries that run.
template <class Verb>
auto tabulated(const rbdyn::Scene& scene, const Handles& handles, Watch& watch, const Verb& verb) {
    const auto raise_with = [&](const auto& e, const char* type_name) {
        raise(error_with(BoundTrajectory{e.run, std::make_shared<const Handles>(handles)}, type_name, e.what()));
    };
    std::optional<decltype(verb())> table;
    try {
        const Unlocked free(!calls_python(scene));
        table = verb();
    } catch (const rbdyn::AccuracyError& e) {
        raise_with(e, "AccuracyError");
    } catch (const rbdyn::IntegrationError& e) {
        raise_with(e, "IntegrationError");
    }
    watch.look(1.0);
    watch.raise_if_raised<BoundTrajectory>(std::nullopt);
    return *std::move(table);
}

}  // namespace binding
