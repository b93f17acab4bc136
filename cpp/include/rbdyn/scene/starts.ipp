// Definitions of rbdyn/scene/starts.hpp.
#pragma once

#include "rbdyn/scene/starts.hpp"

#include <cmath>
#include <cstddef>
#include <string>
#include <type_traits>
#include <variant>

#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/error.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/curve/curve.hpp"
#include "rbdyn/curve/point.hpp"
#include "rbdyn/scene/joints.hpp"

namespace rbdyn::inline RBDYN_FORM::starts {

RBDYN_INLINE Started on(const Free&, const FreeStart& start, const std::string& name) {
    for (int i = 0; i < 3; ++i) {
        require(std::isfinite(start.position[i]), name, "component " + std::to_string(i) + " of position",
                start.position[i], "a position is finite; give it in m");
        require(std::isfinite(start.velocity[i]), name, "component " + std::to_string(i) + " of velocity",
                start.velocity[i], "a velocity is finite; give it in m/s");
    }
    return {.position = start.position, .velocity = start.velocity};
}

RBDYN_INLINE Started on(const Rail& rail, const RailStart& start, const std::string& name) {
    const Curve& curve = rail.curve();
    if (start.parameter && start.arc_length)
        throw InvalidInput(name + ": both parameter " + text(*start.parameter) + " and arc_length " +
                           text(*start.arc_length) + " are given; one of them says where it starts");
    DoubleDouble u = start.parameter.value_or(0.0);
    if (start.arc_length) {
        require(std::isfinite(*start.arc_length), name, "arc_length", *start.arc_length, "it is finite, in m");
        u = curve.exact_parameter_at(arc_length_origin(curve), *start.arc_length);
    }
    require(std::isfinite(u.hi), name, "parameter", u.hi, "a start is a finite parameter of the curve");
    const Domain domain = curve.domain();
    require(u.hi >= domain.begin && u.hi <= domain.end, name, "parameter", u.hi,
            "a start lies in the domain of its curve, " + text(domain.begin) + " to " + text(domain.end));
    require(std::isfinite(start.speed), name, "speed", start.speed, "a speed is finite; give it in m/s");
    curve.require_regular(u.hi);
    // what its equations divide by, and multiply with
    const CurvePoint<double> point = curve.own(u.hi);
    require(std::isfinite(point.speed_squared) && std::isfinite(point.first_dot_second), name, "parameter", u.hi,
            "|r'|^2 and r' . r'' of the curve are beyond doubles there: choose units that make them smaller");
    return {.parameter = u.hi, .speed = start.speed, .parameter_rest = u.lo};
}

RBDYN_INLINE Started on(const Free&, const BodyStart& start, const std::string& name) {
    joints::require_finite(name, "position", start.position);
    joints::require_finite(name, "velocity", start.velocity);
    return {.position = start.position,
            .velocity = start.velocity,
            .attitude = start.attitude,
            .angular_velocity = joints::angular_velocity(start, start.attitude, name),
            .angular_velocity_world = start.angular_velocity_world};
}

RBDYN_INLINE Started on(const Spherical&, const SphericalStart& start, const std::string& name) {
    return {.attitude = start.attitude,
            .angular_velocity = joints::angular_velocity(start, start.attitude, name),
            .angular_velocity_world = start.angular_velocity_world};
}

RBDYN_INLINE Started on(const Revolute& joint, const RevoluteStart& start, const std::string& name) {
    require(std::isfinite(start.angle), name, "angle", start.angle, "an angle is finite; give it in rad");
    require(std::isfinite(start.rate), name, "rate", start.rate, "a rate is finite; give it in rad/s");
    if (joint.motion) {
        require(start.angle == 0.0, name, "angle", start.angle, "a driven joint starts where its motion does");
        require(start.rate == 0.0, name, "rate", start.rate, "a driven joint has the rate of its motion");
    }
    return {.parameter = start.angle, .speed = start.rate};
}

RBDYN_INLINE Started on(const Prismatic& joint, const PrismaticStart& start, const std::string& name) {
    require(std::isfinite(start.displacement), name, "displacement", start.displacement,
            "a displacement is finite; give it in m");
    require(std::isfinite(start.rate), name, "rate", start.rate, "a rate is finite; give it in m/s");
    if (joint.motion) {
        require(start.displacement == 0.0, name, "displacement", start.displacement,
                "a driven joint starts where its motion does");
        require(start.rate == 0.0, name, "rate", start.rate, "a driven joint has the rate of its motion");
    }
    return {.parameter = start.displacement, .speed = start.rate};
}

RBDYN_INLINE Started on(const Universal&, const UniversalStart& start, const std::string& name) {
    for (std::size_t k = 0; k < 2; ++k) {
        require(std::isfinite(start.angles[k]), name, "angles " + std::to_string(k), start.angles[k],
                "an angle is finite; give it in rad");
        require(std::isfinite(start.rates[k]), name, "rates " + std::to_string(k), start.rates[k],
                "a rate is finite; give it in rad/s");
    }
    return {.coordinates = {start.angles[0], start.angles[1], 0.0}, .rates = {start.rates[0], start.rates[1], 0.0}};
}

RBDYN_INLINE Started on(const Cylindrical&, const CylindricalStart& start, const std::string& name) {
    require(std::isfinite(start.angle), name, "angle", start.angle, "an angle is finite; give it in rad");
    require(std::isfinite(start.rate), name, "rate", start.rate, "a rate is finite; give it in rad/s");
    require(std::isfinite(start.displacement), name, "displacement", start.displacement,
            "a displacement is finite; give it in m");
    require(std::isfinite(start.displacement_rate), name, "displacement_rate", start.displacement_rate,
            "a rate is finite; give it in m/s");
    return {.coordinates = {start.angle, start.displacement, 0.0}, .rates = {start.rate, start.displacement_rate, 0.0}};
}

RBDYN_INLINE Started on(const Planar&, const PlanarStart& start, const std::string& name) {
    for (std::size_t k = 0; k < 2; ++k) {
        require(std::isfinite(start.position[k]), name, "position " + std::to_string(k), start.position[k],
                "a position is finite; give it in m");
        require(std::isfinite(start.velocity[k]), name, "velocity " + std::to_string(k), start.velocity[k],
                "a velocity is finite; give it in m/s");
    }
    require(std::isfinite(start.angle), name, "angle", start.angle, "an angle is finite; give it in rad");
    require(std::isfinite(start.rate), name, "rate", start.rate, "a rate is finite; give it in rad/s");
    return {.coordinates = {start.position[0], start.position[1], start.angle},
            .rates = {start.velocity[0], start.velocity[1], start.rate}};
}

RBDYN_INLINE Started on(const Fixed& joint, const FixedStart&, const std::string&) {
    return {.attitude = joint.attitude};
}

RBDYN_INLINE Start words(const Joint& joint, bool is_rigid, const Started& s) {
    const auto turning = [&](auto start) {
        start.attitude = s.attitude;
        start.angular_velocity_world = s.angular_velocity_world;
        if (!s.angular_velocity_world) start.angular_velocity = rounded(s.angular_velocity);
        return start;
    };
    const auto& c = s.coordinates;
    const auto& r = s.rates;
    return std::visit(
        [&](const auto& j) -> Start {
            using J = std::decay_t<decltype(j)>;
            if constexpr (std::is_same_v<J, Free>) {
                if (!is_rigid) return FreeStart{.position = s.position, .velocity = s.velocity};
                return turning(BodyStart{.position = s.position, .velocity = s.velocity});
            } else if constexpr (std::is_same_v<J, Rail>) {
                return RailStart{.parameter = s.parameter, .speed = s.speed};
            } else if constexpr (std::is_same_v<J, Spherical>) {
                return turning(SphericalStart{});
            } else if constexpr (std::is_same_v<J, Revolute>) {
                return RevoluteStart{.angle = s.parameter, .rate = s.speed};
            } else if constexpr (std::is_same_v<J, Prismatic>) {
                return PrismaticStart{.displacement = s.parameter, .rate = s.speed};
            } else if constexpr (std::is_same_v<J, Universal>) {
                return UniversalStart{.angles = {c[0], c[1]}, .rates = {r[0], r[1]}};
            } else if constexpr (std::is_same_v<J, Cylindrical>) {
                return CylindricalStart{.angle = c[0], .rate = r[0], .displacement = c[1], .displacement_rate = r[1]};
            } else if constexpr (std::is_same_v<J, Planar>) {
                return PlanarStart{.position = {c[0], c[1]}, .velocity = {r[0], r[1]}, .angle = c[2], .rate = r[2]};
            } else {
                return FixedStart{};
            }
        },
        joint);
}

}  // namespace rbdyn::inline RBDYN_FORM::starts
