// Bodies on their joints: a tree whose root is the ground, and its coordinates.
//
// Variables: the positions of all joints in the order of bodies, behind them the parameters of points that are held on
// curves (foot.hpp), then the velocities of the joints. Bodies that turn freely have their attitude in the world and
// their angular velocity in world axes (joint/spherical.hpp); a free body with a parent is one without.
// Invariant: constants that derive from the user's doubles, and the start, are numbers of 32 digits.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/double_double_vector.hpp"
#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/body/mass_properties.hpp"
#include "rbdyn/mechanics/anchor.hpp"
#include "rbdyn/mechanics/foot.hpp"
#include "rbdyn/mechanics/joint/law.hpp"
#include "rbdyn/mechanics/moving.hpp"
#include "rbdyn/mechanics/six.hpp"
#include "rbdyn/model/equations.hpp"
#include "rbdyn/scene/handles.hpp"
#include "rbdyn/scene/scene.hpp"

namespace rbdyn::inline RBDYN_FORM {

namespace mechanics {

struct Node {
    std::string name;
    int parent = -1;
    JointLaw joint;
    int q = 0, v = 0;      // its first position among the positions, its first velocity among the velocities
    bool is_point = true;  // a particle
    DoubleDouble mass;
    Vector3Of<DoubleDouble> center{};  // G from P, body axes
    MassProperties body;               // of a rigid body

    /// A point of its own, given from the origin of its axes, from P.
    Vector3Of<DoubleDouble> from_held(const Vector3& point) const { return widened(point) - joint.held().point; }
};

/// Whether beads leave the rails that they may leave, or are held there all the same.
enum class Beads { may_leave, stay };

class Tree {
public:
    /// `flying`: bodies that have left their rails.
    [[gnu::cold]] explicit Tree(const Scene& scene, const std::vector<int>& flying = {},
                                Beads beads = Beads::may_leave);

    int size() const { return static_cast<int>(nodes_.size()); }
    const std::vector<Node>& nodes() const { return nodes_; }
    const Node& node(int i) const { return nodes_[at(i)]; }
    int positions() const { return positions_; }
    int velocities() const { return velocities_; }
    int variables() const { return positions_ + velocities_; }
    Anchor anchor(const End& end) const;
    /// Of the points that constraints hold on curves, in their order.
    const std::vector<Foot>& feet() const { return feet_; }

    /// Where everything is, from positions and velocities: all bodies, and behind them all feet.
    template <class S>
    std::vector<Moving<S>> moving(const S& t, const S* q, const S* v) const {
        std::vector<Moving<S>> all;
        all.reserve(nodes_.size());
        const Moving<S> ground;
        for (const Node& n : nodes_)
            all.push_back(n.joint.move<S>(n.parent < 0 ? ground : all[at(n.parent)], t, q + n.q, v + n.v));
        for (const Foot& f : feet_) {
            Moving<S> foot = f.move<S>(all, q);
            all.push_back(std::move(foot));
        }
        return all;
    }

    /// Moves the feet to where their points are nearest, or to an end of their curves.
    template <class W>
    void follow(double t, W* q) const {
        const std::vector<W> still(at(velocities_), W(0.0));
        for (int pass = 0; pass < 3 && !feet_.empty(); ++pass) {
            const std::vector<Moving<W>> all = moving<W>(W(t), q, still.data());
            double farthest = 0.0;
            for (std::size_t k = 0; k < feet_.size(); ++k) {
                const Foot& f = feet_[k];
                W& u = q[f.q];
                const W off = f.off<W>(all, all[nodes_.size() + k]);
                farthest = std::max(farthest, std::abs(static_cast<double>(off)) / f.part());
                u += off;
                if (f.curve.closed()) continue;
                const Domain d = f.curve.domain();
                if (static_cast<double>(u) < d.begin) u = W(d.begin);
                if (static_cast<double>(u) > d.end) u = W(d.end);
            }
            // what is left is a part of it as small as the gap
            if (farthest < 1e-9) break;
        }
    }

    /// The central inertia of a body in world axes: R I R^T, its third moment taken apart, for R R^T = 1.
    template <class S>
    typename SixInertia<S>::Block inertia_of(int i, const Moving<S>& m) const {
        typename SixInertia<S>::Block result;
        for (auto& row : result) row = {S(0.0), S(0.0), S(0.0)};
        if (node(i).is_point) return result;
        const Matrix3Of<DoubleDouble>& own = node(i).body.inertia;
        const Vector3Of<S>* e[3] = {&m.axes.e1, &m.axes.e2, &m.axes.e3};
        for (int a = 0; a < 3; ++a) {
            Vector3Of<S> row = none<S>();  // sum over b of (I - I_33 1)_ab e_b
            for (int b = 0; b < 3; ++b) {
                const DoubleDouble entry = own(a, b) - (a == b ? own(2, 2) : DoubleDouble(0.0));
                if (!(entry == DoubleDouble(0.0))) row += Vector3Of<S>(*e[b] * exactly<S>(entry));
            }
            for (std::size_t j = 0; j < 3; ++j)
                for (std::size_t k = 0; k < 3; ++k)
                    result[j][k] += (*e[a])[static_cast<Eigen::Index>(j)] * row[static_cast<Eigen::Index>(k)];
        }
        for (std::size_t j = 0; j < 3; ++j) result[j][j] += exactly<S>(own(2, 2));
        return result;
    }

    /// A point: from P of its body in world axes, where it is and how it moves.
    template <class S>
    struct Point {
        Vector3Of<S> arm = none<S>(), place = none<S>(), velocity = none<S>();
    };
    template <class S>
    Point<S> point(const Anchor& a, const std::vector<Moving<S>>& all) const {
        Point<S> p;
        if (a.body < 0) {
            p.place = exactly<S>(a.point);
            return p;
        }
        const Moving<S>& m = all[at(a.body)];
        p.arm = m.to_world(exactly<S>(a.point));
        p.place = m.place + p.arm;
        p.velocity = m.velocity_at(p.arm);
        return p;
    }

    /// All variables as the scene starts, in 32 digits.
    std::vector<DoubleDouble> start(double t) const { return start(t, starts_); }
    /// As others of the same bodies start.
    std::vector<DoubleDouble> start(double t, const std::vector<Scene::Body>& starts) const;

    /// Variables that share a scale.
    std::vector<VariableGroup> groups(bool is_constrained) const;
    /// The coordinates of a body, in words.
    std::string coordinates(int body) const;

private:
    static std::size_t at(int i) { return static_cast<std::size_t>(i); }

    std::vector<Node> nodes_;
    std::vector<Foot> feet_;
    std::vector<Scene::Body> starts_;
    int positions_ = 0, velocities_ = 0;
};

}  // namespace mechanics

}  // namespace rbdyn::inline RBDYN_FORM
