// Joints: how a body may move, and where its motion starts, in the joint's own words.
//
// A joint lies between a body and its parent: the ground, or a body that was added before (`parent` of the start). Then
// `at`, axes and a rail's curve are in the parent's axes, from its origin, and the initial state is relative to it. At
// coordinates zero the axes of both coincide.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <variant>

#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/double_double_vector.hpp"
#include "rbdyn/basics/error.hpp"
#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/curve/curve.hpp"
#include "rbdyn/expression/given.hpp"
#include "rbdyn/expression/numbers.hpp"
#include "rbdyn/expression/time_function.hpp"
#include "rbdyn/rotation/attitude.hpp"
#include "rbdyn/scene/handles.hpp"
#include "rbdyn/scene/rigid_motion.hpp"

namespace rbdyn::inline RBDYN_FORM {

namespace joints {

void require_finite(const std::string& object, const std::string& what, const Vector3& v);
void require_direction(const std::string& object, const Vector3& axis);
void require_right_angle(const std::string& object, const std::string& what, const Vector3& a, const Vector3& b);

/// The angular velocity in body axes that a start gives, or what it is otherwise.
template <class Start>
Vector3Of<DoubleDouble> angular_velocity(const Start& start, const Attitude& attitude, const std::string& object,
                                         const Vector3& otherwise = Vector3::Zero()) {
    if (start.angular_velocity && start.angular_velocity_world)
        throw InvalidInput(object +
                           ": both angular_velocity and angular_velocity_world are given; one of them says how it "
                           "turns, in body axes or in the world's");
    if (start.angular_velocity) {
        require_finite(object, "angular_velocity", *start.angular_velocity);
        return widened(*start.angular_velocity);
    }
    if (!start.angular_velocity_world) return widened(otherwise);
    require_finite(object, "angular_velocity_world", *start.angular_velocity_world);
    return to_body<DoubleDouble>(attitude.exact(), widened(*start.angular_velocity_world));
}

}  // namespace joints

/// No constraint.
struct Free {
    bool operator==(const Free&) const = default;
};

/// Initial state of a free particle: position [m] and velocity [m/s], world axes.
struct FreeStart {
    Vector3 position = Vector3::Zero();
    Vector3 velocity = Vector3::Zero();
    BodyHandle parent = {};  // the ground, or the body it is joined to
};

/// Initial state of a free rigid body: position [m] and velocity [m/s] of the origin of the body's frame, world axes;
/// attitude; angular velocity [rad/s], in body axes or in the world's, one of them.
struct BodyStart {
    Vector3 position = Vector3::Zero();
    Vector3 velocity = Vector3::Zero();
    Attitude attitude = {};
    std::optional<Vector3> angular_velocity = std::nullopt;
    std::optional<Vector3> angular_velocity_world = std::nullopt;
    BodyHandle parent = {};  // the ground, or the body it is joined to
};

/// Coulomb-Morin friction (eq. 7.23): sliding, the tangential reaction is mu_dynamic times the perpendicular one,
/// against the slip; at rest it is whatever rest needs, up to mu_static times the perpendicular one.
///
/// At contacts torques resist what does not slip: against rolling, the angular velocity along the surface, `rolling`
/// times the normal force, and against pivoting, the one along its normal, `pivoting` times it; at rest each is
/// whatever rest needs, up to that.
struct Coulomb {
    Given mu_static = 0.0;
    std::optional<Given> mu_dynamic = std::nullopt;  // default: mu_static
    Given rolling = 0.0, pivoting = 0.0;             // m

    double dynamic() const { return mu_dynamic.value_or(mu_static); }
    bool operator==(const Coulomb& other) const;
    /// With the numbers of the user's as they are now.
    Coulomb frozen() const;
    void give(GivenNumbers& numbers) const;
    bool present() const { return mu_static > 0.0 || dynamic() > 0.0; }
    /// Whether it resists rolling or pivoting; a number of the user's counts as some until it is frozen.
    bool has_torques() const { return !rolling.is_zero() || !pivoting.is_zero(); }
    void validate() const;
};

/// What happens when the bead reaches an end of its curve: the run ends, or the bead goes on freely.
enum class RailEnds { stop, release };

/// On which side a rail holds its bead: on both, or only by pushing it along the curve's normal, or against it.
///
/// The normal is the one on the side of `up` where the bead starts, or else that of Frenet's axes there, carried on
/// along the curve without a jump at points of inflection (curve/one_side.hpp), so the curve lies in a plane. Pulled
/// away, the bead leaves the rail and flies; where its path meets the curve again from the same side it lands, its
/// velocity across the curve lost. A path that leaves the plane of the curve misses it.
enum class RailSide { both, plus, minus };

/// Options of a rail beside its curve and friction.
struct RailOptions {
    TimeFunction drive = 0.0;  // speed with which the rail's surface slides along itself [m/s]
    RigidMotion motion = {};   // of the rail itself, prescribed; its curve is where it is for R = 1, d = 0
    RailSide side = RailSide::both;
    RailEnds ends = RailEnds::stop;
    std::optional<Vector3> up = std::nullopt;  // a direction on the plus side of a rail that holds on one side, world
};

/// A guide along a curve, smooth or rough (eqs. 7.7-7.17, 7.23-7.26), fixed or moving.
class Rail {
public:
    Rail(Curve curve, std::optional<Coulomb> friction = std::nullopt, RailOptions options = {});

    const Curve& curve() const { return curve_; }
    /// Friction, if any of its coefficients is not zero.
    std::optional<Coulomb> friction() const { return friction_ && friction_->present() ? friction_ : std::nullopt; }
    /// As it was given, with coefficients that may be zero now.
    const std::optional<Coulomb>& given_friction() const { return friction_; }
    const TimeFunction& drive() const { return options_.drive; }
    const RigidMotion& motion() const { return options_.motion; }
    RailSide side() const { return options_.side; }
    RailEnds ends() const { return options_.ends; }
    const std::optional<Vector3>& up() const { return options_.up; }
    /// The way it pushes a bead that starts at u, a unit vector in the world; none if it holds on both sides. Throws
    /// InvalidInput unless the curve is plane and `up` says a side there. `name`: what messages call it.
    std::optional<Vector3> pushes(double u, const std::string& name = "Rail") const;
    /// Whether the bead may come to fly.
    bool may_release() const;
    /// With the numbers of the user's as they are now.
    Rail frozen() const;

    /// The numbers of the user's that it depends on.
    void give(GivenNumbers& numbers) const;

    bool operator==(const Rail& other) const;

private:
    Curve curve_;
    std::optional<Coulomb> friction_;
    RailOptions options_;
};

/// Initial state on a rail: where (the curve's parameter or an arc length, one of them) and ds/dt along the curve as
/// placed [m/s]. Arc length counts from the beginning of the curve, or from u = 0 where it has none.
struct RailStart {
    std::optional<double> parameter = std::nullopt;
    std::optional<double> arc_length = std::nullopt;
    double speed = 0.0;
    BodyHandle parent = {};  // the ground, or the body it is joined to
};

/// A ball joint: one point of the body (body axes) is held at a point of the world [m]; it turns as it likes (7.57).
struct Spherical {
    Vector3 at = Vector3::Zero();
    Vector3 point = Vector3::Zero();

    bool operator==(const Spherical&) const = default;
    void validate() const;
};

/// Initial state on a ball joint: attitude; angular velocity [rad/s], in body axes or in the world's, one of them.
struct SphericalStart {
    Attitude attitude = {};
    std::optional<Vector3> angular_velocity = std::nullopt;
    std::optional<Vector3> angular_velocity_world = std::nullopt;
    BodyHandle parent = {};  // the ground, or the body it is joined to
};

/// A hinge: the body turns about an axis through a point of the world, where it holds a point of its own (7.60). At
/// angle 0 body axes and world axes coincide, so the axis is the same direction in both; angles are right-handed.
///
/// With friction it resists by a torque about the axis, up to mu times the radius of its pin times what of the whole
/// reaction force lies across the axis; the reaction's torque presses nothing.
struct Revolute {
    Vector3 axis{0, 0, 1};
    Vector3 at = Vector3::Zero();
    Vector3 point = Vector3::Zero();
    std::optional<TimeFunction> motion = std::nullopt;  // its coordinate as a function of time, prescribed
    std::optional<Coulomb> friction = std::nullopt;     // none: it is smooth
    Given pin_radius = 0.0;                             // where its friction acts [m]

    bool operator==(const Revolute&) const = default;
    void validate() const;
};

/// Initial state on a hinge: angle [rad] and its rate [rad/s].
struct RevoluteStart {
    double angle = 0.0;
    double rate = 0.0;
    BodyHandle parent = {};  // the ground, or the body it is joined to
};

/// A slide: the body moves along an axis without turning, body axes along the world's. At displacement 0 its point is
/// at the point given of the world.
///
/// With friction it resists by a force along the axis, up to mu times what of the whole reaction force lies across the
/// axis; the reaction's torque presses nothing.
struct Prismatic {
    Vector3 axis{1, 0, 0};
    Vector3 at = Vector3::Zero();
    Vector3 point = Vector3::Zero();
    std::optional<TimeFunction> motion = std::nullopt;  // its coordinate as a function of time, prescribed
    std::optional<Coulomb> friction = std::nullopt;     // none: it is smooth

    bool operator==(const Prismatic&) const = default;
    void validate() const;
};

/// Initial state on a slide: displacement [m] along the axis and its rate [m/s].
struct PrismaticStart {
    double displacement = 0.0;
    double rate = 0.0;
    BodyHandle parent = {};  // the ground, or the body it is joined to
};

/// Two hinges with a massless cross between them: the body turns about `first`, fixed in the parent, and then about
/// `second`, fixed in the body, at right angles at angles zero.
struct Universal {
    Vector3 first{1, 0, 0}, second{0, 1, 0};
    Vector3 at = Vector3::Zero();
    Vector3 point = Vector3::Zero();

    bool operator==(const Universal&) const = default;
    void validate() const;
};

/// Initial state on a universal joint: angles [rad] about its two axes and their rates [rad/s].
struct UniversalStart {
    std::array<double, 2> angles{}, rates{};
    BodyHandle parent = {};  // the ground, or the body it is joined to
};

/// A hinge that slides along its axis.
struct Cylindrical {
    Vector3 axis{0, 0, 1};
    Vector3 at = Vector3::Zero();
    Vector3 point = Vector3::Zero();

    bool operator==(const Cylindrical&) const = default;
    void validate() const;
};

/// Initial state on a cylindrical joint: angle [rad], displacement [m] along the axis, and their rates.
struct CylindricalStart {
    double angle = 0.0, rate = 0.0;
    double displacement = 0.0, displacement_rate = 0.0;
    BodyHandle parent = {};  // the ground, or the body it is joined to
};

/// Motion along a plane: the body's origin moves along x and y, unit vectors at right angles, and the body turns about
/// x cross y.
struct Planar {
    Vector3 x{1, 0, 0}, y{0, 1, 0};
    Vector3 at = Vector3::Zero();

    bool operator==(const Planar&) const = default;
    void validate() const;
};

/// Initial state on a planar joint: position [m] of the body's origin from `at` along x and y, its velocity [m/s], the
/// angle from x to y [rad] and its rate [rad/s].
struct PlanarStart {
    std::array<double, 2> position{}, velocity{};
    double angle = 0.0, rate = 0.0;
    BodyHandle parent = {};  // the ground, or the body it is joined to
};

/// No motion: welded to its parent, in an attitude relative to it.
struct Fixed {
    Attitude attitude = {};
    Vector3 at = Vector3::Zero();
    Vector3 point = Vector3::Zero();

    bool operator==(const Fixed&) const = default;
    void validate() const;
};

/// What a weld starts with: nothing but where it is.
struct FixedStart {
    BodyHandle parent = {};  // the ground, or the body it is joined to
};

using Joint = std::variant<Free, Rail, Spherical, Revolute, Prismatic, Universal, Cylindrical, Planar, Fixed>;

/// Whether a hinge or a slide follows a function of time.
bool is_driven(const Joint& joint);
/// The friction in a hinge or a slide, if there is any.
std::optional<Coulomb> friction_in(const Joint& joint);
/// The friction of a rail, if there is any; a number of the user's counts as some.
std::optional<Coulomb> friction_on(const Rail& rail);

/// Where arc length counts from on a curve.
double arc_length_origin(const Curve& curve);

}  // namespace rbdyn::inline RBDYN_FORM
