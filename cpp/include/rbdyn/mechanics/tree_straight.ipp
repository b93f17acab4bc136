// Definitions of rbdyn/mechanics/tree_model.hpp: bodies that slide straight on rough planes.
//
// A body that stands flat on a plane, that nothing but its weight acts on, and that slides on all of its feet in one
// direction d with one coefficient does not turn. It does not tip, so that what its feet exert passes a point of the
// plane from which G lies straight above or along d, by mu times its height: the sum of their forces N (n - mu d) has
// no moment about the normal through G. In numbers this sum of moments is rounding, and it would turn.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "rbdyn/mechanics/contact_state.hpp"
#include "rbdyn/mechanics/level.hpp"
#include "rbdyn/mechanics/tree_model.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE bool TreeModel::keeps_straight(const Mode& mode, int body, std::span<const double> x) const {
    using namespace mechanics::contact_state;
    constexpr double rounding = 4.0 * std::numeric_limits<double>::epsilon();
    const mechanics::Node& node = tree_->node(body);
    if (node.joint.as<mechanics::FreeBodyLaw>() == nullptr || node.parent >= 0 || exerted_->acts_on(body)) return false;
    const auto is_of = [&](const auto& c) { return c.a.body == body || c.b.body == body; };
    if (std::ranges::any_of(conditions_->all(), is_of)) return false;
    for (int i = body + 1; i < tree_->size(); ++i)
        if (tree_->node(i).parent == body) return false;
    for (const mechanics::Resistance& r : conditions_->resistances())
        if (is_of(conditions_->contacts()[at(r.contact)])) return false;
    const double* const v = x.data() + tree_->positions() + node.v;
    const double speed = std::hypot(v[0], v[1], v[2]), turning = std::hypot(v[3], v[4], v[5]);
    std::optional<int> first;
    for (int k = 0; k < contacts(); ++k) {
        const mechanics::ContactLaw& c = conditions_->contacts()[at(k)];
        const signed char state = mode.slip[at(k)];
        if (state == flies || !is_of(c)) continue;
        const bool goes_straight = state == straight || state == rests || is_start(state);
        if (!goes_straight || !c.is_rough() || c.never_slips() || c.b.body >= 0 ||
            c.part != mechanics::ContactLaw::Part::ball || c.surface != mechanics::ContactLaw::Surface::plane)
            return false;
        const double reach = rounded(Vector3Of<DoubleDouble>(c.a.point - node.center)).norm();
        if (turning * reach > rounding * speed) return false;
        if (!first) {
            first = k;
            continue;
        }
        const mechanics::ContactLaw& one = conditions_->contacts()[at(*first)];
        if (!mechanics::leveling::are_level(one, c) ||
            static_cast<double>(one.mu_dynamic) != static_cast<double>(c.mu_dynamic))
            return false;
        const Vector3 axis = mechanics::ContactMemory::of(mode.memory, *first).axis,
                      other = mechanics::ContactMemory::of(mode.memory, k).axis;
        if ((other - axis).norm() > rounding * axis.norm()) return false;
    }
    return first.has_value();
}

}  // namespace rbdyn::inline RBDYN_FORM
