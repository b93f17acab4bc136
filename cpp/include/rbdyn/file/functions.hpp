// Recorded functions in files: one operation a line, as they are printed.
//
//   n0 = parameter 0        of the file's list
//   n1 = -1.0
//   n2 = n0 * n1
//   n3 = input 1
//   n4 = n2 * n3
//   n5 = n3 ^ 0.5           arguments are earlier lines, but for an exponent
//   n6 = n4 where n3 > 0, else n5  (if, line 3)
//   n7 = sin n6
//
// A constant of 32 digits has its rest behind it: 0.1 rest 5.5e-18.
#pragma once

#include <string>
#include <vector>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/expression/function.hpp"
#include "rbdyn/expression/numbers.hpp"
#include "rbdyn/file/place.hpp"

namespace rbdyn::inline RBDYN_FORM::file {

/// What is known while a document is written: the numbers of the user's so far, and the names of bodies.
struct Writing {
    GivenNumbers parameters = {};
    std::vector<std::string> bodies = {};
    bool has_actions = true;  // else of those that change the state only that they do

    /// The index of one that has a value; two values of one number are two.
    int index_of(const Parameter& parameter, double value);
};

[[gnu::cold]] Json function_to(const Function& f, Writing& writing);
[[gnu::cold]] Function function_from(const Place& place);

}  // namespace rbdyn::inline RBDYN_FORM::file
