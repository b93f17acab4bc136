// rbdyn::compiled: all that stands behind simulate(scene), compiled once. A program that links it (RBDYN_COMPILED) has
// only the declaration of attempt(), and what it does not call itself is not compiled with it.
#include "rbdyn/simulate.hpp"

namespace rbdyn {

Attempt attempt(const Scene& scene, const SimulateOptions& options) { return simulating::attempted(scene, options); }

}  // namespace rbdyn
