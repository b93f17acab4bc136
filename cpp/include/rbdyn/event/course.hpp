// How a motion was computed, and where that has come to: what it takes to compute on.
#pragma once

#include <limits>
#include <string>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/event/halt.hpp"
#include "rbdyn/expression/program.hpp"

namespace rbdyn::inline RBDYN_FORM::simulating {

/// How an engine makes its steps: beside its tolerance, so that two runs need not share their rounding.
struct Manner {
    int order = 0;            // of Taylor series; 0: from the tolerance
    double stride = 1.0;      // of dop853: how much of the steps that the tolerance allows is taken
    bool is_refined = false;  // Taylor series whose states go on in more digits than doubles have
    Program::Rounding rounding = Program::Rounding::nearest;  // of constants, so that no rounded one is shared
    bool gives_way = false;                                   // Taylor series that leave to BDF what is stiff
    int chance = 0;                                           // which of the ways to round events otherwise

    bool operator==(const Manner&) const = default;
};

struct Course {
    std::string engine;  // "closed form" too
    double tolerance = 0.0;
    Manner manner;
    Halt halt;
};

/// Where an integration begins: where the motion does, or where another one has come to.
struct Beginning {
    double origin = 0.0;                                           // s: where the motion began
    const Halt* halt = nullptr;                                    // none: it begins there
    double stops_from = -std::numeric_limits<double>::infinity();  // s: what stops a run does so after that
};

}  // namespace rbdyn::inline RBDYN_FORM::simulating
