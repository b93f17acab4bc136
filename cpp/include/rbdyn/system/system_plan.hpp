// What is decided of a System before anything is computed.
#pragma once

#include <ostream>
#include <string>
#include <vector>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/model/size.hpp"
#include "rbdyn/system/system.hpp"

namespace rbdyn::inline RBDYN_FORM {

/// The decisions made from a system.
struct SystemPlan {
    std::vector<std::string> variables;  // their names
    std::vector<std::string> guards;     // what is watched for where the motion begins
    std::vector<std::string> functions;  // the user's: traced, or called back and why
    std::string engine, reason;          // the automatic choice, and why
    std::string judge;                   // the engine that runs are held against
    Size size;                           // of the equations that a motion from time 0 begins with
};

SystemPlan make_plan(const System& system);

std::ostream& operator<<(std::ostream& out, const SystemPlan& plan);

}  // namespace rbdyn::inline RBDYN_FORM
