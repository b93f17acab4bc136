// Definitions of rbdyn/statics/equilibria.hpp.
#pragma once

#include "rbdyn/statics/equilibria.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "rbdyn/basics/error.hpp"
#include "rbdyn/curve/point.hpp"
#include "rbdyn/mechanics/tree_model.hpp"
#include "rbdyn/scene/handles.hpp"
#include "rbdyn/scene/joints.hpp"
#include "rbdyn/scene/scene.hpp"
#include "rbdyn/statics/ball_equilibria.hpp"
#include "rbdyn/statics/equilibrium.hpp"
#include "rbdyn/statics/forces.hpp"
#include "rbdyn/statics/judged_rest.hpp"
#include "rbdyn/statics/nearest_rest.hpp"
#include "rbdyn/statics/path_equilibria.hpp"
#include "rbdyn/statics/path_forces.hpp"
#include "rbdyn/statics/search.hpp"
#include "rbdyn/statics/tree_forces.hpp"

namespace rbdyn::inline RBDYN_FORM {

namespace statics {

/// The one state of rest that a search leads to, if it leads to any.
inline std::vector<Equilibrium> nearest(TreeForces& forces, const std::vector<double>& near) {
    const std::vector<double> start = near.empty() ? forces.start() : forces.place(near);
    std::vector<double> q = start;
    if (near.empty() && settle(forces, q) && relax(forces, q)) return {judged(forces, std::move(q), start).equilibrium};
    if (auto found = NearestRest(forces, start).find()) return {judged(forces, std::move(*found), start).equilibrium};
    return {};
}

}  // namespace statics

RBDYN_INLINE std::vector<Equilibrium> equilibria(const Scene& scene, const std::vector<double>& near) {
    const std::string user = "equilibria";
    if (scene.bodies().empty()) throw InvalidInput("Scene: it has 0 bodies; add() at least one before it is asked");
    const Scene now = scene.frozen();
    const bool is_tree = needs_tree(now);
    int coordinates = 0;
    for (int i = 0; i < static_cast<int>(now.bodies().size()); ++i) {
        const Scene::Body& body = now.bodies()[static_cast<std::size_t>(i)];
        statics::require_timeless(now, i, user);
        if (const Rail* rail = body.rail();
            rail != nullptr && !near.empty() && coordinates < static_cast<int>(near.size())) {
            const double u = near[static_cast<std::size_t>(coordinates)];
            const Domain d = rail->curve().domain();
            require(u >= d.begin && u <= d.end, user, "near, parameter of " + body.name, u,
                    "it lies in the domain of the curve, " + text(d.begin) + " to " + text(d.end));
        }
        coordinates += statics::coordinates_of(body);
    }
    require(near.empty() || static_cast<int>(near.size()) == coordinates, user, "number of coordinates in near",
            static_cast<double>(near.size()), "this scene has " + std::to_string(coordinates));
    for (const double x : near) require(std::isfinite(x), user, "a coordinate of near", x, "it is finite");
    const Scene::Body& first = now.bodies()[0];
    const bool is_alone = !is_tree && now.bodies().size() == 1;
    if (is_alone && first.rail() != nullptr) {
        const double place = near.empty() ? first.parameter : near[0];
        return PathEquilibria(statics::alone(now, BodyHandle{0}, user), place, !near.empty()).find();
    }
    if (coordinates == 1 && now.constraints().empty()) {
        const Scene::Body& mover = *std::ranges::find_if(now.bodies(), statics::coordinates_of);
        if (std::holds_alternative<Revolute>(mover.joint) || std::holds_alternative<Prismatic>(mover.joint))
            return PathEquilibria(now, near.empty() ? mover.parameter : near[0], !near.empty()).find();
    }
    statics::TreeForces forces(now);
    require(forces.freedoms() > 0, user, "number of freedoms", forces.freedoms(), "something can move");
    return is_alone && std::holds_alternative<Spherical>(first.joint)
               ? statics::BallEquilibria(now, near.empty() ? forces.start() : forces.place(near)).find()
               : statics::nearest(forces, near);
}

}  // namespace rbdyn::inline RBDYN_FORM
