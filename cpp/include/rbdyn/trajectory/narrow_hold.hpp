// What was held by friction and is passed by little: how little, beside its rounding.
#pragma once

#include <optional>
#include <string>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/event/record.hpp"

namespace rbdyn::inline RBDYN_FORM {

/// A limit of friction that the load passes by so little that rounding tells on what slips.
struct NarrowHold {
    std::string name;               // of what holds
    double since = 0.0, until = 0;  // s: what is held slips from then on, and until then
    double part = 0.0;              // by which part of what is held the load passes its limit, at most

    /// In words: when, by how much, beside the rounding of forces, and what to do.
    std::string words() const;
};

/// That of all slips from rest in a run that is passed by least, if that is less than a millionth.
std::optional<NarrowHold> narrowest_hold(const Record& run);

}  // namespace rbdyn::inline RBDYN_FORM
