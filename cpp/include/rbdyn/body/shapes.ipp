// Definitions of rbdyn/body/shapes.hpp.
#pragma once

#include "rbdyn/body/shapes.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/double_double_functions.hpp"
#include "rbdyn/basics/double_double_vector.hpp"
#include "rbdyn/basics/error.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/body/mass_properties.hpp"
#include "rbdyn/body/rigid_body.hpp"

namespace rbdyn::inline RBDYN_FORM::shapes::detail {

RBDYN_INLINE DoubleDouble positive(const std::string& shape, const std::string& what, double value,
                                   const std::string& unit) {
    require(std::isfinite(value) && value > 0.0, shape, what, value, "it is positive and finite; give it in " + unit);
    return value;
}

RBDYN_INLINE Vector3Of<DoubleDouble> unit(const std::string& shape, const std::string& what, const Vector3& v) {
    for (int i = 0; i < 3; ++i)
        require(std::isfinite(v[i]), shape, what + "[" + std::to_string(i) + "]", v[i], "a direction is finite");
    const double size = std::max({std::abs(v[0]), std::abs(v[1]), std::abs(v[2])});
    require(size > 0.0, shape, "length of " + what, 0.0, "a direction is a vector of any other length");
    // a power of two, so that squares neither overflow nor vanish
    int exponent = 0;
    std::frexp(size, &exponent);
    const Vector3Of<DoubleDouble> w =
        widened(Vector3(std::ldexp(v[0], -exponent), std::ldexp(v[1], -exponent), std::ldexp(v[2], -exponent)));
    return scaled(w, 1.0 / sqrt(dot<DoubleDouble>(w, w)));
}

RBDYN_INLINE RigidBody revolved(const std::string& shape, const DoubleDouble& mass, const Vector3Of<DoubleDouble>& axis,
                                const DoubleDouble& along, const DoubleDouble& across, const DoubleDouble& height) {
    Matrix3Of<DoubleDouble> inertia;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
            inertia(i, j) = (i == j ? across : DoubleDouble(0.0)) + (along - across) * (axis[i] * axis[j]);
    return RigidBody(MassProperties{mass, scaled(axis, height), inertia}, InertiaAbout::com, shape);
}

RBDYN_INLINE RigidBody three_planes(const std::string& shape, double mass, const Vector3& size,
                                    const DoubleDouble& share) {
    const DoubleDouble m = positive(shape, "mass", mass, "kg");
    Vector3Of<DoubleDouble> square;
    for (int i = 0; i < 3; ++i) {
        const DoubleDouble a =
            positive(shape, (shape == "box" ? "size[" : "semi_axes[") + std::to_string(i) + "]", size[i]);
        square[i] = a * a;
    }
    Matrix3Of<DoubleDouble> inertia;
    for (int i = 0; i < 3; ++i) inertia(i, i) = m * share * (square[(i + 1) % 3] + square[(i + 2) % 3]);
    return RigidBody(MassProperties{m, widened(Vector3(0, 0, 0)), inertia}, InertiaAbout::com, shape);
}

}  // namespace rbdyn::inline RBDYN_FORM::shapes::detail

namespace rbdyn::inline RBDYN_FORM::shapes {

RBDYN_INLINE RigidBody rod(double mass, double length, const Vector3& along) {
    const DoubleDouble m = detail::positive("rod", "mass", mass, "kg"), l = detail::positive("rod", "length", length);
    return detail::revolved("rod", m, detail::unit("rod", "along", along), 0.0, m * l * l / 12.0);
}

RBDYN_INLINE RigidBody box(double mass, const Vector3& size) {
    return detail::three_planes("box", mass, size, DoubleDouble(1.0) / 12.0);
}

RBDYN_INLINE RigidBody disc(double mass, double radius, const Vector3& normal) {
    const DoubleDouble m = detail::positive("disc", "mass", mass, "kg"), r = detail::positive("disc", "radius", radius);
    const DoubleDouble square = m * r * r;
    return detail::revolved("disc", m, detail::unit("disc", "normal", normal), square * 0.5, square * 0.25);
}

RBDYN_INLINE RigidBody ring(double mass, double radius, const Vector3& normal) {
    const DoubleDouble m = detail::positive("ring", "mass", mass, "kg"), r = detail::positive("ring", "radius", radius);
    const DoubleDouble square = m * r * r;
    return detail::revolved("ring", m, detail::unit("ring", "normal", normal), square, square * 0.5);
}

RBDYN_INLINE RigidBody cylinder(double mass, double radius, double height, const Vector3& axis) {
    const DoubleDouble m = detail::positive("cylinder", "mass", mass, "kg"),
                       r = detail::positive("cylinder", "radius", radius),
                       h = detail::positive("cylinder", "height", height);
    return detail::revolved("cylinder", m, detail::unit("cylinder", "axis", axis), m * r * r * 0.5,
                            m * (3.0 * r * r + h * h) / 12.0);
}

RBDYN_INLINE RigidBody sphere(double mass, double radius) {
    const DoubleDouble m = detail::positive("sphere", "mass", mass, "kg"),
                       r = detail::positive("sphere", "radius", radius);
    const DoubleDouble moment = 2.0 * m * r * r / 5.0;
    return detail::revolved("sphere", m, widened(Vector3(0, 0, 1)), moment, moment);
}

RBDYN_INLINE RigidBody shell(double mass, double radius) {
    const DoubleDouble m = detail::positive("shell", "mass", mass, "kg"),
                       r = detail::positive("shell", "radius", radius);
    const DoubleDouble moment = 2.0 * m * r * r / 3.0;
    return detail::revolved("shell", m, widened(Vector3(0, 0, 1)), moment, moment);
}

RBDYN_INLINE RigidBody cone(double mass, double radius, double height, const Vector3& axis) {
    const DoubleDouble m = detail::positive("cone", "mass", mass, "kg"), r = detail::positive("cone", "radius", radius),
                       h = detail::positive("cone", "height", height);
    return detail::revolved("cone", m, detail::unit("cone", "axis", axis), 3.0 * m * r * r / 10.0,
                            3.0 * m * (4.0 * r * r + h * h) / 80.0, h * 0.75);
}

RBDYN_INLINE RigidBody ellipsoid(double mass, const Vector3& semi_axes) {
    return detail::three_planes("ellipsoid", mass, semi_axes, DoubleDouble(1.0) / 5.0);
}

RBDYN_INLINE RigidBody points(const std::vector<double>& masses, const std::vector<Vector3>& positions) {
    if (masses.size() != positions.size() || masses.empty())
        throw InvalidInput("points: masses has " + std::to_string(masses.size()) + " numbers and positions " +
                           std::to_string(positions.size()) + "; a mass for each point, and one point at least");
    MassProperties whole{0.0, widened(Vector3(0, 0, 0)), {}};
    for (std::size_t k = 0; k < masses.size(); ++k) {
        const std::string index = "[" + std::to_string(k) + "]";
        whole.mass += detail::positive("points", "masses" + index, masses[k], "kg");
        for (int i = 0; i < 3; ++i) {
            require(std::isfinite(positions[k][i]), "points", "positions" + index + "[" + std::to_string(i) + "]",
                    positions[k][i], "a position is finite; give it in m");
            whole.com[i] += double_double::exact_product(masses[k], positions[k][i]);
        }
    }
    whole.com = scaled(whole.com, 1.0 / whole.mass);
    for (std::size_t k = 0; k < masses.size(); ++k)
        whole.inertia += point_inertia(masses[k], widened(positions[k]) - whole.com);
    return RigidBody(whole, InertiaAbout::com, "points");
}

}  // namespace rbdyn::inline RBDYN_FORM::shapes
