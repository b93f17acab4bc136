// Definitions of rbdyn/pricing.hpp.
#pragma once

#include "rbdyn/pricing.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "rbdyn/basics/instant.hpp"
#include "rbdyn/basics/processor_time.hpp"
#include "rbdyn/closed_form/closed_form.hpp"
#include "rbdyn/event/record.hpp"
#include "rbdyn/integrate.hpp"
#include "rbdyn/model/observed.hpp"
#include "rbdyn/solve_closed.hpp"
#include "rbdyn/trajectory/accuracy.hpp"
#include "rbdyn/trajectory/error_scales.hpp"

namespace rbdyn::inline RBDYN_FORM::pricing {

RBDYN_INLINE bool Purse::goes_on() {
    if (!is_closed_ && monitor_ && !monitor_(spent())) is_closed_ = true;
    return !is_closed_;
}

// --- runs ---

/// Coefficients of a run that is kept whole: more would fill the memory of small machines.
inline constexpr std::int64_t most_numbers = 25'000'000, order_of_pieces = 25;

RBDYN_INLINE Runner::Runner(const std::vector<Part>& parts, const SimulateOptions& base, Purse& purse)
    : parts_(parts), base_(base), purse_(purse) {
    end_at(base.until);
}

RBDYN_INLINE void Runner::end_at(double until) {
    base_.until = until;
    if (!compared_.times.empty()) {
        std::erase_if(compared_.times, [=](double t) { return t >= until; });
        compared_.times.push_back(until);
        return;
    }
    // enough to meet every phase of the motion; fewer where there is much to compare at each
    std::size_t variables = 1;
    for (const Part& part : parts_) variables = std::max(variables, part.start.size());
    SimulateOptions ends = base_;
    ends.keep = {.what = Keep::What::end, .times = {}};
    compared_ = simulating::compared_pieces(ends);
    const std::size_t enough = std::min(std::clamp<std::size_t>(60'000 / variables, 150, 600), compared_.times.size());
    std::vector<double> times;
    for (std::size_t i = 1; i <= enough; ++i) times.push_back(compared_.times[i * compared_.times.size() / enough - 1]);
    compared_.times = std::move(times);
}

RBDYN_INLINE void Runner::look(double allowed) {
    constexpr double rough = 1e-6;
    std::vector<std::string> engines;
    for (const Part& part : parts_)
        engines.push_back(part.closed ? "closed form" : part.engine_for(part.calls_back ? "dop853" : "taylor"));
    const Measured seen = run(engines, rough, allowed, Keep::What::all, true);
    for (std::size_t i = 0; i < seen.records.size(); ++i) {
        if (parts_[i].closed) continue;
        const std::vector<double> times = AccuracyCheck::places(seen.records[i]);
        compared_.times.insert(compared_.times.end(), times.begin(), times.end());
    }
    std::ranges::sort(compared_.times);
    compared_.times.erase(std::unique(compared_.times.begin(), compared_.times.end()), compared_.times.end());
}

template <class Integrated>
Measured Runner::measured(double allowed, SimulateOptions& options, const Integrated& integrated) {
    Measured result;
    const double began = purse_.spent(), count = static_cast<double>(parts_.size());
    std::size_t now = 0;
    double fraction = 0.0;
    options.monitor = [&](double t) {
        if (!purse_.goes_on()) return false;
        const double spent = purse_.spent() - began;
        fraction = (static_cast<double>(now) + (t - base_.start) / (base_.until - base_.start)) / count;
        // what has come a quarter of its time and not an eighth of its way is given up
        const bool is_hopeless = spent > 0.25 * allowed && spent > 2.0 * allowed * fraction;
        return spent <= allowed && !is_hopeless;
    };
    for (; now < parts_.size(); ++now) {
        const double first = processor_seconds();
        result.records.push_back(integrated(now));
        result.seconds += processor_seconds() - first;
        const Record& record = result.records.back();
        if (record.thrown) std::rethrow_exception(record.thrown);
        if (record.status == Status::reached_end || record.status == Status::stopped_by_event) continue;
        if (record.status == Status::stopped_by_user)
            result.projected = (purse_.spent() - began) / std::max(fraction, 1e-9);
        else if (record.status == Status::step_limit)
            result.is_too_large = true;
        else
            result.broken = simulating::broken_off(parts_[now].model, record);
        result.records.clear();
        break;
    }
    result.spent = purse_.spent() - began;
    return result;
}

RBDYN_INLINE Measured Runner::run(const std::vector<std::string>& engines, double tolerance, double allowed,
                                  Keep::What keep, bool is_auto) {
    SimulateOptions options = base_;
    options.rtol = std::max(tolerance, 1e-16);
    options.engine = is_auto ? "auto" : "";
    const bool keeps_all = keep == Keep::What::all;
    return measured(allowed, options, [&](std::size_t i) {
        const Part& part = parts_[i];
        const auto variables = static_cast<std::int64_t>(std::max<std::size_t>(part.start.size(), 1));
        if (keeps_all) options.max_steps = most_numbers / (order_of_pieces * variables);
        if (engines[i] != "closed form")
            return simulating::integrate(
                       part.model, part.start, options, engines[i], tolerance, keeps_all ? Keep{} : compared_,
                       {.gives_way = simulating::gives_way(part.model, options, engines[i], tolerance)})
                .record;
        // set up, and asked for one state and all events
        const auto form = begun(part.close(), options.start);
        Record record = simulating::solve_in_form(part.model, part.start, options, {options.start}, form).record;
        std::vector<double> end(part.start.size());
        form->state({base_.until - base_.start, 0.0}, end);
        return record;
    });
}

RBDYN_INLINE Measured Runner::run_reference(const std::vector<std::string>& engines, double tolerance, double allowed,
                                            const simulating::Manner& manner) {
    SimulateOptions options = base_;
    return measured(allowed, options, [&](std::size_t i) {
        const Part& part = parts_[i];
        return simulating::integrate(part.model, part.start, options, engines[i], tolerance, compared_, manner,
                                     engines[i] == "closed form" ? begun(part.closed, options.start) : nullptr)
            .record;
    });
}

RBDYN_INLINE std::optional<double> Runner::whole(const Whole& whole, const std::string& engine, double error,
                                                 double allowed, Keep::What keep) {
    SimulateOptions options = base_;
    options.keep.what = keep;
    options.error = std::max(error, simulating::least_error);
    options.engine = engine;
    const double began = purse_.spent();
    options.monitor = [&](double) { return purse_.goes_on() && purse_.spent() - began <= allowed; };
    const double first = processor_seconds();
    const bool is_good = whole.reaches(options);
    const double seconds = processor_seconds() - first;
    return is_good ? std::optional(seconds) : std::nullopt;
}

// --- what errors are measured against ---

RBDYN_INLINE Reference::Reference(Runner& runner, const Whole& whole, Purse& purse, bool is_wanted) : runner_(runner) {
    std::vector<std::string> engines;
    bool has_series = true;
    for (const Part& part : runner.parts()) {
        is_closed_.push_back(part.closed != nullptr);
        engines.push_back(is_closed_.back() ? "closed form" : "taylor");
        has_series = has_series && (is_closed_.back() || !part.calls_back);
    }
    if (!is_wanted) return;
    runner_.look(0.05 * purse.budget());
    const bool all_closed = std::find(is_closed_.begin(), is_closed_.end(), false) == is_closed_.end();
    const double allowed = 0.35 * purse.budget();
    std::string broken;
    const auto made = [&](const std::string& engine, double tolerance, const simulating::Manner& manner, double most) {
        for (std::size_t i = 0; i < engines.size(); ++i) engines[i] = is_closed_[i] ? "closed form" : engine;
        Measured run = runner_.run_reference(engines, tolerance, most, manner);
        if (!run.broken.empty()) broken = run.broken;
        return run;
    };
    using Rounding = Program::Rounding;
    const double least = 0.1 * simulating::least_tolerance("taylor");
    if (has_series) {
        first_ = made("taylor", least, {.is_refined = true}, allowed);
        is_extended_ = is_any();
    }
    // else the tightest runs there are, a second one for rows of the engine of the first
    std::vector<std::string> names = {"cvode-bdf", "cvode-adams", "dop853"};
    if (!has_series) names = {"dop853", "cvode-adams", "cvode-bdf"};
    if (has_series) names.push_back("taylor");
    std::erase_if(names, [&](const std::string& name) {
        try {
            for (const Part& part : runner.parts()) (void)part.engine_for(name);
            return false;
        } catch (const InvalidInput&) {
            return true;
        }
    });
    for (const double tolerance : {0.0, 1e-12, 1e-9, 1e-6})
        for (const std::string& name : names) {
            if (all_closed || is_extended_ || !broken.empty() || !second_.records.empty() || !purse.goes_on()) break;
            if (name == first_engine_) continue;
            // a second one is no use if it is looser
            if (is_any() && tolerance > first_tolerance_) break;
            // other steps and other rounding than any row has
            const simulating::Manner manner{.order = name == "taylor" ? simulating::other_order : 0,
                                            .stride = simulating::other_stride,
                                            .rounding = Rounding::other};
            const double tight = std::max(tolerance, simulating::least_tolerance(name));
            Measured run = made(name, tight, manner, 0.6 * allowed);
            if (run.records.empty()) continue;
            const bool is_first = !is_any();
            (is_first ? first_ : second_) = std::move(run);
            (is_first ? first_engine_ : second_engine_) = name;
            (is_first ? first_tolerance_ : second_tolerance_) = tight;
        }
    if (!broken.empty()) {
        SimulateOptions options = runner_.options();
        options.monitor = [&](double) { return purse.goes_on() && purse.left() > 0.0; };
        whole.require(options);
    }
    // what ends one of them ends all
    double end = runner_.options().until;
    for (const Record& record : first_.records) end = std::min(end, record.end.hi);
    if (end < runner_.options().until) runner_.end_at(end);
}

/// Where series leave to BDF what is stiff, most of a motion is BDF's.
RBDYN_INLINE std::string own_of(const std::string& engine) { return engine == "auto" ? "cvode-bdf" : engine; }

RBDYN_INLINE bool Reference::reaches(const std::string& engine, double tolerance) const {
    if (is_extended_ || first_engine_.empty()) return true;
    if (own_of(engine) != first_engine_) return tolerance >= first_tolerance_;
    return second_.records.empty() ? tolerance >= 10.0 * first_tolerance_ : tolerance >= second_tolerance_;
}

/// How far places are apart after a motion has met another event than the reference.
RBDYN_INLINE double places_apart(const HybridModel& model, const Record& run, const Record& reference,
                                 const Keep& compared, const Comparison& comparison, double wanted) {
    ErrorScales scales = comparison.scales;
    std::vector<Observed> seen, fine;
    struct Difference {
        std::size_t what;
        double value;
    };
    std::vector<Difference> found;
    const double end = std::min(run.end.hi, reference.end.hi);
    for (const double t : compared.times) {
        if (t < comparison.certain_until || t > end) continue;
        const auto observe = [&](const Record& record, std::vector<Observed>& what) {
            const std::vector<double> x = state_at(record, t, Side::after);
            model.observe(record.empty() ? record.modes.front() : record.mode(record.find(t, Side::after)), t, x, what);
        };
        observe(run, seen);
        observe(reference, fine);
        scales.widen(fine);
        for (std::size_t k = 0; k < std::min(seen.size(), fine.size()); ++k)
            if (fine[k].is_position) found.push_back({k, (seen[k].value - fine[k].value).norm()});
    }
    scales.settle(wanted, std::max(end - run.start, 0.0));
    double largest = 0.0;
    for (const Difference& d : found) largest = std::max(largest, scales.relative(d.what, d.value));
    return largest;
}

RBDYN_INLINE void Reference::judge(const Measured& run, const std::vector<std::string>& engines, double about,
                                   CostRow& row) const {
    row.motion_error = 0.0;
    const bool is_own = !second_.records.empty() && own_of(row.engine) == first_engine_;
    const Measured& reference = is_own ? second_ : first_;
    for (std::size_t i = 0; i < run.records.size(); ++i) {
        const Part& part = runner_.parts()[i];
        const Record& record = run.records[i];
        row.steps += record.work.steps;
        row.right_hand_sides += record.work.right_hand_sides;
        if (engines[i] == "closed form") {
            row.motion_error = std::max(row.motion_error, rounding_of(part, runner_.options()));
            row.events += static_cast<int>(record.events.size());
            row.events_expected += static_cast<int>(record.events.size());
            continue;
        }
        // digits are asked for as the row has them: what counts as one event, and the share of a body that hardly moves
        double wanted = std::clamp(about, simulating::least_error, 0.1);
        Comparison c;
        for (int pass = 0; pass < 3; ++pass) {
            c = AccuracyCheck(part.model, wanted)(record, reference.records[i], runner_.compared().times);
            const double found = std::max(c.motion_difference, c.event_difference);
            const double next = std::clamp(5.0 * found, simulating::least_error, 0.1);
            if (found <= wanted ? wanted <= 30.0 * next : wanted >= 0.1) break;
            wanted = next;
        }
        row.motion_error = std::max(row.motion_error, c.motion_difference);
        row.event_error = std::max(row.event_error, c.event_difference);
        row.events += c.events;
        row.events_expected += c.better_events;
        row.has_all_events = row.has_all_events && c.same_events;
        if (!c.same_events)
            row.motion_error = std::max(row.motion_error, places_apart(part.model, record, reference.records[i],
                                                                       runner_.compared(), c, wanted));
    }
    row.error = std::max(row.motion_error, row.event_error);
}

RBDYN_INLINE double rounding_of(const Part& part, const SimulateOptions& base) {
    SimulateOptions options = base;
    options.rtol.reset();
    return simulating::solve_in_form(part.model, part.start, options, {options.start},
                                     begun(part.closed, options.start))
        .error.value_or(std::numeric_limits<double>::infinity());
}

RBDYN_INLINE std::string Reference::said(const Price& price) const {
    const bool all_closed = std::find(is_closed_.begin(), is_closed_.end(), false) == is_closed_.end();
    const bool any_closed = std::find(is_closed_.begin(), is_closed_.end(), true) != is_closed_.end();
    if (all_closed) return "the closed form";
    std::string what = any_closed ? "closed forms where there are any, and " : "";
    const auto at = [](const std::string& name, double tolerance) {
        return name + " at tolerance " + about(tolerance);
    };
    if (is_extended_)
        what += "a Taylor series refined in long double";
    else
        what += at(first_engine_, first_tolerance_);
    if (!second_engine_.empty())
        what += " (rows of " + first_engine_ + ": " + at(second_engine_, second_tolerance_) + ")";
    // the engines that share nothing with it tell how sure it is
    const std::string own = is_extended_ ? "taylor" : first_engine_;
    const CostRow* nearest = nullptr;
    for (const CostRow& row : price.rows)
        if (row.engine != own && row.engine != price.automatic && row.tolerance > 0.0 && row.has_all_events &&
            (nearest == nullptr || row.error < nearest->error))
            nearest = &row;
    if (nearest != nullptr)
        what += ", which " + nearest->engine + " meets to " + about(nearest->error);
    else if (second_engine_.empty())
        what += ", which no other engine could check";
    return what;
}

}  // namespace rbdyn::inline RBDYN_FORM::pricing
