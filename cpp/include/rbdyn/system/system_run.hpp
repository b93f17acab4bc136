// simulate(system): the motion of a System, as accurate as asked for.
#pragma once

#include <exception>
#include <memory>
#include <ostream>
#include <string>
#include <string_view>
#include <vector>

#include "rbdyn/basics/error.hpp"
#include "rbdyn/basics/form.hpp"
#include "rbdyn/event/keep.hpp"
#include "rbdyn/options.hpp"
#include "rbdyn/system/system.hpp"
#include "rbdyn/trajectory/any_run.hpp"
#include "rbdyn/trajectory/events.hpp"
#include "rbdyn/trajectory/statistics.hpp"

namespace rbdyn::inline RBDYN_FORM {

class SystemModel;  // system/system_model.hpp
namespace simulating {
struct Solution;  // integrate.hpp
}

/// The motion of a System. It outlives the system, which it has with the numbers it ran with.
class SystemRun : public AnyRun {
public:
    SystemRun(std::shared_ptr<const SystemModel> model, simulating::Solution solution, std::string engine,
              Statistics statistics);
    // a move copies: what was moved from stays what it was
    SystemRun(const SystemRun&) = default;
    SystemRun& operator=(const SystemRun&) = default;

    const System& system() const;
    const Events& events() const { return *events_; }
    const Statistics& statistics() const { return statistics_; }
    /// The start and the ends of all steps that are kept, increasing [s].
    std::vector<double> times() const;

    /// The state at a time. Throws InvalidInput for a time the run does not hold.
    std::vector<double> x(double t, Side side = Side::after) const;
    /// Its rate, f(t, x) on the side of each case distinction that the motion is on. Throws as x() does.
    std::vector<double> rate(double t, Side side = Side::after) const;

    /// All that was computed.
    const simulating::Solution& solution() const { return *solution_; }

private:
    std::shared_ptr<const SystemModel> model_;
    std::shared_ptr<const simulating::Solution> solution_;
    std::shared_ptr<const Events> events_;
    Statistics statistics_;
};

std::ostream& operator<<(std::ostream& out, const SystemRun& run);

/// A run of a System came to less than was asked for; `run` is what is there.
struct SystemError : Error {
    SystemError(const std::string& message, SystemRun partial);
    SystemRun run;
};

/// What simulate() came to: a run, whole or partial, and what went wrong if anything did.
struct SystemAttempt {
    simulating::Outcome outcome;
    std::string message;
    std::exception_ptr thrown;  // by a function of the user's
    SystemRun run;
};

namespace simulating {
/// The engine that one of a name is for a system. Throws InvalidInput for one that cannot do it.
std::string engine_for(const System& system, const std::string& wanted);
}  // namespace simulating

/// Runs a system and returns what there is, failures with it. Throws InvalidInput for options that break a rule.
SystemAttempt attempt(const System& system, const SimulateOptions& options);

/// Runs a system. Throws InvalidInput for options that break a rule, SystemError with the partial run if the error
/// asked for is out of reach or the motion cannot be continued. What a function of the user's throws passes unchanged.
SystemRun simulate(const System& system, const SimulateOptions& options);

/// What was computed of a run, beside its system.
[[gnu::cold]] std::string bytes_of(const SystemRun& run);
/// The run that bytes were written for, of its system. Throws InvalidInput if they are of no run of it.
[[gnu::cold]] SystemRun system_run_from(const System& system, std::string_view bytes);

}  // namespace rbdyn::inline RBDYN_FORM
