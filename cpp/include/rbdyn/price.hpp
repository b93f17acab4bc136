// A price list: what each accuracy of a motion costs in time, engine by engine (cost.hpp makes it).
//
// Times are processor time, the least of several runs. Errors are measured, in the scales of the motion
// (trajectory/error_scales.hpp), against the reference that the list names.
#pragma once

#include <cstdint>
#include <limits>
#include <ostream>
#include <string>
#include <vector>

#include "rbdyn/basics/form.hpp"

namespace rbdyn::inline RBDYN_FORM {

/// One engine at one tolerance.
struct CostRow {
    std::string engine;
    double tolerance = 0.0;                                         // local, rtol of simulate(); 0 of a closed form
    double motion_error = std::numeric_limits<double>::infinity();  // global; beyond a missed event of positions alone
    double event_error = 0.0;                                       // of the times of events, up to a missed one
    int events = 0, events_expected = 0;
    bool has_all_events = true;                                 // the expected ones, in their order
    double seconds = std::numeric_limits<double>::quiet_NaN();  // of the integration alone
    double spread = std::numeric_limits<double>::quiet_NaN();   // median of the repeats over the least, less 1
    double total =
        std::numeric_limits<double>::quiet_NaN();  // s: simulate() with this error=, or the tightest asked for
    std::int64_t steps = 0, right_hand_sides = 0;
    double error = std::numeric_limits<double>::infinity();  // the larger of both errors
};

/// An engine that is missing from a list, or from its tighter part, and why.
struct MissingEngine {
    std::string engine;
    double tolerance = 0.0;  // the first that it has no row for; 0 if it has none for any
    std::string reason;      // begins with "cannot", "floor reached", "no time left" or "stiff"
    double seconds = std::numeric_limits<double>::quiet_NaN();  // that it would have taken, as far as that is known
};

/// What an accuracy will cost that no row has.
struct Prediction {
    std::string engine;
    double tolerance = 0.0, seconds = 0.0;
    double total = std::numeric_limits<double>::quiet_NaN();  // s: simulate() with this error=
    std::string basis;                                        // the rows it is read from
};

std::ostream& operator<<(std::ostream& out, const Prediction& prediction);

/// The list.
struct Price {
    std::vector<CostRow> rows;
    std::vector<MissingEngine> missing;
    std::string automatic;  // what simulate() takes by itself; "auto" where it changes the engine on the way
    std::string reference;  // what errors are measured against, and how sure that is
    double seconds = 0.0;   // spent on the list, by the clock

    /// The quickest row that reaches an error and has all events; throws InvalidInput if none does.
    const CostRow& cheapest(double error) const;

    /// What an error will cost with the engine that is quickest there: between two rows of an engine, errors, times and
    /// tolerances are interpolated in their logarithms. An error looser than an engine's loosest row costs what that
    /// row does. Throws InvalidInput where no engine has a row as accurate: nothing is extrapolated.
    Prediction predict(double error) const;

    /// The rows than which none is as accurate and quicker, from loose to tight.
    std::vector<CostRow> front() const;
};

std::ostream& operator<<(std::ostream& out, const Price& price);

namespace pricing {

/// A number to two digits.
std::string about(double value);

}  // namespace pricing

}  // namespace rbdyn::inline RBDYN_FORM
