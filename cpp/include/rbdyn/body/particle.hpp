// A point with mass.
#pragma once

#include "rbdyn/basics/error.hpp"
#include "rbdyn/expression/given.hpp"

namespace rbdyn {

/// A material point. mass [kg], positive.
struct Particle {
    Given mass = 0.0;

    bool operator==(const Particle&) const = default;
    /// With the numbers of the user's as they are now.
    Particle frozen() const {
        const Particle result{mass.frozen()};
        result.validate();
        return result;
    }

    void validate() const {
        require(std::isfinite(mass.now()) && mass.now() > 0.0, "Particle", "mass", mass.now(),
                "a mass is positive and finite; give it in kg");
    }
};

}  // namespace rbdyn
