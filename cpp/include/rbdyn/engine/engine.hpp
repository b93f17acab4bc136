// What every engine offers: steps of smooth motion as polynomial pieces, and series of the guards on them.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/instant.hpp"
#include "rbdyn/engine/work.hpp"
#include "rbdyn/model/equations.hpp"
#include "rbdyn/series/piece.hpp"

namespace rbdyn::inline RBDYN_FORM {

enum class StepStatus {
    ok,
    not_finite,  // the right-hand side is not finite at the start of the step
    stalled      // the step became too small to advance time
};

/// A method of integration. One engine serves one run; modes come and go through start().
class Engine {
public:
    virtual ~Engine() = default;

    virtual std::string name() const = 0;

    /// Begins smooth motion at time t and state x. The equations outlive the engine's use of them.
    virtual void start(const Equations& equations, std::span<const double> parameters, Instant t,
                       std::span<const double> x) = 0;

    /// What the state just started from is short of; for engines that sum more digits than they show.
    virtual void carry(std::span<const double> /*rest*/);

    /// One step, not past `limit`; its result is piece(). The next step goes on from its end.
    virtual StepStatus step(double limit) = 0;

    const Piece& piece() const { return piece_; }
    /// The length, in units, that the last step would have had without a limit; infinite if it holds at any.
    virtual double natural_length() const;

    /// The state at tau on the current piece, as exactly as the engine knows it.
    virtual void state(double tau, std::span<double> x) const;

    /// What x, the state at tau on the current piece in doubles, is short of; zeros where the engine knows no more.
    virtual void rest(double /*tau*/, std::span<const double> /*x*/, std::span<double> low) const;

    /// The state that the next step goes on from, after a step, and what it is short of.
    virtual void standing(std::span<double> x, std::span<double> low) const;

    /// What it keeps from step to step beside that, for one that goes on from there; empty if it begins anew.
    virtual std::vector<double> memory() const;
    /// Takes it over, after start() and carry(). What is of another engine's is left alone.
    virtual void recall(std::span<const double> /*memory*/);

    /// The largest size of each variable since the run began; empty where that is not known.
    virtual std::vector<double> largest() const { return {}; }

    /// Whether that is more exact than the piece, so that a root of a variable on the piece is worth improving.
    virtual bool refines() const;

    /// Coefficients 0 .. guard_order() of a guard on the current piece, in the piece's unit of time, unsigned.
    virtual const double* guard(int index) = 0;
    virtual int guard_order() const = 0;
    /// Sizes of the terms that these are made of: their rounding is epsilon times that, or a little more.
    virtual void guard_sizes(int index, double* sizes) = 0;
    /// Whether these say nothing of the guard all along the piece: it is not finite where that begins, or has a
    /// singularity too near. Its values do.
    virtual bool is_rough(int /*guard*/) const;
    /// Whether a guard is known to keep its sign all along the piece, so that nobody need ask for its coefficients.
    virtual bool is_far(int /*guard*/) const;
    /// Whether they are those of polynomials through values, and not of series that are cut off.
    virtual bool fits_guards() const;

    const Work& work() const { return work_; }

    /// Where another engine took over, of one that gives way.
    virtual std::vector<EngineChange> changes() const;

protected:
    // log2 of how much more of a guard than of the state may be cut off: an error there moves one event and does not
    // grow
    static constexpr double guard_slack = 5.0;

    /// What holds at the start of a mode alone holds no longer. Returns whether any parameter changed.
    static bool drop_start_flags(const Equations& equations, std::vector<double>& parameters);

    Piece piece_;
    mutable Work work_;  // a state between the ends of a step may cost some
};

}  // namespace rbdyn::inline RBDYN_FORM
