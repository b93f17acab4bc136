// Where a motion starts: in the words of a body's joint, and as a scene keeps it.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <variant>

#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/rotation/attitude.hpp"
#include "rbdyn/scene/joints.hpp"

namespace rbdyn::inline RBDYN_FORM {

/// The start of a body as its scene keeps it, in all its digits: what its joint has no word for is zero.
struct Started {
    Vector3 position = Vector3::Zero(), velocity = Vector3::Zero();  // of a free body
    double parameter = 0.0, speed = 0.0;                             // of a bead; of a joint with one coordinate
    double parameter_rest = 0.0;                                     // what the parameter is short of 32 digits
    Attitude attitude = {};                                          // of a body that turns freely
    Vector3Of<DoubleDouble> angular_velocity = {};                   // its own, body axes
    std::optional<Vector3> angular_velocity_world = std::nullopt;    // as it was given, if it was in the world's axes
    std::array<double, 3> coordinates{}, rates{};                    // of a joint with two or three

    bool operator==(const Started&) const = default;
};

/// A start in the words of some joint, or what the scene of another body on the same joint keeps of it.
using Start = std::variant<FreeStart, BodyStart, RailStart, SphericalStart, RevoluteStart, PrismaticStart,
                           UniversalStart, CylindricalStart, PlanarStart, FixedStart, Started>;

namespace starts {

/// What a scene keeps of a start on a joint. `name`: of the body. Throws InvalidInput for numbers that break a rule.
Started on(const Free& joint, const FreeStart& start, const std::string& name);
Started on(const Free& joint, const BodyStart& start, const std::string& name);
Started on(const Rail& joint, const RailStart& start, const std::string& name);
Started on(const Spherical& joint, const SphericalStart& start, const std::string& name);
Started on(const Revolute& joint, const RevoluteStart& start, const std::string& name);
Started on(const Prismatic& joint, const PrismaticStart& start, const std::string& name);
Started on(const Universal& joint, const UniversalStart& start, const std::string& name);
Started on(const Cylindrical& joint, const CylindricalStart& start, const std::string& name);
Started on(const Planar& joint, const PlanarStart& start, const std::string& name);
Started on(const Fixed& joint, const FixedStart& start, const std::string& name);

/// The same in the words of its joint, in doubles. `is_rigid`: whether it is that of a rigid body.
Start words(const Joint& joint, bool is_rigid, const Started& start);

}  // namespace starts

}  // namespace rbdyn::inline RBDYN_FORM
