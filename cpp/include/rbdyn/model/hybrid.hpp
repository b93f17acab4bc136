// Motion that is smooth except at events: the interface between the laws of a scene and the driver that runs them.
#pragma once

#include <limits>
#include <span>
#include <string>
#include <vector>

#include "rbdyn/basics/direction.hpp"
#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/model/equations.hpp"
#include "rbdyn/model/size.hpp"
#include "rbdyn/series/piece.hpp"

namespace rbdyn::inline RBDYN_FORM {

struct Event;
struct Observed;

/// What a body does in a mode besides slipping one way (+1, -1).
inline constexpr signed char sticks = 0, flies = 2;

/// A mode of smooth motion, a value: the state of every friction element, and the numbers its equations take.
struct Mode {
    std::vector<signed char> slip;   // one a body: sticks, +1 or -1 the sign of its slip (or no friction), flies
    std::vector<double> parameters;  // of the program of `equations`
    const Equations* equations = nullptr;
    bool still = false;               // nothing can move or happen in this mode
    int jumps = 0;                    // how often the state has jumped so far
    std::vector<double> memory = {};  // of contacts: when they struck, how they slide (mechanics/contact_state.hpp)
    std::string impossible = {};      // why no motion satisfies the laws from here on; empty if one does
};

/// Something that happened at an event.
struct Happening {
    EventKind kind;
    int subject;
    Direction direction;
    std::string name;
    double impulse = 0.0;            // N s
    int contact = -1;                // it is of, by order of addition; -1: none
    Vector3 push = Vector3::Zero();  // of a contact, the impulse on its first side [N s]
    double later = 0.0;              // s: how much later than the instant it was found at it happens
    std::string note = {};           // what else is to be said of it
    double unsure = 0.0;             // what its time is short of, relative, that no two runs differ by
};

/// What a slope is of.
struct Slope {
    bool is_known = false;  // it is finite
    int positions = 0;      // among the variables, the first ones: those that bend as others slope
    double pace = std::numeric_limits<double>::infinity();  // s, in which attitudes turn by about a radian
};

/// The laws of a scene between events and at them. Immutable; shared by the runs made with it.
class HybridModel {
public:
    virtual ~HybridModel() = default;

    virtual int variables() const = 0;

    /// Whether it has contacts, which are held after each step.
    virtual bool touches() const { return false; }

    /// What is known of a mode before any law has been asked: the places of bodies, not their forces.
    virtual Mode undecided() const;

    /// What the state its motion starts in is short of 32 digits; empty if nothing.
    virtual std::vector<double> start_rest() const;

    /// What follows the way a motion has gone and is no function of its state (turns of angles): as it begins. Empty if
    /// there is nothing.
    virtual std::vector<double> winding(double /*t*/, std::span<const double> /*x*/) const;
    /// Takes it along a piece of the motion, in units of the piece.
    virtual void wind(const Piece& /*piece*/, double /*length*/, std::vector<double>& /*winding*/) const;

    /// The mode a motion begins in; nothing fires. May set variables exactly (a speed of a rail that holds a bead).
    virtual Mode begin(double t, std::span<double> x) const = 0;

    /// The mode after the guards `fired` (indices into the equations' guards) fell through zero together at t.
    virtual Mode next(const Mode& mode, std::span<const int> fired, double t, std::span<double> x,
                      std::vector<Happening>& happenings) const = 0;

    /// The same, for one that knows what to do with digits beyond doubles: `rest` is what x is short of, and what it
    /// sets is short of nothing. `largest`: the largest size of each variable so far, if that is known, whose rounding
    /// is in x for good.
    virtual Mode next_with_rest(const Mode& mode, std::span<const int> fired, double t, std::span<double> x,
                                std::span<double> rest, std::span<const double> largest,
                                std::vector<Happening>& happenings) const;

    /// What the accuracy of a motion is judged by, in a fixed order: by default the state variables, group by group.
    virtual void observe(const Mode& mode, double /*t*/, std::span<const double> x,
                         std::vector<Observed>& observed) const;

    /// Whether a body whose slip touches zero without passing would be held there for a while if it came to rest, as it
    /// is where its static coefficient of friction is above the dynamic one; else nothing depends on that.
    virtual bool holds_what_touches(int /*subject*/) const;

    /// Whether an impulse of one contact changes how fast another one opens or slides.
    virtual bool feel_each_other(int /*contact*/, int /*other*/, const Mode& /*mode*/, double /*t*/,
                                 std::span<const double> /*x*/) const {
        return false;
    }

    /// Whether bounces of contacts that end a mode, or begin with it, are followed by digits beyond doubles: not where
    /// they are summed to first order.
    virtual bool follows_bounces(const Mode& /*mode*/) const { return true; }
    /// Whether a contact, and all others of what it joins, throw back what strikes and turn nothing: where one does not
    /// throw back, or corners strike by turns, what bounces comes to rest by the rounding of its gap.
    virtual bool bounces_among_bouncing(int /*contact*/) const { return true; }

    /// Of the constraint that is nearest to depending on the others, how near: the sine of the angle between them, so
    /// to speak. What a state is off by is over that in forces. 1: no constraints lose rank.
    virtual double independence(const Mode& /*mode*/, double /*t*/, std::span<const double> /*x*/) const { return 1.0; }

    /// The value of a guard that is none of the program's outputs.
    virtual double guard_value(const Guard& /*guard*/, const Mode& /*mode*/, double /*t*/,
                               std::span<const double> /*x*/) const;

    /// Why no motion satisfies the laws beyond a state where the equations end; empty if that is not it.
    virtual std::string impossible(const Mode& mode, double t, std::span<const double> x) const;

    /// What is not finite in a state, in words; empty if everything is.
    virtual std::string not_finite(const Mode& /*mode*/, double /*t*/, std::span<const double> /*x*/) const;

    /// What the rate of a variable is called in messages.
    virtual std::string rate_name(int variable) const;

    /// What has grown beyond all measure from one state to another, in words; empty if nothing has.
    virtual std::string grown(const Mode& /*before*/, double /*t0*/, std::span<const double> /*x0*/,
                              const Mode& /*mode*/, double /*t*/, std::span<const double> /*x*/) const;

    /// x' where derivatives of the equations are not finite but the motion is, and x'' of the positions. By default
    /// what the equations of the mode say, and no positions.
    virtual Slope slope(const Mode& mode, double t, std::span<const double> x, std::span<double> slope,
                        std::span<double> bend) const;
};

}  // namespace rbdyn::inline RBDYN_FORM
