// Motion of a rigid body by other means: momenta instead of velocities, rotation matrices instead of quaternions, long
// double, and Bulirsch and Stoer's extrapolation of Gragg's midpoint rule (Hairer, Norsett, Wanner, II.9).
//
// About o, the centre of mass of a free body or the point a ball joint holds: R' = R [w], w = R^T K in the body over
// its inertia; K' = M, K and M about o in world axes; for a free body m r' = Q, Q' = F.
#pragma once

#include <vector>

#include "bodies/random_bodies.hpp"
#include "rbdyn/simulate.hpp"

namespace rbdyn::test {

class Truth {
public:
    using Real = long double;
    using Vec = Eigen::Matrix<Real, 3, 1>;
    using Mat = Eigen::Matrix<Real, 3, 3>;
    using State = Eigen::Matrix<Real, 18, 1>;  // r of o, Q, columns of R, K

    /// A body, free or on a ball joint, with loads or with its weight only.
    static Truth random(Random& random, bool is_free, bool is_loaded) {
        Truth t;
        t.is_free_ = is_free;
        const RigidBody drawn = random_body(random);
        t.mass_ = drawn.mass();
        t.com_ = drawn.com();
        t.inertia_ = drawn.inertia();
        t.gravity_ = random_vector(random, 8.0);
        t.at_ = random_vector(random, 2.0);
        t.point_ = random_vector(random, 1.0);
        t.attitude_ = random_attitude(random);
        t.velocity_ = random_vector(random, 2.0);
        t.omega_ = random_vector(random, 3.0);
        t.spot_ = random_vector(random, 1.0);
        t.anchor_ = random_vector(random, 3.0);
        if (!is_loaded) return t;
        t.stiffness_ = random.uniform(1.0, 8.0);
        t.rest_ = 0.5;
        t.drag_ = random.uniform(0.0, 0.5);
        t.push_ = random_vector(random, 2.0);
        t.twist_ = random_vector(random, 1.0);
        return t;
    }

    /// A symmetric body held on its axis, upright or hanging, fast or slow, in a field of any direction.
    static Truth top(Random& random) {
        Truth t = Truth::random(random, false, false);
        const double across = random.uniform(0.5, 1.0);
        t.inertia_ = Vector3(across, across, random.uniform(0.1, 1.9) * across).asDiagonal();
        t.com_ = Vector3(0, 0, random.uniform(-0.5, 0.5));
        t.point_ = Vector3(0, 0, random.uniform(-1.0, 1.0));
        t.omega_[2] = random.uniform(-20.0, 20.0);
        return t;
    }

    Scene scene() const {
        Scene scene(gravity_);
        const RigidBody body(mass_, inertia_, {.com = com_});
        const BodyHandle b =
            is_free_
                ? scene.add(body, Free{},
                            {.position = at_, .velocity = velocity_, .attitude = attitude_, .angular_velocity = omega_})
                : scene.add(body, Spherical{.at = at_, .point = point_},
                            {.attitude = attitude_, .angular_velocity = omega_});
        if (stiffness_ == 0.0) return scene;
        scene.connect(Spring{.stiffness = stiffness_, .rest_length = rest_}, b.point(spot_), anchor_);
        scene.apply(Drag{.linear = drag_}, b, spot_);
        scene.apply(Force(push_, Frame::body), b, spot_);
        scene.apply(Torque(twist_, Frame::body), b);
        return scene;
    }

    /// The largest error of a run at equal intervals, each quantity over its own scale: attitude [rad], angular
    /// velocity, and place and velocity of the centre of mass of a free body.
    double error(const Trajectory& run, int samples) const {
        State x = start();
        const Vec g0 = center(x);
        Real turn = 0, spin = 0, spin_size = 0, place = 0, speed = 0, speed_size = 0;
        Vec low = g0, high = g0;
        for (int k = 1; k <= samples; ++k) {
            const double before = run.end() * (k - 1) / samples, t = run.end() * k / samples;
            const int parts = 4;
            const Real h = (static_cast<Real>(t) - static_cast<Real>(before)) / parts;
            for (int i = 0; i < parts; ++i) x = advanced(x, h);
            const BodyMotion motion = run[BodyHandle{0}];
            const Mat r = rotation(x);
            turn = std::max(turn, (motion.rotation_matrix(t).cast<Real>() - r).norm() / std::sqrt(Real(2)));
            const Vec w = omega(x);
            spin = std::max(spin, (motion.angular_velocity(t).cast<Real>() - w).norm());
            spin_size = std::max(spin_size, w.norm());
            if (!is_free_) continue;
            const Vec c = center(x), v = x.segment<3>(3) / Real(mass_);
            place = std::max(place, (motion.center_of_mass(t).cast<Real>() - c).norm());
            low = low.cwiseMin(c);
            high = high.cwiseMax(c);
            speed = std::max(speed, (motion.center_of_mass_velocity(t).cast<Real>() - v).norm());
            speed_size = std::max(speed_size, v.norm());
        }
        Real worst = std::max(turn, spin / spin_size);
        if (is_free_) worst = std::max({worst, place / (high - low).norm(), speed / speed_size});
        return static_cast<double>(worst);
    }

private:
    static Mat cross_matrix(const Vec& v) {
        Mat m;
        m << 0, -v[2], v[1], v[2], 0, -v[0], -v[1], v[0], 0;
        return m;
    }
    static Mat rotation(const State& x) {
        Mat r;
        r << x.segment<3>(6), x.segment<3>(9), x.segment<3>(12);
        return r;
    }
    static Vec wide(const Vector3& v) { return v.cast<Real>(); }
    /// o in body axes.
    Vec origin() const { return is_free_ ? wide(com_) : wide(point_); }
    Mat inertia() const {
        const Mat arm = cross_matrix(wide(com_) - origin());
        return inertia_.cast<Real>() - Real(mass_) * arm * arm;
    }
    Vec omega(const State& x) const {
        const Mat i = inertia();
        const Vec k = rotation(x).transpose() * x.segment<3>(15);
        return i.inverse() * k;
    }
    Vec center(const State& x) const { return x.head<3>() + rotation(x) * (wide(com_) - origin()); }

    State start() const {
        const Quaternion& q = attitude_;
        // in long double, as the quaternion is a unit one to rounding of doubles only
        const Real n = std::sqrt(Real(q.w) * q.w + Real(q.x) * q.x + Real(q.y) * q.y + Real(q.z) * q.z);
        const Mat r = Eigen::Quaternion<Real>(q.w / n, q.x / n, q.y / n, q.z / n).toRotationMatrix();
        State x;
        const Vec w = wide(omega_);
        x.head<3>() = is_free_ ? Vec(wide(at_) + r * wide(com_)) : wide(at_);
        x.segment<3>(3) = is_free_ ? Vec(Real(mass_) * (wide(velocity_) + r * w.cross(wide(com_)))) : Vec(Vec::Zero());
        x.segment<3>(6) = r.col(0);
        x.segment<3>(9) = r.col(1);
        x.segment<3>(12) = r.col(2);
        x.segment<3>(15) = r * (inertia() * w);
        return x;
    }

    State slope(const State& x) const {
        const Mat r = rotation(x);
        const Vec w = omega(x), v = x.segment<3>(3) / Real(mass_);
        Vec force = Vec::Zero(), moment = Vec::Zero();
        const auto act = [&](const Vec& f, const Vec& arm) {
            force += f;
            moment += arm.cross(f);
        };
        act(Real(mass_) * wide(gravity_), r * (wide(com_) - origin()));
        const Vec arm = r * (wide(spot_) - origin());
        const Vec d = x.head<3>() + arm - wide(anchor_), u = v + r * w.cross(wide(spot_) - origin());
        act(-Real(stiffness_) * (d.norm() - Real(rest_)) / d.norm() * d, arm);
        act(-Real(drag_) * u, arm);
        act(r * wide(push_), arm);
        moment += r * wide(twist_);
        State rate;
        rate.head<3>() = v;
        rate.segment<3>(3) = is_free_ ? force : Vec(Vec::Zero());
        const Mat turning = r * cross_matrix(w);
        rate.segment<3>(6) = turning.col(0);
        rate.segment<3>(9) = turning.col(1);
        rate.segment<3>(12) = turning.col(2);
        rate.segment<3>(15) = moment;
        return rate;
    }

    /// A step of order 16, or as many shorter ones as agree with order 14.
    State advanced(const State& x, Real h) const {
        constexpr int columns = 8;
        State table[columns];
        for (int j = 0; j < columns; ++j) {
            const int n = 2 * (j + 1);
            const Real part = h / n;
            State before = x, now = x + part * slope(x);
            for (int i = 1; i < n; ++i) {
                const State next = before + 2 * part * slope(now);
                before = now;
                now = next;
            }
            table[j] = (before + now + part * slope(now)) / 2;
            for (int k = j - 1; k >= 0; --k) {
                const Real ratio = Real(n) / (2 * (k + 1));
                table[k] = table[k + 1] + (table[k + 1] - table[k]) / (ratio * ratio - 1);
            }
        }
        // the ends of a spring that all but meet: no step is too short
        if ((table[0] - table[1]).norm() > 1e-15L * table[0].norm()) return advanced(advanced(x, h / 2), h / 2);
        return table[0];
    }

    bool is_free_ = true;
    double mass_ = 1.0, stiffness_ = 0.0, rest_ = 0.0, drag_ = 0.0;
    Vector3 com_, gravity_, at_, point_, velocity_, omega_, spot_, anchor_, push_ = Vector3::Zero(),
                                                                            twist_ = Vector3::Zero();
    Matrix3 inertia_;
    Quaternion attitude_;
};

}  // namespace rbdyn::test
