// Definitions of rbdyn/integrate.hpp.
#pragma once

#include "rbdyn/integrate.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <exception>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "rbdyn/basics/double_double_functions.hpp"
#include "rbdyn/basics/error.hpp"
#include "rbdyn/basics/instant.hpp"
#include "rbdyn/closed_form/closed_form.hpp"
#include "rbdyn/engine/closed_form.hpp"
#include "rbdyn/engine/cvode_factory.hpp"
#include "rbdyn/engine/dop853.hpp"
#include "rbdyn/engine/engine.hpp"
#include "rbdyn/engine/refined_taylor.hpp"
#include "rbdyn/engine/stiff_taylor.hpp"
#include "rbdyn/engine/taylor.hpp"
#include "rbdyn/event/driver.hpp"
#include "rbdyn/event/event.hpp"
#include "rbdyn/event/record.hpp"
#include "rbdyn/expression/program.hpp"
#include "rbdyn/model/equations.hpp"
#include "rbdyn/model/hybrid.hpp"
#include "rbdyn/series/piece.hpp"
#include "rbdyn/trajectory/accuracy.hpp"
#include "rbdyn/trajectory/error_scales.hpp"
#include "rbdyn/trajectory/narrow_hold.hpp"

namespace rbdyn::inline RBDYN_FORM::simulating {

RBDYN_INLINE std::vector<std::string> engines() {
    std::vector<std::string> names = {"taylor", "dop853"};
    for (std::string& name : cvode::names()) names.push_back(std::move(name));
    return names;
}

RBDYN_INLINE double first_tolerance(const std::string& engine, double error) {
    const double tolerance = engine == "taylor" ? std::max(1e-3 * error, std::min(0.02 * error, 1e-15)) : 0.02 * error;
    return std::max(tolerance, least_tolerance(engine));
}

RBDYN_INLINE double judging_tolerance(const std::string& engine, double tolerance) {
    return std::max((engine == "taylor" ? 1e-2 : 1e-3) * tolerance, 0.1 * least_tolerance(engine));
}

RBDYN_INLINE bool gives_way(const HybridModel& model, const SimulateOptions& options, const std::string& engine,
                            double tolerance) {
    return options.engine == "auto" && engine == "taylor" && tolerance >= StiffTaylorEngine::least_tolerance &&
           !model.touches();
}

RBDYN_INLINE std::unique_ptr<Engine> make_engine(const std::string& name, double tolerance, const Manner& manner) {
    if (name == "taylor" && manner.is_refined)
        return std::make_unique<RefinedTaylorEngine>(tolerance, manner.order, manner.rounding);
    if (name == "taylor" && manner.gives_way)
        return std::make_unique<StiffTaylorEngine>(tolerance, manner.order, manner.rounding);
    if (name == "taylor") return std::make_unique<TaylorEngine>(tolerance, manner.order, manner.rounding);
    if (name == "dop853") return std::make_unique<Dop853Engine>(tolerance, false, manner.stride, manner.rounding);
    if (std::unique_ptr<Engine> engine = cvode::make(name, tolerance)) return engine;
    require_engine("simulate", name);
    throw InvalidInput("simulate: engine is \"" + name +
                       "\", and this model has no closed form; use \"auto\" or one of the others");
}

RBDYN_INLINE std::unique_ptr<Driver> make_driver(const HybridModel& model, Engine& engine, const SimulateOptions& o,
                                                 const Beginning& beginning, double tolerance, const Keep& keep,
                                                 const Manner& manner) {
    auto driver = std::make_unique<Driver>(model, engine, o.max_steps, keep, o.monitor,
                                           tolerance * (o.until - beginning.origin), o.rtol.has_value(), tolerance);
    if (manner.rounding == Program::Rounding::other) driver->round_otherwise(manner.chance);
    driver->pass_stops(beginning.stops_from);
    if (streams_events(o)) driver->keep_events(o.events);
    // those that are let go while it runs do not count
    driver->watch_memory({o.warn, !streams_events(o) ? 3.0 : o.events.keeps_all() ? 2.0 : 0.0});
    return driver;
}

RBDYN_INLINE Timed integrate(const HybridModel& model, const std::vector<double>& x, const SimulateOptions& o,
                             const Beginning& beginning, const std::string& name, double tolerance, const Keep& keep,
                             const Manner& manner, const std::shared_ptr<const ClosedForm>& form) {
    const auto before = std::chrono::steady_clock::now();
    const auto made = [&]() -> std::unique_ptr<Engine> {
        if (!form) return make_engine(name, tolerance, manner);
        if (auto by_mode = std::dynamic_pointer_cast<const FormsByMode>(form))
            return std::make_unique<ClosedFormEngine>(std::move(by_mode), tolerance, manner.order);
        return std::make_unique<ClosedFormEngine>(form, Instant{beginning.origin, 0.0}, tolerance, manner.order);
    };
    const std::unique_ptr<Engine> engine = made();
    const std::unique_ptr<Driver> driver = make_driver(model, *engine, o, beginning, tolerance, keep, manner);
    Timed result{beginning.halt != nullptr ? driver->go_on(*beginning.halt, o.until)
                                           : driver->run(beginning.origin, x, o.until)};
    result.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - before).count();
    return result;
}

RBDYN_INLINE void require_size(const Record& record, const std::string& object, double least) {
    if (record.closed) return;
    double largest = 0.0;
    const auto look = [&](std::span<const double> x) {
        for (const double value : x) largest = std::max(largest, std::abs(value));
    };
    look(record.first_state);
    std::vector<double> x(static_cast<std::size_t>(std::max(record.variables, 0)));
    for (std::size_t i = 0; i < record.entries().size() && largest < least; ++i) {
        const Piece piece = record.piece(i);
        piece.state(record.entries()[i].length, x);
        look(x);
    }
    require(largest == 0.0 || !(largest < least), object, "the largest number of its motion", largest,
            "numbers so small are not told from nothing by their squares and errors, from " + text(least) +
                " on: give the state in smaller units");
}

RBDYN_INLINE std::string culprit(const HybridModel& model, const Record& record) {
    if (!record.not_finite.empty()) return record.not_finite;
    if (record.modes.empty()) return {};
    std::vector<double> x = record.first_state;
    if (!record.empty()) record.last_state(x);
    const double t = record.end.hi, span = t - record.start;
    for (const double later : {0.0, 1e-12, 1e-9, 1e-6, 1e-3}) {
        const double step = later * std::max(span, std::abs(t)) + (later > 0.0 && t == 0.0 ? later : 0.0);
        if (std::string name = model.not_finite(record.modes.back(), t + step, x); !name.empty()) return name;
    }
    return model.grown(record.modes.front(), record.start, record.first_state, record.modes.back(), t, x);
}

RBDYN_INLINE std::string broken_off(const HybridModel& model, const Record& record) {
    std::string message = "simulate: " + std::string(name_of(record.status)) + " at t = " + text(record.end.hi) + " s";
    const std::string name = record.status == Status::not_finite ? culprit(model, record) : record.not_finite;
    if (!name.empty()) message += ": " + name;
    const double apart = std::nextafter(std::abs(record.end.hi), INFINITY) - std::abs(record.end.hi);
    if (name.empty() && record.status == Status::not_finite && record.end.hi == record.start && apart > 1e-3)
        return message + ": times there are " + text(apart) + " s apart, which is more than a step of this motion. " +
               "Let it start nearer to t = 0.";
    return message + ". " + std::string(advice(record.status));
}

RBDYN_INLINE std::string broken_off_beside(const Record& judge) {
    if (judge.status != Status::not_finite && judge.status != Status::inconsistent) return {};
    return ", for a run that it is held against is " + std::string(name_of(judge.status)) +
           " at t = " + text(judge.end.hi) + " s" + (judge.not_finite.empty() ? "" : " (" + judge.not_finite + ")");
}

RBDYN_INLINE void end_where_finite(Record& record) {
    if (record.status != Status::reached_end || !record.halt) return;
    std::vector<double> x(static_cast<std::size_t>(record.variables));
    const auto is_finite_at = [&](double t) {
        record.closed->state(exact_difference({t, 0.0}, {record.closed_from, 0.0}), x);
        return std::ranges::all_of(x, [](double value) { return std::isfinite(value); });
    };
    if (is_finite_at(record.end.hi)) return;
    double good = record.start, bad = record.end.hi;
    for (double middle = 0.5 * (good + bad); good < middle && middle < bad; middle = 0.5 * (good + bad))
        (is_finite_at(middle) ? good : bad) = middle;
    is_finite_at(good);
    Halt halt = *record.halt;
    halt.at = record.end = {good, 0.0};
    halt.x = x;
    std::ranges::fill(halt.low, 0.0);
    record.halt = std::make_shared<const Halt>(std::move(halt));
    record.status = Status::not_finite;
    record.not_finite = "the motion grows beyond the largest number of binary64";
}

RBDYN_INLINE Keep compared_pieces(const SimulateOptions& options) {
    Keep compared;
    if (options.keep.what == Keep::What::all) return compared;
    compared.what = Keep::What::times;
    compared.winds = options.keep.what == Keep::What::times;
    compared.times = options.keep.times;
    // spread by the golden section, so that no period of the motion hides from them
    for (int i = 0; i < compared_times; ++i) {
        const double place = (i + std::fmod(0.6180339887498949 * i, 1.0)) / compared_times;
        compared.times.push_back(options.start + (options.until - options.start) * place);
    }
    compared.times.push_back(options.until);
    std::sort(compared.times.begin(), compared.times.end());
    return compared;
}

RBDYN_INLINE Keep held_against(const Record& run) {
    return {.what = Keep::What::times, .times = AccuracyCheck::places(run), .winds = false};
}

RBDYN_INLINE Record formula_record(const Mode& mode, std::vector<double> first, double start, Instant end,
                                   const std::shared_ptr<const ClosedForm>& form, double origin) {
    Record record;
    record.start = start;
    record.end = end;
    record.variables = static_cast<int>(first.size());
    record.modes = {mode};
    record.closed = form;
    record.closed_from = origin;
    Halt halt{.at = end, .x = first, .low = {}, .mode = mode};
    form->state(exact_difference(end, {origin, 0.0}), halt.x);
    halt.low.resize(halt.x.size());
    record.halt = std::make_shared<const Halt>(std::move(halt));
    record.first_state = std::move(first);
    return record;
}

RBDYN_INLINE bool never_fires(const Equations& equations) {
    return std::ranges::all_of(equations.guards, [](const Guard& g) { return g.role == GuardRole::mode; });
}

RBDYN_INLINE std::optional<Record> formula_beside(const Record& run, const std::shared_ptr<const ClosedForm>& form,
                                                  double origin) {
    if (!is_one_form(form) || run.modes.size() != 1 || run.empty()) return std::nullopt;
    const Mode& mode = run.modes.front();
    if (mode.equations == nullptr || !never_fires(*mode.equations)) return std::nullopt;
    return formula_record(mode, run.first_state, run.start, run.end, form, origin);
}

RBDYN_INLINE void settle_events(Solution& solution, const SimulateOptions& options) {
    Record& record = solution.record;
    if (streams_events(options)) return;
    const bool ends = record.status == Status::stopped_by_event;
    try {
        settle(record.events, options.events, ends ? std::optional(record.end.hi) : std::nullopt);
    } catch (...) {
        solution.outcome = Outcome::thrown;
        solution.thrown = std::current_exception();
    }
}

RBDYN_INLINE void take(Solution& result, Timed&& timed) {
    result.integration_seconds = timed.seconds;
    result.record = std::move(timed.record);
}

RBDYN_INLINE bool is_cut_short(const HybridModel& model, Solution& result, Timed& timed) {
    const Status status = timed.record.status;
    if (status == Status::reached_end || status == Status::stopped_by_event) return false;
    take(result, std::move(timed));
    const Record& record = result.record;
    result.certain_until = record.start;
    if (record.thrown) {
        result.outcome = Outcome::thrown;
        result.thrown = record.thrown;
    } else if (status == Status::not_finite || status == Status::inconsistent) {
        result.outcome = Outcome::broken;
        result.certain_until = record.end.hi;
        result.message = broken_off(model, record);
    }
    return true;
}

RBDYN_INLINE std::optional<Course> course_of(const Record& record, const std::string& engine, double tolerance,
                                             const Manner& manner) {
    if (!record.halt) return std::nullopt;
    return Course{engine, tolerance, manner, *record.halt};
}

RBDYN_INLINE void drop_grazes(Record& record, const std::vector<Event>& grazes) {
    std::erase_if(record.events, [&](const Event& e) {
        return std::any_of(grazes.begin(), grazes.end(), [&](const Event& g) {
            return e.time == g.time && e.kind == g.kind && e.subject == g.subject;
        });
    });
}

RBDYN_INLINE Solution solve(const HybridModel& model, const std::vector<double>& x, const SimulateOptions& options,
                            const Beginning& beginning, const std::string& engine, const std::string& judge,
                            const std::shared_ptr<const ClosedForm>& form, Ahead* ahead) {
    Solution result;
    const auto take = [&](Timed&& timed) { simulating::take(result, std::move(timed)); };
    const auto run_with = [&](const std::string& name, const Pass& pass) {
        ++result.runs;
        if (ahead != nullptr && name == engine)
            if (auto made = ahead->take(pass)) return *std::move(made);
        return integrate(model, x, options, beginning, name, pass.tolerance, pass.keep, pass.manner);
    };
    const auto is_cut_short = [&](Timed& timed) { return simulating::is_cut_short(model, result, timed); };

    Pass first = first_pass(model, options, engine);
    if (options.rtol) {
        Timed only = run_with(engine, first);
        result.course = course_of(only.record, engine, first.tolerance, first.manner);
        if (is_cut_short(only)) return result;
        take(std::move(only));
        result.certain_until = result.record.end.hi;
        return result;
    }

    // held against a better one
    const bool is_judge = !form && engine == judge;
    const bool keeps_all = options.keep.what == Keep::What::all;
    Timed run = run_with(engine, first);
    std::vector<Event> grazes;
    bool amplifies = false, has_retried = false;
    double least_reached = std::numeric_limits<double>::infinity();
    // a closed form is not wrong itself
    AccuracyCheck check(model, options.error, options.monitor, form ? 1.25 : 2.0);
    const auto broken_by = [&](std::exception_ptr thrown) {
        take(std::move(run));
        result.record.status = Status::stopped_by_user;
        result.outcome = Outcome::thrown;
        result.thrown = std::move(thrown);
        result.certain_until = result.record.start;
        return std::move(result);
    };
    const auto stopped_by = [&](Status status) {
        run.record.status = status == Status::step_limit ? status : Status::stopped_by_user;
        take(std::move(run));
        result.certain_until = result.record.start;
        return std::move(result);
    };
    for (;;) {
        if (is_cut_short(run)) return result;
        const Pass finer = judging_pass(options, engine, is_judge, first, run.record, amplifies);
        const auto made_better = [&]() -> Timed {
            if (!form) return run_with(judge, finer);
            if (auto formula = formula_beside(run.record, form, beginning.origin)) return {*std::move(formula)};
            return integrate(model, x, options, beginning, judge, 0.1 * least_tolerance("taylor"), finer.keep, {},
                             form);
        };
        Timed better = made_better();
        Comparison comparison;
        try {
            if (better.record.thrown) std::rethrow_exception(better.record.thrown);
            const Status status = better.record.status;
            comparison.stopped = status == Status::stopped_by_user || status == Status::step_limit;
            if (comparison.stopped)
                run.record.status = status;
            else
                comparison = check(run.record, better.record, finer.keep.times);
        } catch (...) {
            return broken_by(std::current_exception());
        }
        if (comparison.stopped) return stopped_by(run.record.status);
        std::string beside = broken_off_beside(better.record);
        result.error = comparison.error;
        result.certain_until = comparison.certain_until;
        grazes = std::move(comparison.grazes);
        result.scales = std::move(comparison.scales);
        result.course = course_of(run.record, engine, first.tolerance, first.manner);
        result.judge = form ? course_of(better.record, "closed form", 0.1 * least_tolerance("taylor"), {})
                            : course_of(better.record, judge, finer.tolerance, finer.manner);
        // rounding has grown alike in both; where that may be more than is asked, a judge of more digits tells
        constexpr double doubtful = 0.125, to_rounding = 1e-15;
        if (comparison.amplifies && comparison.error > doubtful * options.error && finer.tolerance <= to_rounding &&
            is_judge && engine == "taylor" && !finer.manner.is_refined) {
            amplifies = true;
            if (comparison.same_events && comparison.error <= options.error) continue;
        }
        // what chance has pushed apart it may have pushed together: where a motion quickens rounding grows with it, and
        // at least that much is told, or if it comes near what was asked a judge of more digits tells
        constexpr double much = 100.0, roundings = 4.0;
        const auto is_right = [&](const Comparison& c) { return c.same_events && c.error <= options.error; };
        const double grown = roundings * std::numeric_limits<double>::epsilon() * comparison.quickens;
        if (judge == "taylor" && !form && run.record.modes.size() == 1 && comparison.quickens > much &&
            !finer.manner.is_refined && is_right(comparison) && grown > comparison.error) {
            if (grown > doubtful * options.error) {
                amplifies = true;
                continue;
            }
            result.error = comparison.error = grown;
        }
        // where events multiply rounding a second judge, which rounds otherwise again, has to say the same
        if (is_right(comparison) && comparison.amplifies && run.record.modes.size() > 1) {
            Pass again = finer;
            ++again.manner.chance;
            const Timed other = run_with(judge, again);
            if (other.record.status == Status::reached_end || other.record.status == Status::stopped_by_event) {
                const Comparison second = check(run.record, other.record, finer.keep.times);
                comparison.same_events = comparison.same_events && second.same_events;
                result.error = comparison.error = std::max(comparison.error, second.error);
                result.certain_until = comparison.certain_until =
                    std::min(comparison.certain_until, second.certain_until);
            } else if (other.record.thrown) {
                return broken_by(other.record.thrown);
            } else if (other.record.status == Status::stopped_by_user || other.record.status == Status::step_limit) {
                return stopped_by(other.record.status);
            } else {
                // one that breaks off says no such thing
                beside = broken_off_beside(other.record);
                comparison.same_events = false;
                result.certain_until = comparison.certain_until =
                    std::min(comparison.certain_until, other.record.end.hi);
            }
        }
        if (is_right(comparison)) break;
        least_reached = std::min(least_reached, comparison.error);
        // what is left is the rounding of doubles, and what the motion makes of it
        if (engine == "taylor" && !first.manner.is_refined && first.tolerance <= 10.0 * least_tolerance(engine)) {
            const Pass refined{least_tolerance(engine), {.is_refined = true}, first.keep};
            Timed longer = run_with(engine, refined);
            const Status status = longer.record.status;
            if (status != Status::not_finite && status != Status::inconsistent) {
                run = std::move(longer);
                first = refined;
                continue;
            }
        }
        // at the floor errors of neighbouring tolerances differ by several times, either way: one more may do
        constexpr double nearly = 2.0, neighbour = 4.0;
        if (engine != "taylor" && !has_retried && first.tolerance <= least_tolerance(engine) &&
            comparison.same_events && comparison.error <= nearly * options.error) {
            has_retried = true;
            first.tolerance = neighbour * least_tolerance(engine);
            run = run_with(engine, first);
            continue;
        }
        if (first.tolerance <= least_tolerance(engine) || has_retried) {
            // at the floor neighbouring tolerances are by chance a little better
            const bool is_better = 2.0 * least_reached < comparison.error;
            run.record.status = Status::accuracy_not_reached;
            result.outcome = Outcome::inaccurate;
            std::optional<NarrowHold> narrow = narrowest_hold(run.record);
            if (!narrow) narrow = narrowest_hold(better.record);
            result.message =
                "simulate: error " + text(options.error) + " was asked for and engine " + engine +
                (comparison.same_events
                     ? " reached " + text(is_better ? least_reached : comparison.error) + " in this motion" +
                           (comparison.worst.empty() ? "" : ", at worst in " + comparison.worst)
                     : " cannot tell which events this motion has" + beside) +
                (comparison.same_events && is_better ? " (" + text(comparison.error) + " in the run that is returned)"
                                                     : "") +
                (comparison.by_rounding ? ", for a slip touches zero and rounding decides whether it sticks" : "") +
                (narrow ? ", in which " + narrow->words() : "") +
                "; it is certain up to t = " + text(comparison.certain_until) + " s. " +
                std::string(advice(Status::accuracy_not_reached));
            result.judge.reset();
            take(std::move(run));
            return result;
        }
        // errors go with tolerances, roughly, while they are small; a fifth of what is asked is aimed at
        const double before = first.tolerance, aimed = 0.2 * before * options.error / comparison.error;
        const bool is_known = comparison.error < 0.1;
        first.tolerance = is_judge && !is_known ? finer.tolerance : std::clamp(aimed, 1e-3 * before, 0.2 * before);
        first.tolerance = std::max(first.tolerance, least_tolerance(engine));
        first.manner.gives_way = gives_way(model, options, engine, first.tolerance);
        run = run_with(engine, first);
    }
    if (!keeps_all) run.record.keep_only(options.keep.times);
    drop_grazes(run.record, grazes);
    take(std::move(run));
    return result;
}

RBDYN_INLINE std::optional<Solution> carry_on(const HybridModel& model, const Standing& standing,
                                              const SimulateOptions& options,
                                              const std::shared_ptr<const ClosedForm>& form) {
    Solution result;
    const auto go_on = [&](const Course& c, const Keep& keep) {
        ++result.runs;
        const Beginning from{standing.origin, &c.halt};
        return integrate(model, c.halt.x, options, from, c.engine, c.tolerance, keep, c.manner,
                         c.engine == "closed form" ? form : nullptr);
    };
    const Course& course = standing.course;
    const Keep compared = standing.judge != nullptr ? compared_pieces(options) : options.keep;
    Timed run = go_on(course, compared);
    result.course = course_of(run.record, course.engine, course.tolerance, course.manner);
    if (is_cut_short(model, result, run)) return result;
    result.certain_until = run.record.end.hi;
    if (standing.judge == nullptr) {
        take(result, std::move(run));
        return result;
    }
    const Course& judge = *standing.judge;
    const bool is_form = judge.engine == "closed form";
    const Keep held = held_against(run.record);
    auto formula = is_form ? formula_beside(run.record, form, standing.origin) : std::nullopt;
    const Timed better = formula ? Timed{*std::move(formula)} : go_on(judge, held);
    const Status status = better.record.status;
    if (better.record.thrown || (status != Status::reached_end && status != Status::stopped_by_event)) {
        // whoever interrupts it interrupts the run
        if (status != Status::stopped_by_user || better.record.thrown) return std::nullopt;
        run.record.status = status;
        take(result, std::move(run));
        result.certain_until = result.record.start;
        return result;
    }
    const MotionBefore before{standing.origin, standing.scales};
    Comparison comparison = AccuracyCheck(model, options.error, options.monitor, is_form ? 1.25 : 2.0, &before)(
        run.record, better.record, held.times);
    result.error = std::max(standing.error, comparison.error);
    if (!comparison.stopped && !(comparison.same_events && *result.error <= options.error)) return std::nullopt;
    if (comparison.stopped) {
        run.record.status = Status::stopped_by_user;
        result.certain_until = run.record.start;
        result.error.reset();
    }
    result.judge = course_of(better.record, judge.engine, judge.tolerance, judge.manner);
    result.scales = std::move(comparison.scales);
    if (options.keep.what != Keep::What::all) run.record.keep_only(options.keep.times);
    drop_grazes(run.record, comparison.grazes);
    take(result, std::move(run));
    return result;
}

}  // namespace rbdyn::inline RBDYN_FORM::simulating
