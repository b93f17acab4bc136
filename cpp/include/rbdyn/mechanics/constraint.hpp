// Constraints of a scene as conditions on the motion of a tree.
//
// Each is a number of rows, gap = 0, gap' = on_a . (omega_a, v_a) + on_b . (omega_b, v_b) = 0, and gap'' = 0:
//     two points          e_k . (a - b), e_k the world's axes, or others that are fixed in it, or those of a or b: of
//                         three that are not all independent some stay so while all turns (redundant.hpp)
//     a distance          (|a - b|^2 - l^2) / 2
//     a point on a plane  n . (a - c), n and c fixed in b
//     a point on a curve  n_1 . (a - f), n_2 . (a - f), f its foot, n_1 and n_2 across the curve there (foot.hpp)
//     right angles        u . e, u fixed in a and e fixed in b:  (u . e)' = (omega_a - omega_b) . (u x e)
// A hinge is two points and two right angles with its axis, a weld two points and three, a universal joint two and one.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/double_double_vector.hpp"
#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/mechanics/accelerate.hpp"
#include "rbdyn/mechanics/contact.hpp"
#include "rbdyn/mechanics/moving.hpp"
#include "rbdyn/mechanics/tree.hpp"
#include "rbdyn/model/rigid_state.hpp"
#include "rbdyn/scene/scene.hpp"

namespace rbdyn::inline RBDYN_FORM {

namespace mechanics {

/// The rows of one constraint, with what is fixed in its bodies.
struct Condition {
    enum class Points { none, coincide, distance, plane, curve };
    enum class Axes { world, of_a, of_b, fixed };

    std::string name;
    Anchor a, b;
    Points points = Points::coincide;
    Axes axes = Axes::world;  // of two points
    std::array<Vector3Of<DoubleDouble>, 3> fixed{};
    DoubleDouble length;               // of a distance
    Vector3Of<DoubleDouble> normal{};  // of a plane, axes of b; its point is that of b
    struct RightAngle {
        Vector3Of<DoubleDouble> in_a{}, in_b{};
        bool operator==(const RightAngle&) const = default;
    };
    std::vector<RightAngle> angles;
    int foot = -1;  // of a curve: among the feet of the tree
    int first = 0;  // among all rows

    bool operator==(const Condition&) const = default;
    int rows() const {
        const int of_points = points == Points::coincide ? 3
                              : points == Points::curve  ? 2
                              : points == Points::none   ? 0
                                                         : 1;
        return of_points + static_cast<int>(angles.size());
    }
};

class Conditions {
public:
    Conditions() = default;
    /// Of a scene that starts at x.
    [[gnu::cold]] Conditions(const Scene& scene, const Tree& tree, const std::vector<Moving<DoubleDouble>>& start);

    const std::vector<Condition>& all() const { return conditions_; }
    /// What touches: of each one row, its gap, behind those of the constraints; behind them of each three, the velocity
    /// of what is held by friction, along three axes (Touching::held_axis).
    const std::vector<ContactLaw>& contacts() const { return contacts_; }
    int rows() const { return joint_row(static_cast<int>(joints_.size())); }
    /// Behind all others one of each joint that friction may hold, which has no gap.
    int joint_row(int joint) const {
        return first_of_resistances() + 2 * static_cast<int>(resistances_.size()) + joint;
    }
    /// Joints with friction: its body, and whether it turns.
    struct Rubbing {
        int body = -1;
        bool turns = false;
    };
    /// The body whose joint a row is along; -1: it is none of a joint.
    int joint_of(int row) const {
        const int joint = row - joint_row(0);
        return joint < 0 ? -1 : joints_[static_cast<std::size_t>(joint)].body;
    }
    void take_joints(std::vector<Rubbing> joints) {
        joints_ = std::move(joints);
        // smooth contacts are then solved with what is rough
        is_rough_ = is_rough_ || (!joints_.empty() && !contacts_.empty());
    }
    /// What resists rolling or pivoting: behind all others of each two rows, of which pivoting has one.
    const std::vector<Resistance>& resistances() const { return resistances_; }
    int resistance_row(int resistance, int k) const { return first_of_resistances() + 2 * resistance + k; }
    int constraint_rows() const { return rows_; }
    int normal_row(int contact) const { return rows_ + contact; }
    int held_row(int contact, int axis) const {
        return rows_ + static_cast<int>(contacts_.size()) + 3 * contact + axis;
    }
    /// Whether any contact has friction.
    bool is_rough() const { return is_rough_; }
    bool empty() const { return conditions_.empty() && contacts_.empty(); }
    /// Which axes the difference of the two points of a constraint is told in.
    void tell_in(int constraint, Condition::Axes axes) {
        conditions_[static_cast<std::size_t>(constraint)].axes = axes;
    }
    /// The same in axes fixed in the world, of which the last one is given.
    void tell_along(int constraint, const Vector3& last);

    /// All rows where the tree is.
    template <class S>
    std::vector<Row<S>> rows(const Tree& tree, const std::vector<Moving<S>>& all) const {
        std::vector<Row<S>> rows;
        for (const Condition& c : conditions_) {
            const Ends<S> ends(tree, c, all);
            if (c.points == Condition::Points::coincide)
                for (int k = 0; k < 3; ++k) {
                    const Vector3Of<S> e = ends.axis(c, k);
                    if (c.axes == Condition::Axes::world)
                        rows.push_back(pushing(ends, e, ends.arm_b, ends.relative_bias[k]));
                    else if (c.axes == Condition::Axes::fixed)
                        rows.push_back(pushing(ends, e, ends.arm_b, dot<S>(e, ends.relative_bias)));
                    else
                        rows.push_back(c.axes == Condition::Axes::of_b ? across_b(ends, e) : across_a(ends, e));
                }
            if (c.points == Condition::Points::distance)
                rows.push_back(pushing(ends, ends.apart, ends.arm_b,
                                       S(dot<S>(ends.apart, ends.relative_bias) +
                                         dot<S>(ends.relative_velocity, ends.relative_velocity))));
            if (c.points == Condition::Points::plane)
                rows.push_back(across_b(ends, ends.b.to_world(exactly<S>(c.normal))));
            if (c.points == Condition::Points::curve) {
                const Moving<S>& foot = foot_of<S>(tree, c, all);
                for (std::size_t k = 1; k < 3; ++k)
                    rows.push_back(pushing(ends, foot.joint[k].move, Vector3Of<S>(ends.arm_b + ends.apart),
                                           dot<S>(foot.joint[k].move, Vector3Of<S>(ends.bias_a - foot.bias))));
            }
            for (const Condition::RightAngle& angle : c.angles) {
                const Vector3Of<S> u = ends.a.to_world(exactly<S>(angle.in_a)),
                                   e = ends.b.to_world(exactly<S>(angle.in_b)), m = cross<S>(u, e);
                const Vector3Of<S> turning = ends.a.omega - ends.b.omega,
                                   m_rate =
                                       cross<S>(cross<S>(ends.a.omega, u), e) + cross<S>(u, cross<S>(ends.b.omega, e));
                Row<S> row{c.a.body, c.b.body, {}, {}, S(0.0)};
                row.on_a.moment = m;
                row.on_b.moment = -m;
                row.bias = dot<S>(m, Vector3Of<S>(ends.a.bias_turn - ends.b.bias_turn)) + dot<S>(m_rate, turning);
                rows.push_back(row);
            }
        }
        std::vector<Touching<S>> touching;
        for (const ContactLaw& c : contacts_) touching.push_back(c.touching<S>(tree, all));
        for (const Touching<S>& t : touching) rows.push_back(t.row(t.normal, t.normal_rate));
        if (is_rough_)
            for (const Touching<S>& t : touching)
                for (int axis = 0; axis < 3; ++axis) rows.push_back(t.held_row(axis));
        for (const Resistance& r : resistances_)
            for (int k = 0; k < 2; ++k) {
                const Touching<S>& t = touching[static_cast<std::size_t>(r.contact)];
                rows.push_back(k < r.rows() ? r.row(t, k) : Row<S>{t.a, t.b, {}, {}, S(0.0)});
            }
        for (const Rubbing& joint : joints_) rows.push_back(along<S>(joint, tree, all));
        return rows;
    }

    /// How far each row is from being satisfied.
    template <class S>
    std::vector<S> gaps(const Tree& tree, const std::vector<Moving<S>>& all) const {
        std::vector<S> gaps;
        for (const Condition& c : conditions_) {
            const Ends<S> ends(tree, c, all);
            if (c.points == Condition::Points::coincide)
                for (int k = 0; k < 3; ++k)
                    gaps.push_back(c.axes == Condition::Axes::world ? ends.apart[k]
                                                                    : dot<S>(ends.axis(c, k), ends.apart));
            if (c.points == Condition::Points::distance) {
                const S length = exactly<S>(c.length);
                gaps.push_back((dot<S>(ends.apart, ends.apart) - length * length) * S(0.5));
            }
            if (c.points == Condition::Points::plane)
                gaps.push_back(dot<S>(ends.b.to_world(exactly<S>(c.normal)), ends.apart));
            if (c.points == Condition::Points::curve) {
                const Moving<S>& foot = foot_of<S>(tree, c, all);
                for (std::size_t k = 1; k < 3; ++k)
                    gaps.push_back(
                        dot<S>(foot.joint[k].move, Vector3Of<S>(tree.point<S>(c.a, all).place - foot.place)));
            }
            for (const Condition::RightAngle& angle : c.angles)
                gaps.push_back(
                    dot<S>(ends.a.to_world(exactly<S>(angle.in_a)), ends.b.to_world(exactly<S>(angle.in_b))));
        }
        for (const ContactLaw& c : contacts_) gaps.push_back(c.touching<S>(tree, all).gap);
        return gaps;
    }

    /// The longest arm of what constraints and contacts join, of points from what carries them, of centres and of
    /// inertia, and no less than any length that they say [m]: it is the same wherever all of it is.
    double arm() const { return arm_; }
    /// What makes rows of different kinds compare, in any unit: a multiplier times this is a force [N], a gap over it a
    /// length [m]. 1 of points, the length of a distance, and of what turns 1 over the arm.
    std::vector<double> measures() const;

    /// How far the points and axes of a constraint are from where they should be [m], angles at the arm.
    double gap(const Tree& tree, int index, const std::vector<Moving<double>>& all) const;
    /// The rate of a row from the motion of its bodies.
    template <class S>
    static S rate(const Row<S>& row, const std::vector<Moving<S>>& all) {
        S sum(0.0);
        if (row.a >= 0) {
            const Moving<S>& m = all[static_cast<std::size_t>(row.a)];
            sum += power(Twist<S>{m.omega, m.velocity}, row.on_a);
        }
        if (row.b >= 0) {
            const Moving<S>& m = all[static_cast<std::size_t>(row.b)];
            sum += power(Twist<S>{m.omega, m.velocity}, row.on_b);
        }
        return sum;
    }

private:
    /// The acceleration of a joint that rubs, without what a rail's curve makes of it.
    template <class S>
    static Row<S> along(const Rubbing& joint, const Tree& tree, const std::vector<Moving<S>>& all) {
        using std::sqrt;
        const int parent = tree.node(joint.body).parent;
        const Moving<S>& m = all[static_cast<std::size_t>(joint.body)];
        const Twist<S>& motion = m.joint.front();
        Row<S> row{joint.body, parent, {}, {}, S(0.0), true};
        if (joint.turns) {
            row.on_a.moment = motion.turn;
            row.on_b.moment = -motion.turn;
            return row;
        }
        // a bead that flies
        if (is_nothing(Wrench<S>{motion.move, motion.turn})) return row;
        row.pace = sqrt(dot<S>(motion.move, motion.move));
        const Vector3Of<S> way = motion.move * (S(1.0) / row.pace);
        row.on_a.force = way;
        row.on_b.force = -way;
        if (parent >= 0)
            row.on_b.moment =
                cross<S>(Vector3Of<S>(m.place - all[static_cast<std::size_t>(parent)].place), row.on_b.force);
        return row;
    }
    /// The two ends of a constraint.
    template <class S>
    struct Ends {
        Moving<S> a, b;
        int index_a, index_b;
        Vector3Of<S> arm_a, arm_b, apart, relative_velocity, relative_bias, velocity_a, bias_a;

        Ends(const Tree& tree, const Condition& c, const std::vector<Moving<S>>& all)
            : index_a(c.a.body), index_b(c.b.body) {
            if (c.a.body >= 0) a = all[static_cast<std::size_t>(c.a.body)];
            if (c.b.body >= 0) b = all[static_cast<std::size_t>(c.b.body)];
            const auto at_a = tree.point<S>(c.a, all), at_b = tree.point<S>(c.b, all);
            arm_a = at_a.arm;
            // of the world: from its origin
            arm_b = c.b.body >= 0 ? at_b.arm : at_b.place;
            apart = at_a.place - at_b.place;
            velocity_a = at_a.velocity;
            relative_velocity = at_a.velocity - at_b.velocity;
            bias_a = a.bias_at(arm_a);
            relative_bias = bias_a;
            if (c.b.body >= 0) relative_bias = relative_bias - b.bias_at(arm_b);
        }

        /// One of the axes that the difference of two points is told in.
        Vector3Of<S> axis(const Condition& c, int k) const {
            if (c.axes == Condition::Axes::fixed) return exactly<S>(c.fixed[static_cast<std::size_t>(k)]);
            if (c.axes != Condition::Axes::world) {
                const AxesOf<S>& own = c.axes == Condition::Axes::of_a ? a.axes : b.axes;
                return k == 0 ? own.e1 : k == 1 ? own.e2 : own.e3;
            }
            Vector3Of<S> e = none<S>();
            e[k] = S(1.0);
            return e;
        }
    };

    template <class S>
    static const Moving<S>& foot_of(const Tree& tree, const Condition& c, const std::vector<Moving<S>>& all) {
        return all[static_cast<std::size_t>(tree.size() + c.foot)];
    }

    template <class S>
    static Row<S> pushing(const Ends<S>& ends, const Vector3Of<S>& n, const Vector3Of<S>& arm_b, const S& bias) {
        Row<S> row{ends.index_a, ends.index_b, {}, {}, bias};
        row.on_a.force = n;
        row.on_a.moment = cross<S>(ends.arm_a, n);
        row.on_b.force = -n;
        row.on_b.moment = -cross<S>(arm_b, n);
        return row;
    }

    /// n . (a - b) of a direction n that turns with b.
    template <class S>
    static Row<S> across_b(const Ends<S>& ends, const Vector3Of<S>& n) {
        // where a is, as a point of b
        const Vector3Of<S> arm = ends.arm_b + ends.apart, sliding = ends.velocity_a - ends.b.velocity_at(arm);
        const S bias =
            dot<S>(n, Vector3Of<S>(ends.bias_a - ends.b.bias_at(arm) - cross<S>(ends.b.omega, sliding) * S(2.0)));
        return pushing(ends, n, arm, bias);
    }
    /// The same of one that turns with a.
    template <class S>
    static Row<S> across_a(const Ends<S>& ends, const Vector3Of<S>& n) {
        // where b is, as a point of a
        const Vector3Of<S> arm = ends.arm_a - ends.apart,
                           sliding = ends.a.velocity_at(arm) - (ends.velocity_a - ends.relative_velocity);
        const S bias = dot<S>(n, Vector3Of<S>(ends.a.bias_at(arm) - (ends.bias_a - ends.relative_bias) -
                                              cross<S>(ends.a.omega, sliding) * S(2.0)));
        Row<S> row = pushing(ends, n, ends.arm_b, bias);
        row.on_a.moment = cross<S>(arm, n);
        return row;
    }

    std::vector<Condition> conditions_;
    int first_of_resistances() const { return rows_ + (is_rough_ ? 4 : 1) * static_cast<int>(contacts_.size()); }

    std::vector<ContactLaw> contacts_;
    std::vector<Resistance> resistances_;
    std::vector<Rubbing> joints_;
    int rows_ = 0;
    double arm_ = 0.0;
    bool is_rough_ = false;
};

}  // namespace mechanics

}  // namespace rbdyn::inline RBDYN_FORM
