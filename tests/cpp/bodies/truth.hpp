// Motion of a rigid body by other means: momenta instead of velocities, rotation matrices instead of quaternions, long
// double, and Bulirsch and Stoer's extrapolation of Gragg's midpoint rule (Hairer, Norsett, Wanner, II.9).
//
// About o, the centre of mass of a free body or the point its joint holds: R' = R [w], w = R^T K in the body over its
// inertia; K' = M, K and M about o in world axes; for a free body m r' = Q, Q' = F. On a hinge along e, e.I e psi'' =
// e.M; on a slide m d'' = e.F.
#pragma once

#include <optional>
#include <vector>

#include "bodies/random_bodies.hpp"
#include "rbdyn/simulate.hpp"

namespace rbdyn::test {

class Truth {
public:
    using Real = long double;
    using Vec = Eigen::Matrix<Real, 3, 1>;
    using Mat = Eigen::Matrix<Real, 3, 3>;
    using State = Eigen::Matrix<Real, 18, 1>;  // r of o, Q, columns of R, K; or coordinate, its rate
    enum class Kind { free, spherical, revolute, prismatic };

    /// A body with loads or with its weight only; its attitude is given as a quaternion, by Euler's angles or as a
    /// matrix, its angular velocity in its own axes or in the world's.
    static Truth random(Random& random, Kind kind, bool is_loaded) {
        Truth t;
        t.kind_ = kind;
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
        t.angles_ = {random.uniform(-3.0, 3.0), random.uniform(-7.0, 7.0), random.uniform(-7.0, 7.0)};
        t.form_ = random.whole(0, 2);
        t.is_seen_from_world_ = random.chance(0.5);
        t.axis_ = random.uniform(0.5, 2.0) * random.direction();
        t.coordinate_ = random.uniform(-3.0, 3.0);
        t.rate_ = random.uniform(-3.0, 3.0);
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
        Truth t = Truth::random(random, Kind::spherical, false);
        const double across = random.uniform(0.5, 1.0);
        t.inertia_ = Vector3(across, across, random.uniform(0.1, 1.9) * across).asDiagonal();
        t.com_ = Vector3(0, 0, random.uniform(-0.5, 0.5));
        t.point_ = Vector3(0, 0, random.uniform(-1.0, 1.0));
        t.omega_[2] = random.uniform(-20.0, 20.0);
        t.is_seen_from_world_ = false;
        return t;
    }

    Scene scene() const {
        Scene scene(gravity_);
        const RigidBody body(mass_, inertia_, {.com = com_});
        const Attitude attitude = form_ == 0   ? Attitude(attitude_)
                                  : form_ == 1 ? Attitude(angles_)
                                               : Attitude(rotation_matrix(attitude_));
        const std::optional<Vector3> none, omega = omega_, own = is_seen_from_world_ ? none : omega,
                                           seen = is_seen_from_world_ ? omega : none;
        const BodyHandle b = [&] {
            switch (kind_) {
                case Kind::free: return scene.add(body, Free{}, {at_, velocity_, attitude, own, seen});
                case Kind::spherical: return scene.add(body, Spherical{at_, point_}, {attitude, own, seen});
                case Kind::revolute: return scene.add(body, Revolute{axis_, at_, point_}, {coordinate_, rate_});
                default: return scene.add(body, Prismatic{axis_, at_, point_}, {coordinate_, rate_});
            }
        }();
        if (stiffness_ == 0.0) return scene;
        scene.connect(Spring{.stiffness = stiffness_, .rest_length = rest_}, b.point(spot_), anchor_);
        scene.apply(Drag{.linear = drag_}, b, spot_);
        scene.apply(Force(push_, Frame::body), b, spot_);
        scene.apply(Torque(twist_, Frame::body), b);
        return scene;
    }

    /// The largest error of a run at equal intervals, each quantity over its own scale: attitude [rad], angular
    /// velocity, and place and velocity of the centre of mass of a body that is free or slides.
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
            const Pose p = pose(x);
            turn = std::max(turn, (motion.rotation_matrix(t).cast<Real>() - p.r).norm() / std::sqrt(Real(2)));
            spin = std::max(spin, (motion.angular_velocity(t).cast<Real>() - p.w).norm());
            spin_size = std::max(spin_size, p.w.norm());
            if (!moves()) continue;
            const Vec c = center(x), v = p.v;
            place = std::max(place, (motion.center_of_mass(t).cast<Real>() - c).norm());
            low = low.cwiseMin(c);
            high = high.cwiseMax(c);
            speed = std::max(speed, (motion.center_of_mass_velocity(t).cast<Real>() - v).norm());
            speed_size = std::max(speed_size, v.norm());
        }
        Real worst = spin_size > 0 ? std::max(turn, spin / spin_size) : turn;
        if (moves()) worst = std::max({worst, place / (high - low).norm(), speed / speed_size});
        return static_cast<double>(worst);
    }

private:
    static Mat cross_matrix(const Vec& v) {
        Mat m;
        m << 0, -v[2], v[1], v[2], 0, -v[0], -v[1], v[0], 0;
        return m;
    }
    static Vec wide(const Vector3& v) { return v.cast<Real>(); }
    bool moves() const { return kind_ == Kind::free || kind_ == Kind::prismatic; }
    bool turns_freely() const { return kind_ == Kind::free || kind_ == Kind::spherical; }
    Vec axis() const { return wide(axis_).normalized(); }
    /// o in body axes.
    Vec origin() const { return kind_ == Kind::free ? wide(com_) : wide(point_); }
    Mat inertia() const {
        const Mat arm = cross_matrix(wide(com_) - origin());
        return inertia_.cast<Real>() - Real(mass_) * arm * arm;
    }

    /// R, angular velocity in body axes, place and velocity of o.
    struct Pose {
        Mat r;
        Vec w, o, v;
    };
    Pose pose(const State& x) const {
        const Vec none = Vec::Zero(), at = wide(at_);
        if (kind_ == Kind::prismatic) return {Mat::Identity(), none, at + axis() * x[0], axis() * x[1]};
        if (kind_ == Kind::revolute)
            return {Eigen::AngleAxis<Real>(x[0], axis()).toRotationMatrix(), axis() * x[1], at, none};
        Mat r;
        r << x.segment<3>(6), x.segment<3>(9), x.segment<3>(12);
        const Vec momentum = r.transpose() * x.segment<3>(15);
        return {r, inertia().inverse() * momentum, x.head<3>(), x.segment<3>(3) / Real(mass_)};
    }
    Vec center(const State& x) const {
        const Pose p = pose(x);
        return p.o + p.r * (wide(com_) - origin());
    }

    /// The rotation that the form given says, in long double.
    Mat attitude() const {
        using Turn = Eigen::AngleAxis<Real>;
        if (form_ == 1)
            return (Turn(angles_.psi, Vec::UnitZ()) * Turn(angles_.theta, Vec::UnitX()) *
                    Turn(angles_.phi, Vec::UnitZ()))
                .toRotationMatrix();
        if (form_ == 2) {
            Mat r = rotation_matrix(attitude_).cast<Real>();
            for (int k = 0; k < 4; ++k) r = ((r + r.inverse().transpose()) / 2).eval();
            return r;
        }
        const Quaternion& q = attitude_;
        const Real n = std::sqrt(Real(q.w) * q.w + Real(q.x) * q.x + Real(q.y) * q.y + Real(q.z) * q.z);
        return Eigen::Quaternion<Real>(q.w / n, q.x / n, q.y / n, q.z / n).toRotationMatrix();
    }

    State start() const {
        State x = State::Zero();
        if (!turns_freely()) {
            x[0] = coordinate_;
            x[1] = rate_;
            return x;
        }
        const Mat r = attitude();
        const Vec w = is_seen_from_world_ ? Vec(r.transpose() * wide(omega_)) : wide(omega_);
        x.head<3>() = wide(at_);
        if (kind_ == Kind::free) {
            x.head<3>() += r * wide(com_);
            x.segment<3>(3) = Real(mass_) * (wide(velocity_) + r * w.cross(wide(com_)));
        }
        x.segment<3>(6) = r.col(0);
        x.segment<3>(9) = r.col(1);
        x.segment<3>(12) = r.col(2);
        x.segment<3>(15) = r * (inertia() * w);
        return x;
    }

    State slope(const State& x) const {
        const auto [r, w, o, v] = pose(x);
        Vec force = Vec::Zero(), moment = Vec::Zero();
        const auto act = [&](const Vec& f, const Vec& arm) {
            force += f;
            moment += arm.cross(f);
        };
        act(Real(mass_) * wide(gravity_), r * (wide(com_) - origin()));
        const Vec arm = r * (wide(spot_) - origin());
        const Vec d = o + arm - wide(anchor_), u = v + r * w.cross(wide(spot_) - origin());
        act(-Real(stiffness_) * (d.norm() - Real(rest_)) / d.norm() * d, arm);
        act(-Real(drag_) * u, arm);
        act(r * wide(push_), arm);
        moment += r * wide(twist_);
        State rate = State::Zero();
        if (!turns_freely()) {
            rate[0] = x[1];
            rate[1] = kind_ == Kind::revolute ? axis().dot(moment) / axis().dot(inertia() * axis())
                                              : axis().dot(force) / Real(mass_);
            return rate;
        }
        rate.head<3>() = v;
        if (kind_ == Kind::free) rate.segment<3>(3) = force;
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

    Kind kind_ = Kind::free;
    int form_ = 0;  // of the attitude: quaternion, Euler's angles, matrix
    bool is_seen_from_world_ = false;
    double coordinate_ = 0.0, rate_ = 0.0;
    EulerAngles angles_;
    double mass_ = 1.0, stiffness_ = 0.0, rest_ = 0.0, drag_ = 0.0;
    Vector3 axis_, com_, gravity_, at_, point_, velocity_, omega_, spot_, anchor_, push_ = Vector3::Zero(),
                                                                                   twist_ = Vector3::Zero();
    Matrix3 inertia_;
    Quaternion attitude_;
};

}  // namespace rbdyn::test
