// Runs without an end of their own, until = infinity: what stops them ends them.
//
// When that is, is looked for by cheap runs of 1 s, 4, 16 and so on; the run that is returned is one to twice the time
// found, as accurate as asked for: it is the same with any time beyond its end, for whether an event is found never
// depends on `until`. If it is not stopped there, it is run for ever longer times.
#pragma once

#include "rbdyn/basics/error.hpp"
#include "rbdyn/basics/form.hpp"
#include "rbdyn/event/event.hpp"
#include "rbdyn/options.hpp"

namespace rbdyn::inline RBDYN_FORM::simulating {

/// Throws InvalidInput if nothing can stop a run without an end.
void require_stop(bool may_stop);

/// What is asked of a run that lasts a time.
SimulateOptions lasting(SimulateOptions options, double span);
/// What is asked of one that looks for its end alone.
SimulateOptions looking(SimulateOptions options);

/// What one(options) makes of a run that something stops.
template <class One>
auto until_stopped(const SimulateOptions& options, const One& one) {
    // 36 thousand million years
    constexpr double longest = 0x1p60;
    SimulateOptions all = options;
    all.warn = once(options.warn);
    const SimulateOptions rough = looking(all);
    double span = 1.0;
    for (; span <= longest; span *= 4.0) {
        const auto found = one(lasting(rough, span));
        if (found.outcome == Outcome::good && found.run.status() == Status::reached_end) continue;
        // what broke off is to break off again, in the run that is returned
        if (found.run.status() == Status::stopped_by_event) span = 2.0 * (found.run.end() - options.start);
        break;
    }
    // a function of the events is called with those of the run that is returned alone
    SimulateOptions silent = all;
    silent.events.each = {};
    for (; span <= longest; span *= 4.0) {
        auto attempt = one(lasting(silent, span));
        if (attempt.outcome == Outcome::good && attempt.run.status() == Status::reached_end) continue;
        return options.events.each ? one(lasting(all, span)) : attempt;
    }
    throw InvalidInput("simulate: until is inf, and nothing stopped the run up to t = " +
                       text(options.start + 0.25 * span) + " s; give a time, or watch for what happens");
}

}  // namespace rbdyn::inline RBDYN_FORM::simulating
