// A run as bytes beside its scene: what was computed; the plan and the equations are made anew from the scene.
//
// Numbers are written as this machine holds them. Equations of modes are found again by the choices they were recorded
// for, so bytes are read by the version of the library that wrote them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/closed_form/closed_form.hpp"
#include "rbdyn/event/event.hpp"
#include "rbdyn/event/record.hpp"
#include "rbdyn/model/hybrid.hpp"
#include "rbdyn/model/scene_model.hpp"
#include "rbdyn/own_motion.hpp"
#include "rbdyn/plan/plan.hpp"
#include "rbdyn/scene/scene.hpp"
#include "rbdyn/trajectory/run_data.hpp"

namespace rbdyn::inline RBDYN_FORM {

namespace run_bytes {

inline constexpr std::string_view head = "rbdyn run 2", state_head = "rbdyn state run 2";

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
    void put(std::string_view text);
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
    [[noreturn]] static void refuse();

private:
    std::string_view some(std::size_t count);
    std::string_view bytes_;
};

void put(Writer& w, const Statistics& s);
Statistics take_statistics(Reader& r);

void put(Writer& w, const Event& e);
Event take_event(Reader& r);

/// A choice that equations were recorded for.
struct Choice {
    std::uint64_t id;
    long choice;
};

void put(Writer& w, const Mode& mode);
/// A mode that a motion is in at a time, at a state. No model: one that was put without its equations.
Mode take_mode(Reader& r, const SceneModel* model, double t, std::span<const double> x);

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
void put(Writer& w, const Record& record);
Record take_record(Reader& r, const SceneModel* model, const std::shared_ptr<const ClosedForm>& closed);

void put(Writer& w, const RunData& data);
RunData take_run(Reader& r, Scene scene, Plan plan);

}  // namespace run_bytes

/// What was computed of a run of a model of the user's own: what it says of its motion, not the model.
[[gnu::cold]] std::string bytes_of(const StateRun& run);
[[gnu::cold]] StateRun state_run_from(std::string_view bytes);

/// What was computed of a run.
[[gnu::cold]] std::string bytes_of(const RunData& run);
/// The run that bytes were written for, of its scene. Throws InvalidInput if they are of no run of it.
[[gnu::cold]] RunData run_from(const Scene& scene, std::string_view bytes);

}  // namespace rbdyn::inline RBDYN_FORM
