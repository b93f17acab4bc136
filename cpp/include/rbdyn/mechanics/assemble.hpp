// A start that satisfies the constraints of a scene, from rough guesses: Newton's method on the coordinates, then one
// linear system for their rates, each with the smallest change there is.
#pragma once

#include <cmath>
#include <cstddef>
#include <type_traits>
#include <utility>
#include <vector>

#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/mechanics/accelerate.hpp"
#include "rbdyn/mechanics/constraint.hpp"
#include "rbdyn/mechanics/moving.hpp"
#include "rbdyn/mechanics/tree.hpp"
#include "rbdyn/scene/scene.hpp"

namespace rbdyn::inline RBDYN_FORM {

namespace mechanics {

/// How the rates of rows follow from the velocities of joints, row by row.
template <class S>
std::vector<std::vector<S>> jacobian(const Tree& tree, const std::vector<Row<S>>& rows,
                                     const std::vector<Moving<S>>& all) {
    std::vector<std::vector<S>> m;
    const auto size = [](const Vector3Of<S>& v) {
        return std::hypot(static_cast<double>(v[0]), static_cast<double>(v[1]), static_cast<double>(v[2]));
    };
    for (const Row<S>& row : rows) {
        std::vector<S> one(static_cast<std::size_t>(tree.velocities()), S(0.0));
        std::vector<double> sizes(one.size(), 0.0);
        const auto follow = [&](int body, Wrench<S> w) {
            double moment = size(w.moment);
            while (body >= 0) {
                const Node& n = tree.node(body);
                const Moving<S>& here = all[static_cast<std::size_t>(body)];
                for (int k = 0; k < n.joint.velocities(); ++k) {
                    const auto place = static_cast<std::size_t>(n.v + k);
                    const Twist<S>& twist = here.joint[static_cast<std::size_t>(k)];
                    one[place] += power(twist, w);
                    sizes[place] += size(twist.move) * size(w.force) + size(twist.turn) * moment;
                }
                // what turns freely by itself does not turn with its parent
                if (n.joint.attitude() >= 0) w.moment = none<S>();
                if (n.parent >= 0) {
                    const Vector3Of<S> arm = here.place - all[static_cast<std::size_t>(n.parent)].place;
                    w = about<S>(w, arm);
                    moment += size(arm) * size(w.force);
                }
                body = n.parent;
            }
        };
        follow(row.a, row.on_a);
        follow(row.b, row.on_b);
        // what cancels is nothing: bodies that cannot move against each other
        constexpr double rounding = 1e-13;
        if constexpr (std::is_same_v<S, double>)
            for (std::size_t k = 0; k < one.size(); ++k)
                if (std::abs(one[k]) <= rounding * sizes[k]) one[k] = 0.0;
        m.push_back(std::move(one));
    }
    return m;
}

/// The smallest x with m x = b, as far as there is one: rows may depend on each other.
std::vector<double> smallest_solution(const std::vector<std::vector<double>>& m, const std::vector<double>& b);

namespace assembling {

/// Puts the state of a tree back into the start of a scene's body, relative to its parent.
void put(const Tree& tree, int i, const std::vector<Moving<DoubleDouble>>& all, const std::vector<DoubleDouble>& x,
         Scene::Body& body);

}  // namespace assembling

}  // namespace mechanics

}  // namespace rbdyn::inline RBDYN_FORM
