// What stays as it starts: the variables of a scene that need not be simulated.
//
// The largest set of variables whose rates are zero, exactly and at every time, while they are what they start with:
// all are taken for constants, those whose rates are not zero are variables after all, and so on until none is left to
// leave. That is done by recording with constants, for this is what the equations are made of; where it takes long,
// most of the way is gone on one record of the rates, where a node is known if its operands are, or if one factor is
// known to be zero. A particle loses what is across the plane of its start and its loads, a body without moment and
// spin its rotation, one at rest in balance all it has.
//
// Recorded as a function, so that both sides of every case distinction count. Beads that may stick or leave their rails
// are simulated whole: in flight they may be anywhere, and that covers the rail.
#pragma once

#include <string>
#include <vector>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/expression/node.hpp"
#include "rbdyn/expression/recorder.hpp"
#include "rbdyn/special/single_laws.hpp"

namespace rbdyn::inline RBDYN_FORM {

namespace staying {

// scenes of a few bodies are through with less, at half the cost of the other way
inline constexpr int most_passes = 3;

/// Takes from `stays` the variables whose recorded rates, all variables being inputs, are not known to be zero.
void follow(const Recorder& r, const std::vector<Expression>& rates, std::vector<bool>& stays);

}  // namespace staying

/// Which variables stay as they start, as long as no action of the user's changes them; and why that cannot be told, if
/// so.
struct Staying {
    std::vector<bool> variables;
    std::string unknown = {};
};

[[gnu::cold]] Staying what_stays(const SingleLaws& laws);

}  // namespace rbdyn::inline RBDYN_FORM
