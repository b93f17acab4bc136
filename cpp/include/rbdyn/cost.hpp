// cost(): what accuracy costs in time, for the user's own scene.
#pragma once

#include <cstdint>
#include <ostream>
#include <string>
#include <vector>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/event/keep.hpp"
#include "rbdyn/scene/scene.hpp"

namespace rbdyn::inline RBDYN_FORM {

/// One run of the table.
struct CostRow {
    std::string engine;
    double tolerance = 0.0;  // local, as given to the engine
    double error = 0.0;      // global, measured against the most accurate run
    double seconds = 0.0;    // integration alone, median of the repeats
    std::int64_t steps = 0, right_hand_sides = 0;
};

/// The table: engines over tolerances.
struct Price {
    std::vector<CostRow> rows;

    /// The quickest row that reaches an error; throws InvalidInput if none does.
    const CostRow& cheapest(double error) const;
};

struct CostOptions {
    double until = 0.0;
    double start = 0.0;
    std::vector<double> errors = {1e-3, 1e-6, 1e-9,
                                  1e-12};   // every engine is tightened until it reaches each, or its floor
    std::vector<std::string> engines = {};  // empty: all that can do the scene
    double budget = 10.0;                   // s to spend, about
    Monitor monitor = {};
};

/// Prices a scene. Throws what simulate() throws.
Price cost(const Scene& scene, const CostOptions& options);

std::ostream& operator<<(std::ostream& out, const Price& price);

}  // namespace rbdyn::inline RBDYN_FORM
