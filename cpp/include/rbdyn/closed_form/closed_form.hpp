// Motion known in closed form: the state of a whole scene at any time, at the same cost.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/instant.hpp"
#include "rbdyn/rotation/euler_turns.hpp"

namespace rbdyn::inline RBDYN_FORM {

class ClosedForm {
public:
    virtual ~ClosedForm() = default;

    /// The state, in the coordinates of the scene's model, at a time since the start [s].
    virtual void state(Instant since, std::span<double> x) const = 0;

    /// Estimate of the error at a time since the start, relative to the motion's scales, which are those for an error
    /// wanted.
    virtual double error(double since, double wanted) const = 0;

    /// The shortest time in which the motion changes as a whole [s]; infinite where nobody has to know.
    virtual double pace() const;

    /// How the attitude of a body comes back, by order of addition; none if it does not, or nobody knows.
    virtual std::optional<Recurrence> recurrence(int /*body*/) const;

    /// The same motion begun at another time than 0 [s]; none if that changes nothing but the time.
    virtual std::shared_ptr<const ClosedForm> begun(double time) const;

    /// What it is, in words.
    virtual std::string name() const = 0;
};

/// A form, if there is one, of a motion that begins at a time [s].
std::shared_ptr<const ClosedForm> begun(const std::shared_ptr<const ClosedForm>& form, double time);

}  // namespace rbdyn::inline RBDYN_FORM
