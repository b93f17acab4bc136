// What first integrals a rigid body has that is alone in its scene, beside those of all systems.
//
// On a ball joint under its weight: the spin of a symmetric body loaded on its axis (Lagrange); Kovalevskaya's, of a
// body with A = B = 2C whose centre of mass lies in the plane of its equal moments: |z^2 - (M g/C) c zeta|^2, where
// z = w1 + i w2, zeta = u1 + i u2 of the upward vertical u, c = x1 + i x2 of G (Kovalevskaya, "Sur le probleme de la
// rotation d'un corps solide autour d'un point fixe", 1889; checked by differentiation with Euler's equations).
#pragma once

#include <optional>
#include <span>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/model/scene_model.hpp"

namespace rbdyn::inline RBDYN_FORM::planning {

struct LoneBody {
    bool on_ball_joint = false;
    bool is_balanced = false;  // its weight has no moment about the point its joint holds
    bool is_kovalevskaya = false;
    bool keeps_spin = false;  // nothing turns it about its axis of symmetry
};

/// Of the only body of a scene; none where there are more, or it is a particle, or in a tree.
[[gnu::cold]] std::optional<LoneBody> lone_body(const SceneModel& model);

/// The spin of a symmetric body about its axis [rad/s], at a state.
double spin(const SceneModel& model, std::span<const double> x);

/// |z^2 - (M g/C) c zeta|^2 [1/s^4] at a state; `gravity`: its size [m/s^2], `up`: against it, world.
double kovalevskaya(const SceneModel& model, std::span<const double> x, double gravity, const Vector3& up);

}  // namespace rbdyn::inline RBDYN_FORM::planning
