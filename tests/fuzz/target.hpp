// What is given bytes that nobody should give: each target reads an input as what it stands for, and uses what is
// taken.
//
// Any input is refused with a reason (rbdyn::Error) or does no harm. What else is thrown, what ends without a message,
// and what of the library contradicts itself is a find.
#pragma once

#include <array>
#include <stdexcept>
#include <string>
#include <string_view>

namespace rbdyn::fuzz {

/// What should not be, in words.
struct Find : std::logic_error {
    using std::logic_error::logic_error;
};

/// Throws Find unless so.
inline void require(bool condition, const std::string& otherwise) {
    if (!condition) throw Find(otherwise);
}

/// A scene's file, read, written and read again, planned and run.
void scene_file(std::string_view text);
/// A function as a file has it, applied, differentiated, written and read again.
void function(std::string_view text);
/// Operations of a function as they are pickled, used in the same ways.
void program(std::string_view bytes);
/// A run's bytes behind a checksum that is right: those of a run, changed; then asked and gone on with.
void run_file(std::string_view bytes);
/// The same of a run of a model of the user's own.
void state_run(std::string_view bytes);
/// Calls that build a scene, its plan and a short run.
void scene(std::string_view bytes);

struct Target {
    std::string_view name;
    void (*run)(std::string_view input);
    bool is_text;  // else its inputs stand in the corpus as hexadecimal digits
};

inline constexpr std::array<Target, 6> targets = {{{"scene_file", &scene_file, true},
                                                   {"function", &function, true},
                                                   {"program", &program, false},
                                                   {"run_file", &run_file, false},
                                                   {"state_run", &state_run, false},
                                                   {"scene", &scene, false}}};

/// An input given to a target: what it refuses is as it should be. Throws Find, and what else is thrown.
void give(const Target& target, std::string_view input);

}  // namespace rbdyn::fuzz
