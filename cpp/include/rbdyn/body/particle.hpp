// A point with mass.
#pragma once

#include "rbdyn/basics/error.hpp"

namespace rbdyn {

/// A material point. mass [kg], positive.
struct Particle {
    double mass = 0.0;

    bool operator==(const Particle&) const = default;

    void validate() const {
        require(std::isfinite(mass) && mass > 0.0, "Particle", "mass", mass,
                "a mass is positive and finite; give it in kg");
    }
};

}  // namespace rbdyn
