// Particles, free or on rails, smooth or rough: the laws of their motion, and the reactions of their rails.
//
// Notation: r(u) the rail's curve, u its parameter, w = du/dt, r' = dr/du; F the active force, Phi the rail's
// reaction; m a = F + Phi (eq. 7.7). Along r' and across it, in the curve's own parameter:
//     m (|r'|^2 w' + r'.r'' w^2) = r'.F + |r'| Phi_t                        (eq. 7.12)
//     |r'| |Phi_perp| = |c|,   c = m w^2 r' x r'' - r' x F                  (eqs. 7.13, 7.14, 7.24)
// slipping: Phi_t = -mu_d sign(slip) |Phi_perp| (eq. 7.23, 7.25);  sticking: |Phi_t| <= mu_s |Phi_perp|.
// slip = |r'| w - V, V(t) the speed of the rail's surface along itself. Since |c| needs no normal vector, straight
// stretches and points of inflection are nothing special.
//
// Vectors are seen from one placement (`view`), chosen so that what vanishes vanishes exactly: a bead on a plane
// curve under forces in its plane then has c = (0, 0, c_z), and |c| is c_z with its sign locked.
// Invariant: state variables are the positions of all bodies (u, or x y z), then their velocities (w, or vx vy vz).
#pragma once

#include <cmath>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "rbdyn/scene/scene.hpp"

namespace rbdyn {

/// Position, velocity and place on its rail of one particle, in numbers of type S.
template <class S>
struct PointState {
    Vector3Of<S> r, v;
    CurvePoint<S> curve;
    S w;
};

/// Resultant of the active forces on one particle; what is exactly along a rail is kept apart.
template <class S>
struct Resultant {
    Vector3Of<S> force;
    S along;  // r' . (forces along the rail)
};

/// Motion and reaction of one particle at a time, world axes.
struct PointReport {
    Vector3 position, velocity, acceleration, force, reaction;
    double u = 0.0, w = 0.0, w_rate = 0.0, speed = 0.0;
    double tangential_force = 0.0;  // Q_s = F.t (eq. 7.15)
    double rail_speed = 0.0;        // V, of the rail's surface along itself
    double effort = 0.0;            // |F| + m |a| + m V^2 / rho: a reaction of its rounding is none
};

/// What sticking asks of a rail.
struct Holding {
    double tangential;  // |r'| Phi_t
    double across;      // |r'| |Phi_perp|
};

/// The laws of a scene of particles, each written once over the number type. Immutable.
class PointLaws {
public:
    /// One particle.
    struct Body {
        std::string name;
        double mass = 0.0;
        std::optional<Curve> curve;
        bool rough = false;
        double mu_static = 0.0, mu_dynamic = 0.0;
        TimeFunction drive;
        int first = 0;                    // its first position variable
        Vector3 force = Vector3::Zero();  // constant forces together
        double linear_drag = 0.0, quadratic_drag = 0.0;
        std::vector<Force> functions;
        double start_u = 0.0, start_speed = 0.0;
        Vector3 start_position = Vector3::Zero(), start_velocity = Vector3::Zero();

        int freedoms() const { return curve ? 1 : 3; }
    };
    struct SpringEnd {
        int body = -1;
        Vector3 point = Vector3::Zero();
    };
    struct ConnectedSpring {
        Spring spring;
        SpringEnd a, b;
    };

    PointLaws(const Scene& scene, const Placement& view) : view_(view) {
        const auto& bodies = scene.bodies();
        int position = 0;
        for (const Scene::Body& b : bodies) {
            Body body;
            body.mass = b.particle.mass;
            body.name = b.name;
            if (const Rail* rail = b.rail()) {
                body.curve = rail->curve();
                body.drive = rail->drive();
                if (const auto friction = rail->friction()) {
                    body.rough = true;
                    body.mu_static = friction->mu_static;
                    body.mu_dynamic = friction->dynamic();
                }
            }
            body.first = position;
            position += body.freedoms();
            body.force = seen(scene.gravity()) * body.mass;
            body.start_u = b.parameter;
            body.start_speed = b.speed;
            body.start_position = b.position;
            body.start_velocity = b.velocity;
            bodies_.push_back(std::move(body));
        }
        freedoms_ = position;
        for (const Scene::AppliedLoad& load : scene.loads()) {
            Body& body = bodies_[at(load.body)];
            if (const Force* force = std::get_if<Force>(&load.load)) {
                if (force->is_constant())
                    body.force += seen(force->constant());
                else
                    body.functions.push_back(*force);
            } else if (const Drag* drag = std::get_if<Drag>(&load.load)) {
                body.linear_drag += drag->linear;
                body.quadratic_drag += drag->quadratic;
            }
        }
        for (Body& body : bodies_) body.force = snapped(body.force, body.force.norm());
        for (const Scene::Connection& c : scene.connections()) {
            const Spring& spring = std::get<Spring>(c.coupling);
            if (spring.stiffness == 0.0 && spring.damping == 0.0) continue;
            springs_.push_back({spring, end(c.a), end(c.b)});
        }
    }
    const std::vector<Body>& bodies() const { return bodies_; }
    const Body& body(int i) const { return bodies_[at(i)]; }
    const Placement& view() const { return view_; }
    /// Position variables of all bodies together.
    int freedoms() const { return freedoms_; }

    /// The state the scene starts in.
    std::vector<double> start() const {
        std::vector<double> x(at(2 * freedoms_), 0.0);
        for (const Body& b : bodies_) {
            double* q = x.data() + b.first;
            double* v = q + freedoms_;
            if (b.curve) {
                *q = b.start_u;
                *v = b.start_speed / std::sqrt(curve_point(b, b.start_u).speed_squared);
                continue;
            }
            const Vector3 r = seen_point(b.start_position), vel = seen(b.start_velocity);
            for (int i = 0; i < 3; ++i) {
                q[i] = r[i];
                v[i] = vel[i];
            }
        }
        return x;
    }
    /// Motion and reaction of a body whose slip has a sign, or that sticks (slip 0).
    PointReport report(int index, signed char slip, double t, std::span<const double> x) const {
        const Body& b = bodies_[at(index)];
        std::vector<PointState<double>> states;
        for (int i = 0; i < static_cast<int>(bodies_.size()); ++i) states.push_back(state<double>(i, x));
        PointState<double>& p = states[at(index)];
        PointReport result;
        const bool stuck = b.rough && slip == 0;
        if (b.curve && stuck) {
            // held by its rail: the rail's own speed, exactly
            p.w = b.drive(t) / std::sqrt(p.curve.speed_squared);
            p.v = p.curve.first * p.w;
        }
        const auto length_of_w = [](double w) { return std::abs(w); };
        const Resultant<double> f = resultant<double>(index, t, states, length_of_w);
        Vector3 force = f.force, acceleration, reaction = Vector3::Zero();
        if (!b.curve) {
            acceleration = force / b.mass;
        } else {
            const CurvePoint<double>& c = p.curve;
            if (f.along != 0.0) force += c.first * (f.along / c.speed_squared);
            const double w_rate = stuck ? carried_rate<double>(b, t, c, p.w)
                                        : sliding_rate<double>(b, c, p.w, f, static_cast<double>(slip),
                                                               length(friction_vector<double>(b, c, p.w, f)));
            acceleration = c.first * w_rate + c.second * (p.w * p.w);
            reaction = acceleration * b.mass - force;
            const double norm = std::sqrt(c.speed_squared);
            result.rail_speed = b.rough ? b.drive(t) : 0.0;
            const double turn = result.rail_speed / norm;
            result.effort =
                force.norm() + b.mass * (acceleration.norm() + turn * turn * c.first_cross_second.norm() / norm);
            result.u = x[at(b.first)];
            result.w = p.w;
            result.w_rate = w_rate;
            result.speed = stuck ? b.drive(t) : p.w * norm;
            result.tangential_force = (dot<double>(c.first, f.force) + f.along) / norm;
        }
        result.position = view_.origin + view_.axes * p.r;
        result.velocity = view_.axes * p.v;
        result.acceleration = view_.axes * acceleration;
        result.force = view_.axes * force;
        result.reaction = view_.axes * reaction;
        return result;
    }
    /// Derivatives of a body's position and velocity variables.
    void slope(int index, signed char slip, double t, std::span<const double> x, std::span<double> dq,
               std::span<double> dv) const {
        const PointReport r = report(index, slip, t, x);
        if (bodies_[at(index)].curve) {
            dq[0] = r.w;
            dv[0] = r.w_rate;
            return;
        }
        const Vector3 velocity = view_.axes.transpose() * r.velocity,
                      acceleration = view_.axes.transpose() * r.acceleration;
        for (int k = 0; k < 3; ++k) {
            dq[at(k)] = velocity[k];
            dv[at(k)] = acceleration[k];
        }
    }

    // --- the laws, in any number type ---

    template <class S>
    PointState<S> moving(const Body& b, const S* q, const S* v) const {
        PointState<S> p;
        if (b.curve) {
            p.curve = b.curve->at<S>(*q, view_);
            p.w = *v;
            p.r = p.curve.position;
            p.v = p.curve.first * p.w;
        } else {
            p.r = {q[0], q[1], q[2]};
            p.v = {v[0], v[1], v[2]};
        }
        return p;
    }

    template <class S>
    PointState<S> state(int i, std::span<const S> x) const {
        const Body& b = bodies_[at(i)];
        return moving<S>(b, x.data() + b.first, x.data() + b.first + freedoms_);
    }

    /// Active forces on body i. `length_of_w` gives |w| of a bead with the sign of its mode.
    template <class S, class Length>
    Resultant<S> resultant(int i, const S& t, const std::vector<PointState<S>>& states, Length&& length_of_w) const {
        const Body& b = bodies_[at(i)];
        const PointState<S>& p = states[at(i)];
        Resultant<S> f{b.force.template cast<S>(), S(0.0)};
        for (const Force& function : b.functions) {
            const Matrix3& axes = view_.axes;
            const Vector3Of<S> r = turned<S>(axes, p.r), v = turned<S>(axes, p.v);
            f.force += turned<S>(axes.transpose(), function(t, Vector3Of<S>(r + view_.origin.template cast<S>()), v));
        }
        if (b.linear_drag != 0.0 || b.quadratic_drag != 0.0) {
            S factor = S(b.linear_drag);
            if (b.curve) {
                if (b.quadratic_drag != 0.0)
                    factor += S(b.quadratic_drag) * sqrt_of(p.curve.speed_squared) * length_of_w(p.w);
                f.along -= factor * p.w * p.curve.speed_squared;
            } else {
                if (b.quadratic_drag != 0.0) factor += S(b.quadratic_drag) * length(p.v, "speed of " + b.name);
                f.force -= p.v * factor;
            }
        }
        for (const ConnectedSpring& c : springs_) {
            if (c.a.body != i && c.b.body != i) continue;
            const auto [ra, va] = motion_of<S>(c.a, states);
            const auto [rb, vb] = motion_of<S>(c.b, states);
            const Vector3Of<S> d = ra - rb, v = va - vb;
            Vector3Of<S> force;
            if constexpr (std::is_same_v<S, double>)
                force = c.spring(d, v, ra.norm() + rb.norm());
            else
                force = c.spring(d, v);
            if (c.a.body == i)
                f.force += force;
            else
                f.force -= force;
        }
        return f;
    }

    template <class S>
    static Vector3Of<S> turned(const Matrix3& m, const Vector3Of<S>& v) {
        Vector3Of<S> out;
        for (int i = 0; i < 3; ++i) out[i] = S(m(i, 0)) * v[0] + S(m(i, 1)) * v[1] + S(m(i, 2)) * v[2];
        return out;
    }
    template <class S>
    static S sqrt_of(const S& x) {
        using std::sqrt;
        return sqrt(x);
    }

    template <class S>
    std::pair<Vector3Of<S>, Vector3Of<S>> motion_of(const SpringEnd& e,
                                                    const std::vector<PointState<S>>& states) const {
        if (e.body >= 0) return {states[at(e.body)].r, states[at(e.body)].v};
        return {e.point.cast<S>(), Vector3::Zero().cast<S>()};
    }

    /// c = m w^2 r' x r'' - r' x F, |r'| times what the rail must exert across itself.
    template <class S>
    static Vector3Of<S> friction_vector(const Body& b, const CurvePoint<S>& c, const S& w, const Resultant<S>& f) {
        return c.first_cross_second * (S(b.mass) * (w * w)) - cross<S>(c.first, f.force);
    }

    /// w' of a bead that slides (sign: of its slip), or of one on a smooth rail.
    template <class S>
    static S sliding_rate(const Body& b, const CurvePoint<S>& c, const S& w, const Resultant<S>& f, const S& sign,
                          const S& across) {
        S along = dot<S>(c.first, f.force) + f.along;
        if (b.rough && b.mu_dynamic > 0.0) along -= S(b.mu_dynamic) * sign * across;
        return (along / S(b.mass) - c.first_dot_second * (w * w)) / c.speed_squared;
    }

    /// w' of a bead that sticks: |r'| w = V(t).
    template <class S>
    static S carried_rate(const Body& b, const S& t, const CurvePoint<S>& c, const S& w) {
        const S norm = sqrt_of(c.speed_squared);
        return (b.drive.template rate<S>(t) - c.first_dot_second * (w * w) / norm) / norm;
    }

    /// The reaction that a bead without slip needs to stay so.
    Holding holding(int i, double t, std::span<const double> x) const {
        const Body& b = bodies_[at(i)];
        std::vector<PointState<double>> states;
        for (int j = 0; j < static_cast<int>(bodies_.size()); ++j) states.push_back(state<double>(j, x));
        const CurvePoint<double>& c = states[at(i)].curve;
        double& w = states[at(i)].w;
        w = b.drive(t) / std::sqrt(c.speed_squared);
        states[at(i)].v = c.first * w;
        const auto f = resultant<double>(i, t, states, [](double v) { return std::abs(v); });
        const double rate = carried_rate<double>(b, t, c, w);
        const double needed =
            b.mass * (c.speed_squared * rate + c.first_dot_second * (w * w)) - dot<double>(c.first, f.force) - f.along;
        return {needed, friction_vector<double>(b, c, w, f).norm()};
    }

    CurvePoint<double> curve_point(const Body& b, double u) const { return b.curve->at<double>(u, view_); }

private:
    static constexpr double epsilon = std::numeric_limits<double>::epsilon();
    static std::size_t at(int i) { return static_cast<std::size_t>(i); }

    // --- seen from the view ---

    static Vector3 snapped(Vector3 v, double size) {
        for (int i = 0; i < 3; ++i)
            if (std::abs(v[i]) <= 4.0 * epsilon * size) v[i] = 0.0;
        return v;
    }
    Vector3 seen(const Vector3& v) const { return snapped(view_.axes.transpose() * v, v.norm()); }
    Vector3 seen_point(const Vector3& p) const {
        return snapped(view_.axes.transpose() * (p - view_.origin), p.norm() + view_.origin.norm());
    }
    SpringEnd end(const End& e) const {
        if (const BodyHandle* body = std::get_if<BodyHandle>(&e)) return {body->index, Vector3::Zero()};
        return {-1, seen_point(std::get<Vector3>(e))};
    }

    Placement view_;
    std::vector<Body> bodies_;
    std::vector<ConnectedSpring> springs_;
    int freedoms_ = 0;
};

}  // namespace rbdyn
