// Compiled once: bodies joined to bodies.
#include "exported.hpp"

#include "rbdyn/mechanics/assemble.ipp"
#include "rbdyn/mechanics/closure.ipp"
#include "rbdyn/mechanics/complementarity.ipp"
#include "rbdyn/mechanics/constraint.ipp"
#include "rbdyn/mechanics/exert.ipp"
#include "rbdyn/mechanics/tree.ipp"
#include "rbdyn/mechanics/tree_contacts.ipp"
#include "rbdyn/mechanics/tree_model.ipp"
#include "rbdyn/mechanics/tree_observables.ipp"
#include "rbdyn/mechanics/tree_state.ipp"
#include "rbdyn/mechanics/tree_writer.ipp"
