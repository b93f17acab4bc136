// Compiled once: first-order systems of one's own, and their runs.
#include "exported.hpp"

#include "rbdyn/system/system.ipp"
#include "rbdyn/system/system_model.ipp"
#include "rbdyn/system/system_plan.ipp"
#include "rbdyn/system/system_run.ipp"
