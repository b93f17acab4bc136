// Definitions of rbdyn/trajectory/run_bytes.hpp.
#pragma once

#include "rbdyn/trajectory/run_bytes.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "rbdyn/basics/error.hpp"
#include "rbdyn/basics/instant.hpp"
#include "rbdyn/basics/interruption.hpp"
#include "rbdyn/closed_form/closed_form.hpp"
#include "rbdyn/engine/taylor.hpp"
#include "rbdyn/event/event.hpp"
#include "rbdyn/event/record.hpp"
#include "rbdyn/expression/program.hpp"
#include "rbdyn/expression/recorder.hpp"
#include "rbdyn/file/scene_file.hpp"
#include "rbdyn/integrate.hpp"
#include "rbdyn/model/equations.hpp"
#include "rbdyn/model/hybrid.hpp"
#include "rbdyn/model/recorded_model.hpp"
#include "rbdyn/plan/kept_plan.hpp"
#include "rbdyn/plan/plan.hpp"
#include "rbdyn/scene/parts.hpp"
#include "rbdyn/scene/scene.hpp"
#include "rbdyn/series/coefficients.hpp"
#include "rbdyn/series/piece.hpp"
#include "rbdyn/trajectory/run_data.hpp"

namespace rbdyn::inline RBDYN_FORM::run_bytes {

RBDYN_INLINE void Writer::put(std::string_view text) {
    put(text.size());
    bytes.append(text);
}

RBDYN_INLINE void Writer::put(const std::vector<bool>& values) {
    put(values.size());
    for (const bool value : values) put(static_cast<unsigned char>(value ? 1 : 0));
}

RBDYN_INLINE std::uint32_t checksum(std::string_view bytes) {
    static const auto table = [] {
        std::array<std::uint32_t, 256> t{};
        for (std::uint32_t i = 0; i < 256; ++i) {
            t[i] = i;
            for (int k = 0; k < 8; ++k) t[i] = (t[i] >> 1) ^ ((t[i] & 1) != 0 ? 0xEDB88320U : 0U);
        }
        return t;
    }();
    std::uint32_t crc = 0xFFFFFFFFU;
    for (const char c : bytes) crc = (crc >> 8) ^ table[(crc ^ static_cast<unsigned char>(c)) & 0xFFU];
    return ~crc;
}

RBDYN_INLINE void Reader::refuse(std::string_view why) {
    throw InvalidInput("Trajectory: its data are none of a run that this version of the library wrote: " +
                       std::string(why));
}

RBDYN_INLINE std::string_view Reader::some(std::size_t count) {
    if (count > bytes_.size()) refuse("they end too soon");
    const std::string_view first = bytes_.substr(0, count);
    bytes_.remove_prefix(count);
    return first;
}

RBDYN_INLINE void put(Writer& w, const std::vector<EngineChange>& changes) {
    w.put(changes.size());
    for (const EngineChange& change : changes) {
        w.put(change.time);
        w.put(std::string_view(change.engine));
    }
}

RBDYN_INLINE std::vector<EngineChange> take_changes(Reader& r) {
    std::vector<EngineChange> changes;
    for (std::size_t left = r.count(1); left > 0; --left) {
        const auto time = r.take<double>();
        changes.push_back({time, r.text()});
    }
    return changes;
}

RBDYN_INLINE void put(Writer& w, const Statistics& s) {
    for (const double seconds : {s.seconds, s.planning_seconds, s.integration_seconds, s.judging_seconds})
        w.put(seconds);
    for (const std::int64_t count : {s.steps, s.rejected, s.right_hand_sides, s.jacobians, s.guard_evaluations,
                                     s.events, s.python_calls, std::int64_t{s.runs}, std::int64_t{s.size.variables},
                                     std::int64_t{s.size.guards}, std::int64_t{s.size.instructions}})
        w.put(count);
    w.put(s.planned);
    put(w, s.changes);
}

RBDYN_INLINE Statistics take_statistics(Reader& r) {
    Statistics s;
    for (double* seconds : {&s.seconds, &s.planning_seconds, &s.integration_seconds, &s.judging_seconds})
        r.take(*seconds);
    for (std::int64_t* count :
         {&s.steps, &s.rejected, &s.right_hand_sides, &s.jacobians, &s.guard_evaluations, &s.events, &s.python_calls})
        r.take(*count);
    for (int* count : {&s.runs, &s.size.variables, &s.size.guards, &s.size.instructions})
        *count = static_cast<int>(r.take<std::int64_t>());
    r.take(s.planned);
    s.changes = take_changes(r);
    return s;
}

RBDYN_INLINE void put(Writer& w, const Event& e) {
    w.put(e.time);
    w.put(e.kind);
    w.put(e.subject);
    w.put(std::string_view(e.name));
    w.put(e.direction);
    w.put(e.impulse);
    w.put(e.contact);
    for (int i = 0; i < 3; ++i) w.put(e.push[i]);
    w.put(e.instant);
    w.put(std::string_view(e.note));
    w.put(e.count);
}

RBDYN_INLINE Event take_event(Reader& r, const Limits& limits) {
    Event e;
    r.take(e.time);
    e.kind = r.word(EventKind::singular);
    e.subject = r.whole(-1, limits.bodies - 1);
    e.name = r.text();
    e.direction = r.word(Direction::falling);
    r.take(e.impulse);
    e.contact = r.whole(-1, limits.contacts - 1);
    for (int i = 0; i < 3; ++i) r.take(e.push[i]);
    r.take(e.instant);
    e.note = r.text();
    e.count = r.whole(std::int64_t{1}, std::numeric_limits<std::int64_t>::max());
    return e;
}

RBDYN_INLINE void put(Writer& w, const Mode& mode) {
    w.put(mode.slip);
    w.put(mode.parameters);
    w.put(mode.still);
    w.put(mode.jumps);
    w.put(mode.memory);
    w.put(mode.equations != nullptr);
    if (mode.equations == nullptr) return;
    std::vector<Choice> choices;
    for (const Branch& b : mode.equations->branches) choices.push_back({b.id, b.choice});
    w.put(choices);
    w.put(std::vector<std::uint64_t>(mode.equations->sliding.begin(), mode.equations->sliding.end()));
}

RBDYN_INLINE Mode take_mode(Reader& r, const RecordedModel* model, double t, std::span<const double> x) {
    Mode mode;
    mode.slip = r.list<signed char>();
    mode.parameters = r.list<double>();
    r.take(mode.still);
    r.take(mode.jumps);
    mode.memory = r.list<double>();
    if (model != nullptr) {
        const Mode known = model->undecided();
        Reader::require(mode.slip.size() == known.slip.size() && mode.memory.size() == known.memory.size(),
                        "a mode is one of another scene");
    }
    if (!r.take<bool>()) return mode;
    Reader::require(model != nullptr, "a mode has equations that are not its own");
    Decisions decided;
    for (const Choice& c : r.list<Choice>()) decided.forced[c.id] = c.choice;
    for (const std::uint64_t surface : r.list<std::uint64_t>()) decided.sliding.insert(surface);
    Reader::require(model->restore(mode, t, x, decided), "a mode has no such equations");
    return mode;
}

RBDYN_INLINE void put(Writer& w, const Halt& halt) {
    w.put(halt.at);
    w.put(halt.x);
    w.put(halt.low);
    put(w, halt.mode);
    w.put(halt.fresh);
    w.put(halt.begins);
    w.put(halt.crowded);
    w.put(halt.passes);
    w.put(halt.fired);
    w.put(halt.handled);
    w.put(halt.watched.size());
    const auto put_zero = [&](const std::optional<double>& zero) {
        w.put(zero.has_value());
        w.put(zero.value_or(0.0));
    };
    for (const WatchedSide& side : halt.watched) {
        w.put(side.side);
        w.put(side.reached);
        w.put(side.product);
        w.put(side.known_from);
        put_zero(side.zero);
        w.put(side.within);
    }
    w.put(halt.sides);
    w.put(halt.ends);
    w.put(halt.passed);
    w.put(halt.engine);
    w.put(halt.winding);
}

RBDYN_INLINE Halt take_halt(Reader& r, const SceneModel& model) {
    Halt halt;
    r.take(halt.at);
    halt.x = r.list<double>();
    halt.low = r.list<double>();
    const auto variables = static_cast<std::size_t>(model.variables());
    Reader::require(halt.x.size() == variables && halt.low.size() == variables, "a state is one of another scene");
    halt.mode = take_mode(r, &model, halt.at.hi, halt.x);
    Reader::require(halt.mode.equations != nullptr, "a mode has no equations");
    const auto guards = static_cast<int>(halt.mode.equations->guards.size());
    r.take(halt.fresh);
    r.take(halt.begins);
    halt.crowded = r.whole(0, 1000);
    halt.passes = r.whole(0, 1000);
    halt.fired = r.list<int>();
    for (const int guard : halt.fired)
        Reader::require(guard >= 0 && guard < guards, "an event is of none of its equations");
    halt.handled = r.flags();
    const auto take_zero = [&]() -> std::optional<double> {
        const bool has = r.take<bool>();
        const auto value = r.take<double>();
        return has ? std::optional(value) : std::nullopt;
    };
    for (std::size_t left = r.count(1); left > 0; --left) {
        WatchedSide& side = halt.watched.emplace_back();
        side.side = r.whole(-1, 1);
        side.reached = r.whole(-1, 1);
        side.product = r.whole(-1, 1);
        r.take(side.known_from);
        side.zero = take_zero();
        r.take(side.within);
    }
    halt.sides = r.list<int>();
    halt.ends = r.list<double>();
    halt.passed = r.flags();
    halt.engine = r.list<double>();
    halt.winding = r.list<double>();
    Reader::require(halt.winding.empty() || halt.winding.size() == model.winding(halt.at.hi, halt.x).size(),
                    "angles are those of another scene");
    return halt;
}

RBDYN_INLINE void put(Writer& w, const std::optional<simulating::Course>& course) {
    w.put(course.has_value());
    if (!course) return;
    w.put(std::string_view(course->engine));
    w.put(course->tolerance);
    w.put(course->manner.order);
    w.put(course->manner.stride);
    w.put(course->manner.is_refined);
    w.put(course->manner.rounding);
    w.put(course->manner.gives_way);
    put(w, course->halt);
}

RBDYN_INLINE std::optional<simulating::Course> take_course(Reader& r, const SceneModel& model) {
    if (!r.take<bool>()) return std::nullopt;
    simulating::Course course;
    course.engine = r.text();
    r.take(course.tolerance);
    // far below the least that any engine is ever given
    constexpr double least_tolerance = 1e-20;
    Reader::require(course.tolerance >= least_tolerance && course.tolerance < 1.0, "a tolerance is none");
    course.manner.order = r.whole(0, TaylorEngine::max_order);
    Reader::require(course.manner.order == 0 || course.manner.order >= TaylorEngine::min_order, "an order is none");
    r.take(course.manner.stride);
    Reader::require(course.manner.stride > 0.0 && course.manner.stride <= 1.0, "a stride is none");
    r.take(course.manner.is_refined);
    course.manner.rounding = r.word(Program::Rounding::other);
    r.take(course.manner.gives_way);
    course.halt = take_halt(r, model);
    return course;
}

RBDYN_INLINE void put(Writer& w, const Record& record) {
    w.put(record.start);
    w.put(record.end);
    w.put(record.status);
    w.put(record.work);
    put(w, record.changes);
    w.put(record.variables);
    w.put(record.first_state);
    w.put(record.windings);
    w.put(record.closed != nullptr);
    w.put(record.closed_from);
    w.put(record.entries().size());
    for (std::size_t i = 0; i < record.entries().size(); ++i) {
        Interruption::point();
        const Record::Entry& e = record.entries()[i];
        each_field(e, [&](const auto& field) { w.put(field); });
        const Piece piece = record.piece(i);
        for (int v = 0; v < piece.variables; ++v)
            for (int k = 0; k <= piece.order; ++k) w.put(piece.variable(v)[k]);
    }
    w.put(record.modes.size());
    for (const Mode& mode : record.modes) put(w, mode);
    w.put(record.events.size());
    for (const Event& e : record.events) put(w, e);
}

RBDYN_INLINE Record take_record(Reader& r, const Limits& limits) {
    Record record;
    r.take(record.start);
    r.take(record.end);
    record.status = r.word(Status::inconsistent);
    r.take(record.work);
    record.changes = take_changes(r);
    r.take(record.variables);
    record.first_state = r.list<double>();
    const auto variables = record.first_state.size();
    Reader::require(
        record.variables >= 0 && (variables == 0 || variables == static_cast<std::size_t>(record.variables)) &&
            (limits.model == nullptr || record.variables == 0 || record.variables == limits.model->variables()),
        "its state is one of another scene");
    for (std::size_t left = r.count(sizeof(std::size_t)); left > 0; --left) record.windings.push_back(r.list<double>());
    if (r.take<bool>()) {
        Reader::require(limits.closed != nullptr, "it is in closed form, and this scene has none");
        record.closed = limits.closed;
    }
    r.take(record.closed_from);
    record.closed = begun(record.closed, record.closed_from);
    int most_modes = -1;
    for (std::size_t left = r.count(sizeof(double)); left > 0; --left) {
        Interruption::point();
        Record::Entry e{};
        each_field(e, [&](auto& field) { r.take(field); });
        Reader::require(e.order >= 0 && e.order <= series::max_degree && e.mode >= 0 && e.unit > 0.0 && e.length >= 0.0,
                        "a piece of its motion is none");
        most_modes = std::max(most_modes, e.mode);
        const std::size_t count = static_cast<std::size_t>(record.variables) * static_cast<std::size_t>(e.order + 1);
        Reader::require(count <= r.rest().size() / sizeof(double), "they end too soon");
        std::vector<double> coefficients(count);
        for (double& c : coefficients) r.take(c);
        record.append({e.start, e.unit, e.length, record.variables, e.order, coefficients.data(), e.order + 1},
                      e.length, e.mode, e.after_event);
    }
    const std::size_t modes = r.count(1);
    Reader::require(most_modes < static_cast<int>(modes) && record.windings.size() <= record.entries().size() &&
                        (modes == 0 || variables == static_cast<std::size_t>(record.variables)),
                    "a piece of its motion has no mode");
    for (std::size_t m = 0; m < modes; ++m) {
        // where it is first met
        const auto& entries = record.entries();
        const auto first = std::find_if(entries.begin(), entries.end(),
                                        [&](const Record::Entry& e) { return e.mode == static_cast<int>(m); });
        std::vector<double> x = record.first_state;
        if (first != entries.end()) record.piece(static_cast<std::size_t>(first - entries.begin())).state(0.0, x);
        record.modes.push_back(take_mode(r, limits.model, first != entries.end() ? first->start.hi : record.start, x));
    }
    if (limits.model != nullptr && !record.windings.empty()) {
        const std::size_t angles = limits.model->winding(record.start, record.first_state).size();
        Reader::require(record.windings.size() == record.entries().size() &&
                            std::all_of(record.windings.begin(), record.windings.end(),
                                        [&](const auto& one) { return one.size() == angles; }),
                        "angles are those of another scene");
    }
    for (std::size_t left = r.count(sizeof(double)); left > 0; --left) record.events.push_back(take_event(r, limits));
    return record;
}

RBDYN_INLINE void put(Writer& w, const RunData& data) {
    put(w, data.record);
    w.put(std::string_view(data.engine));
    put_accuracy(w, data);
    put(w, data.statistics);
    const SimulateOptions& asked = data.asked;
    w.put(asked.error);
    w.put(asked.rtol.has_value());
    w.put(asked.rtol.value_or(0.0));
    w.put(std::string_view(asked.engine));
    w.put(asked.keep.what);
    w.put(asked.max_steps);
    w.put(data.origin);
    put(w, data.course);
    put(w, data.judge);
    w.put(data.scales.numbers());
    w.put(data.first_angles.size());
    for (const auto& angles : data.first_angles) {
        w.put(angles.has_value());
        w.put(angles.value_or(EulerAngles{}));
    }
    w.put(data.parts.size());
    for (const RunData& part : data.parts) put(w, part);
}

RBDYN_INLINE RunData take_run(Reader& r, Scene scene, Plan plan) {
    RunData data;
    data.scene = std::move(scene);
    data.plan = std::move(plan);
    data.model = data.plan.model;
    const Limits limits{data.model.get(), data.plan.closed, static_cast<int>(data.scene.bodies().size()),
                        static_cast<int>(data.scene.contacts().size())};
    data.record = take_record(r, limits);
    data.events = Events(data.record.events);
    data.engine = r.text();
    take_accuracy(r, data);
    data.statistics = take_statistics(r);
    SimulateOptions& asked = data.asked;
    r.take(asked.error);
    const bool has_rtol = r.take<bool>();
    const auto rtol = r.take<double>();
    if (has_rtol) asked.rtol = rtol;
    asked.engine = r.text();
    asked.keep.what = r.word(Keep::What::times);
    r.take(asked.max_steps);
    r.take(data.origin);
    if (data.model) {
        data.course = take_course(r, *data.model);
        data.judge = take_course(r, *data.model);
    } else {
        Reader::require(!r.take<bool>() && !r.take<bool>(), "a run in parts goes on part by part");
    }
    data.scales = ErrorScales::of(r.list<double>());
    const std::size_t angles = r.count(1);
    Reader::require(angles == 0 || angles == data.scene.bodies().size(), "angles are those of another scene");
    for (std::size_t i = 0; i < angles; ++i) {
        const bool has = r.take<bool>();
        const auto known = r.take<EulerAngles>();
        data.first_angles.push_back(has ? std::optional(known) : std::nullopt);
    }
    const auto parts = r.take<std::size_t>();
    Reader::require(parts == data.plan.parts.size(), "it has not the parts that this scene has");
    Reader::require(parts > 0 || !data.record.modes.empty() || data.record.entries().empty(), "it has no modes");
    for (std::size_t i = 0; i < parts; ++i)
        data.parts.push_back(take_run(r, data.plan.apart->parts[i].scene, data.plan.parts[i]));
    return data;
}

RBDYN_INLINE std::string sealed(std::string_view title, std::string_view text, std::string bytes) {
    Writer w;
    w.put(title);
    w.put(checksum(text));
    w.put(checksum(bytes));
    return w.bytes + bytes;
}
RBDYN_INLINE Reader opened(std::string_view title, std::string_view text, std::string_view bytes) {
    Reader r(bytes);
    if (r.text() != title) Reader::refuse("they begin otherwise");
    const auto of_text = r.take<std::uint32_t>(), of_rest = r.take<std::uint32_t>();
    if (of_rest != checksum(r.rest())) Reader::refuse("they were changed or cut short");
    if (of_text != checksum(text)) Reader::refuse("they are of another scene");
    return r;
}

}  // namespace rbdyn::inline RBDYN_FORM::run_bytes

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE std::string bytes_of(const StateRun& run) {
    const simulating::Solution& solution = run.solution();
    run_bytes::Writer w;
    run_bytes::put(w, solution.record);
    w.put(std::string_view(run.engine()));
    run_bytes::put_accuracy(w, solution);
    return run_bytes::sealed(run_bytes::state_head, {}, std::move(w.bytes));
}

RBDYN_INLINE StateRun state_run_from(std::string_view bytes) {
    run_bytes::Reader r = run_bytes::opened(run_bytes::state_head, {}, bytes);
    simulating::Solution solution;
    solution.record = run_bytes::take_record(r, {.bodies = std::numeric_limits<int>::max()});
    std::string engine = r.text();
    run_bytes::take_accuracy(r, solution);
    return StateRun(std::move(solution), std::move(engine));
}

RBDYN_INLINE std::string bytes_of(const RunData& run) {
    run_bytes::Writer w;
    w.put(run.scene.origin());
    run_bytes::put(w, run);
    return run_bytes::sealed(run_bytes::head, text_without_actions(run.scene), std::move(w.bytes));
}

RBDYN_INLINE RunData run_from(const Scene& scene, std::string_view bytes) {
    run_bytes::Reader r = run_bytes::opened(run_bytes::head, text_without_actions(scene), bytes);
    const auto origin = r.take<double>();
    run_bytes::Reader::require(std::isfinite(origin), "it starts at no time");
    PlannedScene now = planned(scene, origin);
    return run_bytes::take_run(r, std::move(now.scene), std::move(now.plan));
}

}  // namespace rbdyn::inline RBDYN_FORM
