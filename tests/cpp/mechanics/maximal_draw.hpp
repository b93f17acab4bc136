// Definitions of mechanics/maximal.hpp: how trees and loops are drawn.
#pragma once

#include "mechanics/maximal.hpp"

namespace rbdyn::test {

inline void Maximal::add(Random& random, const Draw& draw) {
    const int i = static_cast<int>(parts_.size());
    Part p;
    p.kind = static_cast<Kind>(random.whole(0, static_cast<int>(draw.driven ? Kind::count : Kind::turned) - 1));
    p.parent = random.chance(0.2) ? -1 : random.whole(-1, i - 1);
    if (p.parent >= 0 && is_bead(static_cast<std::size_t>(p.parent))) p.parent = -1;
    if (draw.beads && random.chance(0.2)) return add_bead(random, p);
    // a free one with a parent only starts there
    const BodyHandle parent{p.parent};
    const RigidBody body = random_body(random);
    p.mass = body.mass();
    p.center = wide(body.com());
    p.inertia = body.inertia().cast<Real>();
    const Vector3 at = random_vector(random, 1.5), point = random_vector(random, 1.0),
                  axis = random.uniform(0.5, 2.0) * random.direction();
    const Vector3 other = random.uniform(0.5, 2.0) * axis.cross(random.direction()).normalized();
    const Quaternion attitude = random_attitude(random);
    const Vector3 omega = random_vector(random, 3.0), velocity = random_vector(random, 2.0);
    const std::array<double, 3> q{random.uniform(-3, 3), random.uniform(-2, 2), random.uniform(-3, 3)},
        v{random.uniform(-3, 3), random.uniform(-3, 3), random.uniform(-3, 3)};
    p.at = wide(at);
    p.point = wide(point);
    p.first = wide(axis).normalized();
    p.second = (wide(other) - p.first * p.first.dot(wide(other))).normalized();
    for (std::size_t k = 0; k < 3; ++k) {
        p.q[k] = q[k];
        p.v[k] = v[k];
    }
    const Real w = attitude.w, x = attitude.x, y = attitude.y, z = attitude.z,
               s = 2.0L / (w * w + x * x + y * y + z * z);
    p.attitude << 1 - s * (y * y + z * z), s * (x * y - w * z), s * (x * z + w * y), s * (x * y + w * z),
        1 - s * (x * x + z * z), s * (y * z - w * x), s * (x * z - w * y), s * (y * z + w * x), 1 - s * (x * x + y * y);
    p.omega = wide(omega);
    p.velocity = wide(velocity);
    const double a = random.uniform(-4, 4);
    const auto way = [&](double first, double rate) {
        return TimeFunction([=](const auto& t) { return first + t * (rate + 0.5 * a * t); });
    };
    switch (p.kind) {
        case Kind::free:
            handles.push_back(scene.add(body, Free{},
                                        {.position = at,
                                         .velocity = velocity,
                                         .attitude = attitude,
                                         .angular_velocity = omega,
                                         .parent = parent}));
            break;
        case Kind::spherical:
            handles.push_back(scene.add(body, Spherical{.at = at, .point = point},
                                        {.attitude = attitude, .angular_velocity = omega, .parent = parent}));
            break;
        case Kind::revolute:
            handles.push_back(scene.add(body, Revolute{.axis = axis, .at = at, .point = point},
                                        {.angle = q[0], .rate = v[0], .parent = parent}));
            break;
        case Kind::prismatic:
            handles.push_back(scene.add(body, Prismatic{.axis = axis, .at = at, .point = point},
                                        {.displacement = q[0], .rate = v[0], .parent = parent}));
            break;
        case Kind::universal:
            handles.push_back(scene.add(body, Universal{.first = axis, .second = other, .at = at, .point = point},
                                        {.angles = {q[0], q[1]}, .rates = {v[0], v[1]}, .parent = parent}));
            break;
        case Kind::cylindrical:
            handles.push_back(scene.add(
                body, Cylindrical{.axis = axis, .at = at, .point = point},
                {.angle = q[0], .rate = v[0], .displacement = q[1], .displacement_rate = v[1], .parent = parent}));
            break;
        case Kind::planar: {
            p.point = Vec::Zero();
            const Vector3 ex = axis.normalized(), ey = other.normalized();
            p.first = wide(ex).normalized();
            p.second = (wide(ey) - p.first * p.first.dot(wide(ey))).normalized();
            handles.push_back(scene.add(
                body, Planar{.x = ex, .y = ey, .at = at},
                {.position = {q[0], q[1]}, .velocity = {v[0], v[1]}, .angle = q[2], .rate = v[2], .parent = parent}));
            break;
        }
        case Kind::fixed:
            handles.push_back(
                scene.add(body, Fixed{.attitude = attitude, .at = at, .point = point}, {.parent = parent}));
            break;
        case Kind::turned:
            p.drive = a;
            handles.push_back(scene.add(
                body, Revolute{.axis = axis, .at = at, .point = point, .motion = way(q[0], v[0])}, {.parent = parent}));
            break;
        default:
            p.drive = a;
            handles.push_back(scene.add(body,
                                        Prismatic{.axis = axis, .at = at, .point = point, .motion = way(q[0], v[0])},
                                        {.parent = parent}));
    }
    parts_.push_back(p);
}

/// At u = 0 of a circle of its parent.
inline void Maximal::add_bead(Random& random, Part p) {
    const double mass = random.uniform(0.5, 2.0), radius = random.uniform(0.3, 1.5), speed = random.uniform(-3, 3);
    const Vector3 start = random.direction(), center = random_vector(random, 1.0),
                  toward = start.cross(random.direction()).normalized();
    const Vec radial = wide(start).normalized();
    p.kind = Kind::bead;
    p.mass = mass;
    p.first = -radial * radius;
    p.second = radial.cross(wide(toward)).normalized();
    p.at = wide(center) - p.first;
    p.v[0] = speed;
    handles.push_back(scene.add(Particle{mass}, Rail(Circle{radius, start, toward, center}),
                                {.parameter = 0.0, .speed = speed, .parent = BodyHandle{p.parent}}));
    parts_.push_back(p);
}

/// Loads and couplings anywhere.
inline void Maximal::load(Random& random, const Draw& draw) {
    const bool damped = draw.damped;
    const int n = static_cast<int>(parts_.size());
    const int count = random.whole(0, n);
    for (int k = 0; k < count; ++k) {
        const int body = random.whole(0, n - 1);
        const Vector3 value = random_vector(random, 5.0), point = random_vector(random, 1.0);
        const bool in_body = random.chance(0.5);
        const int kind = damped ? random.whole(0, 3) : 3;
        Applied l{kind, body, wide(value), wide(point), in_body, 0, 0, 0};
        const Kind joint = parts_[static_cast<std::size_t>(body)].kind;
        const bool turns =
            joint == Kind::revolute || joint == Kind::cylindrical || joint == Kind::universal || joint == Kind::planar;
        const double one = random.uniform(1, 8), two = random.uniform(-1, 1),
                     three = damped ? random.uniform(0, 0.5) : 0.0;
        l.one = one;
        l.two = two;
        l.three = three;
        const BodyHandle b = handles[static_cast<std::size_t>(body)];
        if (is_bead(static_cast<std::size_t>(body)) || (kind == 3 && !draw.springs)) continue;
        if (kind == 0)
            scene.apply(Force(value, in_body ? Frame::body : Frame::world), b, point);
        else if (kind == 1)
            scene.apply(Torque(value, in_body ? Frame::body : Frame::world), b);
        else if (kind == 2)
            scene.apply(Drag{.linear = one, .quadratic = three}, b, point);
        else if (turns)
            scene.apply(TorsionSpring{.stiffness = one, .rest_angle = two, .damping = three}, b);
        else
            continue;
        loads_.push_back(l);
    }
    const int couplings = random.whole(0, n);
    for (int k = 0; k < couplings; ++k) {
        const int a = random.whole(0, n - 1), b = random.whole(-1, n - 1);
        if (a == b) continue;
        const auto at = [&](int body) {
            const Vector3 point = random_vector(random, 1.0);
            return body >= 0 && is_bead(static_cast<std::size_t>(body)) ? Vector3(Vector3::Zero()) : point;
        };
        const Vector3 at_a = at(a), at_b = at(b);
        const double stiffness = random.uniform(1, 10), rest = random.uniform(0, 1),
                     damping = damped ? random.uniform(0, 0.5) : 0.0;
        springs_.push_back({a, b, wide(at_a), wide(at_b), stiffness, rest, damping});
        const auto end = [&](int body, const Vector3& point) {
            if (body < 0) return End(point);
            const BodyHandle handle = handles[static_cast<std::size_t>(body)];
            return is_bead(static_cast<std::size_t>(body)) ? End(handle) : End(handle.point(point));
        };
        springs.push_back(scene.connect(Spring{.stiffness = stiffness, .rest_length = rest, .damping = damping},
                                        end(a, at_a), end(b, at_b)));
    }
}

/// Torques and forces along joints, linear in coordinate and rate.
inline void Maximal::exert(Random& random) {
    for (std::size_t i = 0; i < parts_.size(); ++i) {
        const Kind joint = parts_[i].kind;
        const bool turns =
            joint == Kind::revolute || joint == Kind::cylindrical || joint == Kind::universal || joint == Kind::planar;
        const double one = random.uniform(-8, 8), two = random.uniform(-1, 1), three = random.uniform(-2, 2);
        if ((!turns && joint != Kind::prismatic) || random.chance(0.5)) continue;
        const auto law = [=](const auto& /*t*/, const auto& q, const auto& rate) {
            return -one * (q - two) - three * rate;
        };
        if (turns)
            scene.apply(JointTorque(law), handles[i]);
        else
            scene.apply(JointForce(law), handles[i]);
        loads_.push_back({turns ? 3 : 4, static_cast<int>(i), Vec::Zero(), Vec::Zero(), false, one, two, three});
    }
}

inline void Maximal::close(Random& random, bool curves) {
    const int n = static_cast<int>(parts_.size());
    const int a = random.whole(0, n - 1);
    const int b = random.whole(-1, n - 1);
    if (a == b || is_bead(static_cast<std::size_t>(a)) || (b >= 0 && is_bead(static_cast<std::size_t>(b)))) return;
    const auto all = start();
    const Motion one = of(a, all), other = of(b, all);
    const int kind = random.whole(0, curves ? 6 : 5);
    const Vector3 at_a = random_vector(random, 1.0);
    const auto in = [](const Motion& m, const Vec& place) {
        return Vector3((m.r.transpose() * (place - m.origin)).cast<double>());
    };
    const Vec place = one.place(wide(at_a));
    Vector3 at_b = in(other, place);
    Held h{Ball{}, a, b, wide(at_a), Vec::Zero(), {}, Vec::Zero()};
    const Vector3 axis = random.direction();
    if (kind == 1) {
        at_b = random_vector(random, 1.0);
        h.constraint = Rod{static_cast<double>((place - other.place(wide(at_b))).norm())};
    } else if (kind == 2) {
        h.constraint = PointOnPlane{Plane{axis, at_b}};
        h.normal = wide(axis).normalized();
    } else if (kind == 3) {
        h.constraint = Hinge{axis};
        const Vec e = wide(axis).normalized();
        for (const Vec& u : across(e)) h.angles.push_back({one.r.transpose() * (other.r * u), e});
    } else if (kind == 4) {
        h.constraint = Weld{};
        for (int k = 0; k < 3; ++k)
            h.angles.push_back({Vec::Unit(k), other.r.transpose() * (one.r * Vec::Unit((k + 1) % 3))});
    } else if (kind == 5) {
        // at right angles in the world, and by their components
        const Vec first = wide(axis), turned = first.cross(Vec(other.r.transpose() * (one.r * first))),
                  second = turned.norm() > 0.1L ? Vec(turned.normalized()) : across(first)[0];
        if (turned.norm() <= 0.1L && turned.norm() > 0.0L) return;
        h.constraint = Universal{.first = axis, .second = second.cast<double>()};
        h.angles.push_back({first.normalized(), second});
    }
    if (kind == 6) {
        const double radius = random.uniform(0.3, 1.5);
        const Vector3 toward = axis.cross(random.direction()).normalized();
        h.constraint = PointOnCurve{Circle{radius, axis, toward, at_b - radius * axis.normalized()}};
        h.inward = -wide(axis).normalized() * radius;
        h.normal = wide(axis).cross(wide(toward)).normalized();
    }
    h.at_b = wide(at_b);
    const End end = b < 0 ? End(at_b) : End(handles[static_cast<std::size_t>(b)].point(at_b));
    held.push_back(scene.constrain(h.constraint, handles[static_cast<std::size_t>(a)].point(at_a), end));
    held_.push_back(h);
}

}  // namespace rbdyn::test
