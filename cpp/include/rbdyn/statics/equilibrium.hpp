// A state of rest of a scene (eqs. 7.16, 7.60).
#pragma once

#include <optional>
#include <ostream>
#include <utility>
#include <vector>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/vector.hpp"

namespace rbdyn::inline RBDYN_FORM {

/// Where a scene stays at rest, and what it does nearby.
struct Equilibrium {
    /// In order of addition: the parameter of a bead; x, y, z of a free particle; the angle of a hinge, in (-pi, pi] if
    /// it is all there is; the displacement of a slide; the attitude of a body on a ball joint, w, x, y, z; place and
    /// attitude of a free body, seven numbers; the coordinates of other joints; relative to the parent where there is
    /// one, as a scene starts.
    std::vector<double> coordinates;
    /// U has a strict maximum there, or friction holds it; not where it is indifferent, turns about `axes` left aside,
    /// nor where that is not decided.
    bool stable = false;
    /// Coordinates of one bead, hinge or slide between which all is equilibrium: on a rough rail, or where no force
    /// acts along it.
    std::optional<std::pair<double, double>> interval = std::nullopt;
    std::vector<double> periods = {};  // of small oscillations [s], the longest first
    /// Directions in the world of axes about which one body alone may be turned, and all stay at rest: a heavy body on
    /// a ball joint about the vertical. The coordinates are those of the one that the least turn leads to.
    std::vector<Vector3> axes = {};
    /// Whether `stable` is known: not where what forces do nearby is within their rounding, or is not proven.
    bool decided = true;

    bool operator==(const Equilibrium&) const = default;
};

std::ostream& operator<<(std::ostream& out, const Equilibrium& e);

}  // namespace rbdyn::inline RBDYN_FORM
