// Definitions of rbdyn/options.hpp.
#pragma once

#include "rbdyn/options.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "rbdyn/basics/error.hpp"
#include "rbdyn/engine/cvode_factory.hpp"
#include "rbdyn/integrate.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE std::vector<std::string> engines() {
    std::vector<std::string> names = simulating::engines();
    names.insert(names.begin(), "closed form");
    return names;
}

}  // namespace rbdyn::inline RBDYN_FORM

namespace rbdyn::inline RBDYN_FORM::simulating {

RBDYN_INLINE Warn once(Warn warn) {
    if (!warn) return {};
    return [warn = std::move(warn), said = std::make_shared<std::atomic<bool>>(false)](const std::string& sentence) {
        if (!said->exchange(true)) warn(sentence);
    };
}

RBDYN_INLINE void require_engine(const std::string& object, const std::string& engine) {
    const std::vector<std::string> known = rbdyn::engines();
    if (engine == "auto" || std::find(known.begin(), known.end(), engine) != known.end()) return;
    std::string names = "auto";
    for (const std::string& name : known) names += ", " + name;
    const bool lacks_cvode = engine.rfind("cvode", 0) == 0 && cvode::names().empty();
    throw InvalidInput(object + ": engine is \"" + engine + "\"; this build has " + names +
                       (lacks_cvode ? ". cvode-adams and cvode-bdf need SUNDIALS, without which it was built: install "
                                      "it (Debian: libsundials-dev) and build rbdyn anew, with -DRBDYN_SUNDIALS=ON"
                                    : ""));
}

RBDYN_INLINE SimulateOptions continued(const SimulateOptions& asked, const ContinueOptions& options, double start) {
    if (options.error && options.rtol)
        throw InvalidInput("simulate: both error " + text(*options.error) + " and rtol " + text(*options.rtol) +
                           " are given; error is global and estimated, rtol local and without an estimate: give one");
    SimulateOptions o = asked;
    o.until = options.until;
    o.start = start;
    if (options.error || options.rtol) o.rtol = options.rtol;
    if (o.rtol)
        o.error = SimulateOptions{}.error;
    else
        o.error = options.error.value_or(asked.error);
    o.engine = options.engine.value_or(asked.engine);
    if (o.keep.what == Keep::What::times) o.keep = {};
    if (options.keep) o.keep = *options.keep;
    o.events = options.events;
    o.max_steps = options.max_steps.value_or(asked.max_steps);
    o.monitor = options.monitor;
    o.warn = options.warn;
    return o;
}

/// Beyond it powers of two that count its time, and what moves in it, are no doubles.
inline constexpr double longest_run = 0x1p1020;

RBDYN_INLINE void validate(const SimulateOptions& o) {
    require(std::isfinite(o.start), "simulate", "start", o.start, "a time is finite, in s");
    require(std::isfinite(o.until), "simulate", "until", o.until,
            "a time is finite, in s; simulate() of what something can stop takes inf");
    if (!(o.until > o.start))
        refuse("simulate", "until", o.until,
               "a run ends after its start, which is " + text(o.start) +
                   " s; motion backwards is motion with reversed velocities");
    if (!(o.until - o.start <= longest_run))
        refuse("simulate", "until", o.until,
               "it is at most 2^1020 s (1.1e307) after the start, " + text(o.start) +
                   " s, for longer times are no doubles; take a larger unit of time");
    if (o.rtol) {
        if (o.error != SimulateOptions{}.error)
            refuse("simulate", "error", o.error,
                   "it is given beside rtol " + text(*o.rtol) +
                       "; error is global and estimated, rtol local and without an estimate: give one");
        require(*o.rtol >= 1e-16 && *o.rtol <= 0.1, "simulate", "rtol", *o.rtol,
                "a local tolerance lies between 1e-16 and 0.1");
    } else if (!(o.error >= least_error && o.error <= 0.1)) {
        refuse("simulate", "error", o.error,
               "it lies between " + text(least_error) + ", the least that double precision can give, and 0.1");
    }
    require(o.max_steps > 0, "simulate", "max_steps", static_cast<double>(o.max_steps), "it is positive");
    for (double t : o.keep.times)
        require(t >= o.start && t <= o.until, "simulate", "a time of keep", t, "it lies between start and until");
}

}  // namespace rbdyn::inline RBDYN_FORM::simulating
