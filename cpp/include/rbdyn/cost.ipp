// Definitions of rbdyn/cost.hpp.
#pragma once

#include "rbdyn/cost.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "rbdyn/basics/error.hpp"
#include "rbdyn/engine/stiff_taylor.hpp"
#include "rbdyn/event/record.hpp"
#include "rbdyn/integrate.hpp"
#include "rbdyn/options.hpp"
#include "rbdyn/plan/kept_plan.hpp"
#include "rbdyn/plan/plan.hpp"
#include "rbdyn/plan/planning.hpp"
#include "rbdyn/price.hpp"
#include "rbdyn/pricing.hpp"
#include "rbdyn/scene/parts.hpp"
#include "rbdyn/scene/scene.hpp"
#include "rbdyn/simulate.hpp"
#include "rbdyn/solve.hpp"
#include "rbdyn/special/door.hpp"
#include "rbdyn/system/system.hpp"
#include "rbdyn/system/system_model.hpp"
#include "rbdyn/system/system_run.hpp"

namespace rbdyn::inline RBDYN_FORM::pricing {

/// From one tolerance to the next.
inline constexpr double tighter = 0.01;
/// How often what takes no time is timed, and how often what does if there is time.
inline constexpr std::size_t most_repeats = 7, enough_repeats = 3;
/// The part of the budget that repeats of one row may take.
inline constexpr double repeat_share = 0.007;

/// An engine on its way from loose to tight.
struct Ladder {
    std::string engine;
    std::vector<std::string> engines;     // of each part
    double tolerance = 0.0, least = 0.0;  // the next, and the last
    std::vector<CostRow> rows = {};
    std::vector<std::vector<double>> times = {};  // of each row
    double spent = 0.0, had = 0.0;                // s by the clock: on the last row, and on all
    bool is_done = false, has_whole = true;
    Keep::What keep = Keep::What::all;  // what of its runs is
    std::string cannot = {};
    bool is_auto = false;  // what is stiff is left to BDF

    double reached() const {
        double least_error = std::numeric_limits<double>::infinity();
        for (const CostRow& row : rows)
            if (row.has_all_events) least_error = std::min(least_error, row.error);
        return least_error;
    }
    /// How much dearer the next row will be.
    double growth() const {
        if (rows.size() < 2) return 2.5;
        const double ratio = rows.back().seconds / rows[rows.size() - 2].seconds;
        return ratio > 1.1 ? std::min(ratio, 10.0) : 1.1;
    }
};

/// The engines asked for, those that cannot do the scene with the reason. Throws InvalidInput for one that is none.
RBDYN_INLINE std::vector<Ladder> ladders_of(const std::string& natural, const std::vector<Part>& parts,
                                            const CostOptions& options, double loosest) {
    std::vector<std::string> wanted = options.engines;
    if (wanted.empty()) {
        wanted = rbdyn::engines();
        wanted.push_back("auto");
    }
    std::vector<Ladder> ladders;
    for (const std::string& name : wanted) {
        const bool is_auto = name == "auto";
        simulating::require_engine("cost", name);
        Ladder ladder{is_auto ? natural : name, {}};
        const auto is_it = [&](const Ladder& other) { return other.engine == ladder.engine; };
        if (std::any_of(ladders.begin(), ladders.end(), is_it)) continue;
        try {
            for (const Part& part : parts) ladder.engines.push_back(part.engine_for(name));
        } catch (const InvalidInput& e) {
            // the reason alone, without what simulate() says before and advises after it
            const std::string why = e.what();
            const std::size_t begin = why.find("\", and ") + 7, end = why.find("; use", begin);
            ladder.cannot = "cannot: " + why.substr(begin, end - begin);
            ladder.is_done = true;
        }
        for (const std::string& engine : ladder.engines)
            if (engine != "closed form")
                ladder.least = std::max({ladder.least, simulating::least_tolerance(engine), 1e-16});
        ladder.tolerance = ladder.least > 0.0 ? std::max(loosest, ladder.least) : 0.0;
        ladders.push_back(std::move(ladder));
    }
    return ladders;
}

/// The list while it is made.
class Pricing {
public:
    Pricing(const Whole& whole, Runner& runner, const Reference& reference, Purse& purse, double tightest)
        : whole_(whole), runner_(runner), reference_(reference), purse_(purse), tightest_(tightest) {}

    /// One row more of an engine, or the reason why there is none. `others`: engines that have no row yet.
    void turn(Ladder& ladder, std::size_t others);
    /// Times again what was timed less often than it deserves, while there is time.
    void repeat(std::vector<Ladder>& ladders);
    std::vector<MissingEngine> missing;

private:
    void leave(Ladder& ladder, const std::string& reason, double seconds = std::numeric_limits<double>::quiet_NaN());
    void no_time(Ladder& ladder, double seconds);
    void time_again(Ladder& ladder, std::size_t row);

    const Whole& whole_;
    Runner& runner_;
    const Reference& reference_;
    Purse& purse_;
    double tightest_;
};

/// Where series leave something to BDF, at the loosest tolerance, the automatic choice is a way of its own. It is tried
/// in a small part of the budget: what is stiff takes BDF no longer.
RBDYN_INLINE void add_automatic(std::vector<Ladder>& ladders, Runner& runner, const std::string& natural,
                                const CostOptions& options, double loosest, Price& price) {
    constexpr double part = 0.05;
    const auto is_wanted = [&](const std::string& name) {
        return options.engines.empty() ||
               std::find(options.engines.begin(), options.engines.end(), name) != options.engines.end();
    };
    const auto series = std::find_if(ladders.begin(), ladders.end(), [&](const Ladder& ladder) {
        return ladder.engine == natural && ladder.cannot.empty() && ladder.least > 0.0;
    });
    if (!is_wanted("auto") || series == ladders.end()) return;
    Ladder automatic = *series;
    automatic.is_auto = true;
    automatic.engine = "auto";
    automatic.least = std::max(automatic.least, StiffTaylorEngine::least_tolerance);
    const Measured tried =
        runner.run(automatic.engines, std::max(loosest, automatic.least), part * options.budget, Keep::What::end, true);
    if (std::all_of(tried.records.begin(), tried.records.end(), [](const Record& r) { return r.changes.empty(); }))
        return;
    price.automatic = "auto";
    if (!is_wanted(natural)) ladders.erase(series);
    ladders.push_back(std::move(automatic));
}

RBDYN_INLINE void Pricing::leave(Ladder& ladder, const std::string& reason, double seconds) {
    ladder.is_done = true;
    missing.push_back({ladder.engine, ladder.tolerance, reason, seconds});
}

RBDYN_INLINE void Pricing::no_time(Ladder& ladder, double seconds) {
    const std::string where = ladder.tolerance > 0.0 ? " for tolerance " + about(ladder.tolerance) : "";
    leave(ladder, "no time left" + where + ", it would have taken " + about(seconds) + " s", seconds);
}

RBDYN_INLINE void Pricing::time_again(Ladder& ladder, std::size_t i) {
    CostRow& row = ladder.rows[i];
    std::vector<double>& times = ladder.times[i];
    const Measured again = runner_.run(ladder.engines, row.tolerance, std::numeric_limits<double>::infinity(),
                                       ladder.keep, ladder.is_auto);
    if (!again.records.empty()) times.push_back(again.seconds);
    std::sort(times.begin(), times.end());
    row.seconds = times.front();
    if (times.size() > 1) row.spread = times[times.size() / 2] / times.front() - 1.0;
}

RBDYN_INLINE void Pricing::turn(Ladder& ladder, std::size_t others) {
    const bool is_first = ladder.rows.empty();
    const double factor = is_first ? 1.0 : ladder.growth();
    // nothing can be told of what the others are held against
    if (ladder.least > 0.0 && !reference_.reaches(ladder.engine, ladder.tolerance))
        return leave(ladder, "no time left for a run of another engine that tells its error");
    if (purse_.left() < ladder.spent * factor || purse_.left() <= 0.0)
        return is_first ? leave(ladder, "no time left to begin") : no_time(ladder, ladder.rows.back().seconds * factor);
    const double allowed = purse_.left() / (is_first ? static_cast<double>(others) + 1.0 : 1.0);
    const double began = purse_.spent();
    Measured run = runner_.run(ladder.engines, ladder.tolerance, allowed, ladder.keep, ladder.is_auto);
    if (run.is_too_large) {
        ladder.keep = Keep::What::end;
        run = runner_.run(ladder.engines, ladder.tolerance, allowed, ladder.keep, ladder.is_auto);
    }
    if (purse_.is_closed()) return;
    if (run.projected) return no_time(ladder, *run.projected);
    if (run.is_too_large) return leave(ladder, "cannot: it takes more steps than simulate() does");
    if (!run.broken.empty()) return leave(ladder, "cannot: " + run.broken);
    CostRow row{.engine = ladder.engine, .tolerance = ladder.tolerance};
    row.seconds = run.seconds;
    reference_.judge(run, ladder.engines, is_first ? 0.1 : 3.0 * tighter * ladder.rows.back().error, row);
    ladder.spent = purse_.spent() - began;
    ladder.rows.push_back(row);
    ladder.times.push_back({run.seconds});
    // first runs touch memory that later ones find
    const std::size_t last = ladder.rows.size() - 1;
    for (const double first = purse_.spent(); ladder.times[last].size() < most_repeats && purse_.goes_on() &&
                                              purse_.spent() - first + run.spent < repeat_share * purse_.budget();)
        time_again(ladder, last);

    CostRow& now = ladder.rows.back();
    if (ladder.has_whole && now.has_all_events && now.error <= 0.1 && purse_.goes_on()) {
        const double first = purse_.spent();
        for (int i = 0; i < 3 && (i == 0 || 2.0 * (purse_.spent() - first) < repeat_share * purse_.budget()); ++i) {
            const auto seconds =
                runner_.whole(whole_, ladder.engine.find(',') == std::string::npos ? ladder.engine : "auto",
                              std::max(now.error, tightest_), 0.2 * purse_.left(), ladder.keep);
            if (!seconds) {
                // one that takes so long is not tried for less
                ladder.has_whole = purse_.spent() - first < 0.2 * purse_.left();
                break;
            }
            now.total = i == 0 ? *seconds : std::min(now.total, *seconds);
        }
    }

    const double reached = ladder.reached();
    const std::size_t count = ladder.rows.size();
    const auto error_at = [&](std::size_t back) { return ladder.rows[count - back].error; };
    const bool is_stuck =
        count > 2 && ladder.tolerance <= 1e-11 && std::min(error_at(1), error_at(2)) > 0.5 * error_at(3);
    if (reached <= tightest_ || ladder.least == 0.0) {
        ladder.is_done = true;
    } else if (ladder.tolerance <= ladder.least || is_stuck) {
        leave(ladder, std::isfinite(reached) ? "floor reached, an error of " + about(reached)
                                             : "floor reached, and no row has all events");
    } else {
        ladder.tolerance = std::max(ladder.tolerance * tighter, ladder.least);
    }
}

RBDYN_INLINE void Pricing::repeat(std::vector<Ladder>& ladders) {
    struct Slot {
        Ladder* ladder;
        std::size_t row;
    };
    std::vector<Slot> slots;
    for (Ladder& ladder : ladders)
        for (std::size_t i = 0; i < ladder.rows.size(); ++i) slots.push_back({&ladder, i});
    std::sort(slots.begin(), slots.end(), [](const Slot& a, const Slot& b) {
        return a.ladder->rows[a.row].seconds < b.ladder->rows[b.row].seconds;
    });
    for (const Slot& slot : slots)
        while (slot.ladder->times[slot.row].size() < enough_repeats) {
            if (!purse_.goes_on() || 1.2 * slot.ladder->rows[slot.row].seconds > purse_.left()) break;
            time_again(*slot.ladder, slot.row);
        }
}

/// Where an engine had no time and an implicit one has plenty, the scene is stiff for it.
RBDYN_INLINE void name_stiffness(Price& price) {
    constexpr const char* implicit = "cvode-bdf";
    for (MissingEngine& m : price.missing) {
        if (m.engine == implicit || !(m.seconds > 0.0)) continue;
        const CostRow* near = nullptr;
        for (const CostRow& row : price.rows)
            if (row.engine == implicit && row.tolerance >= 0.99 * m.tolerance) near = &row;
        if (near == nullptr || 10.0 * near->seconds > m.seconds) continue;
        m.reason = "stiff: steps are kept short by stability, " + about(m.seconds) + " s for tolerance " +
                   about(m.tolerance) + " where " + implicit + " takes " + about(near->seconds) + " s";
    }
}

/// The options of the runs of a list. Throws InvalidInput for what breaks a rule.
RBDYN_INLINE SimulateOptions runs_of(const CostOptions& options) {
    require(options.budget > 0.0, "cost", "budget", options.budget, "it is positive, in s");
    if (options.errors.empty()) throw InvalidInput("cost: errors has 0 entries; give at least one");
    for (const double e : options.errors)
        require(e > 0.0 && e <= 0.1, "cost", "an error", e, "it lies between 0 and 0.1");
    SimulateOptions base;
    base.until = options.until;
    base.start = options.start;
    simulating::validate(base);
    return base;
}

RBDYN_INLINE Price priced(const std::vector<Part>& parts, const std::string& natural, const Whole& whole,
                          const CostOptions& options, Purse& purse) {
    const SimulateOptions base = runs_of(options);
    std::vector<double> errors = options.errors;
    std::sort(errors.begin(), errors.end());
    std::vector<Ladder> ladders = ladders_of(natural, parts, options, errors.back());
    Price price;
    price.automatic = natural;
    Runner runner(parts, base, purse);
    const auto integrates = [](const Ladder& ladder) { return ladder.cannot.empty() && ladder.least > 0.0; };
    const bool is_wanted = std::any_of(ladders.begin(), ladders.end(), integrates);
    add_automatic(ladders, runner, natural, options, errors.back(), price);
    const Reference reference(runner, whole, purse, is_wanted);
    Pricing list(whole, runner, reference, purse, errors.front());
    for (Ladder& ladder : ladders) {
        if (!ladder.cannot.empty()) list.missing.push_back({ladder.engine, 0.0, ladder.cannot});
        if (integrates(ladder) && !reference.is_any()) {
            list.missing.push_back({ladder.engine, 0.0, "no time left: nothing to measure errors against was there"});
            ladder.is_done = true;
        }
    }
    const auto is_open = [](const Ladder& ladder) { return !ladder.is_done; };
    // it is the turn of the engine that has had the least time, so that dear ones do not keep cheap ones waiting
    while (purse.goes_on() && std::any_of(ladders.begin(), ladders.end(), is_open)) {
        Ladder& next = *std::min_element(ladders.begin(), ladders.end(), [&](const Ladder& a, const Ladder& b) {
            return std::pair(a.is_done, a.had) < std::pair(b.is_done, b.had);
        });
        const auto others = std::count_if(ladders.begin(), ladders.end(), [&](const Ladder& other) {
            return is_open(other) && other.rows.empty() && &other != &next;
        });
        const double before = purse.spent();
        list.turn(next, static_cast<std::size_t>(others));
        next.had += purse.spent() - before;
    }
    list.repeat(ladders);
    for (const Ladder& ladder : ladders) price.rows.insert(price.rows.end(), ladder.rows.begin(), ladder.rows.end());
    price.missing = std::move(list.missing);
    name_stiffness(price);
    price.reference = reference.said(price);
    price.seconds = purse.spent();
    return price;
}

/// What attempts are asked for.
template <class Made>
bool reaches(const Made& made) {
    return made.outcome == simulating::Outcome::good && made.run.status() != Status::stopped_by_user;
}

}  // namespace rbdyn::inline RBDYN_FORM::pricing

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE Price cost(const Scene& scene, const CostOptions& options) {
    using namespace pricing;
    const SimulateOptions base = runs_of(options);
    Purse purse(options.budget, options.monitor);
    const auto [plan_scene, plan, is_new] = planned(scene, base.start);
    std::vector<Part> parts;
    const auto add = [&](const Plan& one, const Scene& alone) {
        parts.push_back({.model = *one.model,
                         .start = one.model->start(base.start),
                         .closed = one.closed,
                         .calls_back = one.calls_back,
                         .engine_for = [&one](const std::string& name) { return simulating::engine_for(one, name); },
                         .close = [&one, &alone] { return planning::closed_form(alone, *one.model, true).form; }});
    };
    if (plan.parts.empty()) add(plan, plan_scene);
    for (std::size_t i = 0; i < plan.parts.size(); ++i) add(plan.parts[i], plan.apart->parts[i].scene);
    const Whole whole{[&](const SimulateOptions& o) { return reaches(attempt(scene, o)); },
                      [&, &frozen = plan_scene](const SimulateOptions& o) { require_good(attempt(frozen, o)); }};
    return priced(parts, plan.engine, whole, options, purse);
}

RBDYN_INLINE Price cost(const System& system, const CostOptions& options) {
    using namespace pricing;
    (void)runs_of(options);
    Purse purse(options.budget, options.monitor);
    const SystemModel model(system.frozen());
    const auto engine_for = [&](const std::string& name) { return simulating::engine_for(system, name); };
    const std::vector<Part> parts = {
        {.model = model, .start = system.start(), .calls_back = system.calls_back(), .engine_for = engine_for}};
    const Whole whole{[&](const SimulateOptions& o) { return reaches(attempt(system, o)); },
                      [&](const SimulateOptions& o) { (void)simulate(system, o); }};
    return priced(parts, engine_for("auto"), whole, options, purse);
}

}  // namespace rbdyn::inline RBDYN_FORM
