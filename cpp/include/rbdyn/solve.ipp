// Definitions of rbdyn/solve.hpp.
#pragma once

#include "rbdyn/solve.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "rbdyn/basics/error.hpp"
#include "rbdyn/basics/instant.hpp"
#include "rbdyn/basics/sort_few.hpp"
#include "rbdyn/curve/curve.hpp"
#include "rbdyn/curve/point.hpp"
#include "rbdyn/engine/engine.hpp"
#include "rbdyn/event/event.hpp"
#include "rbdyn/event/record.hpp"
#include "rbdyn/integrate.hpp"
#include "rbdyn/model/hybrid.hpp"
#include "rbdyn/plan/plan.hpp"
#include "rbdyn/plan/planning.hpp"
#include "rbdyn/scene/joints.hpp"
#include "rbdyn/scene/parts.hpp"
#include "rbdyn/scene/scene.hpp"
#include "rbdyn/scene/watch.hpp"
#include "rbdyn/solve_closed.hpp"
#include "rbdyn/trajectory/body_motion.hpp"
#include "rbdyn/trajectory/run_data.hpp"

namespace rbdyn::inline RBDYN_FORM::simulating {

RBDYN_INLINE std::string engine_for(const Plan& plan, const std::string& wanted) {
    const std::string engine = wanted == "auto" ? plan.engine : wanted;
    if (engine == "closed form") {
        if (plan.closed) return engine;
        std::string why;
        for (const Plan::Omission& o : plan.omissions)
            if (o.what == "closed form") why = o.why;
        throw InvalidInput("simulate: engine is \"closed form\", and this scene has none: " + why +
                           "; use \"auto\" or \"" + plan.integrator + "\"");
    }
    require_engine("simulate", engine);
    if (engine == "taylor" && plan.calls_back)
        throw InvalidInput(
            "simulate: engine is \"taylor\", and a function of this scene is called back, which has no "
            "Taylor series; use \"auto\" or \"dop853\", or write it so that it can be recorded");
    const auto touches = [](const Plan& one) { return one.model && one.model->touches(); };
    if (engine != "taylor" && (touches(plan) || std::any_of(plan.parts.begin(), plan.parts.end(), touches)))
        throw InvalidInput(
            "simulate: engine is \"" + engine +
            "\", and this scene has contacts, which only \"taylor\" holds after each step in this version; "
            "use \"auto\"" +
            (plan.calls_back ? ", and write the function that is called back so that it can be recorded" : ""));
    return engine;
}

RBDYN_INLINE Statistics statistics_of(const Solution& solution) {
    Statistics s;
    const Work& w = solution.record.work;
    s.integration_seconds = solution.integration_seconds;
    s.steps = w.steps;
    s.rejected = w.rejected;
    s.right_hand_sides = w.right_hand_sides;
    s.jacobians = w.jacobians;
    s.guard_evaluations = w.guard_evaluations;
    s.events = solution.record.handed_on;
    for (const Event& e : solution.record.events) s.events += e.count;
    s.runs = solution.runs;
    s.changes = solution.record.changes;
    if (!solution.record.modes.empty()) s.size = Size(solution.record.modes.front());
    return s;
}

RBDYN_INLINE std::string named(const std::string& engine, const std::vector<EngineChange>& changes) {
    std::vector<std::string> names = {engine};
    for (const EngineChange& change : changes)
        if (std::find(names.begin(), names.end(), change.engine) == names.end()) names.push_back(change.engine);
    return planning::first_of(names, names.size(), ", ");
}

/// Events of a contact or a body have its name.
RBDYN_INLINE void name(Event& e, const Scene& scene) {
    if (e.contact >= 0) e.name = scene.contacts()[static_cast<std::size_t>(e.contact)].name;
    if (e.name.empty() && e.subject >= 0) e.name = scene.bodies()[static_cast<std::size_t>(e.subject)].name;
}

RBDYN_INLINE Solved solved(Scene scene, Plan plan, std::string engine, Solution&& solution) {
    Solved result{solution.outcome, std::move(solution.message), solution.thrown, {}};
    RunData& data = result.data;
    data.scene = std::move(scene);
    data.plan = std::move(plan);
    data.model = data.plan.model;
    data.engine = named(engine, solution.record.changes);
    data.statistics = statistics_of(solution);
    data.error = solution.error;
    data.course = std::move(solution.course);
    data.judge = std::move(solution.judge);
    data.scales = std::move(solution.scales);
    data.certain_until = solution.certain_until;
    data.record = std::move(solution.record);
    for (Event& e : data.record.events) name(e, data.scene);
    data.events = Events(data.record.events);
    return result;
}

/// The Euler angles of bodies that turn freely at a time of a run, which those of one that goes on begin with.
RBDYN_INLINE std::vector<std::optional<EulerAngles>> angles_at(const RunData& run, double t) {
    const std::shared_ptr<const RunData> data(std::shared_ptr<const RunData>(), &run);
    std::vector<std::optional<EulerAngles>> angles(run.scene.bodies().size());
    for (std::size_t i = 0; i < angles.size(); ++i)
        if (const int body = static_cast<int>(i);
            run.model && run.model->place_of_angles(body) >= 0 && run.scene.bodies()[i].rigid() != nullptr)
            angles[i] = BodyMotion(data, body).euler_angles(t);
    return angles;
}

/// HybridModel::winding at a time of a run, at its state there.
RBDYN_INLINE std::vector<double> winding_at(const SceneModel& model, const RunData& run, double t,
                                            std::span<const double> x) {
    std::vector<double> winding = model.winding(t, x);
    if (winding.empty()) return winding;
    const auto angles = angles_at(run, t);
    for (int body = 0; body < model.bodies(); ++body) {
        const int place = model.place_of_angles(body);
        const auto& known = angles[static_cast<std::size_t>(body)];
        if (place < 0 || !known) continue;
        double* own = winding.data() + 3 * place;
        own[0] = known->theta;
        own[1] = known->psi;
        own[2] = known->phi;
    }
    return winding;
}

/// What of a run tells that it is one that goes on, and with which.
RBDYN_INLINE void set_origin(Solved& result, const SimulateOptions& options, const RunData* before) {
    result.data.asked = options;
    result.data.asked.monitor = {};
    result.data.asked.warn = {};
    result.data.asked.events = {};
    result.data.origin = before != nullptr ? before->origin : options.start;
    if (before != nullptr) result.data.first_angles = angles_at(*before, options.start);
}

RBDYN_INLINE void require_squares(const Scene& scene) {
    constexpr double most = 1e150;
    double largest = 0.0;
    const Scene::Body* whose = nullptr;
    for (const Scene::Body& body : scene.bodies()) {
        const auto look = [&](double x) {
            if (!(std::abs(x) > largest)) return;
            largest = std::abs(x);
            whose = &body;
        };
        for (int k = 0; k < 3; ++k) {
            look(body.position[k]);
            look(body.velocity[k]);
            look(body.coordinates[static_cast<std::size_t>(k)]);
            look(body.rates[static_cast<std::size_t>(k)]);
            look(static_cast<double>(body.angular_velocity[k]));
        }
        look(body.parameter);
        look(body.speed);
    }
    if (whose != nullptr)
        require(largest < most, whose->name, "the largest number of its start", largest,
                "numbers of a start are below 1e150, so that their squares are numbers: give lengths or times in "
                "larger units");
}

RBDYN_INLINE Solved solve_together(Scene scene, Plan plan, const SimulateOptions& asked, const RunData* before,
                                   Ahead* ahead) {
    std::string engine = engine_for(plan, asked.engine);
    SimulateOptions options = asked;
    // what goes on may be computed anew from where it began
    if (before != nullptr)
        options.events = {};
    else if (asked.events.each)
        options.events.each = [&](Event e) {
            name(e, scene);
            asked.events.each(e);
        };
    const SceneModel& model = *plan.model;
    const auto from_start = [&] {
        require_squares(scene);
        const std::vector<double> x = model.start(options.start);
        const Beginning beginning{options.start};
        return solve_from(model, plan, x, engine, options, beginning, ahead);
    };
    Solution solution = before != nullptr ? solve_on(model, plan, engine, options, *before) : from_start();
    // what is a square loses its digits from here on; a run that broke off may not have come to more
    constexpr double least = 1e-150;
    const Status status = solution.record.status;
    if (status == Status::reached_end || status == Status::stopped_by_event || status == Status::accuracy_not_reached)
        require_size(solution.record, "Scene", least);
    Solved result = solved(std::move(scene), std::move(plan), std::move(engine), std::move(solution));
    set_origin(result, options, before);
    return result;
}

RBDYN_INLINE Solution solve_from(const SceneModel& model, const Plan& plan, const std::vector<double>& x,
                                 const std::string& engine, const SimulateOptions& options, const Beginning& beginning,
                                 Ahead* ahead) {
    const std::shared_ptr<const ClosedForm> form = begun(plan.closed, beginning.origin);
    return engine == "closed form" ? solve_in_form(model, x, options, beginning, form)
                                   : solve(model, x, options, beginning, engine, plan.integrator, form, ahead);
}

RBDYN_INLINE Solution solve_on(const SceneModel& model, const Plan& plan, const std::string& engine,
                               const SimulateOptions& options, const RunData& before) {
    const bool stands = before.course && before.record.end.hi == options.start;
    if (engine == "closed form" && stands && before.course->engine == engine) {
        Solution solution = solve_in_form(model, before.course->halt.x, options, {before.origin, &before.course->halt},
                                          begun(plan.closed, before.origin));
        // of a motion that has more than one form each adds its error
        const bool adds = !is_one_form(plan.closed) && solution.error;
        if (adds) *solution.error += before.error.value_or(0.0);
        if (!adds || *solution.error <= options.error) return solution;
    }
    const bool has_estimate = before.judge && before.error && !before.asked.rtol &&
                              options.error >= before.asked.error && before.course->engine == engine;
    if (stands && engine != "closed form" && (options.rtol || has_estimate)) {
        Course course = *before.course;
        if (options.rtol) {
            // what another engine keeps says nothing to this one
            if (course.engine != engine) course.halt.engine.clear();
            course.engine = engine;
            course.tolerance = *options.rtol;
            course.manner = {.gives_way = gives_way(model, options, engine, course.tolerance)};
        }
        const Course* judge = options.rtol ? nullptr : &*before.judge;
        Course better = judge != nullptr ? *judge : course;
        // turns that are counted go on from those of the run
        course.halt.winding = better.halt.winding = winding_at(model, before, options.start, course.halt.x);
        const Standing standing{before.origin, course, judge != nullptr ? &better : nullptr, before.scales,
                                before.error.value_or(0.0)};
        if (auto solution = carry_on(model, standing, options, begun(plan.closed, before.origin)))
            return *std::move(solution);
    }
    // all of it anew; times that are kept are those wanted and the start, so that there is a state
    SimulateOptions whole = options;
    whole.start = before.origin;
    if (whole.keep.what != Keep::What::all) {
        std::vector<double>& times = whole.keep.times;
        whole.keep.what = Keep::What::times;
        times.insert(times.begin(), options.start);
        if (options.keep.what == Keep::What::end) times.push_back(options.until);
    }
    // an event at the end of the run before is met within the error of either
    const double error = std::max(options.rtol.value_or(options.error), before.asked.rtol.value_or(before.asked.error)),
                 near = 10.0 * error * (options.start - before.origin) +
                        8.0 * std::numeric_limits<double>::epsilon() * std::abs(options.start);
    const Beginning beginning{before.origin, nullptr, options.start + near};
    const std::vector<double> x = model.start(before.origin);
    Solution solution = solve_from(model, plan, x, engine, whole, beginning, nullptr);
    const auto had = [&](const Event& e) {
        return std::any_of(before.record.events.begin(), before.record.events.end(), [&](const Event& b) {
            return b.kind == e.kind && b.subject == e.subject && b.contact == e.contact &&
                   std::abs(b.time - e.time) <= 2.0 * near;
        });
    };
    std::vector<Event> there;
    for (Event e : solution.record.events) {
        if (e.time > options.start + near) {
            there.push_back(e);
        } else if (e.time >= options.start - near && !had(e)) {
            e.time = std::max(e.time, options.start);
            if (e.time == options.start) e.instant = {options.start, 0.0};
            there.push_back(e);
        }
    }
    solution.record.drop_before(options.start);
    solution.record.events = std::move(there);
    solution.certain_until = std::max(solution.certain_until, solution.record.start);
    return solution;
}

RBDYN_INLINE Solved not_begun(const Scene& scene, const Plan& plan, const std::string& engine,
                              const SimulateOptions& options, const RunData* before) {
    Solution solution;
    Record& record = solution.record;
    const double start = options.start;
    record.start = start;
    record.end = {start, 0.0};
    record.status = Status::stopped_by_user;
    record.variables = plan.model->variables();
    record.modes = {plan.model->undecided()};
    record.first_state = plan.model->start(before != nullptr ? before->origin : start);
    if (before != nullptr && before->course && before->record.end.hi == start) {
        record.first_state = before->course->halt.x;
        record.modes = {before->course->halt.mode};
        solution.course = before->course;
        solution.judge = before->judge;
        solution.scales = before->scales;
    }
    solution.certain_until = start;
    Solved result = solved(scene, plan, engine, std::move(solution));
    set_origin(result, options, before);
    return result;
}

RBDYN_INLINE bool may_stop(const Scene& scene) {
    const auto stops = [](const Scene::Watch& w) { return w.options.action.kind == WatchAction::Kind::stop; };
    const auto has_end = [](const Scene::Body& b) {
        const Rail* rail = b.rail();
        if (rail == nullptr || rail->ends() != RailEnds::stop || rail->curve().closed()) return false;
        const Domain domain = rail->curve().domain();
        return std::isfinite(domain.begin) || std::isfinite(domain.end);
    };
    return std::any_of(scene.watches().begin(), scene.watches().end(), stops) ||
           std::any_of(scene.bodies().begin(), scene.bodies().end(), has_end);
}

RBDYN_INLINE std::vector<Event> events_of(const std::vector<Solved>& parts, const SceneParts& apart, double end) {
    std::vector<Event> all;
    for (std::size_t i = 0; i < parts.size(); ++i)
        for (Event e : parts[i].data.record.events) {
            if (e.time > end) break;
            if (e.contact >= 0) e.contact = apart.parts[i].contacts[static_cast<std::size_t>(e.contact)];
            if (e.subject >= 0) e.subject = apart.parts[i].bodies[static_cast<std::size_t>(e.subject)];
            all.push_back(std::move(e));
        }
    std::stable_sort(all.begin(), all.end(),
                     [](const Event& a, const Event& b) { return a.instant - b.instant < 0.0; });
    const auto together = [](const Event& a, const Event& b) {
        return b.instant - a.instant <= 8.0 * std::numeric_limits<double>::epsilon() * std::abs(b.time);
    };
    for (std::size_t first = 0, last = 0; first < all.size(); first = last) {
        for (last = first + 1; last < all.size() && together(all[last - 1], all[last]);) ++last;
        sort_few(std::span(all).subspan(first, last - first), comes_before);
    }
    return all;
}

RBDYN_INLINE Solved solve_apart(Scene scene, Plan plan, const SimulateOptions& options, const RunData* before) {
    const SceneParts& apart = *plan.apart;
    const std::size_t count = plan.parts.size();
    std::vector<std::string> engines, names;
    for (const Plan& part : plan.parts) {
        engines.push_back(engine_for(part, options.engine));
    }
    std::vector<Solved> parts(count);
    std::vector<double> untils(count);
    Instant end{options.until, 0.0};
    std::size_t shortest = count;  // the part that ends the others
    bool goes_on = true;
    int runs = 0;
    SimulateOptions own = options;
    // of several parts they are handed on in the order of all
    own.events.each = {};
    const auto ends_by_event = [&](const Solved& part) {
        const Status status = part.data.record.status;
        return status == Status::stopped_by_event || status == Status::accuracy_not_reached;
    };
    const auto solve_part = [&](std::size_t i) {
        own.until = untils[i] = end.hi;
        const Scene& alone = apart.parts[i].scene;
        const RunData* part_before = before != nullptr ? &before->parts[i] : nullptr;
        parts[i] = goes_on && own.until > own.start ? solve_together(alone, plan.parts[i], own, part_before)
                                                    : not_begun(alone, plan.parts[i], engines[i], own, part_before);
        const Record& record = parts[i].data.record;
        runs += parts[i].data.statistics.runs;
        goes_on = goes_on && record.status != Status::stopped_by_user;
        if (record.end.hi < end.hi) {
            end = record.end;
            shortest = i;
        }
    };
    // first what may end the others, then what takes no time and is there if the rest is interrupted
    const auto turn = [&](std::size_t i) {
        return may_stop(apart.parts[i].scene) ? 0 : engines[i] == "closed form" ? 1 : 2;
    };
    for (const int now : {0, 1, 2})
        for (std::size_t i = 0; i < count; ++i)
            if (turn(i) == now) solve_part(i);
    for (std::size_t i = 0; i < count && shortest < count && goes_on && ends_by_event(parts[shortest]);) {
        const bool is_longer = i != shortest && untils[i] > end.hi;
        if (is_longer) solve_part(i);
        // its event may lie a little earlier in this run: then the others end there
        i = is_longer && shortest == i ? 0 : i + 1;
    }

    const auto worse = [](const Solved& a, const Solved& b) {
        return std::tie(a.outcome, a.data.record.status) < std::tie(b.outcome, b.data.record.status);
    };
    Solved& worst = *std::max_element(parts.begin(), parts.end(), worse);
    Solved result{worst.outcome, std::move(worst.message), worst.thrown, {}};
    if (result.outcome == Outcome::inaccurate)
        result.message += " This is said of " + planning::names_of(worst.data.scene) + ".";
    RunData& data = result.data;
    data.record.start = options.start;
    data.record.end = end;
    data.record.status = worst.data.record.status;
    data.record.events = events_of(parts, apart, end.hi);
    data.events = Events(data.record.events);
    data.certain_until = end.hi;
    if (!options.rtol) data.error = 0.0;
    Statistics& s = data.statistics;
    s.runs = runs;
    for (const Event& e : data.events) s.events += e.count;
    for (Solved& part : parts) {
        const Statistics& w = part.data.statistics;
        if (std::find(names.begin(), names.end(), part.data.engine) == names.end()) names.push_back(part.data.engine);
        s.changes.insert(s.changes.end(), w.changes.begin(), w.changes.end());
        s.integration_seconds += w.integration_seconds;
        s.steps += w.steps;
        s.rejected += w.rejected;
        s.right_hand_sides += w.right_hand_sides;
        s.jacobians += w.jacobians;
        s.guard_evaluations += w.guard_evaluations;
        s.size += w.size;
        data.certain_until = std::min(data.certain_until, part.data.certain_until);
        if (data.error && part.data.error)
            data.error = std::max(*data.error, *part.data.error);
        else
            data.error.reset();
        data.parts.push_back(std::move(part.data));
    }
    data.engine = planning::first_of(names, names.size(), ", ");
    std::stable_sort(s.changes.begin(), s.changes.end(),
                     [](const EngineChange& a, const EngineChange& b) { return a.time < b.time; });
    data.scene = std::move(scene);
    data.plan = std::move(plan);
    data.asked = options;
    data.asked.monitor = {};
    data.asked.warn = {};
    data.origin = before != nullptr ? before->origin : options.start;
    return result;
}

}  // namespace rbdyn::inline RBDYN_FORM::simulating
