// Definitions of rbdyn/body/particle.hpp.
#pragma once

#include "rbdyn/body/particle.hpp"

#include <cmath>

#include "rbdyn/basics/error.hpp"
#include "rbdyn/expression/given.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE Particle Particle::frozen() const {
    const Particle result{mass.frozen()};
    result.validate();
    return result;
}

RBDYN_INLINE void Particle::validate() const {
    require(std::isfinite(mass.now()) && mass.now() > 0.0, "Particle", "mass", mass.now(),
            "a mass is positive and finite; give it in kg");
}

}  // namespace rbdyn::inline RBDYN_FORM
