// Where a body of a tree is and how it moves, in numbers of any type.
//
// Notation: P the point of a body that its joint holds, R its axes, omega its angular velocity. Of the accelerations of
// a tree one part is linear in those of its joints, the rest is what is left when they are zero (`bias`):
//     omega' = sum e_k v_k' + bias_turn,   a_P = sum d_k v_k' + bias
// over the velocities v_k of all joints on the way from the ground.
// Conventions: everything is seen from the world, but for points of bodies.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <initializer_list>
#include <memory>
#include <type_traits>
#include <utility>

#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/double_double_vector.hpp"
#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/expression/expression.hpp"
#include "rbdyn/model/rigid_state.hpp"
#include "rbdyn/rotation/quaternion.hpp"

namespace rbdyn::inline RBDYN_FORM {

namespace mechanics {

template <class S>
Vector3Of<S> none() {
    return Vector3Of<S>(S(0.0), S(0.0), S(0.0));
}

/// How a body moves: it turns, and a point of it moves.
template <class S>
struct Twist {
    Vector3Of<S> turn = none<S>(), move = none<S>();
};

/// What a unit velocity of each of a joint's own adds, six at most. They are kept in place, for they are made anew
/// again and again where contacts close and open.
template <class S>
class JointTwists {
public:
    static constexpr std::size_t most = 6;

    JointTwists() = default;
    JointTwists(std::initializer_list<Twist<S>> all) {
        for (const Twist<S>& one : all) push_back(one);
    }
    void push_back(const Twist<S>& one) { all_[count_++] = one; }

    std::size_t size() const { return count_; }
    const Twist<S>& operator[](std::size_t k) const { return all_[k]; }
    const Twist<S>& front() const { return all_[0]; }

private:
    std::array<Twist<S>, most> all_;
    std::size_t count_ = 0;
};

/// Axes that are those of another body, or the world's, turned about one axis of theirs by one angle.
template <class S>
struct TurnedAxes {
    AxesOf<S> from;
    Vector3Of<DoubleDouble> axis;
    S angle;
};

template <class S>
struct Moving {
    Vector3Of<S> place = none<S>(), velocity = none<S>(), bias = none<S>();  // of P
    AxesOf<S> axes{Vector3Of<S>(S(1.0), S(0.0), S(0.0)), Vector3Of<S>(S(0.0), S(1.0), S(0.0)),
                   Vector3Of<S>(S(0.0), S(0.0), S(1.0))};
    Vector3Of<S> omega = none<S>(), bias_turn = none<S>();
    JointTwists<S> joint;                         // what a unit velocity of each of its joint's own adds
    std::shared_ptr<const TurnedAxes<S>> turned;  // as a recorded motion has it, if its axes are; else none

    Vector3Of<S> to_world(const Vector3Of<S>& a) const {
        return Vector3Of<S>(axes.e1 * a[0] + axes.e2 * a[1] + axes.e3 * a[2]);
    }
    Vector3Of<S> to_body(const Vector3Of<S>& a) const {
        return Vector3Of<S>(dot<S>(axes.e1, a), dot<S>(axes.e2, a), dot<S>(axes.e3, a));
    }
    /// Of a point at r from P, world axes.
    Vector3Of<S> velocity_at(const Vector3Of<S>& r) const { return Vector3Of<S>(velocity + cross<S>(omega, r)); }
    Vector3Of<S> bias_at(const Vector3Of<S>& r) const {
        return Vector3Of<S>(bias + cross<S>(bias_turn, r) + cross<S>(omega, cross<S>(omega, r)));
    }
};

/// Axes turned by an angle about an axis e of theirs, a unit vector in their own components (Rodrigues' formula):
/// columns of R (c 1 + (1 - c) e e^T + s [e]).
template <class S>
AxesOf<S> turned_about(const AxesOf<S>& axes, const Vector3Of<DoubleDouble>& e, const S& cosine, const S& sine) {
    const auto entry = [&](int i, int j) {
        const DoubleDouble cross_matrix[3][3] = {{0.0, -e[2], e[1]}, {e[2], 0.0, -e[0]}, {-e[1], e[0], 0.0}};
        const DoubleDouble square = e[i] * e[j];
        const S along = exactly<S>(square), across = exactly<S>(i == j ? DoubleDouble(1.0) - square : -square);
        return S(along + cosine * across + sine * exactly<S>(cross_matrix[i][j]));
    };
    const auto column = [&](int j) {
        return Vector3Of<S>(axes.e1 * entry(0, j) + axes.e2 * entry(1, j) + axes.e3 * entry(2, j));
    };
    return {column(0), column(1), column(2)};
}

/// Turns a child's axes by an angle about an axis of its parent. In a recorded motion what turns one after the other
/// about the same axis, as in a plane, turns by the sum of the angles: no products of their sines and cosines.
template <class S>
void turn_axes(Moving<S>& child, const Moving<S>& parent, const Vector3Of<DoubleDouble>& axis, const S& angle) {
    using std::cos, std::sin;
    if constexpr (std::is_same_v<S, Expression>) {
        TurnedAxes<S> whole{parent.axes, axis, angle};
        if (parent.turned) {
            const Vector3Of<DoubleDouble>& known = parent.turned->axis;
            const bool is_same = known == axis, is_opposite = known == Vector3Of<DoubleDouble>(-axis);
            if (is_same || is_opposite)
                whole = {parent.turned->from, known,
                         is_same ? parent.turned->angle + angle : parent.turned->angle - angle};
        }
        child.axes = turned_about<S>(whole.from, whole.axis, cos(whole.angle), sin(whole.angle));
        child.turned = std::make_shared<const TurnedAxes<S>>(std::move(whole));
    } else {
        child.axes = turned_about<S>(parent.axes, axis, cos(angle), sin(angle));
    }
}

/// A child held at an offset from P of its parent, in the parent's axes, that turns and moves with it.
template <class S>
Moving<S> carried(const Moving<S>& parent, const Vector3Of<S>& offset) {
    Moving<S> child;
    const Vector3Of<S> r = parent.to_world(offset);
    child.place = parent.place + r;
    child.velocity = parent.velocity_at(r);
    child.bias = parent.bias_at(r);
    child.axes = parent.axes;
    child.omega = parent.omega;
    child.bias_turn = parent.bias_turn;
    return child;
}

/// Turns a child further about an axis, world axes: its own rate, and what is known of the rate of that.
template <class S>
void add_turn(Moving<S>& child, const Vector3Of<S>& axis, const S& rate, const S& known) {
    const Vector3Of<S> turning = axis * rate;
    child.bias_turn += cross<S>(child.omega, turning) + Vector3Of<S>(axis * known);
    child.omega += turning;
}

/// Moves P of a child further along an axis that turns with `omega` of what it slides on: by a way, at a rate, and what
/// is known of the rate of that. `bias_turn`: of what it slides on.
template <class S>
void add_slide(Moving<S>& child, const Moving<S>& on, const Vector3Of<S>& axis, const S& way, const S& rate,
               const S& known) {
    const Vector3Of<S> r = axis * way, sliding = axis * rate;
    child.place += r;
    child.velocity += cross<S>(on.omega, r) + sliding;
    child.bias += cross<S>(on.bias_turn, r) + cross<S>(on.omega, cross<S>(on.omega, r)) +
                  Vector3Of<S>(cross<S>(on.omega, sliding) * S(2.0)) + Vector3Of<S>(axis * known);
}

}  // namespace mechanics

}  // namespace rbdyn::inline RBDYN_FORM
