// Friction in hinges, in slides and on rails.
//
// What of the whole reaction R of a joint lies across its axis presses. Where the joint moves, s = +-1 the sign of its
// rate, friction is -s T along it, T = k |R|: a force of a slide, k = mu, and a torque of a hinge, k = mu r with the
// radius r of its pin. At rest it is whatever rest needs up to that. The torque of the reaction presses nothing.
//
// A bead on a rail is a slide on a curve: its axis is the tangent t = r'/|r'|, its rate the slip |r'| w - V, V(t) the
// speed of the rail's surface along itself. What presses is taken along n_1 = e x t/|e x t| and n_2 = t x n_1, e a
// direction that no tangent of the curve has (foot.hpp), so on a plane curve all of it is along n_1, with a sign.
//
// R depends on the accelerations, and with them on the friction of all joints, R_i = R0_i - sum_j s_j R1_ij T_j. With
// the directions e_i = R_i/|R_i| that is linear, T_i = k_i e_i . R_i, and taking e_i anew from the solution is Newton's
// method for |R_i|. Where R keeps its direction, as in plane motion of a slide, one turn of it is exact, and N = e . R
// has a root where |R| would have a corner.
//
// R is the whole reaction force at the pin, so mu is the ratio of what resists at its rim to R; where the pin is said
// to be pressed by R with friction mu' at its point of contact (the friction circle), mu = mu' / sqrt(1 + mu'^2).
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/double_double_vector.hpp"
#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/curve/point.hpp"
#include "rbdyn/expression/given.hpp"
#include "rbdyn/expression/time_function.hpp"
#include "rbdyn/mechanics/accelerate.hpp"
#include "rbdyn/mechanics/joint/rail.hpp"
#include "rbdyn/mechanics/moving.hpp"
#include "rbdyn/mechanics/tree.hpp"
#include "rbdyn/scene/scene.hpp"

namespace rbdyn::inline RBDYN_FORM {

namespace mechanics {

/// A hinge, a slide or a rail with friction.
struct RoughJoint {
    std::string name;  // of its body
    int body = -1, parent = -1;
    int q = 0, v = 0;  // its position and its velocity
    bool turns = false;
    Given mu_static = 0.0, mu_dynamic = 0.0, radius = 1.0;  // of its pin [m]; of a slide 1
    std::array<Vector3Of<DoubleDouble>, 2> across_in{};     // two directions across its axis, the parent's axes
    std::optional<RailLaw> rail = std::nullopt;             // of a bead; across_in is then e in the curve's coordinates
    TimeFunction drive = 0.0;                               // of a rail: V [m/s]
    bool is_alone = false;  // nothing that friction in joints does changes what presses it

    /// Friction by what presses it where it slides, or stays at its limit.
    const Given& coefficient(bool slides) const { return slides ? mu_dynamic : mu_static; }

    /// |r'| of a rail, else 1: what its rate is by its coordinate's.
    template <class S>
    S pace(const std::vector<Moving<S>>& all) const {
        using std::sqrt;
        if (!rail || is_gone<S>(all)) return S(1.0);
        const Vector3Of<S>& along = all[static_cast<std::size_t>(body)].joint.front().move;
        return sqrt(dot<S>(along, along));
    }
    /// The rate that it slides with: the slip of a rail.
    template <class S>
    S slip(const S& t, const std::vector<Moving<S>>& all, const S& rate) const {
        if (!rail) return rate;
        const S speed = pace<S>(all) * rate;
        return drive.is_zero() ? speed : S(speed - drive(t));
    }
    /// Of a rail: |r'| w' where it carries its bead along, V' - (r'.r''/|r'|) w^2.
    template <class S>
    S carried(const S& t, const S* positions, const S& rate, const std::vector<Moving<S>>& all) const {
        if (!rail) return S(0.0);
        const CurvePoint<S> c = rail->curve->at<S>(positions[q], Placement{});
        const S bend = c.first_dot_second * (rate * rate) / pace<S>(all);
        return drive.is_constant() ? S(-bend) : S(drive.rate(t) - bend);
    }

    /// Whether its bead flies.
    template <class S>
    bool is_gone(const std::vector<Moving<S>>& all) const {
        const Twist<S>& along = all[static_cast<std::size_t>(body)].joint.front();
        return is_nothing(Wrench<S>{along.move, along.turn});
    }

    /// Whether what presses along a direction, parts of n_1 and n_2, is along n = b x t (1) or against it (-1), b
    /// across the plane of t and what presses: on the side of e, and of what is straight on that of z, y or x of the
    /// parent, the first that is not across b. Of a hinge 1.
    int side(const std::array<double, 2>& along, double t, const std::vector<Moving<double>>& all) const;

    template <class S>
    std::array<Vector3Of<S>, 2> across(const S& t, const std::vector<Moving<S>>& all) const {
        const Vector3Of<S> x = exactly<S>(across_in[0]), y = exactly<S>(across_in[1]);
        if (rail) {
            using std::sqrt;
            if (is_gone<S>(all)) return {none<S>(), none<S>()};
            const Vector3Of<S> e = rail->turned<S>(t, x);
            const Vector3Of<S>& along = all[static_cast<std::size_t>(body)].joint.front().move;
            const Vector3Of<S> first =
                cross<S>(parent < 0 ? e : all[static_cast<std::size_t>(parent)].to_world(e), along);
            const Vector3Of<S> unit = first * (S(1.0) / sqrt(dot<S>(first, first)));
            return {unit, cross<S>(along, unit) * (S(1.0) / pace<S>(all))};
        }
        if (parent < 0) return {x, y};
        const Moving<S>& m = all[static_cast<std::size_t>(parent)];
        return {m.to_world(x), m.to_world(y)};
    }
};

/// Those of a scene. Throws InvalidInput where this version has none.
[[gnu::cold]] std::vector<RoughJoint> rough_joints(const Scene& scene, const Tree& tree);

/// What a rough joint does in a mode, as its number in Mode::slip behind those of contacts: no friction yet, held,
/// idle, for others hold what it would, or it resists by T = k |R|: it slides, or stays, idle too, at the limit beyond
/// which others hold the rest; forward or backward, from rest, pressed in a direction that turns, remembered where that
/// without friction is none to begin with, or by nothing but rounding.
namespace joint_state {

inline constexpr signed char open = 0, held = 8, slides = 16, backward = 1, from_rest = 2, veering = 4, unloaded = 32,
                             idle = 64, remembered = 8;

inline bool is_at_rest(signed char state) { return state == held || (state & idle) != 0; }
/// Whether its friction is k |R|.
inline bool resists(signed char state) { return (state & slides) != 0; }
inline bool is_sliding(signed char state) { return resists(state) && (state & idle) == 0; }
inline bool has(signed char state, signed char what) { return resists(state) && (state & what) != 0; }
/// The sign of the rate that its friction is against.
inline int against(signed char state) { return !resists(state) ? 0 : has(state, backward) ? -1 : 1; }
/// The sign of its rate; 0: it is at rest.
inline int sign(signed char state) { return is_sliding(state) ? against(state) : 0; }

}  // namespace joint_state

/// What a mode remembers of a rough joint, behind what it does of contacts.
struct JointMemory {
    static constexpr int numbers = 5, parameters = 4;  // of these its equations know the first ones
    static constexpr std::size_t said = 5;             // what the equations say of it (tree_writer.hpp)

    double least_rate = 0.0;        // below it a rate is rounding [rad/s, m/s]
    std::array<double, 2> along{};  // the direction in which it is pressed
    double least_load = 0.0;        // below it a load, or what of it has another direction, is rounding [N]
    bool turns = false;             // the direction has turned

    static JointMemory of(const double* m) { return {m[0], {m[1], m[2]}, m[3], m[4] != 0.0}; }
    void put(double* m) const {
        const double all[numbers] = {least_rate, along[0], along[1], least_load, turns ? 1.0 : 0.0};
        for (int k = 0; k < numbers; ++k) m[k] = all[k];
    }
};

/// What a unit of friction along each rough joint does, while constraints hold. What slides on a contact holds it by a
/// force that is not along its row.
template <class S>
class FrictionResponse {
public:
    using Load = std::array<S, 2>;
    using Sparse = typename Accelerate<S>::Sparse;

    /// `acting`: what a unit of the force of each constraint is; none: their own.
    FrictionResponse(const Tree& tree, const std::vector<RoughJoint>& joints, const Accelerate<S>& accelerate,
                     const S& t, const std::vector<Moving<S>>& all, const std::vector<Row<S>>& constraints,
                     const std::vector<Row<S>>* acting = nullptr)
        : tree_(tree),
          joints_(joints),
          accelerate_(accelerate),
          all_(all),
          is_symmetric_(acting == nullptr),
          acting_(acting != nullptr ? *acting : constraints) {
        for (const RoughJoint& joint : joints) axes_.push_back(joint.across(t, all));
        for (const Row<S>& row : constraints) held_.push_back(accelerate.response(row));
        pushes_ = held_;
        for (std::size_t k = 0; k < held_.size() && !is_symmetric_; ++k) pushes_[k] = accelerate.response(acting_[k]);
        for (const Sparse& one : held_) {
            used_.emplace_back();
            for (const Sparse& other : pushes_) used_.back().push_back(accelerate.between(one, other));
        }
        for (const RoughJoint& joint : joints) {
            along_.push_back(accelerate.driving(joint.body, 0));
            if (joint.rail)
                for (const S pace = joint.pace(all); auto& [n, one] : along_.back()) one *= pace;
            std::vector<S> u(static_cast<std::size_t>(accelerate.freedoms()), S(0.0));
            for (const auto& [n, one] : along_.back()) u[static_cast<std::size_t>(n)] = one;
            multipliers_.push_back(hold(u));
            driven_.push_back(std::move(u));
        }
        for (std::size_t j = 0; j < joints.size(); ++j) {
            const auto spread = accelerate.spread(driven_[j]).bodies;
            for (std::size_t i = 0; i < joints.size(); ++i) {
                if (j == 0) loads_.emplace_back();
                loads_[i].push_back(joints[i].is_alone ? Load{S(0.0), S(0.0)} : load(i, spread, multipliers_[j]));
            }
        }
    }

    /// The acceleration of joint i, |r'| w' of a rail, by a unit of friction in j.
    S acceleration(std::size_t i, std::size_t j) const { return accelerate_.along(along_[i], driven_[j]); }
    /// The same of i by itself, were there no constraints.
    S alone(std::size_t i) const { return accelerate_.between(along_[i], along_[i]); }
    /// The acceleration of joint i by what drives the tree.
    S acceleration(std::size_t i, const std::vector<S>& u) const { return accelerate_.along(along_[i], u); }
    /// How a unit of friction in j changes what presses joint i.
    const Load& load(std::size_t i, std::size_t j) const { return loads_[i][j]; }
    const std::vector<S>& driven(std::size_t j) const { return driven_[j]; }
    const std::vector<S>& multipliers(std::size_t j) const { return multipliers_[j]; }

    /// What presses joint i by accelerations, but for their bias, and by constraints.
    Load load(std::size_t i, const std::vector<Twist<S>>& bodies, const std::vector<S>& multipliers) const {
        Vector3Of<S> sum = none<S>();
        for (int body = joints_[i].body; body < tree_.size(); ++body) {
            if (!carries(joints_[i].body, body)) continue;
            const Node& n = tree_.node(body);
            const Twist<S>& a = bodies[static_cast<std::size_t>(body)];
            const Vector3Of<S> c = all_[static_cast<std::size_t>(body)].to_world(exactly<S>(n.center));
            sum += Vector3Of<S>(a.move + cross<S>(a.turn, c)) * exactly<S>(n.mass);
        }
        for (std::size_t r = 0; r < acting_.size(); ++r) sum += less(i, acting_[r], multipliers[r]);
        return across(i, sum);
    }
    /// What a force takes from what presses joint i.
    Vector3Of<S> less(std::size_t i, const Row<S>& row, const S& force) const {
        Vector3Of<S> sum = none<S>();
        for (const auto& [body, on] : {std::pair{row.a, &row.on_a}, std::pair{row.b, &row.on_b}})
            if (body >= 0 && carries(joints_[i].body, body)) sum += Vector3Of<S>(on->force * S(-force));
        return sum;
    }
    Load across(std::size_t i, const Vector3Of<S>& force) const {
        return {dot<S>(axes_[i][0], force), dot<S>(axes_[i][1], force)};
    }
    /// Whether a body hangs on another one, or is it.
    bool carries(int on, int body) const {
        while (body > on) body = tree_.node(body).parent;
        return body == on;
    }

private:
    /// The multipliers that hold the constraints while something drives the tree; adds what they do.
    std::vector<S> hold(std::vector<S>& u) const {
        std::vector<S> b;
        for (const Sparse& one : held_) b.push_back(-accelerate_.along(one, u));
        std::vector<S> found, pivots, driven;
        if (is_symmetric_)
            found = solve_definite<S>(used_, std::move(b));
        else
            found = solve_in_order<S>(used_, std::move(b), pivots, driven);
        for (std::size_t k = 0; k < held_.size(); ++k)
            for (const auto& [n, one] : pushes_[k]) u[static_cast<std::size_t>(n)] += one * found[k];
        return found;
    }

    const Tree& tree_;
    const std::vector<RoughJoint>& joints_;
    const Accelerate<S>& accelerate_;
    const std::vector<Moving<S>>& all_;
    bool is_symmetric_;
    std::vector<Row<S>> acting_;
    std::vector<std::array<Vector3Of<S>, 2>> axes_;
    std::vector<Sparse> held_, pushes_, along_;
    std::vector<std::vector<S>> used_, driven_, multipliers_;
    std::vector<std::vector<Load>> loads_;
};

}  // namespace mechanics

}  // namespace rbdyn::inline RBDYN_FORM
