// What every class of a scene is in files: the one statement of its kind and its fields.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>
#include <variant>
#include <vector>

#include "rbdyn/basics/direction.hpp"
#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/error.hpp"
#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/body/particle.hpp"
#include "rbdyn/body/rigid_body.hpp"
#include "rbdyn/curve/curve.hpp"
#include "rbdyn/expression/function.hpp"
#include "rbdyn/expression/given.hpp"
#include "rbdyn/expression/time_function.hpp"
#include "rbdyn/file/values.hpp"
#include "rbdyn/rotation/attitude.hpp"
#include "rbdyn/scene/constraints.hpp"
#include "rbdyn/scene/contacts.hpp"
#include "rbdyn/scene/couplings.hpp"
#include "rbdyn/scene/handles.hpp"
#include "rbdyn/scene/joints.hpp"
#include "rbdyn/scene/loads.hpp"
#include "rbdyn/scene/recorded_action.hpp"
#include "rbdyn/scene/rigid_motion.hpp"
#include "rbdyn/scene/surfaces.hpp"
#include "rbdyn/scene/watch.hpp"

namespace rbdyn::inline RBDYN_FORM::file {

using std::tuple;
using Words2 = std::array<std::string_view, 2>;
using Words3 = std::array<std::string_view, 3>;

// --- enumerations ---

template <>
struct WordsOf<Frame> {
    static constexpr Words2 words = {"world", "body"};
};
template <>
struct WordsOf<InertiaAbout> {
    static constexpr Words2 words = {"com", "origin"};
};
template <>
struct WordsOf<RailSide> {
    static constexpr Words3 words = {"both", "+", "-"};
};
template <>
struct WordsOf<RailEnds> {
    static constexpr Words2 words = {"stop", "release"};
};
template <>
struct WordsOf<Direction> {
    static constexpr Words3 words = {"either", "rising", "falling"};
};
template <>
struct WordsOf<WatchAction::Kind> {
    static constexpr Words3 words = {"record", "stop", "change"};
};
template <>
struct WordsOf<Quantity> {
    static constexpr std::array<std::string_view, 29> words = {"time",
                                                               "position",
                                                               "velocity",
                                                               "acceleration",
                                                               "force",
                                                               "reaction",
                                                               "parameter",
                                                               "speed",
                                                               "tangential_force",
                                                               "kinetic_energy",
                                                               "center_of_mass",
                                                               "center_of_mass_velocity",
                                                               "center_of_mass_acceleration",
                                                               "quaternion",
                                                               "rotation_matrix",
                                                               "euler_angles",
                                                               "angular_velocity",
                                                               "angular_acceleration",
                                                               "angular_velocity_world",
                                                               "poisson_vector",
                                                               "reaction_torque",
                                                               "angle",
                                                               "displacement",
                                                               "rate",
                                                               "displacement_rate",
                                                               "angles",
                                                               "rates",
                                                               "length",
                                                               "coupling_force"};
};

// --- values with a form of their own ---

/// A body by its name; a whole number in these classes is the index of one.
Json put(int body, Writing& w);
int take(const Place& p, Tag<int>);
/// [begin, end]
Json put(const Domain& domain, Writing& w);
Domain take(const Place& p, Tag<Domain>);
/// A quaternion [w, x, y, z], or the Euler angles it was given by.
Json put(const Attitude& attitude, Writing& w);
Attitude take(const Place& p, Tag<Attitude>);
Json put(const Curve& curve, Writing& w);
Curve take(const Place& p, Tag<Curve>);
/// A number, or a function of time.
Json put(const TimeFunction& f, Writing& w);
TimeFunction take(const Place& p, Tag<TimeFunction>);
Json put(const RigidMotion& motion, Writing& w);
RigidMotion take(const Place& p, Tag<RigidMotion>);
/// {"body": name}, {"body": name, "point": [...]} or, of the world, {"point": [...]}.
Json put(const End& end, Writing& w);
End take(const Place& p, Tag<End>);
Json put(const WatchFunction& f, Writing& w);
WatchFunction take(const Place& p, Tag<WatchFunction>);
Json put(const RecordedAction& action, Writing& w);
RecordedAction take(const Place& p, Tag<RecordedAction>);

/// Throws InvalidInput: what is called back is no data.
[[noreturn, gnu::cold]] void refuse_called_back(const std::string& who, const Callback& callback);

// --- bodies and curves ---

template <>
struct Described<EulerAngles> {
    static constexpr std::string_view kind = "Euler angles";
    static constexpr tuple fields{need("theta", &EulerAngles::theta), need("psi", &EulerAngles::psi),
                                  need("phi", &EulerAngles::phi)};
};
template <>
struct Described<Particle> {
    static constexpr std::string_view kind = "particle";
    static constexpr tuple fields{need("mass", &Particle::mass)};
};
struct BodyParts {
    DoubleDouble mass;
    Vector3Of<DoubleDouble> com;
    Matrix3Of<DoubleDouble> inertia;
    InertiaAbout about = InertiaAbout::com;
};
template <>
struct Described<BodyParts> {
    static constexpr tuple fields{need("mass", &BodyParts::mass), need("inertia", &BodyParts::inertia),
                                  need("com", &BodyParts::com), usual("inertia_about", &BodyParts::about)};
};
template <>
struct Described<RigidBody> {
    static constexpr std::string_view kind = "rigid body";
    static BodyParts parts(const RigidBody& b) {
        return {b.given().mass, b.given().com, b.given().inertia, b.inertia_about()};
    }
    static RigidBody made(BodyParts p) { return RigidBody(MassProperties{p.mass, p.com, p.inertia}, p.about); }
};
template <>
struct Described<Line> {
    static constexpr std::string_view kind = "line";
    static constexpr tuple fields{need("direction", &Line::direction), usual("point", &Line::point)};
};
template <>
struct Described<Circle> {
    static constexpr std::string_view kind = "circle";
    static constexpr tuple fields{need("radius", &Circle::radius), need("start", &Circle::start),
                                  need("toward", &Circle::toward), usual("center", &Circle::center)};
};
template <>
struct Described<Parabola> {
    static constexpr std::string_view kind = "parabola";
    static constexpr tuple fields{need("a", &Parabola::a), need("x", &Parabola::x), need("y", &Parabola::y),
                                  usual("vertex", &Parabola::vertex)};
};
template <>
struct Described<Cycloid> {
    static constexpr std::string_view kind = "cycloid";
    static constexpr tuple fields{need("radius", &Cycloid::radius), need("x", &Cycloid::x), need("y", &Cycloid::y),
                                  usual("vertex", &Cycloid::vertex)};
};
template <>
struct Described<Helix> {
    static constexpr std::string_view kind = "helix";
    static constexpr tuple fields{need("radius", &Helix::radius), need("pitch", &Helix::pitch),
                                  need("start", &Helix::start), need("toward", &Helix::toward),
                                  usual("center", &Helix::center)};
};
template <>
struct Described<Polynomial> {
    static constexpr std::string_view kind = "polynomial";
    static constexpr tuple fields{need("coefficients", &Polynomial::coefficients),
                                  usual("domain", &Polynomial::domain)};
};
template <>
struct Described<Spline> {
    static constexpr std::string_view kind = "spline";
    static constexpr tuple fields{need("points", &Spline::points), usual("closed", &Spline::closed),
                                  usual("slopes", &Spline::slopes)};
};
template <>
struct Described<FunctionCurve> {
    static constexpr std::string_view kind = "curve";
    static constexpr tuple fields{need("function", &FunctionCurve::function), usual("domain", &FunctionCurve::domain),
                                  usual("closed", &FunctionCurve::closed), usual("label", &FunctionCurve::label)};
};

// --- joints ---

template <>
struct Described<Coulomb> {
    static constexpr std::string_view kind = "Coulomb";
    static constexpr tuple fields{need("mu_static", &Coulomb::mu_static), usual("mu_dynamic", &Coulomb::mu_dynamic),
                                  usual("rolling", &Coulomb::rolling), usual("pivoting", &Coulomb::pivoting)};
};
template <>
struct Described<Free> {
    static constexpr std::string_view kind = "free";
    static constexpr tuple<> fields{};
};
struct RailParts {
    std::optional<Curve> curve;
    std::optional<Coulomb> friction;
    TimeFunction drive;
    RigidMotion motion;
    RailSide side = RailSide::both;
    RailEnds ends = RailEnds::stop;
    std::optional<Vector3> up;
};
template <>
struct Described<RailParts> {
    static constexpr tuple fields{need("curve", &RailParts::curve),  usual("friction", &RailParts::friction),
                                  usual("drive", &RailParts::drive), usual("motion", &RailParts::motion),
                                  usual("side", &RailParts::side),   usual("ends", &RailParts::ends),
                                  usual("up", &RailParts::up)};
};
template <>
struct Described<Rail> {
    static constexpr std::string_view kind = "rail";
    static RailParts parts(const Rail& r) {
        return {r.curve(), r.given_friction(), r.drive(), r.motion(), r.side(), r.ends(), r.up()};
    }
    static Rail made(RailParts p) {
        if (!p.curve) throw InvalidInput("it has no curve");
        return {*p.curve, p.friction, {p.drive, p.motion, p.side, p.ends, p.up}};
    }
};
template <>
struct Described<Spherical> {
    static constexpr std::string_view kind = "spherical";
    static constexpr tuple fields{usual("at", &Spherical::at), usual("point", &Spherical::point)};
};
template <>
struct Described<Revolute> {
    static constexpr std::string_view kind = "revolute";
    static constexpr tuple fields{need("axis", &Revolute::axis),          usual("at", &Revolute::at),
                                  usual("point", &Revolute::point),       usual("motion", &Revolute::motion),
                                  usual("friction", &Revolute::friction), usual("pin_radius", &Revolute::pin_radius)};
};
template <>
struct Described<Prismatic> {
    static constexpr std::string_view kind = "prismatic";
    static constexpr tuple fields{need("axis", &Prismatic::axis), usual("at", &Prismatic::at),
                                  usual("point", &Prismatic::point), usual("motion", &Prismatic::motion),
                                  usual("friction", &Prismatic::friction)};
};
template <>
struct Described<Universal> {
    static constexpr std::string_view kind = "universal";
    static constexpr tuple fields{need("first", &Universal::first), need("second", &Universal::second),
                                  usual("at", &Universal::at), usual("point", &Universal::point)};
};
template <>
struct Described<Cylindrical> {
    static constexpr std::string_view kind = "cylindrical";
    static constexpr tuple fields{need("axis", &Cylindrical::axis), usual("at", &Cylindrical::at),
                                  usual("point", &Cylindrical::point)};
};
template <>
struct Described<Planar> {
    static constexpr std::string_view kind = "planar";
    static constexpr tuple fields{need("x", &Planar::x), need("y", &Planar::y), usual("at", &Planar::at)};
};
template <>
struct Described<Fixed> {
    static constexpr std::string_view kind = "fixed";
    static constexpr tuple fields{usual("attitude", &Fixed::attitude), usual("at", &Fixed::at),
                                  usual("point", &Fixed::point)};
};

// --- loads and couplings ---

/// A constant vector or a recorded function, in a frame.
struct LawParts {
    std::optional<Vector3> vector;
    std::optional<Function> function;
    std::string name;
    Frame frame = Frame::world;
};
template <>
struct Described<LawParts> {
    static constexpr tuple fields{usual("vector", &LawParts::vector), usual("function", &LawParts::function),
                                  usual("name", &LawParts::name), need("frame", &LawParts::frame)};
};
template <class Law>
LawParts law_parts(const Law& law, const std::string& who) {
    if (law.callback()) refuse_called_back(who, *law.callback());
    if (law.function()) return {std::nullopt, law.function(), law.name(), law.frame()};
    return {law.constant(), std::nullopt, {}, law.frame()};
}
template <class Law>
Law law_made(LawParts p) {
    if (p.vector.has_value() == p.function.has_value())
        throw InvalidInput("it has a vector or a function, one of them");
    if (p.vector) return Law(*p.vector, p.frame);
    return Law(*std::move(p.function), p.name, p.frame);
}
template <>
struct Described<Force> {
    static constexpr std::string_view kind = "force";
    static LawParts parts(const Force& f) { return law_parts(f, "Force"); }
    static Force made(LawParts p) { return law_made<Force>(std::move(p)); }
};
template <>
struct Described<Torque> {
    static constexpr std::string_view kind = "torque";
    static LawParts parts(const Torque& f) { return law_parts(f, "Torque"); }
    static Torque made(LawParts p) { return law_made<Torque>(std::move(p)); }
};
/// A recorded function with its name; none: one that does nothing.
struct FunctionParts {
    std::optional<Function> function;
    std::string name;
};
template <>
struct Described<FunctionParts> {
    static constexpr tuple fields{usual("function", &FunctionParts::function), usual("name", &FunctionParts::name)};
};
template <>
struct Described<Potential> {
    static constexpr std::string_view kind = "potential";
    static FunctionParts parts(const Potential& p) { return {p.function(), p.name()}; }
    static Potential made(FunctionParts p) {
        if (!p.function) throw InvalidInput("it has no function");
        return Potential(*std::move(p.function), p.name);
    }
};
template <class Pair>
struct DescribedPair {
    static FunctionParts parts(const Pair& pair) {
        if (pair.law().callback()) refuse_called_back(std::string(Described<Pair>::kind), *pair.law().callback());
        if (!pair.law()) return {};
        return {pair.law().function(), pair.law().name()};
    }
    static Pair made(FunctionParts p) { return p.function ? Pair(*std::move(p.function), p.name) : Pair(); }
};
template <>
struct Described<Central> : DescribedPair<Central> {
    static constexpr std::string_view kind = "central force";
};
template <>
struct Described<PairForce> : DescribedPair<PairForce> {
    static constexpr std::string_view kind = "pair force";
};
struct JointLoadParts {
    std::optional<Given> number;
    std::optional<Function> function;
    std::string name;
};
template <>
struct Described<JointLoadParts> {
    static constexpr tuple fields{usual("number", &JointLoadParts::number),
                                  usual("function", &JointLoadParts::function), usual("name", &JointLoadParts::name)};
};
template <class Load>
struct DescribedJointLoad {
    static JointLoadParts parts(const Load& load) {
        if (load.callback()) refuse_called_back(std::string(Described<Load>::kind), *load.callback());
        if (load.function()) return {std::nullopt, load.function(), load.name()};
        return {load.constant(), std::nullopt, {}};
    }
    static Load made(JointLoadParts p) {
        if (p.number.has_value() == p.function.has_value())
            throw InvalidInput("it has a number or a function, one of them");
        return p.number ? Load(JointLoad(*p.number)) : Load(JointLoad(*std::move(p.function), p.name));
    }
};
template <>
struct Described<JointTorque> : DescribedJointLoad<JointTorque> {
    static constexpr std::string_view kind = "joint torque";
};
template <>
struct Described<JointForce> : DescribedJointLoad<JointForce> {
    static constexpr std::string_view kind = "joint force";
};
template <>
struct Described<Lorentz> {
    static constexpr std::string_view kind = "Lorentz";
    static constexpr tuple fields{need("strength", &Lorentz::strength), need("field", &Lorentz::field)};
};
template <>
struct Described<Drag> {
    static constexpr std::string_view kind = "drag";
    static constexpr tuple fields{usual("linear", &Drag::linear), usual("quadratic", &Drag::quadratic)};
};
template <>
struct Described<TorsionSpring> {
    static constexpr std::string_view kind = "torsion spring";
    static constexpr tuple fields{need("stiffness", &TorsionSpring::stiffness),
                                  usual("rest_angle", &TorsionSpring::rest_angle),
                                  usual("damping", &TorsionSpring::damping)};
};
template <>
struct Described<Spring> {
    static constexpr std::string_view kind = "spring";
    static constexpr tuple fields{need("stiffness", &Spring::stiffness), usual("rest_length", &Spring::rest_length),
                                  usual("damping", &Spring::damping)};
};
template <>
struct Described<Gravitation> {
    static constexpr std::string_view kind = "gravitation";
    static constexpr tuple fields{need("constant", &Gravitation::constant)};
};

// --- constraints and contacts ---

template <>
struct Described<Plane> {
    static constexpr std::string_view kind = "plane";
    static constexpr tuple fields{need("normal", &Plane::normal), usual("point", &Plane::point)};
};
template <>
struct Described<Sphere> {
    static constexpr std::string_view kind = "sphere";
    static constexpr tuple fields{need("center", &Sphere::center), need("radius", &Sphere::radius),
                                  usual("inside", &Sphere::inside)};
};
template <>
struct Described<Ball> {
    static constexpr std::string_view kind = "ball";
    static constexpr tuple<> fields{};
};
template <>
struct Described<Rod> {
    static constexpr std::string_view kind = "rod";
    static constexpr tuple fields{need("length", &Rod::length)};
};
template <>
struct Described<Weld> {
    static constexpr std::string_view kind = "weld";
    static constexpr tuple<> fields{};
};
template <>
struct Described<Hinge> {
    static constexpr std::string_view kind = "hinge";
    static constexpr tuple fields{need("axis", &Hinge::axis)};
};
template <>
struct Described<PointOnPlane> {
    static constexpr std::string_view kind = "point on plane";
    static constexpr tuple fields{need("plane", &PointOnPlane::plane)};
};
struct CurveParts {
    std::optional<Curve> curve;
};
template <>
struct Described<CurveParts> {
    static constexpr tuple fields{need("curve", &CurveParts::curve)};
};
template <>
struct Described<PointOnCurve> {
    static constexpr std::string_view kind = "point on curve";
    static CurveParts parts(const PointOnCurve& p) { return {p.curve}; }
    static PointOnCurve made(CurveParts p) {
        if (!p.curve) throw InvalidInput("it has no curve");
        return {*p.curve};
    }
};
template <>
struct Described<BodyHandle> {
    static constexpr std::string_view kind = "body";
    static constexpr tuple fields{need("body", &BodyHandle::index)};
};
template <>
struct Described<BodyPoint> {
    static constexpr std::string_view kind = "body point";
    static constexpr tuple fields{need("body", &BodyPoint::body), need("point", &BodyPoint::point)};
};
template <>
struct Described<BodySphere> {
    static constexpr std::string_view kind = "body sphere";
    static constexpr tuple fields{need("body", &BodySphere::body), need("radius", &BodySphere::radius),
                                  usual("center", &BodySphere::center)};
};
template <>
struct Described<BodyDisc> {
    static constexpr std::string_view kind = "body disc";
    static constexpr tuple fields{need("body", &BodyDisc::body), need("radius", &BodyDisc::radius),
                                  need("normal", &BodyDisc::normal), usual("center", &BodyDisc::center)};
};
template <>
struct Described<BodyEllipsoid> {
    static constexpr std::string_view kind = "body ellipsoid";
    static constexpr tuple fields{need("body", &BodyEllipsoid::body), need("semi_axes", &BodyEllipsoid::semi_axes),
                                  usual("center", &BodyEllipsoid::center), usual("attitude", &BodyEllipsoid::attitude)};
};
template <>
struct Described<BodyPlane> {
    static constexpr std::string_view kind = "body plane";
    static constexpr tuple fields{need("body", &BodyPlane::body), need("plane", &BodyPlane::plane)};
};

}  // namespace rbdyn::inline RBDYN_FORM::file
