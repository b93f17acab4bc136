// Definitions of rbdyn/statics/equilibria.hpp.
#pragma once

#include "rbdyn/statics/equilibria.hpp"

#include <cmath>
#include <cstddef>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "rbdyn/basics/error.hpp"
#include "rbdyn/curve/point.hpp"
#include "rbdyn/scene/handles.hpp"
#include "rbdyn/scene/joints.hpp"
#include "rbdyn/scene/scene.hpp"
#include "rbdyn/statics/ball_equilibria.hpp"
#include "rbdyn/statics/equilibrium.hpp"
#include "rbdyn/statics/forces.hpp"
#include "rbdyn/statics/path_equilibria.hpp"
#include "rbdyn/statics/path_forces.hpp"
#include "rbdyn/statics/search.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE std::vector<Equilibrium> equilibria(const Scene& scene, const std::vector<double>& near) {
    const std::string user = "equilibria";
    if (scene.bodies().empty()) throw InvalidInput("Scene: it has 0 bodies; add() at least one before it is asked");
    const Scene now = scene.frozen();
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
        coordinates += statics::Forces::coordinates_of(body);
    }
    require(near.empty() || static_cast<int>(near.size()) == coordinates, user, "number of coordinates in near",
            static_cast<double>(near.size()), "this scene has " + std::to_string(coordinates));
    for (const double x : near) require(std::isfinite(x), user, "a coordinate of near", x, "it is finite");
    const Scene::Body& first = now.bodies()[0];
    if (now.bodies().size() == 1 && coordinates == 1) {
        const double place = near.empty() ? first.parameter : near[0];
        return PathEquilibria(first.rail() != nullptr ? statics::alone(now, BodyHandle{0}, user) : now, place).find();
    }
    statics::Forces forces(now);
    const std::vector<double> start = near.empty() ? forces.start() : forces.place(near);
    if (now.bodies().size() == 1 && std::holds_alternative<Spherical>(first.joint))
        return statics::BallEquilibria(now, start).find();
    std::vector<double> q = start;
    if (near.empty() && statics::settle(forces, q) && statics::relax(forces, q))
        return {statics::judged(forces, std::move(q), start).equilibrium};
    q = start;
    if (!statics::relax(forces, q)) return {};
    return {statics::judged(forces, std::move(q), start).equilibrium};
}

}  // namespace rbdyn::inline RBDYN_FORM
