// Where a motion has come to, with all that it takes to go on as if it had not been interrupted.
#pragma once

#include <optional>
#include <vector>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/instant.hpp"
#include "rbdyn/model/hybrid.hpp"

namespace rbdyn::inline RBDYN_FORM {

/// What is known of a watched function, kept through the modes.
struct WatchedSide {
    int side = 0;                               // it is on; 0: not known yet
    int reached = 0;                            // the side it would go to from the zero where the mode began
    int product = 0;                            // of a first factor: the last side of the product that is known
    double known_from = 0.0;                    // where on the piece its side becomes known; 0: it is
    std::optional<double> zero = std::nullopt;  // its value where it fired last
    // it has passed zero where a mode ended, and been no farther from there since than rounding of the motion then;
    // 0: that is over
    double within = 0.0;
};

struct Halt {
    Instant at;
    std::vector<double> x, low;  // the state, and what it is short of
    Mode mode;
    bool fresh = true;            // the mode begins here
    bool begins = false;          // and with it the motion
    int crowded = 0, passes = 0;  // events of this instant; points passed in a row where the equations are not finite
    Instant passed_at = {};       // the first of these
    std::vector<int> fired = {};  // guards that stopped the run, among others: what these change is still to be done
    std::vector<bool> handled = {};         // guards whose zero began the mode
    std::vector<WatchedSide> watched = {};  // by watched function
    std::vector<int> sides = {};            // by guard, as the next two
    std::vector<double> ends = {};          // values of watched guards at the end of the last piece
    std::vector<bool> passed = {};          // those that passed zero just here, whatever rounding makes of them
    std::vector<double> engine = {};        // what it keeps from step to step
    std::vector<double> winding = {};       // HybridModel::winding
};

}  // namespace rbdyn::inline RBDYN_FORM
