// Compiled once: what touches, slides, sticks and rolls.
#include "exported.hpp"

#include "rbdyn/mechanics/complementarity.ipp"
#include "rbdyn/mechanics/cone_program.ipp"
#include "rbdyn/mechanics/foot.ipp"
#include "rbdyn/mechanics/friction_cones.ipp"
#include "rbdyn/mechanics/tree_contacts.ipp"
#include "rbdyn/mechanics/tree_friction.ipp"
#include "rbdyn/mechanics/tree_joint_contacts.ipp"
#include "rbdyn/mechanics/tree_joint_strikes.ipp"
#include "rbdyn/mechanics/tree_rest.ipp"
#include "rbdyn/mechanics/tree_rolling.ipp"
#include "rbdyn/mechanics/tree_sharing.ipp"
