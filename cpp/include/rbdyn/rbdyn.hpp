// Everything of rbdyn in one include.
//
// What is declared here is defined in the library that a program links (rbdyn::rbdyn, rbdyn::core); with
// rbdyn::header_only it is defined at the end of this header, and nothing of rbdyn's own is linked.
#pragma once

#if __cplusplus < 202002L && !(defined(_MSVC_LANG) && _MSVC_LANG >= 202002L)
#error "rbdyn needs C++20: compile with -std=c++20, or link the target rbdyn::rbdyn, which asks for it"
#endif

#include "rbdyn/basics/form.hpp"
#include "rbdyn/body/momentum.hpp"
#include "rbdyn/body/shapes.hpp"
#include "rbdyn/cost.hpp"
#include "rbdyn/effects.hpp"
#include "rbdyn/file/scene_file.hpp"
#include "rbdyn/file/schema.hpp"
#include "rbdyn/model/euler_top.hpp"
#include "rbdyn/own_motion.hpp"
#include "rbdyn/plan/plan.hpp"
#include "rbdyn/simulate.hpp"
#include "rbdyn/simulate_many.hpp"
#include "rbdyn/statics/equilibria.hpp"
#include "rbdyn/statics/normal_modes.hpp"
#include "rbdyn/statics/rail_potential.hpp"
#include "rbdyn/system/system_plan.hpp"
#include "rbdyn/system/system_run.hpp"

namespace rbdyn::inline RBDYN_FORM {

inline constexpr const char* version = "0.1.0";

}  // namespace rbdyn::inline RBDYN_FORM

#ifdef RBDYN_HEADER_ONLY
#include "rbdyn/implementation.hpp"
#endif
