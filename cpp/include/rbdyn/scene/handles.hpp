// Handles: what a scene gives back for a thing it has taken, by order of addition.
#pragma once

#include <string>
#include <variant>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/rotation/attitude.hpp"
#include "rbdyn/scene/surfaces.hpp"

namespace rbdyn::inline RBDYN_FORM {

/// A point of a body: in body axes, from the origin of its frame [m].
struct BodyPoint {
    int body = -1;
    Vector3 point = Vector3::Zero();
    bool operator==(const BodyPoint&) const = default;
};
/// A body of a scene.
struct BodyHandle {
    int index = -1;
    /// One of its points, in body axes [m].
    BodyPoint point(const Vector3& place) const { return {index, place}; }
    /// Parts of it that touch (contacts.hpp), in body axes [m].
    BodySphere sphere(double radius, const Vector3& center = Vector3::Zero()) const { return {index, radius, center}; }
    BodyDisc disc(double radius, const Vector3& normal, const Vector3& center = Vector3::Zero()) const {
        return {index, radius, normal, center};
    }
    BodyEllipsoid ellipsoid(const Vector3& semi_axes, const Vector3& center = Vector3::Zero(),
                            const Attitude& attitude = {}) const {
        return {index, semi_axes, center, attitude};
    }
    BodyPlane plane(const Plane& plane) const { return {index, plane}; }
    bool operator==(const BodyHandle&) const = default;
};
/// A load of a scene.
struct LoadHandle {
    int index = -1;
    bool operator==(const LoadHandle&) const = default;
};
/// A coupling of a scene.
struct CouplingHandle {
    int index = -1;
    bool operator==(const CouplingHandle&) const = default;
};
/// A constraint of a scene.
struct ConstraintHandle {
    int index = -1;
    bool operator==(const ConstraintHandle&) const = default;
};
/// A contact of a scene.
struct ContactHandle {
    int index = -1;
    bool operator==(const ContactHandle&) const = default;
};
/// A watched function of a scene.
struct WatchHandle {
    int index = -1;
    bool operator==(const WatchHandle&) const = default;
};

/// An end of a coupling: a body (a particle, or the centre of mass), one of its points, or a point of the world.
using End = std::variant<BodyHandle, BodyPoint, Vector3>;

/// What can be taken from a scene: an effect by its name, one load, one coupling, one contact.
using Removable = std::variant<std::string, LoadHandle, CouplingHandle, ContactHandle>;

/// The body an end is on, or -1.
int body_of(const End& end);

}  // namespace rbdyn::inline RBDYN_FORM
