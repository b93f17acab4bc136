// What a model says of one body at a time: its motion, and its reactions.
#pragma once

#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/rotation/quaternion.hpp"

namespace rbdyn::inline RBDYN_FORM {

/// Motion and reaction of one particle at a time, world axes.
struct PointReport {
    Vector3 position, velocity, acceleration, force, reaction;
    double u = 0.0, w = 0.0, w_rate = 0.0,
           speed = 0.0;                          // in flight: where it left the rail, 0, 0, 0; without a rail |v|
    double tangential_force = 0.0;               // Q_s = F.t (eq. 7.15)
    double rail_speed = 0.0;                     // V, of the rail's surface along itself
    Vector3 spin_momentum = Vector3::Zero();     // K_G of a rigid body
    double spin_energy = 0.0, spin_power = 0.0;  // T^(G), and its rate
    double effort = 0.0;                         // |F| + m |a| + m V^2 / rho: a reaction of its rounding is none
    Vector3 applied = Vector3::Zero();           // force without that of couplings; of a particle
};

/// Motion and reactions of a rigid body at a time.
struct RigidReport {
    Quaternion attitude;
    Vector3 position, velocity, acceleration;        // of the origin of the body's frame, world
    Vector3 center_acceleration, force, reaction;    // world
    Vector3 moment, reaction_torque;                 // about o, world
    Vector3 angular_velocity, angular_acceleration;  // body axes
    Vector3 spin_momentum, spin_rate;                // K_G = I_G omega, and its rate, world
    double spin_energy = 0.0, spin_power = 0.0;      // T^(G) = I_G omega.omega/2, and its rate
    double coordinate = 0.0, rate = 0.0;             // of a joint with one
    double force_effort = 0.0, torque_effort = 0.0;  // sizes of what the reactions are differences of
};

}  // namespace rbdyn::inline RBDYN_FORM
