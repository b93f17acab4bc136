// What simulate() is asked for.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/event/keep.hpp"

namespace rbdyn::inline RBDYN_FORM {

/// What a run is asked to be.
struct SimulateOptions {
    double until = 0.0;                         // s; infinity: until something stops it
    double start = 0.0;                         // s
    double error = 1e-9;                        // global, relative to the motion's own scales
    std::optional<double> rtol = std::nullopt;  // local tolerance only, no estimate: the cheap way
    std::string engine = "auto";                // "closed form", "taylor", "dop853", "cvode-adams", "cvode-bdf"
    Keep keep = {};
    KeepEvents events = {};
    std::int64_t max_steps = 100'000'000;
    Monitor monitor = {};  // called now and then with the time reached; false stops the run
    Warn warn = {};        // called at most once, with figures, if what is kept will not fit into memory
};

/// The names of the engines that this build has, as `engine` takes them beside "auto".
std::vector<std::string> engines();

/// What a run that goes on with another is asked to be; what is not given is as for that one.
struct ContinueOptions {
    double until = 0.0;  // s; infinity: until something stops it
    std::optional<double> error = std::nullopt, rtol = std::nullopt;
    std::optional<std::string> engine = std::nullopt;
    std::optional<Keep> keep = std::nullopt;  // else all of it, or its end if that was asked for
    KeepEvents events = {};
    std::optional<std::int64_t> max_steps = std::nullopt;
    Monitor monitor = {};
    Warn warn = {};
};

namespace simulating {

/// What came of a run.
enum class Outcome {
    good,
    inaccurate,  // the error asked for was not reached
    broken,      // the motion could not be continued
    thrown       // a function of the user's threw
};

/// Below this double precision cannot promise anything (about 20 units in the last place).
inline constexpr double least_error = 4e-15;

/// What a run is asked to be that goes on at a time with one that was asked for these.
SimulateOptions continued(const SimulateOptions& asked, const ContinueOptions& options, double start);

/// Calls a function the first time only.
Warn once(Warn warn);

/// Throws InvalidInput, with the names there are and what would bring it in, for an engine that this build has not.
void require_engine(const std::string& object, const std::string& engine);

/// Throws InvalidInput for options that break a rule.
void validate(const SimulateOptions& o);

}  // namespace simulating

}  // namespace rbdyn::inline RBDYN_FORM
