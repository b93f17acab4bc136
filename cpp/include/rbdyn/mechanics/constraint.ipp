// Definitions of rbdyn/mechanics/constraint.hpp.
#pragma once

#include "rbdyn/mechanics/constraint.hpp"

#include <algorithm>
#include <cmath>
#include <variant>
#include <vector>

#include "rbdyn/basics/double_double_functions.hpp"
#include "rbdyn/basics/double_double_vector.hpp"
#include "rbdyn/basics/error.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/mechanics/joint/held.hpp"
#include "rbdyn/scene/constraints.hpp"
#include "rbdyn/scene/contacts.hpp"
#include "rbdyn/scene/handles.hpp"
#include "rbdyn/scene/surfaces.hpp"

namespace rbdyn::inline RBDYN_FORM::mechanics {

namespace contacts {

/// A contact with what is fixed in its bodies.
inline ContactLaw law_of(const Scene::Touch& touch, const Tree& tree) {
    ContactLaw c;
    c.name = touch.name;
    c.is_gone = touch.is_gone;
    c.restitution = touch.options.restitution;
    if (const auto& friction = touch.options.friction; friction && !c.is_gone) {
        c.mu_static = friction->mu_static;
        c.mu_dynamic = friction->mu_dynamic.value_or(friction->mu_static);
        c.rolling = friction->rolling;
        c.pivoting = friction->pivoting;
        if (friction->has_torques() && !std::holds_alternative<Plane>(touch.b) &&
            !std::holds_alternative<BodyPlane>(touch.b))
            throw InvalidInput(touch.name +
                               ": friction against rolling or pivoting acts on planes alone in this version; leave "
                               "rolling and pivoting out where b is a sphere");
    }
    const auto from_held = [&](int body, const Vector3& p) {
        const Node& n = tree.node(body);
        return Anchor{body, n.is_point ? Vector3Of<DoubleDouble>{} : n.from_held(p)};
    };
    if (const BodyHandle* body = std::get_if<BodyHandle>(&touch.a)) c.a = tree.anchor(*body);
    if (const BodyPoint* point = std::get_if<BodyPoint>(&touch.a)) c.a = from_held(point->body, point->point);
    if (const BodySphere* ball = std::get_if<BodySphere>(&touch.a)) {
        c.a = from_held(ball->body, ball->center);
        c.radius = ball->radius;
    }
    if (const BodyDisc* disc = std::get_if<BodyDisc>(&touch.a)) {
        c.part = ContactLaw::Part::disc;
        c.a = from_held(disc->body, disc->center);
        c.radius = disc->radius;
        c.axis = unit(disc->normal);
    }
    if (const BodyEllipsoid* solid = std::get_if<BodyEllipsoid>(&touch.a)) {
        c.part = ContactLaw::Part::ellipsoid;
        c.a = from_held(solid->body, solid->center);
        const Matrix3Of<DoubleDouble> own = rotation_matrix(solid->attitude.exact());
        for (int k = 0; k < 3; ++k) c.own[k] = scaled(own.col(k), solid->semi_axes[k]);
    }
    const auto take_plane = [&](const Plane& plane, int body) {
        c.normal = unit(plane.normal);
        c.given = widened(Vector3(plane.normal * std::ldexp(1.0, -std::ilogb(safe_norm(plane.normal)))));
        Vector3 least = Vector3::Zero();
        least[rbdyn::least(sizes(rounded(c.normal)))] = 1.0;
        c.tangents[0] = unit_across(least, c.normal);
        c.tangents[1] = cross<DoubleDouble>(c.normal, c.tangents[0]);
        c.b = body < 0 ? Anchor{-1, widened(plane.point)} : from_held(body, plane.point);
    };
    const auto take_sphere = [&](const Anchor& center, double radius, bool inside) {
        c.surface = inside ? ContactLaw::Surface::bowl : ContactLaw::Surface::ball;
        c.b = center;
        c.surface_radius = radius;
        if (const BodyEllipsoid* solid = std::get_if<BodyEllipsoid>(&touch.a))
            c.nearest_of.emplace(solid->semi_axes, radius, inside);
    };
    if (const Plane* plane = std::get_if<Plane>(&touch.b)) take_plane(*plane, -1);
    if (const BodyPlane* plane = std::get_if<BodyPlane>(&touch.b)) take_plane(plane->plane, plane->body);
    if (const Sphere* ball = std::get_if<Sphere>(&touch.b))
        take_sphere({-1, widened(ball->center)}, ball->radius, ball->inside);
    if (const BodySphere* ball = std::get_if<BodySphere>(&touch.b))
        take_sphere(from_held(ball->body, ball->center), ball->radius, false);
    return c;
}

/// The longest arm (Conditions::arm).
inline double longest_arm(const Tree& tree, const std::vector<Condition>& conditions,
                          const std::vector<ContactLaw>& contacts) {
    double most = 0.0;
    const auto take = [&](const Anchor& end) {
        if (end.body >= 0) most = std::max(most, safe_norm(rounded(end.point)));
    };
    for (const Node& n : tree.nodes()) {
        most = std::max(most, safe_norm(rounded(n.center)));
        const auto& inertia = n.body.inertia;
        const double mass = static_cast<double>(n.mass);
        if (!n.is_point && mass > 0.0)
            most = std::max(most, std::sqrt(static_cast<double>(inertia(0, 0) + inertia(1, 1) + inertia(2, 2)) / mass));
    }
    for (const Condition& c : conditions) {
        take(c.a);
        take(c.b);
        most = std::max(most, c.length.hi);
    }
    for (const ContactLaw& c : contacts) {
        take(c.a);
        take(c.b);
        most = std::max(most, c.radius.hi);
    }
    return most;
}

/// Whether a unit vector is along no axis of the world, but for rounding.
inline bool is_askew(const Vector3& direction) {
    int along = 0;
    for (const double part : direction) along += std::abs(part) > 0x1p-50 ? 1 : 0;
    return along > 1;
}

/// Whether its plane starts across no axis of the world.
inline bool leans(const ContactLaw& c, const std::vector<Moving<DoubleDouble>>& start) {
    if (c.surface != ContactLaw::Surface::plane) return false;
    Moving<DoubleDouble> on;
    if (c.b.body >= 0) on = start[static_cast<std::size_t>(c.b.body)];
    return is_askew(rounded(on.to_world(c.normal)));
}

/// The normal, in the world, of the plane that joints keep both bodies of a contact in, if it is along no axis of the
/// world.
inline std::optional<Vector3Of<DoubleDouble>> plane_of(const ContactLaw& c, const Tree& tree,
                                                       const std::vector<Moving<DoubleDouble>>& start) {
    constexpr double rounding = 16.0 * std::numeric_limits<double>::epsilon();
    std::optional<Vector3Of<DoubleDouble>> plane;
    for (const int body : {c.a.body, c.b.body}) {
        if (body < 0) continue;
        const Node& n = tree.node(body);
        const PlanarLaw* law = n.parent < 0 ? n.joint.as<PlanarLaw>() : nullptr;
        if (law == nullptr) return std::nullopt;
        if (plane && rounded(*plane).cross(rounded(law->normal)).norm() > rounding) return std::nullopt;
        if (!plane) plane = law->normal;
    }
    if (!plane) return std::nullopt;
    const Vector3 n = rounded(*plane);
    if (!is_askew(n)) return std::nullopt;
    Vector3 normal = Vector3::Zero();
    if (c.surface == ContactLaw::Surface::plane) {
        Moving<DoubleDouble> on;
        if (c.b.body >= 0) on = start[static_cast<std::size_t>(c.b.body)];
        normal = rounded(on.to_world(c.normal));
    } else if (c.part == ContactLaw::Part::ball) {
        const Vector3Of<DoubleDouble> apart =
            tree.point<DoubleDouble>(c.a, start).place - tree.point<DoubleDouble>(c.b, start).place;
        normal = rounded(apart).normalized();
    }
    if (!(normal.norm() > 0.5) || std::abs(n.dot(normal)) > rounding) return std::nullopt;
    return plane;
}

}  // namespace contacts

RBDYN_INLINE Conditions::Conditions(const Scene& scene, const Tree& tree,
                                    const std::vector<Moving<DoubleDouble>>& start) {
    using Wide = Vector3Of<DoubleDouble>;
    const Moving<DoubleDouble> ground;
    int feet = 0;
    for (const Scene::Held& held : scene.constraints()) {
        Condition c;
        c.name = held.name;
        c.a = tree.anchor(held.a);
        c.b = tree.anchor(held.b);
        const auto body = [&](const Anchor& anchor) -> const Moving<DoubleDouble>& {
            return anchor.body < 0 ? ground : start[static_cast<std::size_t>(anchor.body)];
        };
        const Moving<DoubleDouble>&a = body(c.a), &b = body(c.b);
        // held to the world without a place of it: where it starts
        if (c.b.body < 0 && !std::holds_alternative<Vector3>(held.b))
            c.b.point = tree.point<DoubleDouble>(c.a, start).place;
        // welded to a body without a point of it: there, too
        if (std::holds_alternative<Weld>(held.constraint) && std::holds_alternative<BodyHandle>(held.b) &&
            c.b.body >= 0)
            c.b.point = b.to_body(tree.point<DoubleDouble>(c.a, start).place - b.place);
        const auto across = [&](const Wide& axis) {
            // two directions across an axis of b, as a has them now
            const Wide world = b.to_world(axis);
            const Vector3 near = rounded(world);
            Vector3 least = Vector3::Zero();
            least[rbdyn::least(sizes(near))] = 1.0;
            const Wide u = unit_across(least, world), w = cross<DoubleDouble>(world, u);
            c.angles.push_back({a.to_body(u), axis});
            c.angles.push_back({a.to_body(w), axis});
            return u;
        };
        if (const Rod* rod = std::get_if<Rod>(&held.constraint)) {
            c.points = Condition::Points::distance;
            c.length = rod->length;
        } else if (const PointOnPlane* on = std::get_if<PointOnPlane>(&held.constraint)) {
            c.points = Condition::Points::plane;
            c.normal = unit(on->plane.normal);
            // the plane's point, in the axes of b
            c.b.point = widened(on->plane.point);
            if (c.b.body >= 0) c.b.point -= tree.node(c.b.body).joint.held().point;
        } else if (const Hinge* hinge = std::get_if<Hinge>(&held.constraint)) {
            across(unit(hinge->axis));
        } else if (std::holds_alternative<Weld>(held.constraint)) {
            for (int k = 0; k < 3; ++k) {
                Wide one{}, next{};
                one[k] = 1.0;
                next[(k + 1) % 3] = 1.0;
                // axis k of a, and the next one as b has it now
                c.angles.push_back({one, b.to_body(a.to_world(next))});
            }
        } else if (const Universal* joint = std::get_if<Universal>(&held.constraint)) {
            const Wide first = unit(joint->first);
            c.angles.push_back({first, unit(joint->second)});
        } else if (const PointOnCurve* along = std::get_if<PointOnCurve>(&held.constraint)) {
            c.points = Condition::Points::curve;
            c.foot = feet++;
            // a point of the curve, in the axes of b
            const Domain d = along->curve.domain();
            c.b.point = widened(along->curve.position(std::isfinite(d.begin) ? d.begin : 0.0));
            if (c.b.body >= 0) c.b.point -= tree.node(c.b.body).joint.held().point;
        }
        c.first = rows_;
        rows_ += c.rows();
        conditions_.push_back(std::move(c));
    }
    for (const Scene::Touch& touch : scene.contacts()) {
        contacts_.push_back(contacts::law_of(touch, tree));
        is_rough_ = is_rough_ || contacts_.back().is_rough();
        const int contact = static_cast<int>(contacts_.size()) - 1;
        if (!contacts_.back().rolling.is_zero()) resistances_.push_back({contact, false});
        if (!contacts_.back().pivoting.is_zero())
            resistances_.push_back({contact, true});
        else if (!contacts_.back().rolling.is_zero())
            resistances_.push_back({contact, true, true});
    }
    // what touches once bears all of its load, and needs no axes of its own
    for (ContactLaw& c : contacts_) {
        const auto shares = [&](const ContactLaw& other) {
            return &other != &c && (other.a.body == c.a.body || other.b.body == c.a.body ||
                                    (c.b.body >= 0 && (other.a.body == c.b.body || other.b.body == c.b.body)));
        };
        if (c.is_rough()) c.across = contacts::plane_of(c, tree, start);
        c.is_along_plane = contacts::leans(c, start) && std::ranges::any_of(contacts_, shares);
        if (!c.never_slips() || tree.node(c.a.body).joint.as<FreeBodyLaw>() == nullptr) continue;
        for (const ContactLaw& other : contacts_)
            if (shares(other) && other.never_slips()) c.beside.push_back(static_cast<int>(&other - contacts_.data()));
    }
    arm_ = contacts::longest_arm(tree, conditions_, contacts_);
}

RBDYN_INLINE std::vector<double> Conditions::measures() const {
    // what turns has an arm, if only that of inertia
    const double turning = arm_ > 0.0 ? 1.0 / arm_ : 1.0;
    std::vector<double> measures(static_cast<std::size_t>(rows()), 1.0);
    const auto put = [&](int first, int count, double measure) {
        std::fill_n(measures.begin() + first, count, measure);
    };
    for (const Condition& c : conditions_) {
        const int angles = static_cast<int>(c.angles.size());
        if (c.points == Condition::Points::distance) put(c.first, 1, c.length.hi);
        put(c.first + c.rows() - angles, angles, turning);
    }
    put(first_of_resistances(), 2 * static_cast<int>(resistances_.size()), turning);
    for (std::size_t i = 0; i < joints_.size(); ++i)
        if (joints_[i].turns) put(joint_row(static_cast<int>(i)), 1, turning);
    return measures;
}

RBDYN_INLINE void Conditions::tell_along(int constraint, const Vector3& last) {
    Condition& c = conditions_[static_cast<std::size_t>(constraint)];
    Vector3 least = Vector3::Zero();
    least[rbdyn::least(sizes(last))] = 1.0;
    const Vector3Of<DoubleDouble> n = unit(last), u = unit_across(least, n);
    c.axes = Condition::Axes::fixed;
    c.fixed = {u, cross<DoubleDouble>(n, u), n};
}

RBDYN_INLINE double Conditions::gap(const Tree& tree, int index, const std::vector<Moving<double>>& all) const {
    const Condition& c = conditions_[static_cast<std::size_t>(index)];
    const Ends<double> ends(tree, c, all);
    double squares = 0.0;
    if (c.points == Condition::Points::coincide) squares += ends.apart.squaredNorm();
    if (c.points == Condition::Points::distance)
        squares += std::pow(ends.apart.norm() - static_cast<double>(c.length), 2);
    if (c.points == Condition::Points::plane)
        squares += std::pow(dot<double>(ends.b.to_world(exactly<double>(c.normal)), ends.apart), 2);
    if (c.points == Condition::Points::curve)
        squares += (tree.point<double>(c.a, all).place - foot_of<double>(tree, c, all).place).squaredNorm();
    for (const Condition::RightAngle& angle : c.angles)
        squares += std::pow(arm_ * dot<double>(ends.a.to_world(exactly<double>(angle.in_a)),
                                               ends.b.to_world(exactly<double>(angle.in_b))),
                            2);
    return std::sqrt(squares);
}

}  // namespace rbdyn::inline RBDYN_FORM::mechanics
