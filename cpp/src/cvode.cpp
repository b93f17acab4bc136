// Compiled once: the engines by CVODE, the only file that sees SUNDIALS; without it, that there are none.
#include "exported.hpp"

#include "rbdyn/engine/cvode_factory.ipp"
#ifdef RBDYN_WITH_SUNDIALS
#include "rbdyn/engine/cvode.ipp"
#include "rbdyn/engine/cvode_integrator.ipp"
#include "rbdyn/engine/cvode_vector.ipp"
#endif
