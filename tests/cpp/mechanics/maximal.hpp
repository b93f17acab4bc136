// Trees and loops drawn at random, and their accelerations and reactions by other means.
//
// Every body has six accelerations (a_G, alpha), world axes; every joint and every constraint is rows on them, written
// from its geometry, J x = c; and with the inertia M of the bodies and what acts on them, F,
//     | M  -J^T | | x      |   | F |
//     | J    0  | | lambda | = | c |      in long double, with all pivots.
// Nothing is recursive, no joint has coordinates, no body is reduced to another.
#pragma once

#include <Eigen/LU>
#include <array>
#include <string>
#include <variant>
#include <vector>

#include "bodies/random_bodies.hpp"
#include "rbdyn/simulate.hpp"

namespace rbdyn::test {

class Maximal {
public:
    using Real = long double;
    using Vec = Eigen::Matrix<Real, 3, 1>;
    using Mat = Eigen::Matrix<Real, 3, 3>;
    enum class Kind {
        free,
        spherical,
        revolute,
        prismatic,
        universal,
        cylindrical,
        planar,
        fixed,
        turned,
        pushed,
        count
    };

    struct Draw {
        int least = 1, most = 12;  // bodies
        double loops = 0.0;        // constraints for each body
        bool loaded = true, damped = true;
        bool driven = true;  // some joints are functions of time
    };

    Maximal(Random& random, const Draw& draw) : scene(wide_gravity(random)) {
        const int n = random.whole(draw.least, draw.most);
        for (int i = 0; i < n; ++i) add(random, draw.driven);
        if (draw.loaded) load(random, draw.damped);
        const int loops = static_cast<int>(std::lround(draw.loops * n));
        for (int k = 0; k < loops; ++k) close(random);
    }

    Scene scene;
    std::vector<BodyHandle> handles;
    std::vector<ConstraintHandle> held;
    std::vector<CouplingHandle> springs;

    struct Motion {
        Mat r = Mat::Identity();
        Vec origin = Vec::Zero(), velocity = Vec::Zero(), omega = Vec::Zero();
        Vec place(const Vec& p) const { return origin + r * p; }
        Vec speed(const Vec& p) const { return velocity + omega.cross(Vec(r * p)); }
    };
    /// As the joints' starts say.
    std::vector<Motion> start() const {
        std::vector<Motion> all;
        for (std::size_t i = 0; i < parts_.size(); ++i) all.push_back(started(i, all));
        return all;
    }
    /// As a run has it at its start.
    std::vector<Motion> seen(const Trajectory& run) const {
        std::vector<Motion> all;
        for (const BodyHandle b : handles) {
            const auto q = run[b].quaternion(0.0);
            Motion m;
            const Real w = q.w, x = q.x, y = q.y, z = q.z, s = 2.0L / (w * w + x * x + y * y + z * z);
            m.r << 1 - s * (y * y + z * z), s * (x * y - w * z), s * (x * z + w * y), s * (x * y + w * z),
                1 - s * (x * x + z * z), s * (y * z - w * x), s * (x * z - w * y), s * (y * z + w * x),
                1 - s * (x * x + y * y);
            m.origin = run[b].position(0.0).cast<Real>();
            m.velocity = run[b].velocity(0.0).cast<Real>();
            m.omega = m.r * run[b].angular_velocity(0.0).cast<Real>();
            all.push_back(m);
        }
        return all;
    }

    struct Wrench {
        Vec force = Vec::Zero(), torque = Vec::Zero();
    };
    struct Result {
        std::vector<Vec> acceleration, turning;  // of G, and alpha
        std::vector<Wrench> joints, held;        // about the joint's point; on a, about its point
        bool is_unique = true;
        int rows = 0, rank = 0;
        Real least_pivot = 1.0L;
    };
    Result solve(const std::vector<Motion>& all) const;
    /// What acts on each body, about G.
    std::vector<Wrench> acting(const std::vector<Motion>& all) const;

    Vec mass_center(std::size_t i) const { return parts_[i].center; }
    int parent(std::size_t i) const { return parts_[i].parent; }
    std::string kinds() const {
        static const char* const names[] = {"free",        "spherical", "revolute", "prismatic", "universal",
                                            "cylindrical", "planar",    "fixed",    "turned",    "pushed"};
        std::string all;
        for (const Part& p : parts_)
            all += std::string(names[static_cast<std::size_t>(p.kind)]) + "(" + std::to_string(p.parent) + ") ";
        for (const Held& h : held_) all += "+" + std::to_string(h.constraint.index());
        return all;
    }

private:
    struct Part {
        Kind kind = Kind::free;
        int parent = -1;
        Real mass = 1.0L;
        Vec center = Vec::Zero(), at = Vec::Zero(), point = Vec::Zero(), first = Vec::Zero(), second = Vec::Zero();
        Mat inertia = Mat::Identity();
        std::array<Real, 3> q{}, v{};
        Mat attitude = Mat::Identity();
        Vec omega = Vec::Zero(), velocity = Vec::Zero();  // relative, of free and spherical ones
        Real drive = 0.0L;                                // second rate of a driven joint
    };
    struct Applied {
        int kind, body;  // 0 force, 1 torque, 2 drag, 3 torsion spring
        Vec value, point;
        bool in_body;
        Real one, two, three;
    };
    struct Coupled {
        int a, b;  // -1: the world
        Vec at_a, at_b;
        Real stiffness, rest, damping;
    };
    struct Held {
        Constraint constraint;
        int a, b;
        Vec at_a, at_b;
        std::vector<std::pair<Vec, Vec>> angles;  // directions of a and of b at right angles
        Vec normal = Vec::Zero();                 // of a plane, axes of b
    };
    /// Conditions on accelerations, a row at a time.
    struct Rows {
        struct Row {
            int a, b;
            Vec force_a, torque_a, force_b, torque_b;  // coefficients of a_G, alpha
            Real right = 0.0L;
            int joint, held;
        };
        std::vector<Row> all;
        int joint = -1, constraint = -1;
        void add(int a, const Vec& fa, const Vec& ta, int b, const Vec& fb, const Vec& tb, Real right) {
            all.push_back({a, b, fa, ta, fb, tb, right, joint, constraint});
        }
    };

    static Vector3 wide_gravity(Random& random) { return random_vector(random, 8.0); }
    static Vec wide(const Vector3& v) { return v.cast<Real>(); }
    static Mat turn(const Vec& axis, Real angle) {
        Mat k;
        k << 0, -axis[2], axis[1], axis[2], 0, -axis[0], -axis[1], axis[0], 0;
        return Mat::Identity() + std::sin(angle) * k + (1 - std::cos(angle)) * (k * k);
    }
    static std::array<Vec, 2> across(const Vec& n) {
        Vec least = Vec::Zero();
        int k = 0;
        n.cwiseAbs().minCoeff(&k);
        least[k] = 1;
        const Vec u = n.cross(least).normalized();
        return {u, Vec(n.cross(u))};
    }

    void add(Random& random, bool driven);
    void load(Random& random, bool damped);
    void close(Random& random);
    Motion started(std::size_t i, const std::vector<Motion>& all) const;
    static Motion of(int body, const std::vector<Motion>& all) {
        return body < 0 ? Motion{} : all[static_cast<std::size_t>(body)];
    }
    /// From G of a body to a point of it, in the world; of the world from its origin.
    Vec arm(int body, const Vec& p, const std::vector<Motion>& all) const {
        if (body < 0) return p;
        const auto i = static_cast<std::size_t>(body);
        return all[i].r * (p - parts_[i].center);
    }
    /// u . (P of a - Q of b), u turning with b.
    void add_point(Rows& rows, const std::vector<Motion>& all, int a, const Vec& p, int b, const Vec& q, const Vec& u,
                   bool turns, Real right = 0.0L) const {
        const Motion one = of(a, all), other = of(b, all);
        const Vec ra = arm(a, p, all), rb = arm(b, q, all), d = one.place(p) - other.place(q),
                  d_rate = one.speed(p) - other.speed(q), w = turns ? other.omega : Vec(Vec::Zero()),
                  swung = one.omega.cross(one.omega.cross(ra)) -
                          (b < 0 ? Vec(Vec::Zero()) : Vec(other.omega.cross(other.omega.cross(rb))));
        Vec tb = -rb.cross(u);
        if (turns) tb += u.cross(d);
        rows.add(a, u, ra.cross(u), b, -u, tb,
                 right - u.dot(swung) - 2 * w.cross(u).dot(d_rate) - w.cross(w.cross(u)).dot(d));
    }
    /// e . w = 0, e of a and w of b.
    void add_right_angle(Rows& rows, const std::vector<Motion>& all, int a, const Vec& in_a, int b,
                         const Vec& in_b) const {
        const Motion one = of(a, all), other = of(b, all);
        const Vec e = one.r * in_a, w = other.r * in_b, m = e.cross(w), wa = one.omega, wb = other.omega;
        rows.add(a, Vec::Zero(), m, b, Vec::Zero(), -m,
                 -(wa.cross(wa.cross(e)).dot(w) + 2 * wa.cross(e).dot(wb.cross(w)) + e.dot(wb.cross(wb.cross(w)))));
    }
    /// alpha of a - alpha of b is known.
    void add_turn(Rows& rows, int a, int b, const Vec& known) const {
        for (int k = 0; k < 3; ++k) rows.add(a, Vec::Zero(), Vec::Unit(k), b, Vec::Zero(), -Vec::Unit(k), known[k]);
    }
    void add_joint(Rows& rows, const std::vector<Motion>& all, int i) const;
    void add_held(Rows& rows, const std::vector<Motion>& all, const Held& h) const;

    std::vector<Part> parts_;
    std::vector<Applied> loads_;
    std::vector<Coupled> springs_;
    std::vector<Held> held_;
};

inline void Maximal::add(Random& random, bool driven) {
    const int i = static_cast<int>(parts_.size());
    Part p;
    p.kind = static_cast<Kind>(random.whole(0, static_cast<int>(driven ? Kind::count : Kind::turned) - 1));
    p.parent = random.chance(0.2) ? -1 : random.whole(-1, i - 1);
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

inline Maximal::Motion Maximal::started(std::size_t i, const std::vector<Motion>& all) const {
    const Part& p = parts_[i];
    const Motion parent = of(p.parent, all);
    Motion m;
    Vec place = parent.place(p.at), velocity = parent.speed(p.at);  // of the joint's point of the child
    m.r = parent.r;
    m.omega = parent.omega;
    const auto slide = [&](const Vec& axis, Real way, Real rate) {
        const Vec e = parent.r * axis;
        place += e * way;
        velocity += parent.omega.cross(Vec(e * way)) + e * rate;
    };
    const auto turned = [&](const Vec& axis, Real angle, Real rate) {
        m.omega += m.r * axis * rate;
        m.r = m.r * turn(axis, angle);
    };
    switch (p.kind) {
        case Kind::free:
            m.origin = parent.place(p.at);
            m.velocity = parent.speed(p.at) + parent.r * p.velocity;
            m.r = parent.r * p.attitude;
            m.omega += m.r * p.omega;
            return m;
        case Kind::spherical:
            m.r = parent.r * p.attitude;
            m.omega += m.r * p.omega;
            break;
        case Kind::revolute:
        case Kind::turned: turned(p.first, p.q[0], p.v[0]); break;
        case Kind::prismatic:
        case Kind::pushed: slide(p.first, p.q[0], p.v[0]); break;
        case Kind::universal:
            turned(p.first, p.q[0], p.v[0]);
            turned(p.second, p.q[1], p.v[1]);
            break;
        case Kind::cylindrical:
            slide(p.first, p.q[1], p.v[1]);
            turned(p.first, p.q[0], p.v[0]);
            break;
        case Kind::planar:
            slide(p.first, p.q[0], p.v[0]);
            slide(p.second, p.q[1], p.v[1]);
            turned(p.first.cross(p.second), p.q[2], p.v[2]);
            break;
        default: m.r = parent.r * p.attitude;
    }
    m.origin = place - m.r * p.point;
    m.velocity = velocity - m.omega.cross(Vec(m.r * p.point));
    return m;
}

/// Loads and couplings anywhere.
inline void Maximal::load(Random& random, bool damped) {
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
        const Vector3 at_a = random_vector(random, 1.0), at_b = random_vector(random, 1.0);
        const double stiffness = random.uniform(1, 10), rest = random.uniform(0, 1),
                     damping = damped ? random.uniform(0, 0.5) : 0.0;
        springs_.push_back({a, b, wide(at_a), wide(at_b), stiffness, rest, damping});
        const End end = b < 0 ? End(at_b) : End(handles[static_cast<std::size_t>(b)].point(at_b));
        springs.push_back(scene.connect(Spring{.stiffness = stiffness, .rest_length = rest, .damping = damping},
                                        handles[static_cast<std::size_t>(a)].point(at_a), end));
    }
}

inline void Maximal::close(Random& random) {
    const int n = static_cast<int>(parts_.size());
    const int a = random.whole(0, n - 1);
    const int b = random.whole(-1, n - 1);
    if (a == b) return;
    const auto all = start();
    const Motion one = of(a, all), other = of(b, all);
    const int kind = random.whole(0, 5);
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
    h.at_b = wide(at_b);
    const End end = b < 0 ? End(at_b) : End(handles[static_cast<std::size_t>(b)].point(at_b));
    held.push_back(scene.constrain(h.constraint, handles[static_cast<std::size_t>(a)].point(at_a), end));
    held_.push_back(h);
}

inline void Maximal::add_joint(Rows& rows, const std::vector<Motion>& all, int i) const {
    const Part& p = parts_[static_cast<std::size_t>(i)];
    const Motion parent = of(p.parent, all), own = of(i, all);
    rows.joint = i;
    rows.constraint = -1;
    const auto hold = [&] {
        for (int k = 0; k < 3; ++k) add_point(rows, all, i, p.point, p.parent, p.at, Vec::Unit(k), false);
    };
    const auto guide = [&](const Vec& axis) {
        for (const Vec& u : across(axis)) add_point(rows, all, i, p.point, p.parent, p.at, parent.r * u, true);
    };
    const auto swivel = [&](const Vec& axis) {
        for (const Vec& u : across(axis)) add_right_angle(rows, all, i, u, p.parent, axis);
    };
    switch (p.kind) {
        case Kind::free: break;
        case Kind::spherical: hold(); break;
        case Kind::revolute:
            hold();
            swivel(p.first);
            break;
        case Kind::prismatic:
            guide(p.first);
            add_turn(rows, i, p.parent, Vec::Zero());
            break;
        case Kind::universal:
            hold();
            // of the body its second axis, of the parent its first
            add_right_angle(rows, all, i, p.second, p.parent, p.first);
            break;
        case Kind::cylindrical:
            guide(p.first);
            swivel(p.first);
            break;
        case Kind::planar: {
            const Vec n = p.first.cross(p.second);
            add_point(rows, all, i, p.point, p.parent, p.at, parent.r * n, true);
            swivel(n);
            break;
        }
        case Kind::fixed:
            hold();
            add_turn(rows, i, p.parent, Vec::Zero());
            break;
        case Kind::turned: {
            hold();
            const Vec e = parent.r * p.first;
            add_turn(rows, i, p.parent, parent.omega.cross(Vec(own.omega - parent.omega)) + e * p.drive);
            break;
        }
        default:
            guide(p.first);
            add_point(rows, all, i, p.point, p.parent, p.at, parent.r * p.first, true, p.drive);
            add_turn(rows, i, p.parent, Vec::Zero());
    }
}

inline void Maximal::add_held(Rows& rows, const std::vector<Motion>& all, const Held& h) const {
    const Motion one = of(h.a, all), other = of(h.b, all);
    if (std::holds_alternative<Rod>(h.constraint)) {
        // (d . d)' = 0: d . d'' + d' . d' = 0
        const Vec d = one.place(h.at_a) - other.place(h.at_b), rate = one.speed(h.at_a) - other.speed(h.at_b);
        add_point(rows, all, h.a, h.at_a, h.b, h.at_b, d, false, -rate.dot(rate));
    } else if (std::holds_alternative<PointOnPlane>(h.constraint)) {
        add_point(rows, all, h.a, h.at_a, h.b, h.at_b, other.r * h.normal, true);
    } else {
        for (int k = 0; k < 3; ++k) add_point(rows, all, h.a, h.at_a, h.b, h.at_b, Vec::Unit(k), false);
    }
    for (const auto& [e, w] : h.angles) add_right_angle(rows, all, h.a, e, h.b, w);
}

inline std::vector<Maximal::Wrench> Maximal::acting(const std::vector<Motion>& all) const {
    std::vector<Wrench> w(parts_.size());
    const auto push = [&](int body, const Vec& point, const Vec& force) {
        if (body < 0) return;
        auto& own = w[static_cast<std::size_t>(body)];
        own.force += force;
        own.torque += arm(body, point, all).cross(force);
    };
    for (std::size_t i = 0; i < w.size(); ++i) w[i].force += wide(scene.gravity()) * parts_[i].mass;
    for (const Applied& l : loads_) {
        const auto i = static_cast<std::size_t>(l.body);
        const Motion& m = all[i];
        const Vec value = l.in_body ? Vec(m.r * l.value) : l.value;
        if (l.kind == 0) push(l.body, l.point, value);
        if (l.kind == 1) w[i].torque += value;
        if (l.kind == 2) {
            const Vec v = m.speed(l.point);
            push(l.body, l.point, -v * (l.one + l.three * v.norm()));
        }
        if (l.kind == 3) {
            const Part& p = parts_[i];
            const Scene::Body& started = scene.bodies()[i];
            const bool planar = p.kind == Kind::planar, single = p.kind == Kind::revolute;
            const Vec e = of(p.parent, all).r * (planar ? Vec(p.first.cross(p.second)) : p.first);
            const Real angle = single ? started.parameter : started.coordinates[planar ? 2 : 0],
                       rate = single ? started.speed : started.rates[planar ? 2 : 0];
            const Vec torque = -e * (l.one * (angle - l.two) + l.three * rate);
            w[i].torque += torque;
            if (p.parent >= 0) w[static_cast<std::size_t>(p.parent)].torque -= torque;
        }
    }
    for (const Coupled& c : springs_) {
        const Motion a = of(c.a, all), b = of(c.b, all);
        const Vec d = a.place(c.at_a) - b.place(c.at_b), v = a.speed(c.at_a) - b.speed(c.at_b), e = d.normalized();
        const Vec force = -e * (c.stiffness * (d.norm() - c.rest) + c.damping * e.dot(v));
        push(c.a, c.at_a, force);
        push(c.b, c.at_b, -force);
    }
    return w;
}

inline Maximal::Result Maximal::solve(const std::vector<Motion>& all) const {
    const auto n = static_cast<Eigen::Index>(parts_.size());
    Rows rows;
    for (int i = 0; i < static_cast<int>(n); ++i) add_joint(rows, all, i);
    rows.joint = -1;
    for (std::size_t k = 0; k < held_.size(); ++k) {
        rows.constraint = static_cast<int>(k);
        add_held(rows, all, held_[k]);
    }
    const auto m = static_cast<Eigen::Index>(rows.all.size());
    using Matrix = Eigen::Matrix<Real, Eigen::Dynamic, Eigen::Dynamic>;
    Matrix k = Matrix::Zero(6 * n + m, 6 * n + m);
    Eigen::Matrix<Real, Eigen::Dynamic, 1> right = Eigen::Matrix<Real, Eigen::Dynamic, 1>::Zero(6 * n + m);
    const auto acts = acting(all);
    for (Eigen::Index i = 0; i < n; ++i) {
        const auto at = static_cast<std::size_t>(i);
        const Mat inertia = all[at].r * parts_[at].inertia * all[at].r.transpose();
        k.block<3, 3>(6 * i, 6 * i) = Mat::Identity() * parts_[at].mass;
        k.block<3, 3>(6 * i + 3, 6 * i + 3) = inertia;
        right.segment<3>(6 * i) = acts[at].force;
        right.segment<3>(6 * i + 3) = acts[at].torque - all[at].omega.cross(Vec(inertia * all[at].omega));
    }
    for (Eigen::Index r = 0; r < m; ++r) {
        const auto& row = rows.all[static_cast<std::size_t>(r)];
        const auto put = [&](int body, const Vec& f, const Vec& t) {
            if (body < 0) return;
            k.block<1, 3>(6 * n + r, 6 * body) = f.transpose();
            k.block<1, 3>(6 * n + r, 6 * body + 3) = t.transpose();
            k.block<3, 1>(6 * body, 6 * n + r) = -f;
            k.block<3, 1>(6 * body + 3, 6 * n + r) = -t;
        };
        put(row.a, row.force_a, row.torque_a);
        put(row.b, row.force_b, row.torque_b);
        right[6 * n + r] = row.right;
    }
    Eigen::FullPivLU<Matrix> lu(k);
    // what is left of dependent rows is rounding of doubles: of the start
    lu.setThreshold(1e-10L);
    Result result;
    result.rows = static_cast<int>(m);
    result.rank = static_cast<int>(lu.rank()) - static_cast<int>(6 * n);
    result.is_unique = lu.rank() == 6 * n + m;
    for (Eigen::Index i = 0; i < lu.rank(); ++i)
        result.least_pivot = std::min(result.least_pivot, std::abs(lu.matrixLU()(i, i)) / lu.maxPivot());
    const auto x = lu.solve(right).eval();
    result.joints.resize(parts_.size());
    result.held.resize(held_.size());
    for (Eigen::Index i = 0; i < n; ++i) {
        result.acceleration.push_back(x.segment<3>(6 * i));
        result.turning.push_back(x.segment<3>(6 * i + 3));
    }
    for (Eigen::Index r = 0; r < m; ++r) {
        const auto& row = rows.all[static_cast<std::size_t>(r)];
        Wrench& w = row.joint >= 0 ? result.joints[static_cast<std::size_t>(row.joint)]
                                   : result.held[static_cast<std::size_t>(row.held)];
        w.force += row.force_a * x[6 * n + r];
        w.torque += row.torque_a * x[6 * n + r];
    }
    // from G to the points that are held
    for (std::size_t i = 0; i < parts_.size(); ++i)
        result.joints[i].torque -= arm(static_cast<int>(i), parts_[i].point, all).cross(result.joints[i].force);
    for (std::size_t i = 0; i < held_.size(); ++i)
        result.held[i].torque -= arm(held_[i].a, held_[i].at_a, all).cross(result.held[i].force);
    return result;
}

}  // namespace rbdyn::test
