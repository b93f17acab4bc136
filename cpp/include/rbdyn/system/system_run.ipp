// Definitions of rbdyn/system/system_run.hpp.
#pragma once

#include "rbdyn/system/system_run.hpp"

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <iomanip>
#include <limits>
#include <memory>
#include <ostream>
#include <sstream>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "rbdyn/event/record.hpp"
#include "rbdyn/integrate.hpp"
#include "rbdyn/solve.hpp"
#include "rbdyn/system/system_model.hpp"
#include "rbdyn/system/system_plan.hpp"
#include "rbdyn/trajectory/run_bytes.hpp"
#include "rbdyn/until_stopped.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE SystemRun::SystemRun(std::shared_ptr<const SystemModel> model, simulating::Solution solution,
                                  std::string engine, Statistics statistics)
    : AnyRun(solution.record.status, solution.record.start, solution.record.end.hi, solution.certain_until,
             std::move(engine), solution.error),
      model_(std::move(model)),
      solution_(std::make_shared<const simulating::Solution>(std::move(solution))),
      statistics_(std::move(statistics)) {
    std::vector<std::string> names;
    for (const System::Watch& w : system().watches()) names.push_back(w.name);
    events_ = std::make_shared<const Events>(Events(solution_->record.events).among(std::move(names)));
}

RBDYN_INLINE const System& SystemRun::system() const { return model_->system(); }

RBDYN_INLINE std::vector<double> SystemRun::times() const {
    std::vector<double> times;
    const auto add = [&](double t) {
        if (times.empty() || t > times.back()) times.push_back(t);
    };
    const Record& record = solution_->record;
    for (std::size_t i = 0; i < record.entries().size(); ++i) {
        const Piece piece = record.piece(i);
        add(piece.start.hi);
        add(piece.at(record.entries()[i].length).hi);
    }
    if (times.empty()) add(record.start);
    return times;
}

RBDYN_INLINE std::vector<double> SystemRun::x(double t, Side side) const {
    return state_at(solution_->record, t, side);
}

RBDYN_INLINE std::vector<double> SystemRun::rate(double t, Side side) const {
    const Record& record = solution_->record;
    const auto entry = entry_at(record, t, side);
    const Mode mode = entry ? record.mode(*entry) : record.modes.empty() ? Mode{} : record.modes.front();
    return model_->rate(mode, t, x(t, side));
}

RBDYN_INLINE std::ostream& operator<<(std::ostream& out, const SystemRun& run) {
    out << "Run: " << name_of(run.status()) << " at t = " << text(run.end());
    if (run.status() == Status::stopped_by_event && !run.events().empty()) out << ", " << run.events().back().name;
    out << ". " << advice(run.status()) << "\n  engine " << run.engine() << ", " << run.statistics().steps << " steps, "
        << run.events().size() << " events, ";
    return out << error_in_words(run) << '\n';
}

RBDYN_INLINE SystemError::SystemError(const std::string& message, SystemRun partial)
    : Error(message), run(std::move(partial)) {}

RBDYN_INLINE std::string simulating::engine_for(const System& system, const std::string& wanted) {
    const std::string natural = system.calls_back() ? "dop853" : "taylor";
    const std::string engine = wanted == "auto" ? natural : wanted;
    if (engine == "closed form")
        throw InvalidInput("simulate: engine is \"closed form\", and a System has none; use \"auto\" or \"" + natural +
                           "\"");
    simulating::require_engine("simulate", engine);
    if (engine == "taylor" && system.calls_back())
        throw InvalidInput(
            "simulate: engine is \"taylor\", and f of this System is called back, which has no Taylor series; use "
            "\"auto\" or \"dop853\", or write it so that it can be recorded (" +
            system.function().callback()->reason + ")");
    return engine;
}

RBDYN_INLINE SystemAttempt attempt(const System& system, const SimulateOptions& options) {
    if (options.until == std::numeric_limits<double>::infinity()) {
        const auto stops = [](const System::Watch& w) { return w.options.action.kind == WatchAction::Kind::stop; };
        simulating::require_stop(std::any_of(system.watches().begin(), system.watches().end(), stops));
        return simulating::until_stopped(options, [&](const SimulateOptions& o) { return attempt(system, o); });
    }
    using Clock = std::chrono::steady_clock;
    const auto began = Clock::now();
    simulating::validate(options);
    const auto model = std::make_shared<const SystemModel>(system.frozen());
    const std::string natural = simulating::engine_for(system, "auto");
    const std::string engine = simulating::engine_for(system, options.engine);
    const std::int64_t calls = system.python_calls();
    SimulateOptions own = options;
    own.warn = simulating::once(options.warn);
    simulating::Solution solution =
        simulating::solve(*model, system.start(), own, {.origin = options.start}, engine, natural);
    // where steps and errors, powers of a tolerance times a state, lose their digits
    constexpr double least = 1e-250;
    simulating::require_size(solution.record, "System", least);
    Statistics s = simulating::statistics_of(solution);
    s.python_calls = system.python_calls() - calls;
    s.seconds = std::chrono::duration<double>(Clock::now() - began).count();
    solution.course.reset();
    solution.judge.reset();
    solution.record.halt = nullptr;
    simulating::settle_events(solution, options);
    const auto outcome = solution.outcome;
    const auto thrown = solution.thrown;
    std::string message = solution.message;
    return {outcome, std::move(message), thrown,
            SystemRun(model, std::move(solution), simulating::named(engine, s.changes), s)};
}

RBDYN_INLINE SystemRun simulate(const System& system, const SimulateOptions& options) {
    SystemAttempt result = attempt(system, options);
    if (result.outcome == simulating::Outcome::thrown) std::rethrow_exception(result.thrown);
    if (result.outcome != simulating::Outcome::good) throw SystemError(result.message, std::move(result.run));
    return std::move(result.run);
}

/// What tells a system from another one.
RBDYN_INLINE std::string text_of(const System& system) {
    std::string result = system.function().function() ? system.function().function().text() : "called back";
    for (const System::Watch& w : system.watches()) result += w.name;
    return result;
}

RBDYN_INLINE std::string bytes_of(const SystemRun& run) {
    run_bytes::Writer w;
    run_bytes::put(w, run.solution().record);
    w.put(std::string_view(run.engine()));
    run_bytes::put_accuracy(w, run.solution());
    run_bytes::put(w, run.statistics());
    return run_bytes::sealed("rbdyn system run 1", text_of(run.system()), std::move(w.bytes));
}

RBDYN_INLINE SystemRun system_run_from(const System& system, std::string_view bytes) {
    run_bytes::Reader r = run_bytes::opened("rbdyn system run 1", text_of(system), bytes);
    const auto model = std::make_shared<const SystemModel>(system.frozen());
    simulating::Solution solution;
    solution.record = run_bytes::take_record(r, {.model = model.get()});
    std::string engine = r.text();
    run_bytes::take_accuracy(r, solution);
    Statistics statistics = run_bytes::take_statistics(r);
    return SystemRun(model, std::move(solution), std::move(engine), std::move(statistics));
}

}  // namespace rbdyn::inline RBDYN_FORM
