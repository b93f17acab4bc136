// Compiled once: scenes.
#include "exported.hpp"

#include "rbdyn/scene/couplings.ipp"
#include "rbdyn/scene/effects.ipp"
#include "rbdyn/scene/handles.ipp"
#include "rbdyn/scene/joints.ipp"
#include "rbdyn/scene/loads.ipp"
#include "rbdyn/scene/parts.ipp"
#include "rbdyn/scene/plan_slot.ipp"
#include "rbdyn/scene/rigid_motion.ipp"
#include "rbdyn/scene/scene.ipp"
#include "rbdyn/scene/torque.ipp"
#include "rbdyn/scene/watch.ipp"
