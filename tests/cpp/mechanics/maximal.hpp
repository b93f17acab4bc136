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
        count,
        bead = count  // a particle on a circle of its parent
    };

    struct Draw {
        int least = 1, most = 12;  // bodies
        double loops = 0.0;        // constraints for each body
        bool loaded = true, damped = true;
        bool driven = true;    // some joints are functions of time
        bool springs = true;   // torsion springs on hinges
        bool beads = false;    // some are particles on rails
        bool exerted = false;  // JointTorque and JointForce
        bool curves = false;   // points held on circles of others
    };

    Maximal(Random& random, const Draw& draw) : scene(wide_gravity(random)) {
        const int n = random.whole(draw.least, draw.most);
        for (int i = 0; i < n; ++i) add(random, draw);
        if (draw.loaded) load(random, draw);
        if (draw.exerted) exert(random);
        const int loops = static_cast<int>(std::lround(draw.loops * n));
        for (int k = 0; k < loops; ++k) close(random, draw.curves);
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
    bool is_bead(std::size_t i) const { return parts_[i].kind == Kind::bead; }
    /// As a run has it.
    std::vector<Motion> seen(const Trajectory& run, double t = 0.0) const {
        std::vector<Motion> all;
        for (const BodyHandle b : handles) {
            Motion m;
            if (is_bead(all.size())) {
                m.origin = run[b].position(t).cast<Real>();
                m.velocity = run[b].velocity(t).cast<Real>();
                all.push_back(m);
                continue;
            }
            const auto q = run[b].quaternion(t);
            const Real w = q.w, x = q.x, y = q.y, z = q.z, s = 2.0L / (w * w + x * x + y * y + z * z);
            m.r << 1 - s * (y * y + z * z), s * (x * y - w * z), s * (x * z + w * y), s * (x * y + w * z),
                1 - s * (x * x + z * z), s * (y * z - w * x), s * (x * z - w * y), s * (y * z + w * x),
                1 - s * (x * x + y * y);
            m.origin = run[b].position(t).cast<Real>();
            m.velocity = run[b].velocity(t).cast<Real>();
            m.omega = m.r * run[b].angular_velocity(t).cast<Real>();
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
    /// As all moves from there in a time, by extrapolation (Gragg, Bulirsch and Stoer) with steps of a length.
    std::vector<Motion> moved(std::vector<Motion> all, Real time, Real step) const;
    /// What acts on each body, about G.
    std::vector<Wrench> acting(const std::vector<Motion>& all) const;

    Vec mass_center(std::size_t i) const { return parts_[i].center; }
    int parent(std::size_t i) const { return parts_[i].parent; }
    std::string kinds() const {
        static const char* const names[] = {"free",   "spherical", "revolute", "prismatic", "universal", "cylindrical",
                                            "planar", "fixed",     "turned",   "pushed",    "bead"};
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
        int kind, body;  // 0 force, 1 torque, 2 drag, 3 torsion spring or torque of a joint, 4 force of a joint
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
        Vec normal = Vec::Zero();                 // of a plane or of a circle, axes of b
        Vec inward = Vec::Zero();                 // from a place of a circle to its centre, of its radius
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

    void add(Random& random, const Draw& draw);
    void add_bead(Random& random, Part p);
    void load(Random& random, const Draw& draw);
    void exert(Random& random);
    void close(Random& random, bool curves);
    /// Rows of a point p of a on a circle of b through q, `inward` its radius, `normal` across its plane.
    void add_circle(Rows& rows, const std::vector<Motion>& all, int a, const Vec& p, int b, const Vec& q,
                    const Vec& inward, const Vec& normal) const;
    std::vector<Motion> rates(const std::vector<Motion>& all) const;
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

}  // namespace rbdyn::test

#include "mechanics/maximal_draw.hpp"
#include "mechanics/maximal_solve.hpp"
