// A point with mass.
#pragma once

#include "rbdyn/basics/form.hpp"
#include "rbdyn/expression/given.hpp"

namespace rbdyn::inline RBDYN_FORM {

/// A material point. mass [kg], positive.
struct Particle {
    Given mass = 0.0;

    bool operator==(const Particle&) const = default;
    /// With the numbers of the user's as they are now.
    Particle frozen() const;

    void validate() const;
};

}  // namespace rbdyn::inline RBDYN_FORM
