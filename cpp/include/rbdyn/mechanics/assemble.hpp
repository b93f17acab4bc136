// A start that satisfies the constraints of a scene, from rough guesses: Newton's method on the coordinates, then one
// linear system for their rates, each with the smallest change there is.
#pragma once

#include <cstddef>
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
    for (const Row<S>& row : rows) {
        std::vector<S> one(static_cast<std::size_t>(tree.velocities()), S(0.0));
        const auto follow = [&](int body, Wrench<S> w) {
            while (body >= 0) {
                const Node& n = tree.node(body);
                const Moving<S>& here = all[static_cast<std::size_t>(body)];
                for (int k = 0; k < n.joint.velocities(); ++k)
                    one[static_cast<std::size_t>(n.v + k)] += power(here.joint[static_cast<std::size_t>(k)], w);
                // what turns freely by itself does not turn with its parent
                if (n.joint.attitude() >= 0) w.moment = none<S>();
                if (n.parent >= 0)
                    w = about<S>(w, Vector3Of<S>(here.place - all[static_cast<std::size_t>(n.parent)].place));
                body = n.parent;
            }
        };
        follow(row.a, row.on_a);
        follow(row.b, row.on_b);
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
