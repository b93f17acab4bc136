// What simulate() is asked for.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/event/keep.hpp"

namespace rbdyn::inline RBDYN_FORM {

/// What a run is asked to be.
struct SimulateOptions {
    double until = 0.0;                         // s
    double start = 0.0;                         // s
    double error = 1e-9;                        // global, relative to the motion's own scales
    std::optional<double> rtol = std::nullopt;  // local tolerance only, no estimate: the cheap way
    std::string engine = "auto";                // "closed form", "taylor", "dop853", "cvode-adams", "cvode-bdf"
    Keep keep = {};
    std::int64_t max_steps = 100'000'000;
    Monitor monitor = {};  // called now and then with the time reached; false stops the run
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

/// Throws InvalidInput for options that break a rule.
void validate(const SimulateOptions& o);

}  // namespace simulating

}  // namespace rbdyn::inline RBDYN_FORM
