// Compiled once: verbs that run a scene many times, to tell what it costs and what its effects do.
#include "exported.hpp"

#include "rbdyn/cost.ipp"
#include "rbdyn/effects.ipp"
#include "rbdyn/price.ipp"
#include "rbdyn/pricing.ipp"
