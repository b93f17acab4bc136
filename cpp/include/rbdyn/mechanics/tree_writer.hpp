// The equations of a tree as recorded programs.
#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/expression/node.hpp"
#include "rbdyn/expression/recorder.hpp"
#include "rbdyn/mechanics/constraint.hpp"
#include "rbdyn/mechanics/contact.hpp"
#include "rbdyn/mechanics/contact_state.hpp"
#include "rbdyn/mechanics/exert.hpp"
#include "rbdyn/mechanics/joint_friction.hpp"
#include "rbdyn/mechanics/loose_rail.hpp"
#include "rbdyn/mechanics/tree.hpp"
#include "rbdyn/model/equations_writer.hpp"
#include "rbdyn/scene/scene.hpp"
#include "rbdyn/scene/watch.hpp"

namespace rbdyn::inline RBDYN_FORM {

namespace mechanics {

/// The direction across a normal that an axis has.
inline Vector3Of<Expression> unit_along(const Vector3Of<Expression>& axis, const Vector3Of<Expression>& normal) {
    const Vector3Of<Expression> along = cross<Expression>(axis, normal);
    return along * (Expression(1.0) / sqrt(dot<Expression>(along, along)));
}

/// The motion of a tree as expressions: recorded in two turns (model/sliding.hpp), first the laws, then the guards.
class TreeWriter {
public:
    using S = Expression;

    /// `rows`: those used; `states`: what each contact does, and behind them each resistance and each rough joint. Of
    /// each contact that has_numbers(), each resistance and each joint that slides the mode has parameters, the numbers
    /// of its memory, the first of all.
    TreeWriter(Recorder& r, const Tree& tree, const Conditions& conditions, const Exerted& exerted,
               const std::vector<RoughJoint>& joints, const std::vector<int>& rows,
               const std::vector<signed char>& states);

    /// That the multipliers of constraints are solved for again, for what they lack of what is asked: with a heavy body
    /// on a light one their matrix has fewer digits than they.
    void make_up() { makes_up_ = true; }
    /// The rates of all variables, and what acts, in the layout of tree_state.hpp.
    std::vector<S> laws();
    /// Takes them as they are in the motion, each distinction weighed once.
    /// A factor of how a body turns that stands on a contact: 0 where it slides straight.
    const S& turns(int contact) const { return friction_[at(contact)].turns; }
    void take(std::span<const S> values) { values_.assign(values.begin(), values.end()); }
    /// The guards of contacts: what comes to touch, what would have to pull, and what friction does next.
    void touch(EquationsWriter& write) const;
    /// What friction in joints does: what is held does not move, and the guards of what follows.
    void rub(EquationsWriter& write);
    /// The independence of the used rows of constraints: of each, what of it is independent of those before it, over
    /// what that was as the scene started.
    void guard_pivots(EquationsWriter& write, const std::vector<double>& first) const;
    /// The ends of curves: of rails, and of those that points are held on.
    void guard_ends(EquationsWriter& write) const;
    /// What presses a bead on its rail along the way that it pushes, |r'| times; and how high one is over its rail.
    S pressing(const LooseRail& rail) const;
    S height(const LooseRail& rail) const;
    /// What driven joints do, and that it is finite.
    void guard_drives(EquationsWriter& write);
    /// The first of their outputs; -1: there are none.
    int drives() const { return drives_; }
    /// The first output of the speeds of rails' surfaces that vary; -1: there are none.
    int surfaces() const { return surfaces_; }
    /// The constraints that have rows which are not used and are not zero for good.
    std::vector<int> loose() const;
    /// How far the rows that are used are from depending on each other: the determinant of J M^-1 J^T over the product
    /// of units of its diagonal.
    S independence(const std::vector<double>& units) const;
    /// The guards of watched functions.
    void watch(EquationsWriter& write, const std::vector<Scene::Watch>& watches) const;

private:
    static std::size_t at(int i) { return static_cast<std::size_t>(i); }
    /// What a contact remembers, as parameters.
    struct Friction {
        Vector3Of<S> axis = none<S>(), force = none<S>();  // of its ContactMemory
        S least = S(0.0);
        Vector3Of<S> along = none<S>();  // the direction it slides in
        S speed = S(0.0);                // in that direction
        S left = S(0.0);                 // of the time in which it curves [s]
        S turns = S(1.0);                // 0: its body slides straight and does not turn
    };
    /// The place among the values of what a rough contact does: its force (3), and where it slides numerator and
    /// denominator of N; its torque (3).
    std::size_t place(int contact) const { return first_of_joints() - per_contact * (touching_.size() - at(contact)); }
    std::size_t first_multiplier() const { return first_of_joints() - rows_.size() - per_contact * touching_.size(); }
    static constexpr std::size_t per_contact = 8;
    /// Behind them of each rough joint: its friction, what presses it (2), the square of what is left to the direction
    /// of that, and a pivot.
    static constexpr std::size_t per_joint = JointMemory::said;
    std::size_t first_of_joints() const { return values_.size() - per_joint * joints_.size(); }
    Vector3Of<S> vector_at(std::size_t i) const { return {values_[i], values_[i + 1], values_[i + 2]}; }
    /// A unit of the normal force with its friction.
    Vector3Of<S> pushing(std::size_t contact) const;
    /// What of a contact's force the motion does not determine.
    Vector3Of<S> shared(std::size_t contact) const;
    void guard_friction(EquationsWriter& write, int contact) const;
    /// Where contacts and joints slide, the determinant of what determines their forces: above zero where there is one
    /// motion, whatever the signs of its factors, each of a contact or a joint with those before it.
    std::optional<S> grip() const;
    /// How one side of a contact turns on the other, along the surface or about its normal.
    struct Turning {
        std::array<S, 2> last{S(0.0), S(0.0)}, rate{S(0.0), S(0.0)}, along{S(0.0), S(0.0)};  // as parameter; now
        S least = S(0.0), speed = S(0.0);
    };
    /// The torque on the first side of a contact that turns, of a unit of normal force.
    Vector3Of<S> twisting(std::size_t contact) const;
    void guard_resistance(EquationsWriter& write, std::size_t resistance) const;
    /// What a rough joint remembers, as parameters.
    struct Pressed {
        S least_rate = S(0.0), least_load = S(0.0);
        std::array<S, 2> along{S(0.0), S(0.0)};
    };
    /// The rows that hold in a mode, in the order in which they are solved for.
    struct Solved {
        std::vector<std::size_t> order;    // among the rows used
        std::vector<Row<S>> rows, acting;  // and what a unit of the force of each is
        bool is_symmetric = true;
    };
    /// Adds friction in joints that slide to what drives the tree and to the multipliers of rows; returns what is said
    /// of all of it among the values.
    std::vector<S> add_friction(const Accelerate<S>& tree, const Acts& acts, const Solved& solved, std::vector<S>& u,
                                std::vector<S>& multipliers) const;
    /// What a watched function asks for.
    S observed(const Observable& o) const;
    /// A vector among what acts, by its place behind the rates.
    Vector3Of<S> acting(int first) const;
    Vector3Of<S> acceleration(int body, const Vector3Of<S>& arm) const;
    /// What the parent of a body exerts on it through and along the joint, about P.
    Wrench<S> reaction(int body) const;
    /// The same without what is exerted along the joint: by a torsion spring, a joint torque or force.
    Wrench<S> reaction_alone(int body) const;

    Recorder& r_;
    const Tree& tree_;
    const Conditions& conditions_;
    const Exerted& exerted_;
    const std::vector<RoughJoint>& joints_;
    const std::vector<int>& rows_;
    const std::vector<signed char> states_, resistance_states_, joint_states_;
    std::vector<Touching<S>> touching_;
    std::vector<Friction> friction_;  // of each contact
    std::vector<Turning> turning_;    // each resistance
    std::vector<Pressed> pressed_;    // each rough joint
    std::vector<S> q_, v_, values_, pivots_;
    int drives_ = -1, surfaces_ = -1;
    std::vector<Moving<S>> moving_;
    bool makes_up_ = false;
};

}  // namespace mechanics

}  // namespace rbdyn::inline RBDYN_FORM
