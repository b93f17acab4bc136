// Definitions of rbdyn/solve_closed.hpp.
#pragma once

#include "rbdyn/solve_closed.hpp"

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "rbdyn/basics/error.hpp"
#include "rbdyn/basics/instant.hpp"
#include "rbdyn/closed_form/closed_form.hpp"
#include "rbdyn/engine/closed_form.hpp"
#include "rbdyn/event/driver.hpp"
#include "rbdyn/event/event.hpp"
#include "rbdyn/event/record.hpp"
#include "rbdyn/integrate.hpp"
#include "rbdyn/model/hybrid.hpp"
#include "rbdyn/model/observed.hpp"
#include "rbdyn/trajectory/accuracy.hpp"
#include "rbdyn/trajectory/error_scales.hpp"

namespace rbdyn::inline RBDYN_FORM::simulating {

RBDYN_INLINE double rounding_seen(const HybridModel& model, const Mode& mode, const ClosedForm& form,
                                  const SimulateOptions& options, double start, double end) {
    // enough to meet most of the extent of a motion, and what it was before it died away
    const double span = end - start, pace = std::min(form.pace(), span);
    std::vector<double> x(static_cast<std::size_t>(model.variables()));
    std::vector<Observed> seen;
    ErrorScales scales;
    for (const double since : {0.0, span, 0.618 * span, 0.236 * span, pace, 0.3 * pace}) {
        form.state({since, 0.0}, x);
        model.observe(mode, start + since, x, seen);
        scales.widen(seen);
    }
    scales.settle(options.error, span);
    // of some four sums and products; of six as long as these are the last digits. Where a scale has its floor for
    // rounding (least_share) four are what it is made for
    constexpr double last_digits = 1e-14;
    return std::max(4.0 * scales.rounding(), std::min(6.0 * scales.rounding(), last_digits));
}

/// What a motion in closed form has come to: its error, that of `error_at` where it ends and of its events.
RBDYN_INLINE void judge(Solution& result, const HybridModel& model, const SimulateOptions& options,
                        const Comparison& events, const std::function<double(double)>& error_at) {
    Record& record = result.record;
    result.course = course_of(record, "closed form", least_tolerance("taylor"), {});
    result.certain_until = record.end.hi;
    if (record.thrown) {
        result.outcome = Outcome::thrown;
        result.thrown = record.thrown;
        result.certain_until = record.start;
        return;
    }
    if (record.status == Status::not_finite || record.status == Status::inconsistent) {
        result.outcome = Outcome::broken;
        result.message = broken_off(model, record);
        return;
    }
    if (options.rtol) return;
    result.error = std::max(events.error, error_at(record.end.hi));
    if (*result.error <= options.error) return;
    // errors of a closed form grow with time
    double good = options.start, bad = record.end.hi;
    for (int i = 0; i < 60 && error_at(good) <= options.error; ++i) {
        const double middle = 0.5 * (good + bad);
        (error_at(middle) <= options.error ? good : bad) = middle;
    }
    if (error_at(record.end.hi) <= options.error) good = record.end.hi;
    good = std::min(good, events.certain_until);
    result.certain_until = good;
    result.outcome = Outcome::inaccurate;
    record.status = Status::accuracy_not_reached;
    result.message = "simulate: error " + text(options.error) + " was asked for and the closed form reaches " +
                     text(*result.error) + " with numbers in double precision; it is certain up to t = " + text(good) +
                     " s. " + std::string(advice(Status::accuracy_not_reached));
}

RBDYN_INLINE Solution solve_closed(const HybridModel& model, std::vector<double> x, const SimulateOptions& options,
                                   const Beginning& beginning, const std::shared_ptr<const ClosedForm>& form) {
    const auto before = std::chrono::steady_clock::now();
    Solution result;
    result.runs = 1;
    // pieces say when events are, not where things are: they are kept if all of a run is, or while two are compared
    const bool keeps_all = options.keep.what == Keep::What::all;
    const Keep keep =
        keeps_all || !options.rtol ? compared_pieces(options) : Keep{.what = Keep::What::end, .times = {}};
    const auto run = [&](double tolerance, int order) {
        return integrate(model, x, options, beginning, "", tolerance, keep, {.order = order}, form).record;
    };
    Comparison events{.error = 0.0, .certain_until = options.until};
    std::vector<double> first = x;
    Mode mode;
    if (beginning.halt != nullptr) {
        mode = beginning.halt->mode;
        form->state(exact_difference({options.start, 0.0}, {beginning.origin, 0.0}), first);
    } else {
        mode = model.begin(options.start, first);
    }
    if (never_fires(*mode.equations)) {
        result.record =
            formula_record(mode, std::move(first), options.start, {options.until, 0.0}, form, beginning.origin);
    } else {
        result.record = run(least_tolerance("taylor"), 0);
        if (!options.rtol) {
            const Record better = run(0.1 * least_tolerance("taylor"), other_order);
            ++result.runs;
            if (!better.thrown && !result.record.thrown)
                events = AccuracyCheck(model, options.error, options.monitor)(result.record, better, keep.times);
            if (!keeps_all) result.record.keep_only();
        }
    }
    Record& record = result.record;
    record.closed = form;
    record.closed_from = beginning.origin;
    end_where_finite(record);
    result.integration_seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - before).count();
    const double seen =
        options.rtol ? 0.0
                     : rounding_seen(model, record.modes.front(), *form, options, beginning.origin, record.end.hi);
    judge(result, model, options, events,
          [&](double t) { return seen + form->error(t - beginning.origin, options.error); });
    return result;
}

RBDYN_INLINE Solution solve_by_modes(const HybridModel& model, const std::vector<double>& x,
                                     const SimulateOptions& options, const Beginning& beginning,
                                     const std::shared_ptr<const FormsByMode>& forms) {
    const auto before = std::chrono::steady_clock::now();
    const bool keeps_all = options.keep.what == Keep::What::all;
    const Keep keep = keeps_all || options.rtol ? options.keep : compared_pieces(options);
    const auto run = [&](double tolerance, int order) {
        ClosedFormEngine engine(forms, tolerance, order);
        const std::unique_ptr<Driver> driver = make_driver(model, engine, options, beginning, tolerance, keep, {});
        Record record = beginning.halt != nullptr ? driver->go_on(*beginning.halt, options.until)
                                                  : driver->run(beginning.origin, x, options.until);
        return std::pair(std::move(record), engine.forms_so_far());
    };
    Solution result;
    result.runs = 1;
    auto made = run(least_tolerance("taylor"), 0);
    const std::vector<ClosedFormEngine::Begun> begun = std::move(made.second);
    result.record = std::move(made.first);
    Record& record = result.record;
    Comparison events{.error = 0.0, .certain_until = options.until};
    if (!options.rtol && !record.thrown) {
        const Record better = run(0.1 * least_tolerance("taylor"), other_order).first;
        ++result.runs;
        if (!better.thrown) events = AccuracyCheck(model, options.error, options.monitor)(record, better, keep.times);
    }
    const bool is_one = begun.size() == 1 && begun.front().form != nullptr && beginning.halt == nullptr;
    if (is_one) {
        record.closed = begun.front().form;
        record.closed_from = beginning.origin;
        if (!keeps_all) record.keep_only();
        end_where_finite(record);
    } else if (!keeps_all && !options.rtol) {
        record.keep_only(options.keep.times);
    }
    result.integration_seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - before).count();
    // what is computed from a state is rounded, and each form adds what it is off where it ends
    const auto error_at = [&](double t) {
        double seen = 0.0, off = 0.0;
        for (std::size_t i = 0; i < begun.size() && (i == 0 || begun[i].from.hi < t); ++i) {
            if (begun[i].form == nullptr) continue;
            const double from = begun[i].from.hi, end = i + 1 < begun.size() ? std::min(begun[i + 1].from.hi, t) : t;
            if (end <= from) continue;
            const Mode& mode = record.modes[std::min(i, record.modes.size() - 1)];
            seen = std::max(seen, rounding_seen(model, mode, *begun[i].form, options, from, end));
            off += begun[i].form->error(end - from, options.error);
        }
        // two that went apart did so from there on
        return is_one || t <= events.certain_until ? seen + off : events.error + seen + off;
    };
    judge(result, model, options, events, error_at);
    return result;
}

RBDYN_INLINE Solution solve_in_form(const HybridModel& model, const std::vector<double>& x,
                                    const SimulateOptions& options, const Beginning& beginning,
                                    const std::shared_ptr<const ClosedForm>& form) {
    if (const auto by_mode = std::dynamic_pointer_cast<const FormsByMode>(form))
        return solve_by_modes(model, x, options, beginning, by_mode);
    return solve_closed(model, x, options, beginning, form);
}

}  // namespace rbdyn::inline RBDYN_FORM::simulating
