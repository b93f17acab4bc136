// What a tree does at a state of a mode, in doubles: motion, what acts, accelerations and reactions.
//
// What acts and how it accelerates everything comes from the equations of the mode, as guards have it (see
// model/acting.hpp). Layout of the values behind the rates of the state: of each body force [N] and moment about P
// [N m] of what acts, its angular acceleration and the acceleration of P; of each coupling the force on its first end
// [N]; of each load its power [W]; along each velocity of the joints what is exerted [N or N m]; the multiplier of each
// row of the constraints that is used; of each contact the force on its first side [N], two numbers of no use
// here, and the torque [N m]; what is said of friction in joints, of no use here. World axes.
//
// The reaction of a joint is what is left of the law of its body, m a_G and the rate of K_G, less what acts, less what
// constraints and the joints of its children exert on it, and less what is exerted along the joint; friction in the
// joint is part of it.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/mechanics/constraint.hpp"
#include "rbdyn/mechanics/exert.hpp"
#include "rbdyn/mechanics/moving.hpp"
#include "rbdyn/mechanics/tree.hpp"
#include "rbdyn/model/body_report.hpp"
#include "rbdyn/model/rigid_state.hpp"
#include "rbdyn/model/scene_model.hpp"
#include "rbdyn/model/system_report.hpp"

namespace rbdyn::inline RBDYN_FORM {

namespace mechanics {

struct TreeState {
    struct Body {
        Vector3 arm, center, velocity, acceleration;        // of G; arm from P
        Matrix3 inertia;                                    // about G, world axes
        Vector3 spin_momentum, spin_rate;                   // K_G and its rate
        Vector3 angular_acceleration, origin_acceleration;  // the latter of P
        Wrench<double> acts, reaction;                      // about P
        Wrench<double> effort;                              // sizes of what the reaction is a difference of
    };

    const Tree& tree;
    std::vector<Moving<double>> moving;
    std::vector<Body> bodies;
    std::vector<Vector3> couplings;
    std::vector<double> powers;
    std::vector<double> along;  // by velocity: what springs and loads of joints exert along it [N, N m]
    std::vector<ConstraintReport> constraints;
    std::vector<ContactReport> contacts;
    std::vector<Vector3> torques;  // of each contact, on its first side, against rolling and pivoting [N m]

    /// `values`: as in the layout, without the rates. `rows`: those used.
    TreeState(const Tree& tree, const Conditions& conditions, const Exerted& exerted, const std::vector<int>& rows,
              std::vector<Moving<double>> moving, std::span<const double> values);

    /// Motion alone: no forces, no accelerations.
    TreeState(const Tree& tree, std::vector<Moving<double>> moving);

    PointReport point(int body) const;
    /// With couplings among what is applied.
    BodyReport body_report(int body, std::span<const double> x) const;
    RigidReport rigid(int body, std::span<const double> x) const;

private:
    void place();
    static std::size_t at(int i) { return static_cast<std::size_t>(i); }
};

}  // namespace mechanics

}  // namespace rbdyn::inline RBDYN_FORM
