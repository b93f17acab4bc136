// simulate(model): the motion of a model of the user's own, as accurate as asked for.
#pragma once

#include <memory>
#include <ostream>
#include <string>
#include <vector>

#include "rbdyn/basics/error.hpp"
#include "rbdyn/basics/form.hpp"
#include "rbdyn/engine/work.hpp"
#include "rbdyn/event/event.hpp"
#include "rbdyn/event/keep.hpp"
#include "rbdyn/expression/functor.hpp"
#include "rbdyn/model/own_model.hpp"
#include "rbdyn/options.hpp"
#include "rbdyn/trajectory/any_run.hpp"

namespace rbdyn::inline RBDYN_FORM {

namespace simulating {
struct Solution;  // integrate.hpp
}

/// The motion of a model of the user's own.
class StateRun : public AnyRun {
public:
    StateRun(simulating::Solution solution, std::string engine);
    // a move copies: what was moved from stays what it was
    StateRun(const StateRun&) = default;
    StateRun& operator=(const StateRun&) = default;

    const std::vector<Event>& events() const;
    const Work& work() const;

    int variables() const;
    /// All that was computed.
    const simulating::Solution& solution() const;
    /// The state at a time. Throws InvalidInput for a time the run does not hold.
    std::vector<double> state(double t, Side side = Side::after) const;

private:
    std::shared_ptr<const simulating::Solution> solution_;
};

std::ostream& operator<<(std::ostream& out, const StateRun& run);

/// A run of a model of the user's own came to less than was asked for; `run` is what is there.
struct ModelError : Error {
    ModelError(const std::string& message, StateRun partial);
    StateRun run;
};

namespace simulating {

/// What simulate(model, state, options) does once the model is recorded.
StateRun simulate_own(const HybridModel& model, const std::vector<double>& state, const SimulateOptions& options);

}  // namespace simulating

/// Runs a model of the user's own from a state. Throws as simulate(scene) does; what a failed run had is in the error.
template <OwnModel M>
StateRun simulate(const M& model, const std::vector<double>& state, const SimulateOptions& options) {
    return simulating::simulate_own(FunctorModel<M>(model), state, options);
}
template <class M>
requires(!OwnModel<M>) StateRun simulate(const M&, const std::vector<double>&, const SimulateOptions&) {
    static_assert(recording::fits<M>,
                  "a model of your own has `int variables() const` and is called as model(t, x, rate), a number, a "
                  "std::span<const S> and a std::span<S>: a template over S");
    throw Error("no model");
}

}  // namespace rbdyn::inline RBDYN_FORM
