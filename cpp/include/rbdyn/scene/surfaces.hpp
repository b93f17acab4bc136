// Surfaces: what points are held on, and what bodies touch.
#pragma once

#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/rotation/attitude.hpp"

namespace rbdyn::inline RBDYN_FORM {

/// A plane through a point [m], its normal of any length.
struct Plane {
    Vector3 normal{0, 0, 1};
    Vector3 point = Vector3::Zero();

    bool operator==(const Plane&) const = default;
    void validate() const;
};

/// A sphere: its outside, or its inside, a bowl. Centre and radius [m].
struct Sphere {
    Vector3 center = Vector3::Zero();
    double radius = 1.0;
    bool inside = false;

    bool operator==(const Sphere&) const = default;
    void validate() const;
};

/// A plane of a body, in its axes.
struct BodyPlane {
    int body = -1;
    Plane plane;
    bool operator==(const BodyPlane&) const = default;
};

/// A ball of a body: its centre in body axes and its radius [m].
struct BodySphere {
    int body = -1;
    double radius = 0.0;
    Vector3 center = Vector3::Zero();
    bool operator==(const BodySphere&) const = default;
};

/// A disc of a body, without thickness: its radius [m], the direction across it and its centre in body axes [m].
struct BodyDisc {
    int body = -1;
    double radius = 0.0;
    Vector3 normal{0, 0, 1};
    Vector3 center = Vector3::Zero();
    bool operator==(const BodyDisc&) const = default;
};

/// An ellipsoid of a body: its semi-axes [m], its centre in body axes [m], and how its own axes are turned from them.
struct BodyEllipsoid {
    int body = -1;
    Vector3 semi_axes = Vector3::Ones();
    Vector3 center = Vector3::Zero();
    Attitude attitude = {};
    bool operator==(const BodyEllipsoid&) const = default;
};

}  // namespace rbdyn::inline RBDYN_FORM
