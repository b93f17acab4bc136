// The law of one rigid body on its joint to the ground: coordinates, and what forces make of them.
//
// About o, the centre of mass of a free body or the point a ball joint holds, on principal axes (Euler's equations,
// 7.47, 7.48), M the moment about o:
//     A w1' = (B - C) w2 w3 + M1   and cyclically;   m a_G = F for a free body
// A symmetric body, A = B, whose forces act on its axis only, is written in the frame that follows the axis e3 and does
// not turn about it (rigid_state.hpp):
//     A w1' = M1 - C w3 w2,  A w2' = M2 + C w3 w1,  w3' = 0,  spin' = w3
// On a hinge: I_33 psi'' = M_3 (7.60), e3 the axis, I_33 about it. On a slide: m d'' = F.e3.
//
// Coordinates: free: G, quaternion (w, x, y, z), spin | G', w1, w2, w3; ball joint: the same without G; hinge: psi |
// psi'; slide: d | d'. Spin is a coordinate in the frame that does not turn only.
// Invariant: constants that derive from the user's doubles, and the start, are numbers of 32 digits; recorded equations
// take them as they are, doubles take them rounded once.
#pragma once

#include <cmath>
#include <limits>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/double_double_vector.hpp"
#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/instant.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/body/principal_axes.hpp"
#include "rbdyn/expression/node.hpp"
#include "rbdyn/model/equations.hpp"
#include "rbdyn/model/rigid_state.hpp"
#include "rbdyn/rotation/quaternion.hpp"
#include "rbdyn/scene/scene.hpp"

namespace rbdyn::inline RBDYN_FORM {

class RigidLaw {
public:
    enum class Kind { free, spherical, revolute, prismatic };

    /// What derives from the user's doubles, in 32 digits.
    struct Exact {
        DoubleDouble mass;
        Matrix3Of<DoubleDouble> frame;              // columns: the frame's axes in body axes (spin zero)
        QuaternionOf<DoubleDouble> frame_attitude;  // of the frame in the body
        Vector3Of<DoubleDouble> origin;             // o, in body axes
        Vector3Of<DoubleDouble> center;             // G from o, in the frame
        Vector3Of<DoubleDouble> moments;            // about o: on the principal axes; on a hinge [2] is I_33
        Vector3Of<DoubleDouble> coupling;           // (B - C)/A, (C - A)/B, (A - B)/C; following the axis: C/A in all
        Vector3Of<DoubleDouble> weight;             // world
    };

    Kind kind = Kind::free;
    bool follows_axis = false;  // the frame does not turn about e3
    Exact exact;
    // rounded
    double mass = 0.0;
    Matrix3 frame = Matrix3::Identity();
    Quaternion frame_attitude;
    Vector3 origin = Vector3::Zero(), center = Vector3::Zero(), moments = Vector3::Ones();
    Vector3 at = Vector3::Zero();       // where o is held, or slides from, in the world
    Matrix3 inertia = Matrix3::Zero();  // about G, in the frame

    /// Of a body of a scene.
    [[gnu::cold]] RigidLaw(const Scene& scene, int index);

    /// Whether a ball joint holds o.
    bool holds_a_point() const { return kind == Kind::spherical; }
    bool turns_freely() const { return kind == Kind::free || kind == Kind::spherical; }
    int positions() const;
    /// The first coordinate of its attitude; -1: it has none.
    int first_of_attitude() const { return kind == Kind::free ? 3 : kind == Kind::spherical ? 0 : -1; }
    int velocities() const { return kind == Kind::free ? 6 : kind == Kind::spherical ? 3 : 1; }

    /// What its coordinates are, in words.
    std::string coordinates() const;

    /// The state a scene's body starts in.
    void start(const Scene::Body& b, DoubleDouble* q, DoubleDouble* v) const;

    /// The coordinates of an attitude and an angular velocity, both of the body's axes, a time after the start.
    void set_attitude(const Quaternion& attitude, const Vector3& omega, Instant since, double* q, double* v) const;

    template <class S>
    RigidState<S> state(const S* q, const S* v) const {
        RigidState<S> s;
        const Vector3Of<S> none{S(0.0), S(0.0), S(0.0)};
        s.r = constant<S>(at);
        s.v = s.omega = s.turning = none;
        switch (kind) {
            case Kind::free:
                s.r = {q[0], q[1], q[2]};
                s.v = {v[0], v[1], v[2]};
                q += 3;
                v += 3;
                [[fallthrough]];
            case Kind::spherical: {
                QuaternionOf<S> p{q[0], q[1], q[2], q[3]};
                if constexpr (std::is_floating_point_v<S>) p = unit(p);
                s.attitude = p;
                s.axes = axes(p);
                s.omega = s.turning = {v[0], v[1], v[2]};
                if (follows_axis) {
                    s.turning[2] = S(0.0);
                    s.spin = q[4];
                }
                break;
            }
            case Kind::revolute: {
                using std::cos, std::sin;
                const S c = cos(q[0]), n = sin(q[0]);
                const Vector3Of<S> x = constant<S>(exact.frame.col(0)), y = constant<S>(exact.frame.col(1));
                s.axes = {x * c + y * n, y * c - x * n, constant<S>(exact.frame.col(2))};
                s.omega[2] = s.turning[2] = v[0];
                break;
            }
            case Kind::prismatic:
                s.axes = {constant<S>(exact.frame.col(0)), constant<S>(exact.frame.col(1)),
                          constant<S>(exact.frame.col(2))};
                s.r += s.axes.e3 * q[0];
                s.v = s.axes.e3 * v[0];
                break;
        }
        if (!turns_freely()) {
            s.coordinate = q[0];
            s.rate = v[0];
        }
        return s;
    }

    /// The derivatives of the coordinates.
    template <class S>
    void rates(const RigidState<S>& s, const S* q, const Wrench<S>& w, S* q_rate, S* v_rate) const {
        if (kind == Kind::revolute) {
            *q_rate = s.rate;
            *v_rate = w.moment[2] / exactly<S>(exact.moments[2]);
            return;
        }
        if (kind == Kind::prismatic) {
            *q_rate = s.rate;
            *v_rate = dot<S>(s.axes.e3, w.force) / exactly<S>(exact.mass);
            return;
        }
        if (kind == Kind::free) {
            for (int i = 0; i < 3; ++i) {
                *q_rate++ = s.v[i];
                *v_rate++ = w.force[i] / exactly<S>(exact.mass);
            }
            q += 3;
        }
        const S half = 0.5;
        const Vector3Of<S> t = s.turning * half;
        q_rate[0] = -(q[1] * t[0]) - q[2] * t[1] - q[3] * t[2];
        q_rate[1] = q[0] * t[0] + q[2] * t[2] - q[3] * t[1];
        q_rate[2] = q[0] * t[1] + q[3] * t[0] - q[1] * t[2];
        q_rate[3] = q[0] * t[2] + q[1] * t[1] - q[2] * t[0];
        const Vector3Of<S>& o = s.omega;
        if (follows_axis) {
            q_rate[4] = o[2];
            const S across = exactly<S>(exact.moments[0]), coupling = exactly<S>(exact.coupling[0]);
            v_rate[0] = w.moment[0] / across - coupling * o[2] * o[1];
            v_rate[1] = w.moment[1] / across + coupling * o[2] * o[0];
            v_rate[2] = S(0.0);
            return;
        }
        for (int i = 0; i < 3; ++i)
            v_rate[i] = exactly<S>(exact.coupling[i]) * (o[(i + 1) % 3] * o[(i + 2) % 3]) +
                        w.moment[i] / exactly<S>(exact.moments[i]);
    }

    /// The coordinates, or the velocities, that share a scale: an attitude's is 1.
    std::vector<VariableGroup> groups(bool of_positions) const;

    /// The angular acceleration in the frame, and the acceleration of o in the world, from the rates of the velocities.
    template <class S>
    std::pair<Vector3Of<S>, Vector3Of<S>> accelerations(const RigidState<S>& s, const S* v_rate) const {
        Vector3Of<S> turning{S(0.0), S(0.0), S(0.0)}, moving = turning;
        if (kind == Kind::revolute) turning[2] = v_rate[0];
        if (kind == Kind::prismatic) moving = s.axes.e3 * v_rate[0];
        if (kind == Kind::free) {
            moving = {v_rate[0], v_rate[1], v_rate[2]};
            v_rate += 3;
        }
        if (turns_freely()) turning = Vector3Of<S>(v_rate[0], v_rate[1], v_rate[2]) + cross<S>(s.turning, s.omega);
        return {turning, moving};
    }

    /// A vector of the frame in body axes, and one of the body in the frame.
    template <class S>
    Vector3Of<S> to_body(const RigidState<S>& s, const Vector3Of<S>& a) const {
        return turned<S>(exact.frame, follows_axis ? spun(a, S(-s.spin)) : a);
    }
    template <class S>
    Vector3Of<S> from_body(const RigidState<S>& s, const Vector3Of<S>& a) const {
        const Vector3Of<S> b = turned<S>(exact.frame.transpose(), a);
        return follows_axis ? spun(b, s.spin) : b;
    }
    /// The body's own axes in the world.
    template <class S>
    AxesOf<S> body_axes(const RigidState<S>& s) const {
        const auto axis = [&](int i) {
            const Vector3Of<S> e = constant<S>(Vector3(Vector3::Unit(i)));
            return kind == Kind::prismatic ? e : s.to_world(from_body(s, e));
        };
        return {axis(0), axis(1), axis(2)};
    }
    /// The origin of the body's axes from o, in the frame.
    template <class S>
    Vector3Of<S> origin_in_frame(const RigidState<S>& s) const {
        return from_body(s, constant<S>(-exact.origin));
    }
    /// The acceleration of a point of the body, world axes; what accelerations() says is given.
    template <class S>
    static Vector3Of<S> acceleration(const RigidState<S>& s, const std::pair<Vector3Of<S>, Vector3Of<S>>& rates,
                                     const Vector3Of<S>& point) {
        return rates.second +
               s.to_world(Vector3Of<S>(cross<S>(rates.first, point) + cross<S>(s.omega, cross<S>(s.omega, point))));
    }
    /// The quaternion of the body's axes.
    template <class S>
    QuaternionOf<S> attitude(const RigidState<S>& s) const {
        using std::cos, std::sin;
        if (kind == Kind::prismatic) return {S(1.0), S(0.0), S(0.0), S(0.0)};
        if (kind == Kind::revolute) {
            const S half = s.coordinate * S(0.5), n = sin(half);
            const Vector3Of<S> e = constant<S>(exact.frame.col(2));
            return {cos(half), n * e[0], n * e[1], n * e[2]};
        }
        QuaternionOf<S> q = s.attitude;
        if (follows_axis) {
            const S half = s.spin * S(0.5);
            q = q * QuaternionOf<S>{cos(half), S(0.0), S(0.0), sin(half)};
        }
        const QuaternionOf<DoubleDouble>& f = exact.frame_attitude;
        if (f == QuaternionOf<DoubleDouble>{}) return q;
        return q * QuaternionOf<S>{exactly<S>(f.w), exactly<S>(-f.x), exactly<S>(-f.y), exactly<S>(-f.z)};
    }

    /// A point given in body axes, in the frame; with spin zero.
    Vector3Of<DoubleDouble> point_in_frame(const Vector3& p) const { return in_frame(widened(p) - exact.origin); }

    template <class S>
    static Vector3Of<S> constant(const Vector3Of<DoubleDouble>& a) {
        return exactly<S>(a);
    }
    /// m v
    template <class S>
    static Vector3Of<S> turned(const Matrix3Of<DoubleDouble>& m, const Vector3Of<S>& v) {
        Vector3Of<S> result;
        for (int i = 0; i < 3; ++i)
            result[i] = exactly<S>(m(i, 0)) * v[0] + exactly<S>(m(i, 1)) * v[1] + exactly<S>(m(i, 2)) * v[2];
        return result;
    }
    template <class S>
    static Vector3Of<S> constant(const Vector3& a) {
        return Vector3Of<S>(S(a[0]), S(a[1]), S(a[2]));
    }
    template <class S>
    static bool is_exactly_zero(const S& x) {
        if constexpr (std::is_same_v<S, Expression>)
            return x.is_zero();
        else
            return x == S(0.0);
    }

private:
    // how far from the axis, over the distance from o, doubles leave a point that is on it
    static constexpr double off_axis = 4.0 * std::numeric_limits<double>::epsilon();

    /// v turned about e3.
    template <class S>
    static Vector3Of<S> spun(const Vector3Of<S>& a, const S& angle) {
        using std::cos, std::sin;
        if (is_exactly_zero(a[0]) && is_exactly_zero(a[1])) return a;
        const S c = cos(angle), n = sin(angle);
        return Vector3Of<S>(c * a[0] - n * a[1], n * a[0] + c * a[1], a[2]);
    }
    template <class S>
    static QuaternionOf<S> unit(const QuaternionOf<S>& q) {
        const S n = std::sqrt(squared_norm(q));
        return {q.w / n, q.x / n, q.y / n, q.z / n};
    }

    /// v in components of the frame, without what is rounding in them: that of 32 digits, or of the doubles that put it
    /// on the axis that the frame follows.
    Vector3Of<DoubleDouble> in_frame(const Vector3Of<DoubleDouble>& v) const;

    /// e3 along the axis, G in the plane of e3 and e1.
    static Matrix3Of<DoubleDouble> hinge_frame(const Vector3Of<DoubleDouble>& axis,
                                               const Vector3Of<DoubleDouble>& to_center);
    static Vector3Of<DoubleDouble> unit(const Vector3Of<DoubleDouble>& v);
    /// The world axis most across a direction.
    static Vector3 least_along(const Vector3& direction);

    /// The principal axes about o; for a symmetric body loaded on its axis, that axis third.
    void choose_principal_frame(const Scene& scene, int index, const PrincipalAxesOf<DoubleDouble>& p,
                                const Vector3Of<DoubleDouble>& to_center);

    /// Whether all that acts on a body acts at points of the axis e through o, and not along axes of the body.
    bool acts_on_axis(const Scene& scene, int index, const Vector3Of<DoubleDouble>& e) const;
};

}  // namespace rbdyn::inline RBDYN_FORM
