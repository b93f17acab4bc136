// Motion that is smooth except at events: the interface between the laws of a scene and the driver that runs them.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "rbdyn/model/equations.hpp"

namespace rbdyn {

/// A mode of smooth motion, a value: the state of every friction element, and the numbers its equations take.
struct Mode {
    std::vector<signed char> slip;   // one a body: 0 sticks, +1 or -1 the sign of its slip (or no friction)
    std::vector<double> parameters;  // of the program of `equations`
    const Equations* equations = nullptr;
    bool still = false;  // nothing can move or happen in this mode
};

/// Something that happened at an event.
struct Happening {
    EventKind kind;
    int subject;
    Direction direction;
    std::string name;
};

/// The laws of a scene between events and at them. Immutable; shared by the runs made with it.
class HybridModel {
public:
    virtual ~HybridModel() = default;

    virtual int variables() const = 0;

    /// The mode a motion begins in; nothing fires. May set variables exactly (a speed of a rail that holds a bead).
    virtual Mode begin(double t, std::span<double> x) const = 0;

    /// The mode after the guards `fired` (indices into the equations' guards) fell through zero together at t.
    virtual Mode next(const Mode& mode, std::span<const int> fired, double t, std::span<double> x,
                      std::vector<Happening>& happenings) const = 0;

    /// x' where the equations are not finite but the motion is; false if there is none. Positions come first in x.
    virtual bool slope(const Mode&, double /*t*/, std::span<const double> /*x*/, std::span<double> /*slope*/) const {
        return false;
    }
};

}  // namespace rbdyn
