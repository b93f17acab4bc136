// Definitions of rbdyn/trajectory/run_bytes.hpp.
#pragma once

#include "rbdyn/trajectory/run_bytes.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "rbdyn/basics/error.hpp"
#include "rbdyn/basics/instant.hpp"
#include "rbdyn/closed_form/closed_form.hpp"
#include "rbdyn/event/event.hpp"
#include "rbdyn/event/record.hpp"
#include "rbdyn/expression/recorder.hpp"
#include "rbdyn/integrate.hpp"
#include "rbdyn/model/equations.hpp"
#include "rbdyn/model/hybrid.hpp"
#include "rbdyn/model/points.hpp"
#include "rbdyn/model/recorded_model.hpp"
#include "rbdyn/plan/kept_plan.hpp"
#include "rbdyn/plan/plan.hpp"
#include "rbdyn/scene/parts.hpp"
#include "rbdyn/scene/scene.hpp"
#include "rbdyn/series/piece.hpp"
#include "rbdyn/trajectory/run_data.hpp"

namespace rbdyn::inline RBDYN_FORM::run_bytes {

RBDYN_INLINE void Writer::put(std::string_view text) {
    put(text.size());
    bytes.append(text);
}

RBDYN_INLINE void Reader::refuse() {
    throw InvalidInput("Trajectory: its data are none of a run that this version of the library wrote");
}

RBDYN_INLINE std::string_view Reader::some(std::size_t count) {
    if (count > bytes_.size()) refuse();
    const std::string_view first = bytes_.substr(0, count);
    bytes_.remove_prefix(count);
    return first;
}

RBDYN_INLINE void put(Writer& w, const Statistics& s) {
    for (const double seconds : {s.seconds, s.integration_seconds}) w.put(seconds);
    for (const std::int64_t count : {s.steps, s.rejected, s.right_hand_sides, s.jacobians, s.guard_evaluations,
                                     s.events, s.python_calls, std::int64_t{s.runs}, std::int64_t{s.size.variables},
                                     std::int64_t{s.size.guards}, std::int64_t{s.size.instructions}})
        w.put(count);
    w.put(s.planned);
}

RBDYN_INLINE Statistics take_statistics(Reader& r) {
    Statistics s;
    for (double* seconds : {&s.seconds, &s.integration_seconds}) r.take(*seconds);
    for (std::int64_t* count :
         {&s.steps, &s.rejected, &s.right_hand_sides, &s.jacobians, &s.guard_evaluations, &s.events, &s.python_calls})
        r.take(*count);
    for (int* count : {&s.runs, &s.size.variables, &s.size.guards, &s.size.instructions})
        *count = static_cast<int>(r.take<std::int64_t>());
    r.take(s.planned);
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
}

RBDYN_INLINE Event take_event(Reader& r) {
    Event e;
    r.take(e.time);
    r.take(e.kind);
    r.take(e.subject);
    e.name = r.text();
    r.take(e.direction);
    r.take(e.impulse);
    r.take(e.contact);
    for (int i = 0; i < 3; ++i) r.take(e.push[i]);
    r.take(e.instant);
    e.note = r.text();
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

RBDYN_INLINE Mode take_mode(Reader& r, const SceneModel* model, double t, std::span<const double> x) {
    Mode mode;
    mode.slip = r.list<signed char>();
    mode.parameters = r.list<double>();
    r.take(mode.still);
    r.take(mode.jumps);
    mode.memory = r.list<double>();
    if (!r.take<bool>()) return mode;
    if (model == nullptr) Reader::refuse();
    Decisions decided;
    for (const Choice& c : r.list<Choice>()) decided.forced[c.id] = c.choice;
    for (const std::uint64_t surface : r.list<std::uint64_t>()) decided.sliding.insert(surface);
    if (!model->restore(mode, t, x, decided)) Reader::refuse();
    return mode;
}

RBDYN_INLINE void put(Writer& w, const Record& record) {
    w.put(record.start);
    w.put(record.end);
    w.put(record.status);
    w.put(record.work);
    w.put(record.variables);
    w.put(record.first_state);
    w.put(record.windings);
    w.put(record.closed != nullptr);
    w.put(record.entries().size());
    for (std::size_t i = 0; i < record.entries().size(); ++i) {
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

RBDYN_INLINE Record take_record(Reader& r, const SceneModel* model, const std::shared_ptr<const ClosedForm>& closed) {
    Record record;
    r.take(record.start);
    r.take(record.end);
    r.take(record.status);
    r.take(record.work);
    r.take(record.variables);
    record.first_state = r.list<double>();
    const auto wound = r.take<std::size_t>();
    for (std::size_t i = 0; i < wound; ++i) record.windings.push_back(r.list<double>());
    if (r.take<bool>()) record.closed = closed;
    for (auto left = r.take<std::size_t>(); left > 0; --left) {
        Record::Entry e{};
        each_field(e, [&](auto& field) { r.take(field); });
        std::vector<double> coefficients;
        for (int k = 0; k < record.variables * (e.order + 1); ++k) coefficients.push_back(r.take<double>());
        record.append({e.start, e.unit, e.length, record.variables, e.order, coefficients.data(), e.order + 1},
                      e.length, e.mode, e.after_event);
    }
    const auto modes = r.take<std::size_t>();
    for (std::size_t m = 0; m < modes; ++m) {
        // where it is first met
        const auto& entries = record.entries();
        const auto first = std::find_if(entries.begin(), entries.end(),
                                        [&](const Record::Entry& e) { return e.mode == static_cast<int>(m); });
        std::vector<double> x = record.first_state;
        if (first != entries.end()) record.piece(static_cast<std::size_t>(first - entries.begin())).state(0.0, x);
        record.modes.push_back(take_mode(r, model, first != entries.end() ? first->start.hi : record.start, x));
    }
    for (auto left = r.take<std::size_t>(); left > 0; --left) record.events.push_back(take_event(r));
    return record;
}

/// How accurate a run is.
template <class Run>
void put_accuracy(Writer& w, const Run& run) {
    w.put(run.error.has_value());
    w.put(run.error.value_or(0.0));
    w.put(run.certain_until);
}
template <class Run>
void take_accuracy(Reader& r, Run& run) {
    const bool has_error = r.take<bool>();
    const auto error = r.take<double>();
    if (has_error) run.error = error;
    r.take(run.certain_until);
}

RBDYN_INLINE void put(Writer& w, const RunData& data) {
    put(w, data.record);
    w.put(std::string_view(data.engine));
    put_accuracy(w, data);
    put(w, data.statistics);
    w.put(data.parts.size());
    for (const RunData& part : data.parts) put(w, part);
}

RBDYN_INLINE RunData take_run(Reader& r, Scene scene, Plan plan) {
    RunData data;
    data.scene = std::move(scene);
    data.plan = std::move(plan);
    data.model = data.plan.model;
    data.record = take_record(r, data.model.get(), data.plan.closed);
    data.events = Events(data.record.events);
    data.engine = r.text();
    take_accuracy(r, data);
    data.statistics = take_statistics(r);
    const auto parts = r.take<std::size_t>();
    if (parts != data.plan.parts.size()) Reader::refuse();
    for (std::size_t i = 0; i < parts; ++i)
        data.parts.push_back(take_run(r, data.plan.apart->parts[i].scene, data.plan.parts[i]));
    return data;
}

}  // namespace rbdyn::inline RBDYN_FORM::run_bytes

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE std::string bytes_of(const StateRun& run) {
    const simulating::Solution& solution = run.solution();
    run_bytes::Writer w;
    w.put(run_bytes::state_head);
    run_bytes::put(w, solution.record);
    w.put(std::string_view(run.engine()));
    run_bytes::put_accuracy(w, solution);
    return std::move(w.bytes);
}

RBDYN_INLINE StateRun state_run_from(std::string_view bytes) {
    run_bytes::Reader r(bytes);
    if (r.text() != run_bytes::state_head) run_bytes::Reader::refuse();
    simulating::Solution solution;
    solution.record = run_bytes::take_record(r, nullptr, nullptr);
    std::string engine = r.text();
    run_bytes::take_accuracy(r, solution);
    return StateRun(std::move(solution), std::move(engine));
}

RBDYN_INLINE std::string bytes_of(const RunData& run) {
    run_bytes::Writer w;
    w.put(run_bytes::head);
    run_bytes::put(w, run);
    return std::move(w.bytes);
}

RBDYN_INLINE RunData run_from(const Scene& scene, std::string_view bytes) {
    run_bytes::Reader r(bytes);
    if (r.text() != run_bytes::head) run_bytes::Reader::refuse();
    PlannedScene now = planned(scene);
    return run_bytes::take_run(r, std::move(now.scene), std::move(now.plan));
}

}  // namespace rbdyn::inline RBDYN_FORM
