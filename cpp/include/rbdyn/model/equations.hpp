// Equations of smooth motion in one structural mode: what an engine integrates and what guards watch over it.
#pragma once

#include <string>
#include <vector>

#include "rbdyn/expression/program.hpp"

namespace rbdyn {

enum class EventKind {
    watch,
    reverse,
    stick,
    slip,
    normal_zero,
    rail_end,
    detach,
    land,
    impact,
    rest,
    accumulation,
    switching
};

enum class Direction { either, rising, falling };

/// What a guard stands for.
enum class GuardRole {
    mode,   // smooth motion is valid while sign * value >= 0; leaving it asks the model for the next mode
    stop,   // the run ends where the value falls through zero
    record  // a watched function: noted, nothing changes
};

/// A scalar function whose zeros are events.
struct Guard {
    EventKind kind = EventKind::watch;
    GuardRole role = GuardRole::mode;
    int subject = -1;         // body (or watch) it belongs to, by order of addition
    int output = -1;          // index among the program's outputs, those of its switches counted on
    int sign_parameter = -1;  // parameter whose sign multiplies the value; -1: none
    Direction direction = Direction::falling;
    std::string name;
};

/// State variables that share a scale, [first, first + count).
struct VariableGroup {
    int first, count;
    bool is_position;  // measured by the extent of its motion; else by its largest magnitude
};

/// x' = f(t, x; p) with its guards, as one program: outputs 0 .. n-1 are x', the rest guards.
struct Equations {
    Program program;
    std::vector<Guard> guards;
    std::vector<VariableGroup> groups;
    std::vector<int> start_flags;  // parameters that hold for the first step after start() only, then are zero

    int variables() const { return program.inputs(); }
    /// Whether a guard is a state variable itself.
    bool is_variable(const Guard& guard) const { return program.output(guard.output) < program.inputs(); }
};

}  // namespace rbdyn
