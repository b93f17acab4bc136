// A state of rest of a scene (eq. 7.16).
#pragma once

#include <optional>
#include <ostream>
#include <utility>
#include <vector>

#include "rbdyn/basics/error.hpp"

namespace rbdyn {

/// Where a scene stays at rest, and what it does nearby.
struct Equilibrium {
    std::vector<double> coordinates;  // in order of addition: u of a bead; x, y, z of a free particle
    bool stable = false;              // U has a strict maximum there, or friction holds it; not where it is indifferent
    /// Parameters of one bead between which all is equilibrium: on a rough rail, or where no force acts along it.
    std::optional<std::pair<double, double>> interval = std::nullopt;
    std::vector<double> periods = {};  // of small oscillations [s], the longest first

    bool operator==(const Equilibrium&) const = default;
};

inline std::ostream& operator<<(std::ostream& out, const Equilibrium& e) {
    out << "Equilibrium at ";
    for (std::size_t k = 0; k < e.coordinates.size(); ++k) out << (k == 0 ? "" : ", ") << text(e.coordinates[k]);
    out << (e.stable ? ", stable" : ", not stable");
    if (e.interval) out << ", from " << text(e.interval->first) << " to " << text(e.interval->second);
    for (std::size_t k = 0; k < e.periods.size(); ++k) out << (k == 0 ? ", periods " : ", ") << text(e.periods[k]);
    if (!e.periods.empty()) out << " s";
    return out << '\n';
}

}  // namespace rbdyn
