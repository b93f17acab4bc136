// Definitions of rbdyn/mechanics/tree_model.hpp: what of the errors of forces is judged where slips end.
//
// The direction of a slip, or of a turn on a surface, is u/|u| of a u that comes to zero or begins there: it is wrong
// by the error of u over |u|, and so is every force that it enters, however well the motion is known. Of these no more
// is told than of u: an error counts by the part that u is of the speeds which make it up. A normal force, which need
// not depend on it, counts in full until u is a thousandth of them.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include "rbdyn/mechanics/contact_state.hpp"
#include "rbdyn/mechanics/tree_model.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE TreeModel::SlipParts::SlipParts(const TreeModel& model, const Mode& mode,
                                             const mechanics::TreeState& state) {
    const auto is_turning = [](signed char does) {
        return does == mechanics::contact_state::turning || does == mechanics::contact_state::brief;
    };
    const auto add = [&](int k, double speed) {
        const double most = model.speed_of(k, state.moving);
        slips_.push_back({k, -1, most > 0.0 ? std::min(1.0, speed / most) : 1.0});
    };
    for (int k = 0; k < model.contacts(); ++k)
        if (is_turning(mode.slip[at(k)])) add(k, state.contacts[at(k)].slip.norm());
    for (int e = 0; e < model.resistances(); ++e) {
        if (!is_turning(model.resisting(mode, e))) continue;
        const int k = model.conditions_->resistances()[at(e)].contact;
        const std::array<double, 2> rate = model.rate_of(e, state.moving);
        add(k, std::hypot(rate[0], rate[1]) * model.size_of(k, state.moving));
    }
    if (slips_.empty()) return;
    // groups of bodies that pass forces on to each other; what moves as functions of time say passes none on
    const auto& nodes = model.tree_->nodes();
    std::vector<bool> is_given;
    std::vector<std::array<int, 2>> joined;
    for (const mechanics::Node& n : nodes) {
        const auto i = static_cast<int>(group_.size());
        is_given.push_back(n.joint.velocities() == 0 && (n.parent < 0 || is_given[at(n.parent)]));
        joined.push_back({n.parent, i});
        group_.push_back(i);
    }
    for (int k = 0; k < model.contacts(); ++k) {
        const mechanics::ContactLaw& c = model.conditions_->contacts()[at(k)];
        if (mode.slip[at(k)] != flies) joined.push_back({c.a.body, c.b.body});
        contacts_.push_back({c.a.body, c.b.body});
    }
    for (const mechanics::Condition& c : model.conditions_->all()) joined.push_back({c.a.body, c.b.body});
    for (const auto& [a, b] : joined)
        if (a >= 0 && b >= 0 && !is_given[at(a)] && !is_given[at(b)] && group_[at(a)] != group_[at(b)])
            std::ranges::replace(group_, int(group_[at(a)]), int(group_[at(b)]));
    for (std::size_t i = 0; i < nodes.size(); ++i)
        if (is_given[i]) group_[i] = none;
    for (Slip& slip : slips_) slip.group = group_of(contacts_[at(slip.contact)]);
    for (const int group : group_) parts_.push_back(part(group, none));
    // what is given bears what touches it and what it carries
    for (auto pair = joined.rbegin(); pair != joined.rend(); ++pair)
        for (const auto& [a, b] : {*pair, std::array{(*pair)[1], (*pair)[0]}})
            if (a >= 0 && b >= 0 && is_given[at(a)]) parts_[at(a)] = std::min(parts_[at(a)], parts_[at(b)]);
}

RBDYN_INLINE int TreeModel::SlipParts::group_of(const std::array<int, 2>& bodies) const {
    for (const int i : bodies)
        if (i >= 0 && group_[at(i)] != none) return group_[at(i)];
    return none;
}

RBDYN_INLINE double TreeModel::SlipParts::part(int group, int contact) const {
    double least = 1.0;
    for (const Slip& slip : slips_)
        if (slip.group == group && group != none)
            least = std::min(least, slip.contact == contact ? 1e3 * slip.part : slip.part);
    return least;
}

RBDYN_INLINE double TreeModel::SlipParts::of_contact(int k) const {
    return slips_.empty() ? 1.0 : part(group_of(contacts_[at(k)]), k);
}

RBDYN_INLINE double TreeModel::SlipParts::between(int a, int b) const { return std::min(on(a), on(b)); }

RBDYN_INLINE double TreeModel::SlipParts::on(int body) const {
    return slips_.empty() || body < 0 ? 1.0 : parts_[at(body)];
}

}  // namespace rbdyn::inline RBDYN_FORM
