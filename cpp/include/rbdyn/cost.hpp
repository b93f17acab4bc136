// cost(): what accuracy costs in time, for the user's own scene.
//
// Every engine that can do the scene has its turn at each tolerance, from loose to tight, while the budget lasts.
// Errors are measured against the closed form where there is one, else against a Taylor series whose steps are refined
// in long double; where that has no time, or the scene no series, against the most accurate run of another engine than
// the row's. Bodies that nothing joins are priced apart, and their times add up.
#pragma once

#include <string>
#include <vector>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/event/keep.hpp"
#include "rbdyn/price.hpp"
#include "rbdyn/scene/scene.hpp"

namespace rbdyn::inline RBDYN_FORM {

class System;

struct CostOptions {
    double until = 0.0;                                      // s
    double start = 0.0;                                      // s
    std::vector<double> errors = {1e-3, 1e-6, 1e-9, 1e-12};  // an engine begins at the loosest, and is tightened
                                                             // until it reaches the tightest, or its floor
    std::vector<std::string> engines = {};                   // empty: all
    double budget = 5.0;                                     // s to spend, by the clock, the reference included
    Monitor monitor = {};  // called now and then with the time spent [s]; false ends the list there
};

/// Prices a scene. Throws InvalidInput for options that break a rule, and what simulate() throws of a scene that has no
/// motion up to `until`.
Price cost(const Scene& scene, const CostOptions& options);
/// Prices equations of one's own (system/system.hpp).
Price cost(const System& system, const CostOptions& options);

}  // namespace rbdyn::inline RBDYN_FORM
