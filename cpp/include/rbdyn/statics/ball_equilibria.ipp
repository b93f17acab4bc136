// Definitions of rbdyn/statics/ball_equilibria.hpp.
#pragma once

#include "rbdyn/statics/ball_equilibria.hpp"

#include <algorithm>
#include <cstddef>
#include <numbers>
#include <utility>
#include <vector>

#include "rbdyn/basics/vector.hpp"
#include "rbdyn/rotation/quaternion.hpp"
#include "rbdyn/statics/equilibrium.hpp"
#include "rbdyn/statics/judged_rest.hpp"
#include "rbdyn/statics/search.hpp"
#include "rbdyn/statics/tree_forces.hpp"

namespace rbdyn::inline RBDYN_FORM::statics {

RBDYN_INLINE std::vector<Equilibrium> BallEquilibria::find() {
    look_from(start_);
    // the 24 attitudes of a cube, out of line with all that is symmetric
    const Vector3 x(1, 0, 0), y(0, 1, 0), z(0, 0, 1), aside = direction(Vector3(1, 2, 4));
    constexpr double quarter = 0.5 * std::numbers::pi;
    for (const auto& [axis, up] : {std::pair(x, 0), {x, 1}, {x, 2}, {x, 3}, {y, 1}, {y, 3}})
        for (int k = 0; k < 4; ++k)
            look_from(turned(turned(turned(start_, z, k * quarter), axis, up * quarter), aside, 0.5));
    std::stable_sort(found_.begin(), found_.end(),
                     [](const Equilibrium& a, const Equilibrium& b) { return a.stable && !b.stable; });
    return found_;
}

RBDYN_INLINE std::vector<double> BallEquilibria::turned(const std::vector<double>& q, const Vector3& axis,
                                                        double angle) const {
    return forces_.turned(q, 0, axis, Vector3::Zero(), angle);
}

RBDYN_INLINE void BallEquilibria::look_from(std::vector<double> q) {
    if (!found_.empty() && !forces_.at_rest(q).is_finite()) return;
    if (!relax(forces_, q)) return;
    const Judgement here = judged(forces_, std::move(q), start_);
    if (!here.is_decided && !places_.empty()) return;
    for (std::size_t k = 0; k < places_.size(); ++k) {
        const Quaternion between = attitude(here.place) * conjugate(attitude(places_[k]));
        Vector3 apart(between.x, between.y, between.z);
        for (const Vector3& axis : found_[k].axes) apart -= axis * axis.dot(apart);
        // as near as zeros of higher order are found
        if (apart.norm() < 1e-6) return;
    }
    found_.push_back(here.equilibrium);
    places_.push_back(here.place);
}

}  // namespace rbdyn::inline RBDYN_FORM::statics
