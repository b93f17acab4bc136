// The general assembly: accelerations and reactions of any scene from its joints alone, in doubles. The special laws
// (special/) are optimisations of it, and the tests compare them with it.
//
// A joint is a pose of the body's axes, a motion subspace S and a bias b: with velocities v of the joint's own,
//     (omega, v_O) = S v,   (omega', a_O) = S v' + b,      world axes, O the origin of the body's axes.
// With c = G - O the body's law at O (7.38, 7.39, 7.47) is M (omega', a_O) + h = W + Phi,
//     M = | I_G - m [c][c]   m [c] |    h = | omega x I_G omega + m c x (omega x (omega x c)) |
//         |    -m [c]         m 1  |        |            m omega x (omega x c)              |
// W the wrench (moment about O, force) of what acts, Phi that of the joint. Ideal: S^T Phi = 0 (7.57, 7.60, 7.16), so
//     S^T M S v' = S^T (W - h - M b).
// Every parent is the ground, so one block a body. Friction, drives and moving rails are not in it.
#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/scene/scene.hpp"

namespace rbdyn::inline RBDYN_FORM {

/// How a body may move where it is.
struct JointMotion {
    using Columns = Eigen::Matrix<double, 6, Eigen::Dynamic>;
    using Six = Eigen::Matrix<double, 6, 1>;

    Vector3 position = Vector3::Zero(), held = Vector3::Zero();  // of O, and of the point the joint holds
    Matrix3 axes = Matrix3::Identity();                          // of the body
    Columns subspace;                                            // S
    Six bias = Six::Zero();                                      // b
    Six velocity = Six::Zero();                                  // S v

    /// Of a body of a scene at the state it starts in.
    explicit JointMotion(const Scene::Body& b);

    Vector3 omega() const { return velocity.head(3); }
    /// Place and velocity of a point given in body axes.
    std::pair<Vector3, Vector3> point(const Vector3& p) const;
    /// [v] with [v] a = v x a.
    static Matrix3 cross_matrix(const Vector3& v);
};

/// One body of a scene, world axes; about the point its joint holds.
struct AssembledBody {
    Vector3 angular_acceleration, acceleration;  // the latter of the origin of the body's axes
    Vector3 force;                               // of all that acts
    Vector3 reaction, reaction_torque;
    std::vector<double> virtual_power;  // of the reactions on every virtual motion of the joint: zero but for rounding
    double effort;                      // the size of what these are differences of, forces and moments together
};

class Assembly {
public:
    /// Of a scene at the state it starts in, at a time.
    explicit Assembly(const Scene& scene, double t = 0.0);

    const JointMotion& motion(int body) const { return motions_[at(body)]; }
    /// Moment of all that acts, about a point of the world.
    Vector3 moment(int body, const Vector3& pole) const;

    AssembledBody body(int index) const;

private:
    static std::size_t at(int i) { return static_cast<std::size_t>(i); }
    static Vector3 center_of(const Scene::Body& b);
    static Vector3 center_arm(const Scene::Body& b, const JointMotion& j) { return j.axes * center_of(b); }
    /// I_G in world axes. A particle has none, and turns with nothing: any will do that can be solved for.
    static Matrix3 central_inertia(const Scene::Body& b, const JointMotion& j);

    void act(int body, const Vector3& force, const Vector3& place);
    void weigh(int body);
    void apply(const Scene::AppliedLoad& load, double t);
    void connect(const Scene::Connection& c, double t);

    Scene scene_;
    std::vector<JointMotion> motions_;
    std::vector<JointMotion::Six> wrenches_;
};

}  // namespace rbdyn::inline RBDYN_FORM
