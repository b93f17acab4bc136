// A run as bytes beside its scene: what was computed; the plan and the equations are made anew from the scene.
//
// Numbers are written as this machine holds them. Equations of modes are found again by the choices they were recorded
// for, so bytes are read by the version of the library that wrote them.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "rbdyn/plan/kept_plan.hpp"
#include "rbdyn/simulate.hpp"
#include "rbdyn/trajectory/run_data.hpp"

namespace rbdyn {

namespace run_bytes {

inline constexpr std::string_view head = "rbdyn run 1", state_head = "rbdyn state run 1";

/// Bytes that are written one after the other.
class Writer {
public:
    std::string bytes;

    template <class T>
    requires std::is_trivially_copyable_v<T>
    void put(const T& value) {
        const auto* first = reinterpret_cast<const char*>(&value);
        bytes.append(first, sizeof(T));
    }
    void put(std::string_view text) {
        put(text.size());
        bytes.append(text);
    }
    template <class T>
    void put(const std::vector<T>& values) {
        put(values.size());
        for (const T& value : values) put(value);
    }
};

/// And read in the same order. Throws InvalidInput where there are too few.
class Reader {
public:
    explicit Reader(std::string_view bytes) : bytes_(bytes) {}

    template <class T>
    requires std::is_trivially_copyable_v<T> T take() {
        T value;
        std::memcpy(&value, some(sizeof(T)).data(), sizeof(T));
        return value;
    }
    template <class T>
    void take(T& value) {
        value = take<T>();
    }
    std::string text() { return std::string(some(take<std::size_t>())); }
    template <class T>
    std::vector<T> list() {
        const auto count = take<std::size_t>();
        if (count > bytes_.size()) refuse();
        std::vector<T> values(count);
        for (T& value : values) value = take<T>();
        return values;
    }
    [[noreturn]] static void refuse() {
        throw InvalidInput("Trajectory: its data are none of a run that this version of the library wrote");
    }

private:
    std::string_view some(std::size_t count) {
        if (count > bytes_.size()) refuse();
        const std::string_view first = bytes_.substr(0, count);
        bytes_.remove_prefix(count);
        return first;
    }
    std::string_view bytes_;
};

inline void put(Writer& w, const Statistics& s) {
    for (const double seconds : {s.seconds, s.integration_seconds}) w.put(seconds);
    for (const std::int64_t count : {s.steps, s.rejected, s.right_hand_sides, s.jacobians, s.guard_evaluations,
                                     s.events, s.python_calls, std::int64_t{s.runs}, std::int64_t{s.size.variables},
                                     std::int64_t{s.size.guards}, std::int64_t{s.size.instructions}})
        w.put(count);
    w.put(s.planned);
}
inline Statistics take_statistics(Reader& r) {
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

inline void put(Writer& w, const Event& e) {
    w.put(e.time);
    w.put(e.kind);
    w.put(e.subject);
    w.put(std::string_view(e.name));
    w.put(e.direction);
    w.put(e.impulse);
    w.put(e.instant);
}
inline Event take_event(Reader& r) {
    Event e;
    r.take(e.time);
    r.take(e.kind);
    r.take(e.subject);
    e.name = r.text();
    r.take(e.direction);
    r.take(e.impulse);
    r.take(e.instant);
    return e;
}

/// A choice that equations were recorded for.
struct Choice {
    std::uint64_t id;
    long choice;
};

inline void put(Writer& w, const Mode& mode) {
    w.put(mode.slip);
    w.put(mode.parameters);
    w.put(mode.still);
    w.put(mode.jumps);
    w.put(mode.equations != nullptr);
    if (mode.equations == nullptr) return;
    std::vector<Choice> choices;
    for (const Branch& b : mode.equations->branches) choices.push_back({b.id, b.choice});
    w.put(choices);
    w.put(std::vector<std::uint64_t>(mode.equations->sliding.begin(), mode.equations->sliding.end()));
}
/// A mode that a motion is in at a time, at a state. No model: without its equations.
inline Mode take_mode(Reader& r, const PointsModel* model, double t, std::span<const double> x) {
    Mode mode;
    mode.slip = r.list<signed char>();
    mode.parameters = r.list<double>();
    r.take(mode.still);
    r.take(mode.jumps);
    if (!r.take<bool>()) return mode;
    Decisions decided;
    for (const Choice& c : r.list<Choice>()) decided.forced[c.id] = c.choice;
    for (const std::uint64_t surface : r.list<std::uint64_t>()) decided.sliding.insert(surface);
    if (model != nullptr && !model->restore(mode, t, x, decided)) Reader::refuse();
    return mode;
}

/// What is kept of an entry, one by one: what lies between its fields in memory is nobody's.
template <class Entry, class Visit>
void each_field(Entry& e, const Visit& visit) {
    visit(e.start);
    visit(e.unit);
    visit(e.length);
    visit(e.order);
    visit(e.mode);
    visit(e.after_event);
}
inline void put(Writer& w, const Record& record) {
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
/// `has_equations`: of a model, whose modes are restored.
inline Record take_record(Reader& r, const PointsModel* model, const std::shared_ptr<const ClosedForm>& closed,
                          bool has_equations = true) {
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
        if (has_equations && model == nullptr) Reader::refuse();
        record.modes.push_back(take_mode(r, model, first != entries.end() ? first->start.hi : record.start, x));
    }
    for (auto left = r.take<std::size_t>(); left > 0; --left) record.events.push_back(take_event(r));
    return record;
}

inline void put(Writer& w, const RunData& data) {
    put(w, data.record);
    w.put(std::string_view(data.engine));
    w.put(data.error.has_value());
    w.put(data.error.value_or(0.0));
    w.put(data.certain_until);
    put(w, data.statistics);
    w.put(data.parts.size());
    for (const RunData& part : data.parts) put(w, part);
}
inline RunData take_run(Reader& r, Scene scene, Plan plan) {
    RunData data;
    data.scene = std::move(scene);
    data.plan = std::move(plan);
    data.model = data.plan.model;
    data.record = take_record(r, data.model.get(), data.plan.closed);
    data.events = Events(data.record.events);
    data.engine = r.text();
    const bool has_error = r.take<bool>();
    const auto error = r.take<double>();
    if (has_error) data.error = error;
    r.take(data.certain_until);
    data.statistics = take_statistics(r);
    const auto parts = r.take<std::size_t>();
    if (parts != data.plan.parts.size()) Reader::refuse();
    for (std::size_t i = 0; i < parts; ++i)
        data.parts.push_back(take_run(r, data.plan.apart->parts[i].scene, data.plan.parts[i]));
    return data;
}

}  // namespace run_bytes

/// What was computed of a run of a model of the user's own: what it says of its motion, not the model.
[[gnu::cold]] inline std::string bytes_of(const StateRun& run) {
    const simulating::Solution& solution = run.solution();
    run_bytes::Writer w;
    w.put(run_bytes::state_head);
    run_bytes::put(w, solution.record);
    w.put(std::string_view(run.engine()));
    w.put(solution.error.has_value());
    w.put(solution.error.value_or(0.0));
    w.put(solution.certain_until);
    return std::move(w.bytes);
}
[[gnu::cold]] inline StateRun state_run_from(std::string_view bytes) {
    run_bytes::Reader r(bytes);
    if (r.text() != run_bytes::state_head) run_bytes::Reader::refuse();
    simulating::Solution solution;
    solution.record = run_bytes::take_record(r, nullptr, nullptr, false);
    std::string engine = r.text();
    const bool has_error = r.take<bool>();
    const auto error = r.take<double>();
    if (has_error) solution.error = error;
    r.take(solution.certain_until);
    return StateRun(std::move(solution), std::move(engine));
}

/// What was computed of a run.
[[gnu::cold]] inline std::string bytes_of(const RunData& run) {
    run_bytes::Writer w;
    w.put(run_bytes::head);
    run_bytes::put(w, run);
    return std::move(w.bytes);
}
/// The run that bytes were written for, of its scene. Throws InvalidInput if they are of no run of it.
[[gnu::cold]] inline RunData run_from(const Scene& scene, std::string_view bytes) {
    run_bytes::Reader r(bytes);
    if (r.text() != run_bytes::head) run_bytes::Reader::refuse();
    PlannedScene now = planned(scene);
    return run_bytes::take_run(r, std::move(now.scene), std::move(now.plan));
}

}  // namespace rbdyn
