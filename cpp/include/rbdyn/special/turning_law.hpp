// The law of a rigid body that turns freely, about its centre of mass or about the point that a ball joint holds.
//
// About o on principal axes (Euler's equations, 7.47, 7.48), M the moment about o:
//     A w1' = (B - C) w2 w3 + M1   and cyclically
// A symmetric body, A = B, whose forces act on its axis only, is written in the frame that follows the axis e3 and does
// not turn about it (rigid_state.hpp):
//     A w1' = M1 - C w3 w2,  A w2' = M2 + C w3 w1,  w3' = 0,  spin' = w3
// Coordinates, behind those of the place of one that is free: quaternion (w, x, y, z), in the frame that does not turn
// spin | w1, w2, w3.
#pragma once

#include <cmath>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/double_double_vector.hpp"
#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/body/principal_axes.hpp"
#include "rbdyn/model/rigid_state.hpp"
#include "rbdyn/rotation/quaternion.hpp"
#include "rbdyn/scene/scene.hpp"
#include "rbdyn/special/body_form.hpp"
#include "rbdyn/special/rigid_law.hpp"
#include "rbdyn/special/words.hpp"

namespace rbdyn::inline RBDYN_FORM {

class TurningLaw : public RigidLaw {
public:
    Vector3Of<DoubleDouble> coupling;  // (B - C)/A, (C - A)/B, (A - B)/C; following the axis: C/A in all

    int positions() const override { return first_turn() + (follows_axis ? 5 : 4); }
    int velocities() const override { return first_turn() + 3; }
    int first_of_attitude() const override { return first_turn(); }
    int fixed_velocity() const override { return follows_axis ? velocities() - 1 : -1; }
    std::vector<VariableGroup> groups(bool of_positions) const override;
    std::unique_ptr<const Projection> projection(std::span<const double> x, std::span<const double> low) const override;
    const char* mover() const override { return "a force, a moment or a velocity"; }
    std::vector<std::string> words() const override;

    /// The frame of its attitude, for motions in closed form.
    closed_forms::TurningFrame turning_frame() const { return {frame, frame_attitude, follows_axis}; }

    template <class T>
    QuaternionOf<T> turn(const RigidState<T>& s) const {
        using std::cos, std::sin;
        QuaternionOf<T> q = s.attitude;
        if (follows_axis) {
            const T half = s.spin * T(0.5);
            q = q * QuaternionOf<T>{cos(half), T(0.0), T(0.0), sin(half)};
        }
        const QuaternionOf<DoubleDouble>& f = exact.frame_attitude;
        if (f == QuaternionOf<DoubleDouble>{}) return q;
        return q * QuaternionOf<T>{exactly<T>(f.w), exactly<T>(-f.x), exactly<T>(-f.y), exactly<T>(-f.z)};
    }

protected:
    /// `about_o`: the tensor of inertia about o, body axes.
    TurningLaw(const Scene& scene, int place, const Vector3& at, const Vector3& origin,
               const Vector3Of<DoubleDouble>& exact_origin, const Matrix3Of<DoubleDouble>& about_o);

    /// Coordinates from those of the attitude on: how they turn the body, and how they change.
    template <class T>
    void place_turned(RigidState<T>& s, const T* q, const T* v) const {
        QuaternionOf<T> p{q[0], q[1], q[2], q[3]};
        if constexpr (std::is_floating_point_v<T>) p = unit(p);
        s.attitude = p;
        s.axes = axes(p);
        s.omega = s.turning = {v[0], v[1], v[2]};
        if (follows_axis) {
            s.turning[2] = T(0.0);
            s.spin = q[4];
        }
    }
    template <class T>
    void turn_by(const RigidState<T>& s, const T* q, const Wrench<T>& w, T* q_rate, T* v_rate) const {
        const T half = 0.5;
        const Vector3Of<T> t = s.turning * half;
        q_rate[0] = -(q[1] * t[0]) - q[2] * t[1] - q[3] * t[2];
        q_rate[1] = q[0] * t[0] + q[2] * t[2] - q[3] * t[1];
        q_rate[2] = q[0] * t[1] + q[3] * t[0] - q[1] * t[2];
        q_rate[3] = q[0] * t[2] + q[1] * t[1] - q[2] * t[0];
        const Vector3Of<T>& o = s.omega;
        if (follows_axis) {
            q_rate[4] = o[2];
            const T across = exactly<T>(exact.moments[0]), coupled = exactly<T>(coupling[0]);
            v_rate[0] = w.moment[0] / across - coupled * o[2] * o[1];
            v_rate[1] = w.moment[1] / across + coupled * o[2] * o[0];
            v_rate[2] = T(0.0);
            return;
        }
        for (int i = 0; i < 3; ++i)
            v_rate[i] = exactly<T>(coupling[i]) * (o[(i + 1) % 3] * o[(i + 2) % 3]) +
                        w.moment[i] / exactly<T>(exact.moments[i]);
    }
    template <class T>
    static Vector3Of<T> angular_acceleration(const RigidState<T>& s, const T* v_rate) {
        return Vector3Of<T>(v_rate[0], v_rate[1], v_rate[2]) + cross<T>(s.turning, s.omega);
    }
    /// The attitude and the angular velocity of a start.
    void start_turned(const Scene::Body& b, DoubleDouble* q, DoubleDouble* v) const;
    /// The coordinates of its attitude in words, all of them, and those that are simulated by name.
    std::string whole_attitude() const;
    planning::Named part_of_attitude(const StateMap& map) const;
    /// What of its rotation is left out; `about`: what it turns about.
    void leave_out_turns(const StateMap& map, const char* about, std::vector<Omission>& omissions) const;

private:
    template <class T>
    static QuaternionOf<T> unit(const QuaternionOf<T>& q) {
        const T n = std::sqrt(squared_norm(q));
        return {q.w / n, q.x / n, q.y / n, q.z / n};
    }
    /// The principal axes about o; for a symmetric body loaded on its axis, that axis third.
    void choose_principal_frame(const Scene& scene, const PrincipalAxesOf<DoubleDouble>& p);
    /// Whether all that acts on it acts at points of the axis e through o, and not along axes of the body.
    bool acts_on_axis(const Scene& scene, const Vector3Of<DoubleDouble>& e) const;
};

}  // namespace rbdyn::inline RBDYN_FORM
