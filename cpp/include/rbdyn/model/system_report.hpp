// What the theorems of systems are made of: all bodies and couplings of a scene at one moment, world axes.
//
// Any model gives it, once for all bodies, so that what is summed from it is linear in them.
#pragma once

#include <vector>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/rotation/quaternion.hpp"

namespace rbdyn::inline RBDYN_FORM {

/// How much of a moment is asked for: where everything is and how it moves, or also what acts.
enum class Asked { motion, forces };

/// A particle or a rigid body at a moment.
struct BodyReport {
    double mass = 0.0;
    Vector3 position = Vector3::Zero(), velocity = Vector3::Zero();  // of the centre of mass G
    Vector3 origin = Vector3::Zero();                                // of the axes of a rigid body; else G
    Quaternion attitude{1.0, 0.0, 0.0, 0.0};                         // of a rigid body
    Vector3 angular_velocity = Vector3::Zero();                      // of a rigid body
    Vector3 spin_momentum = Vector3::Zero();                         // K_G
    double spin_energy = 0.0;                                        // T^(G)
    double coordinate = 0.0;                                         // of a joint with one; the parameter of a bead

    // where forces are asked for

    Vector3 acceleration = Vector3::Zero();                                 // of G
    Vector3 spin_rate = Vector3::Zero();                                    // dK_G/dt
    double spin_power = 0.0;                                                // dT^(G)/dt
    Vector3 force = Vector3::Zero();                                        // all active forces, couplings among them
    Vector3 applied = Vector3::Zero(), applied_moment = Vector3::Zero();    // without them, and the moment about G
    Vector3 reaction = Vector3::Zero(), reaction_moment = Vector3::Zero();  // of its rail or joint, moment about G

    /// Place and velocity of a point given in the axes of a rigid body.
    Vector3 place(const Vector3& point) const { return origin + to_world<double>(attitude, point); }
    Vector3 velocity_of(const Vector3& point) const {
        return velocity + angular_velocity.cross(Vector3(place(point) - position));
    }
};

/// A coupling at a moment.
struct CouplingReport {
    int a = -1, b = -1;  // the bodies its ends are on; -1: a point of the world
    Vector3 place_a = Vector3::Zero(), place_b = Vector3::Zero();
    Vector3 force = Vector3::Zero();  // on the first end, where forces are asked for

    double length() const { return (place_a - place_b).norm(); }
};

struct SystemReport {
    std::vector<BodyReport> bodies;
    std::vector<CouplingReport> couplings;
};

}  // namespace rbdyn::inline RBDYN_FORM
