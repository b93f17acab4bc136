// A run as bytes beside its scene: what was computed; the plan and the equations are made anew from the scene.
//
// Numbers are written as this machine holds them. Equations of modes are found again by the choices they were recorded
// for, so bytes are read by the version of the library that wrote them. A checksum over them and over the text of the
// scene tells what was changed or cut short; what is read is checked all the same, so that no bytes do harm.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/closed_form/closed_form.hpp"
#include "rbdyn/event/course.hpp"
#include "rbdyn/event/event.hpp"
#include "rbdyn/event/halt.hpp"
#include "rbdyn/event/record.hpp"
#include "rbdyn/model/hybrid.hpp"
#include "rbdyn/model/recorded_model.hpp"
#include "rbdyn/model/scene_model.hpp"
#include "rbdyn/own_motion.hpp"
#include "rbdyn/plan/plan.hpp"
#include "rbdyn/scene/scene.hpp"
#include "rbdyn/trajectory/run_data.hpp"

namespace rbdyn::inline RBDYN_FORM {

namespace run_bytes {

inline constexpr std::string_view head = "rbdyn run 5", state_head = "rbdyn state run 4";

/// CRC-32 (ISO 3309), as zlib has it.
[[gnu::cold]] std::uint32_t checksum(std::string_view bytes);

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
    void put(const std::vector<bool>& values);
    template <class T>
    void put(const std::vector<T>& values) {
        put(values.size());
        for (const T& value : values) put(value);
    }
};

/// And read in the same order. Throws InvalidInput where there are too few, or what they say cannot be.
class Reader {
public:
    explicit Reader(std::string_view bytes) : bytes_(bytes) {}

    template <class T>
    requires std::is_trivially_copyable_v<T> T take() {
        if constexpr (std::is_same_v<T, bool>) {
            const auto byte = take<unsigned char>();
            require(byte <= 1, "a flag is neither true nor false");
            return byte == 1;
        } else {
            T value;
            std::memcpy(&value, some(sizeof(T)).data(), sizeof(T));
            return value;
        }
    }
    template <class T>
    void take(T& value) {
        value = take<T>();
    }
    /// A word of an enumeration from 0 to `last`.
    template <class T>
    T word(T last) {
        using Number = std::underlying_type_t<T>;
        const auto number = take<Number>();
        require(number >= 0 && number <= static_cast<Number>(last), "a word is none of its list");
        return static_cast<T>(number);
    }
    /// A whole number within limits.
    template <class T>
    T whole(T lowest, T highest) {
        const T number = take<T>();
        require(number >= lowest && number <= highest, "a number is out of range");
        return number;
    }
    /// A count of things that take so many bytes each.
    std::size_t count(std::size_t each) {
        const auto number = take<std::size_t>();
        require(number <= bytes_.size() / each, "they end too soon");
        return number;
    }
    std::string text() { return std::string(some(take<std::size_t>())); }
    template <class T>
    std::vector<T> list() {
        std::vector<T> values(count(sizeof(T)));
        for (T& value : values) value = take<T>();
        return values;
    }
    std::vector<bool> flags() {
        std::vector<bool> values(count(1));
        for (std::size_t i = 0; i < values.size(); ++i) values[i] = take<bool>();
        return values;
    }
    std::string_view rest() const { return bytes_; }
    static void require(bool condition, std::string_view otherwise) {
        if (!condition) refuse(otherwise);
    }
    [[noreturn, gnu::cold]] static void refuse(std::string_view why);

private:
    std::string_view some(std::size_t count);
    std::string_view bytes_;
};

/// What a run is of: the limits of what its bytes may say.
struct Limits {
    const RecordedModel* model = nullptr;  // none: one of the user's own, made of a functor
    std::shared_ptr<const ClosedForm> closed = nullptr;
    int bodies = 0, contacts = 0;
};

void put(Writer& w, const Statistics& s);
Statistics take_statistics(Reader& r);

void put(Writer& w, const Event& e);
Event take_event(Reader& r, const Limits& limits);

/// A choice that equations were recorded for.
struct Choice {
    std::uint64_t id;
    long choice;
};

void put(Writer& w, const Mode& mode);
/// A mode that a motion is in at a time, at a state. No model: one that was put without its equations.
Mode take_mode(Reader& r, const RecordedModel* model, double t, std::span<const double> x);

/// Where it has come to; with `model` that of a scene.
void put(Writer& w, const Halt& halt);
Halt take_halt(Reader& r, const SceneModel& model);
void put(Writer& w, const std::optional<simulating::Course>& course);
std::optional<simulating::Course> take_course(Reader& r, const SceneModel& model);

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
Record take_record(Reader& r, const Limits& limits);

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

void put(Writer& w, const RunData& data);
RunData take_run(Reader& r, Scene scene, Plan plan);

/// Puts a head and a checksum before bytes, and reads behind them: those of what a text tells from others.
std::string sealed(std::string_view title, std::string_view text, std::string bytes);
Reader opened(std::string_view title, std::string_view text, std::string_view bytes);

}  // namespace run_bytes

/// What was computed of a run of a model of the user's own: what it says of its motion, not the model.
[[gnu::cold]] std::string bytes_of(const StateRun& run);
[[gnu::cold]] StateRun state_run_from(std::string_view bytes);

/// What was computed of a run.
[[gnu::cold]] std::string bytes_of(const RunData& run);
/// The run that bytes were written for, of its scene. Throws InvalidInput if they are of no run of it.
[[gnu::cold]] RunData run_from(const Scene& scene, std::string_view bytes);

}  // namespace rbdyn::inline RBDYN_FORM
