// The first integrals that a scene's effects leave (7.40-7.43, 7.46): their names, and what they are about.
//
// Rigid bodies with a point fixed (7.58): energy; the angular momentum about that point along the vertical; the spin of
// a symmetric body loaded on its axis (Lagrange); Kovalevskaya's (special/lone_body.hpp).
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/scene/scene.hpp"
#include "rbdyn/special/lone_body.hpp"

namespace rbdyn::inline RBDYN_FORM {

/// Names of first integrals, the point about which those of angular momentum are taken, the vertical, and the axis
/// along which the one named "axial angular momentum" is.
struct FirstIntegrals {
    std::vector<std::string> names;
    Vector3 pole = Vector3::Zero();
    Vector3 up{0, 0, 1}, axis{0, 0, 1};
};

namespace planning {

/// Whether a force of the user's has a potential along the way of its body, though it may have none in space: one of
/// position only, on a bead that stays on a smooth rail at rest (eq. 7.18).
bool has_potential_along_rail(const Scene& scene, const Scene::AppliedLoad& load);

/// What the effects of a scene leave of the first integrals of a system (7.40-7.42, 7.46), effect by effect.
///
/// Of momentum a component stays if no force from outside has it. Of angular momentum about a pole a component stays if
/// no force from outside has a moment about the line through the pole along it: forces at known points of the world
/// (anchors, ball joints) have none if those lie on the line, forces along it never have, and equal and opposite ones
/// along the line of their ends cancel. Lines along x, y, z are told exactly, any other to rounding.
struct Remaining {
    bool energy = true;
    bool momentum[3] = {true, true, true}, angular[3] = {true, true, true};
    bool only_weight = true;      // nothing acts but gravity and joints
    std::vector<Vector3> points;  // of the world that forces of any direction go through
    std::vector<Vector3> lines;   // directions that a line without moments has to have
    bool any_line = true;         // there may be one

    /// A force of known direction and any line, as far as its components are not zero.
    void push(const Vector3& force);
    /// A force with unknown components, but for those that are zero.
    void push(bool x, bool y, bool z) {
        push(Vector3(x, y, z));
        any_line = any_line && x + y + z < 2;
    }
    void push_anyhow() { push(true, true, true); }
    /// A force of any direction at a point of the world.
    void hold(const Vector3& point);
    /// What lets turn about one line freely, and may slide along it or not.
    void turn_about(const Vector3& point, const Vector3& axis, bool slides);
    /// A moment of any direction.
    void twist();
    /// Nothing but what is along an axis exactly stays of three components.
    static void keep_along(bool (&kept)[3], const Vector3& axis);
    /// What stays of angular momentum about a point, of the points that forces go through the first.
    Vector3 settle();
    /// The direction of the one line through the pole about which there are no moments, if there is one and no more.
    std::optional<Vector3> line(const Vector3& pole) const;
};

Remaining remaining_of(const Scene& scene);

/// `body`: what is known of the only one, if it is rigid.
FirstIntegrals first_integrals(const Scene& scene, const std::optional<LoneBody>& body);

}  // namespace planning

}  // namespace rbdyn::inline RBDYN_FORM
