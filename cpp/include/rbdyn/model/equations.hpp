// Equations of smooth motion in one structural mode: what an engine integrates and what guards watch over it.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "rbdyn/basics/direction.hpp"
#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/form.hpp"
#include "rbdyn/expression/numbers.hpp"
#include "rbdyn/expression/program.hpp"
#include "rbdyn/expression/recorder.hpp"
#include "rbdyn/series/piece.hpp"

namespace rbdyn::inline RBDYN_FORM {

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
    switching,
    singular
};

/// Finds an event that is no zero of a function of the state: where a path meets a curve, say.
class Locator {
public:
    virtual ~Locator() = default;
    /// The first place on a piece, in its units of time; `fresh`: the piece begins where the mode began.
    virtual std::optional<double> first(const Piece& piece, bool fresh) const = 0;
};

/// What a guard stands for.
enum class GuardRole {
    mode,   // smooth motion is valid while sign * value >= 0; leaving it asks the model for the next mode
    stop,   // the run ends where the value falls through zero
    record  // noted, nothing changes
};

/// A scalar function whose zeros are events. One that is watched may have either sign; then only zeros passed in its
/// direction count, and its role says what follows.
struct Guard {
    EventKind kind = EventKind::watch;
    GuardRole role = GuardRole::mode;
    int subject = -1;         // body it belongs to, by order of addition; -1: none
    int contact = -1;         // contact it belongs to, by order of addition; -1: none
    int joint = -1;           // joint with friction it belongs to, by order of addition; -1: none
    int output = -1;          // among the program's outputs, those of its switches counted on; -1: none of them
    int sign_parameter = -1;  // parameter whose sign multiplies the value; -1: none
    Direction direction = Direction::falling;
    std::string name = {};
    int watch = -1;             // the watched function it is, or a factor of, by order of addition
    int part = -1;              // by order of writing, among all that is watched
    bool is_itself = true;      // its values are those of the watched function
    int branch = -1, step = 0;  // the branch whose choice moves by a step where it fires
    int sliding = -1;           // the sliding surface that is left where it fires, to side step
    std::shared_ptr<const Locator> locator = nullptr;  // finds it, if there is no output
    bool renews = false;                               // where it fires its parameters change, and its value with them
    double least = 0.0;  // below 0: noted where it sinks to that, all but, and rises again; no step is shorter for it

    bool is_watched() const { return watch >= 0 || role == GuardRole::record; }
};

/// What is alike in all bodies of a part of a scene: none of them is known to more digits of its own than the rounding
/// of the whole leaves.
enum class Alike : signed char { nothing = -1, place, velocity, turning, force, torque };

/// State variables that share a scale, [first, first + count).
struct VariableGroup {
    int first, count;
    bool is_position;     // measured by the extent of its motion; else by its largest magnitude
    double steady = 0.0;  // the largest magnitude of what belongs to it and stays as it starts
    Alike alike = Alike::nothing;
    double measure = 1.0;  // what one of it is where `alike` is compared: m, m/s, rad/s
    // of a joint among bodies that constraints join: what is alike there has one scale for steps of low order
    enum class Tied : signed char { none, turns, slides } tied = Tied::none;

    bool operator==(const VariableGroup&) const = default;
};

/// The share of the scale of the whole that the scale of a part is at least, for an error wanted: a body that hardly
/// moves yet is known to that error of the error of the whole, or to rounding. `size`: of the numbers over that scale.
double least_share(double wanted, double size);

/// Holds what a motion conserves against the errors of its integration.
class Projection {
public:
    virtual ~Projection() = default;
    /// Moves the state x + low, low its compensation, to where its first integrals are what they were. `step`: the
    /// time since it was moved last [s]; `t`: the time it is at.
    virtual void apply(std::span<double> x, std::span<double> low, double step, double t) const = 0;
    /// How far the state x + low, at time t, is from there: in parts of what may pass for rounding, and of the size of
    /// what is held; zeros if nobody asks.
    struct Off {
        double rounding = 0.0, size = 0.0;
    };
    virtual Off off(std::span<const double> x, std::span<const double> low, double t) const;
    /// How many variables, the first, are positions: what rounding leaves of accelerations moves them like the square
    /// of the time, and the others in proportion to it. None where nobody asks how far it is off.
    virtual int positions() const;
    /// Moves a state of 32 digits to where constraints hold, with as many.
    virtual void refine(std::vector<DoubleDouble>& x, double t) const;
    /// The same beside a place where constraints lose rank, `there` at time `then`, found roughly: to where they hold
    /// but for what the rounding of their numbers leaves open at that place. False where nothing is.
    virtual bool refine_beside(std::vector<DoubleDouble>& x, double t, const std::vector<DoubleDouble>& there,
                               double then) const;
    /// Whether it adds what rounded constants of the equations leave out.
    virtual bool makes_up_for_rounding() const;
};

/// x' = f(t, x; p) with its guards, as one program: outputs 0 .. n-1 are x', the rest guards.
struct Equations {
    Program program;
    std::vector<Guard> guards;
    std::vector<VariableGroup> groups;
    std::vector<Branch> branches;  // the choices between formulas that were made for them
    std::vector<int> start_flags;  // parameters that hold for the first step after start() only, then are zero
    std::vector<std::uint64_t> sliding = {};  // the surfaces the motion slides along, by id
    int drives = -1;  // where they change in time: the first of an output a body, the speed of its rail's surface; of
                      // a tree of two outputs a driven joint, its coordinate and the rate of that, and behind them of
                      // 24 a rail that moves, those of its placement
    int pulls = -1;   // where any bead sticks: the first of an output a body, the tangential reaction rest needs,
                      // |r'| Phi_t; of a tree of an output a rough rail whose drive varies, that drive
    // where a side, a sign or a weight belongs to the mode: the rates and what acts in it, for reports (acting.hpp)
    std::shared_ptr<const Program> acting = nullptr;
    std::shared_ptr<const Numbers> numbers = nullptr;  // of the user's that they hold for; none if there are none
    std::vector<std::pair<std::int32_t, int>> number_parameters = {};  // of each its node, and the parameter it is

    /// The projection for motion from a state x + low; empty if nothing is held.
    std::function<std::unique_ptr<const Projection>(std::span<const double> x, std::span<const double> low)>
        projection = {};

    int variables() const { return program.inputs(); }
    /// The switch whose argument a guard is; none for guards of other kinds.
    const Switch* switch_of(const Guard& guard) const;
    /// The surface of the switch or of the choice of two that a guard stands for, by id; none for others.
    std::optional<std::uint64_t> surface_of(const Guard& guard) const;
    /// Whether a guard is a state variable itself.
    bool is_variable(const Guard& guard) const;
};

}  // namespace rbdyn::inline RBDYN_FORM
