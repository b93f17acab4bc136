// Variables of a linear motion that depend on each other, and on no others.
#pragma once

#include <limits>
#include <span>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/instant.hpp"

namespace rbdyn::inline RBDYN_FORM {

class LinearBlock {
public:
    virtual ~LinearBlock() = default;
    /// Its variables at a time since the start, at their places in the state.
    virtual void state(Instant since, std::span<double> x) const = 0;
    /// Adds estimates of their errors, without the rounding of the state itself.
    virtual void add_errors(double since, std::span<double> errors) const = 0;
    /// The rate of what changes fastest in it [1/s].
    virtual double fastest() const = 0;

    /// Between which numbers something is at all times from the start on.
    struct Range {
        double middle = 0.0, radius = 0.0;
    };
    /// Of its part of a sum of variables, each times a weight (at its place in the state); by default unlimited.
    virtual Range range(std::span<const double> /*weights*/) const {
        return {0.0, std::numeric_limits<double>::infinity()};
    }
};

}  // namespace rbdyn::inline RBDYN_FORM
