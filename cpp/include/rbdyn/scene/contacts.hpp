// Contacts: what of a body touches what, and how it strikes and slides.
//
// A part of body a, a point or a convex shape, stays on the outer side of a surface: of the world, or of a body b, in
// its axes. The normal points from the surface to a; gaps are positive where there is room.
#pragma once

#include <optional>
#include <variant>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/expression/given.hpp"
#include "rbdyn/rotation/attitude.hpp"
#include "rbdyn/scene/handles.hpp"
#include "rbdyn/scene/joints.hpp"
#include "rbdyn/scene/surfaces.hpp"

namespace rbdyn::inline RBDYN_FORM {

/// What touches: a particle, a point, a sphere, a disc or an ellipsoid of a body.
using ContactPart = std::variant<BodyHandle, BodyPoint, BodySphere, BodyDisc, BodyEllipsoid>;
/// What it touches: a plane or a sphere, of the world or of a body.
using ContactSurface = std::variant<Plane, Sphere, BodyPlane, BodySphere>;

/// Options of a contact.
struct ContactOptions {
    /// Coulomb-Morin friction; none: it is smooth.
    std::optional<Coulomb> friction = std::nullopt;
    /// Newton's coefficient of restitution, 0 to 1: what is left of the speed of approach as a speed of separation.
    double restitution = 0.0;

    bool operator==(const ContactOptions&) const = default;
    void validate() const;
};

int body_of(const ContactPart& part);
/// -1: the world.
int body_of(const ContactSurface& surface);

}  // namespace rbdyn::inline RBDYN_FORM
