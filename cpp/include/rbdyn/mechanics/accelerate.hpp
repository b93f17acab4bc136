// Accelerations of a tree of bodies, and of one whose loops are closed by constraints.
//
// The articulated-body recursion (R. Featherstone, Rigid Body Dynamics Algorithms, Springer 2008, chapter 7), one
// velocity of a joint after the other: from the leaves to the ground the inertia that each motion meets, U = I s,
// d = s.U, is taken from what its parent feels, I - U U^T/d; the wrench that is left drives it, u = tau - s.p,
// p + U u/d. From the ground to the leaves v' = (u - U.a)/d. This is the factorisation of the tree's matrix of masses,
// M = L D L^T, without fill-in, with u = L^-1 of the generalised forces.
//
// Constraints J v' + bias = 0 act with wrenches J^T lambda (chapter 8):
//     (J M^-1 J^T) lambda = -(bias + J M^-1 (tau - h)),  J M^-1 J^T = sum over the tree's velocities of u_j u_k / d.
#pragma once

#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/expression/node.hpp"
#include "rbdyn/mechanics/moving.hpp"
#include "rbdyn/mechanics/six.hpp"
#include "rbdyn/model/rigid_state.hpp"

namespace rbdyn::inline RBDYN_FORM {

namespace mechanics {

template <class S>
bool is_nothing(const Wrench<S>& w) {
    for (int k = 0; k < 3; ++k)
        if (!is_nothing(w.force[k]) || !is_nothing(w.moment[k])) return false;
    return true;
}

/// One condition on the accelerations of two bodies: on_a . acc_a + on_b . acc_b + bias = 0, with wrenches about P of
/// each, that are also what a unit of its force exerts. A body -1 is the ground.
template <class S>
struct Row {
    int a = -1, b = -1;
    Wrench<S> on_a, on_b;
    S bias = S(0.0);
    bool is_joint = false;  // along the first velocity of a's joint, of which b is the parent
    S pace = S(1.0);        // of that its rate
};

/// x of A x = b, A symmetric and positive definite, given by its lower half, without pivots: A = L D L^T. Rows that are
/// zero give zero. `pivots`: D.
template <class S>
std::vector<S> solve_definite(std::vector<std::vector<S>> a, std::vector<S> b, std::vector<S>* pivots = nullptr) {
    const std::size_t n = b.size();
    for (std::size_t j = 0; j < n; ++j) {
        if (pivots != nullptr) pivots->push_back(a[j][j]);
        if (is_nothing(a[j][j])) {
            b[j] = S(0.0);
            continue;
        }
        const S inverse = S(1.0) / a[j][j];
        for (std::size_t i = j + 1; i < n; ++i) {
            if (is_nothing(a[i][j])) continue;
            const S factor = a[i][j] * inverse;
            for (std::size_t k = j + 1; k <= i; ++k)
                if (!is_nothing(a[k][j])) a[i][k] -= factor * a[k][j];
            b[i] -= factor * b[j];
        }
        // columns of L stay scaled by D
        b[j] *= inverse;
        for (std::size_t i = j + 1; i < n; ++i)
            if (!is_nothing(a[i][j])) a[i][j] *= inverse;
    }
    for (std::size_t j = n; j-- > 0;)
        for (std::size_t i = 0; i < j; ++i)
            if (!is_nothing(a[j][i])) b[i] -= a[j][i] * b[j];
    return b;
}

/// x of A x = b by elimination in the order given, without pivots. `pivots`: the diagonal that is left; `driven`: b
/// before x is put back. Rows that are zero give zero.
template <class S>
std::vector<S> solve_in_order(std::vector<std::vector<S>> a, std::vector<S> b, std::vector<S>& pivots,
                              std::vector<S>& driven) {
    const std::size_t n = b.size();
    for (std::size_t j = 0; j < n; ++j) {
        pivots.push_back(a[j][j]);
        if (is_nothing(a[j][j])) {
            b[j] = S(0.0);
            continue;
        }
        const S inverse = S(1.0) / a[j][j];
        for (std::size_t i = j + 1; i < n; ++i) {
            if (is_nothing(a[i][j])) continue;
            const S factor = a[i][j] * inverse;
            for (std::size_t k = j + 1; k < n; ++k)
                if (!is_nothing(a[j][k])) a[i][k] -= factor * a[j][k];
            b[i] -= factor * b[j];
        }
    }
    driven = b;
    for (std::size_t j = n; j-- > 0;) {
        if (is_nothing(a[j][j])) continue;
        for (std::size_t k = j + 1; k < n; ++k)
            if (!is_nothing(a[j][k])) b[j] -= a[j][k] * b[k];
        b[j] = b[j] / a[j][j];
    }
    return b;
}

template <class S>
class Accelerate {
public:
    /// A body: its parent, its motion, its inertia about P.
    struct Body {
        int parent;
        Moving<S> moving;
        SixInertia<S> inertia;
    };

    explicit Accelerate(std::vector<Body> bodies) : bodies_(std::move(bodies)) {
        std::vector<SixInertia<S>> felt;
        for (const Body& b : bodies_) {
            first_.push_back(static_cast<int>(steps_.size()));
            steps_.resize(steps_.size() + b.moving.joint.size());
            felt.push_back(b.inertia);
        }
        for (int i = count() - 1; i >= 0; --i) {
            const Body& b = bodies_[at(i)];
            for (int k = velocities(i) - 1; k >= 0; --k) {
                Step& step = steps_[at(first_[at(i)] + k)];
                const Wrench<S> u = felt[at(i)] * twist(i, k);
                step.mass = power(twist(i, k), u);
                // what moves nothing (joint/loose_rail.hpp)
                if (is_nothing(step.mass)) continue;
                step.inverse = S(1.0) / step.mass;
                step.scaled.force = u.force * step.inverse;
                step.scaled.moment = u.moment * step.inverse;
                if (b.parent >= 0 || k > 0) release(felt[at(i)], u, step.scaled, twist(i, k));
            }
            if (b.parent >= 0) felt[at(b.parent)] += felt[at(i)].about(arm(i));
        }
    }

    int count() const { return static_cast<int>(bodies_.size()); }
    int freedoms() const { return static_cast<int>(steps_.size()); }
    /// What a velocity of a joint meets: the tree's inertia along it.
    const S& mass(int velocity) const { return steps_[at(velocity)].mass; }

    /// What drives each velocity, L^-1 (tau - h), from the wrenches that are left to be balanced at zero accelerations
    /// of the joints (inertia of the bias, less loads), about P, and from forces of the joints.
    std::vector<S> driven(std::vector<Wrench<S>> left, const std::vector<S>& forces) const {
        std::vector<S> u(steps_.size(), S(0.0));
        for (int i = count() - 1; i >= 0; --i) {
            for (int k = velocities(i) - 1; k >= 0; --k) {
                const int n = first_[at(i)] + k;
                u[at(n)] = forces[at(n)] - power(twist(i, k), left[at(i)]);
                add<S>(left[at(i)], steps_[at(n)].scaled, u[at(n)]);
            }
            const int parent = bodies_[at(i)].parent;
            if (parent >= 0) add<S>(left[at(parent)], about<S>(left[at(i)], arm(i)), S(1.0));
        }
        return u;
    }

    /// Of a row: L^-1 J^T, by velocity, those on the ways of its bodies to the ground.
    using Sparse = std::vector<std::pair<int, S>>;
    Sparse response(const Row<S>& row) const {
        if (row.is_joint) {
            Sparse along = driving(row.a, 0);
            for (auto& [n, one] : along) one *= row.pace;
            return along;
        }
        Sparse u;
        int a = row.a, b = row.b;
        Wrench<S> at_a = row.on_a, at_b = row.on_b;
        while (a >= 0 || b >= 0) {
            if (a == b) {
                add<S>(at_a, at_b, S(1.0));
                at_b = {};
                b = -1;
            }
            if (b > a) {
                std::swap(a, b);
                std::swap(at_a, at_b);
            }
            if (!is_nothing(at_a))
                for (int k = velocities(a) - 1; k >= 0; --k) {
                    const int n = first_[at(a)] + k;
                    const S one = power(twist(a, k), at_a);
                    if (is_nothing(one)) continue;
                    u.emplace_back(n, one);
                    add<S>(at_a, steps_[at(n)].scaled, S(-one));
                }
            at_a = about<S>(at_a, arm(a));
            a = bodies_[at(a)].parent;
        }
        std::sort(u.begin(), u.end(), [](const auto& x, const auto& y) { return x.first < y.first; });
        return u;
    }

    /// What J M^-1 J^T of a row would be if nothing in it cancelled: its rounding is a part of this, also where bodies
    /// cannot move against each other and all of it cancels.
    double extent(const Row<double>& row) const {
        double sum = 0.0;
        for (const auto& [end, wrench] : {std::pair(row.a, row.on_a), std::pair(row.b, row.on_b)}) {
            const double force = wrench.force.norm();
            double moment = wrench.moment.norm();
            for (int i = end; i >= 0; i = bodies_[at(i)].parent) {
                for (int k = 0; k < velocities(i); ++k) {
                    const double one = twist(i, k).move.norm() * force + twist(i, k).turn.norm() * moment;
                    sum += one * one * steps_[at(first_[at(i)] + k)].inverse;
                }
                moment += arm(i).norm() * force;
            }
        }
        return sum;
    }

    /// L^-1 of a unit of force along one velocity.
    Sparse driving(int body, int k) const {
        Sparse u{{first_[at(body)] + k, S(1.0)}};
        Wrench<S> left = steps_[at(u.front().first)].scaled;
        left.force = left.force * S(-1.0);
        left.moment = left.moment * S(-1.0);
        for (int i = body; i >= 0; i = bodies_[at(i)].parent) {
            for (int j = (i == body ? k : velocities(i)) - 1; j >= 0; --j) {
                const int n = first_[at(i)] + j;
                const S one = power(twist(i, j), left);
                if (is_nothing(one)) continue;
                u.emplace_back(n, one);
                add<S>(left, steps_[at(n)].scaled, S(-one));
            }
            left = about<S>(left, arm(i));
        }
        std::sort(u.begin(), u.end(), [](const auto& x, const auto& y) { return x.first < y.first; });
        return u;
    }

    /// J M^-1 J^T between two rows.
    S between(const Sparse& one, const Sparse& other) const {
        S sum(0.0);
        for (std::size_t i = 0, j = 0; i < one.size() && j < other.size();) {
            if (one[i].first == other[j].first) {
                sum += one[i].second * (other[j].second * steps_[at(one[i].first)].inverse);
                ++i, ++j;
            } else if (one[i].first < other[j].first) {
                ++i;
            } else {
                ++j;
            }
        }
        return sum;
    }
    /// J M^-1 of what drives each velocity.
    S along(const Sparse& row, const std::vector<S>& u) const {
        S sum(0.0);
        for (const auto& [n, one] : row) sum += one * (u[at(n)] * steps_[at(n)].inverse);
        return sum;
    }

    /// The accelerations of joints, and what is linear in them of those of the bodies, from what drives each velocity.
    struct Result {
        std::vector<S> joints;
        std::vector<Twist<S>> bodies;
    };
    Result spread(const std::vector<S>& u) const {
        Result result;
        result.joints.resize(steps_.size(), S(0.0));
        for (int i = 0; i < count(); ++i) {
            Twist<S> a;
            if (const int parent = bodies_[at(i)].parent; parent >= 0) {
                const Twist<S>& p = result.bodies[at(parent)];
                a.turn = p.turn;
                a.move = p.move + cross<S>(p.turn, arm(i));
            }
            for (int k = 0; k < velocities(i); ++k) {
                const int n = first_[at(i)] + k;
                const S rate = u[at(n)] * steps_[at(n)].inverse - power(a, steps_[at(n)].scaled);
                result.joints[at(n)] = rate;
                a.turn += Vector3Of<S>(twist(i, k).turn * rate);
                a.move += Vector3Of<S>(twist(i, k).move * rate);
            }
            result.bodies.push_back(a);
        }
        return result;
    }

private:
    static std::size_t at(int i) { return static_cast<std::size_t>(i); }

    /// One velocity of a joint: d, 1/d, U/d.
    struct Step {
        S mass = S(0.0), inverse = S(0.0);
        Wrench<S> scaled;
    };

    /// In a recorded motion what is zero for good is left out.
    static void release(SixInertia<S>& felt, const Wrench<S>& u, const Wrench<S>& scaled, const Twist<S>& motion) {
        if constexpr (std::is_same_v<S, Expression>)
            felt.release(u, scaled, motion);
        else
            felt.release(u, scaled);
    }

    int velocities(int i) const { return static_cast<int>(bodies_[at(i)].moving.joint.size()); }
    const Twist<S>& twist(int i, int k) const { return bodies_[at(i)].moving.joint[at(k)]; }
    /// From P of the parent to P.
    Vector3Of<S> arm(int i) const {
        const int parent = bodies_[at(i)].parent;
        if (parent < 0) return none<S>();
        return bodies_[at(i)].moving.place - bodies_[at(parent)].moving.place;
    }

    std::vector<Body> bodies_;
    std::vector<int> first_;
    std::vector<Step> steps_;
};

}  // namespace mechanics

}  // namespace rbdyn::inline RBDYN_FORM
