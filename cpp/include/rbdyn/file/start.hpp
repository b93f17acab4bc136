// What scenes' files have besides what classes are in them: their name and version, and where a body starts.
#pragma once

#include <array>
#include <string_view>
#include <tuple>
#include <variant>
#include <vector>

#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/body/particle.hpp"
#include "rbdyn/body/rigid_body.hpp"
#include "rbdyn/file/described.hpp"
#include "rbdyn/file/values.hpp"
#include "rbdyn/rotation/attitude.hpp"

namespace rbdyn::inline RBDYN_FORM::file {

inline constexpr std::string_view scene_format = "rbdyn scene";
inline constexpr long scene_version = 1;

using AnyBody = std::variant<Particle, RigidBody>;

/// Where a body starts, in the words of its joint.
struct Start {
    std::vector<double> position, velocity, angular_velocity_world;
    DoubleDouble parameter;
    double speed = 0.0, angle = 0.0, rate = 0.0, displacement = 0.0, displacement_rate = 0.0;
    std::array<double, 2> angles{}, rates{};
    Attitude attitude;
    Vector3Of<DoubleDouble> angular_velocity = {};
};
template <>
struct Described<Start> {
    static constexpr tuple fields{usual("position", &Start::position),
                                  usual("velocity", &Start::velocity),
                                  usual("parameter", &Start::parameter),
                                  usual("speed", &Start::speed),
                                  usual("angle", &Start::angle),
                                  usual("rate", &Start::rate),
                                  usual("displacement", &Start::displacement),
                                  usual("displacement_rate", &Start::displacement_rate),
                                  usual("angles", &Start::angles),
                                  usual("rates", &Start::rates),
                                  usual("attitude", &Start::attitude),
                                  usual("angular_velocity", &Start::angular_velocity),
                                  usual("angular_velocity_world", &Start::angular_velocity_world)};
};

}  // namespace rbdyn::inline RBDYN_FORM::file
