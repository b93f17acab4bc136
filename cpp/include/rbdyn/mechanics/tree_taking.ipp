// Definitions of rbdyn/mechanics/tree_model.hpp: which contacts forces that are found hold, and which begin to slide.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <vector>

#include "rbdyn/mechanics/closure.hpp"
#include "rbdyn/mechanics/contact_state.hpp"
#include "rbdyn/mechanics/friction_cones.hpp"
#include "rbdyn/mechanics/touched.hpp"
#include "rbdyn/mechanics/tree_model.hpp"

namespace rbdyn::inline RBDYN_FORM {

namespace taking {

/// Of the largest coefficient of friction.
inline constexpr double far_less = 1e-3;

}  // namespace taking

RBDYN_INLINE std::vector<bool> TreeModel::begin_to_slide(const Mode& mode, Touched& touched,
                                                         const mechanics::ConeForces& found,
                                                         const std::vector<double>& b, const std::vector<double>& noise,
                                                         const std::vector<int>& breaking) const {
    using mechanics::ConeState;
    std::vector<bool> begins(touched.all.size(), false);
    // by what it does, or against the force that held it where it begins without an acceleration
    std::vector<Vector3> wholes(touched.all.size(), Vector3(Vector3::Zero()));
    std::vector<bool> moves(touched.all.size(), false);
    std::vector<bool> bears = moves;
    std::vector<double> doubt(touched.all.size(), 0.0);  // of its direction
    double largest = 0.0;
    for (const double one : found.force) largest = std::max(largest, std::abs(one));
    for (std::size_t i = 0; i < touched.all.size(); ++i) {
        Touched::One& one = touched.all[i];
        const auto f = static_cast<std::size_t>(touched.cones[i].first);
        const bool breaks = std::find(breaking.begin(), breaking.end(), one.contact) != breaking.end();
        begins[i] = found.states[i] != ConeState::open && is_rough(one.contact) && !one.slides &&
                    (found.states[i] == ConeState::slides || breaks);
        if (!begins[i]) continue;
        const Vector3 rate = one.axes[1] * found.rate[f + 1] + one.axes[2] * found.rate[f + 2],
                      force = one.axes[1] * found.force[f + 1] + one.axes[2] * found.force[f + 2];
        const double blurred = noise[f + 1] + noise[f + 2];
        moves[i] = rate.norm() > 1e3 * blurred;
        wholes[i] = moves[i] ? rate : Vector3(-force);
        bears[i] = moves[i] || force.norm() > 1e-13 * largest;
        // that of a force on its edge is known to the root of what its rate is short of none
        const double all = std::hypot(b[f + 1], b[f + 2]), left = all > 0.0 ? rate.norm() / all : 0.0;
        doubt[i] = moves[i] ? 1e-9 + blurred / rate.norm() : 1e-6 + 128.0 * std::sqrt(left);
        one.along = wholes[i].normalized();
    }
    // of contacts of the same bodies that begin along one direction all do so along that of their sum: what each of
    // them bears is known to the root of rounding, where it is one choice of many on the edges of all cones
    std::vector<Vector3> common(touched.all.size());
    for (std::size_t i = 0; i < touched.all.size(); ++i) {
        if (!begins[i]) continue;
        const mechanics::ContactLaw& c = conditions_->contacts()[at(touched.all[i].contact)];
        Vector3 sum = Vector3::Zero();
        std::vector<std::size_t> group;
        for (std::size_t j = 0; j < touched.all.size(); ++j) {
            const mechanics::ContactLaw& other = conditions_->contacts()[at(touched.all[j].contact)];
            if (!begins[j] || !bears[j] || other.a.body != c.a.body || other.b.body != c.b.body) continue;
            group.push_back(j);
            sum += wholes[j];
        }
        const auto is_along = [&](std::size_t j, std::size_t k) {
            return moves[j] == moves[k] && (touched.all[j].at.normal - touched.all[k].at.normal).norm() <= 1e-14 &&
                   (touched.all[j].along - touched.all[k].along).norm() <= doubt[j] + doubt[k];
        };
        // what bears nothing has no direction of its own: it has theirs, if that is one
        const bool is_one = std::ranges::all_of(group, [&](std::size_t j) {
            return bears[i] ? is_along(i, j)
                            : std::ranges::all_of(group, [&](std::size_t k) { return is_along(j, k); });
        });
        common[i] = is_one ? Vector3(sum.normalized()) : touched.all[i].along;
        begins[i] = bears[i] || (is_one && !group.empty());
    }
    for (std::size_t i = 0; i < touched.all.size(); ++i) {
        if (!begins[i]) continue;
        Touched::One& one = touched.all[i];
        one.along = common[i];
        mechanics::Row<double>& push = touched.pushes[at(touched.cones[i].first)];
        push = one.at.row(Vector3(one.at.normal - one.along * one.sliding), Vector3(Vector3::Zero()));
        one.at.add_torque(push, twisting(mode, one.contact, touched.moving));
    }
    return begins;
}

RBDYN_INLINE std::vector<int> TreeModel::sharing_with(int contact, const std::vector<int>& of,
                                                      const std::vector<int>& rows,
                                                      const std::vector<mechanics::Moving<double>>& all) const {
    std::vector<int> result;
    for (const int k : of) {
        const auto is_own = [&](int row) {
            bool is = row == conditions_->normal_row(k);
            for (int axis = 0; axis < 3; ++axis) is = is || row == conditions_->held_row(k, axis);
            return is;
        };
        std::vector<int> others;
        std::ranges::copy_if(rows, std::back_inserter(others), [&](int row) { return !is_own(row); });
        const std::size_t first = others.size();
        others.push_back(conditions_->normal_row(contact));
        // without what it shares a load with it has one of its own
        const bool shares =
            first < rows.size() &&
            mechanics::independent_rows(*tree_, *conditions_, others, all, first).size() == others.size();
        if (k == contact || shares) result.push_back(k);
    }
    return result;
}

RBDYN_INLINE bool TreeModel::take(const Mode& before, Mode& mode, double t, Touched& touched,
                                  const mechanics::ConeForces& found, const std::vector<double>& b,
                                  const std::vector<double>& noise, const std::vector<int>& breaking,
                                  bool may_be_on_edges) const {
    using mechanics::ConeState;
    using namespace mechanics::contact_state;
    const std::vector<mechanics::Moving<double>>& all = touched.moving;
    const auto breaks = [&](int k) { return std::find(breaking.begin(), breaking.end(), k) != breaking.end(); };
    std::vector<int> candidates;
    for (const Touched::One& one : touched.all) candidates.push_back(one.contact);
    const std::vector<bool> starting = begin_to_slide(mode, touched, found, b, noise, breaking);
    // sliding forces come first, then what is held
    std::vector<int> rows = rows_without_contacts(mode);
    for (std::size_t i = 0; i < candidates.size(); ++i) {
        const int k = candidates[i];
        Touched::One& one = touched.all[i];
        const auto f = static_cast<std::size_t>(touched.cones[i].first);
        if (found.states[i] == ConeState::open) continue;
        if (!is_rough(k)) {
            rows.push_back(conditions_->normal_row(k));
            continue;
        }
        mechanics::ContactMemory memory = mechanics::ContactMemory::of(mode.memory, k);
        const bool begins = starting[i];
        if (!one.slides && !begins) continue;
        rows.push_back(conditions_->normal_row(k));
        // a motion that an impact or its own stop did not touch goes on in its form
        if (one.slides && before.jumps == mode.jumps) {
            const signed char was = before.slip[at(k)];
            if (slides(was) || is_given(was)) {
                // the time since when it shares its load is no longer that since when it bends
                mode.slip[at(k)] = slides(was)    ? was
                                   : was == bends ? mechanics::contact_state::turning
                                                  : mechanics::contact_state::own(was);
                continue;
            }
        }
        double fastest = speed_of(k, all), size = 0.0;
        for (std::size_t j = f; j < f + (touched.cones[i].is_line ? 1U : 3U); ++j)
            size = std::max(size, std::max(std::abs(b[j]), std::abs(found.rate[j])));
        memory.axis = one.at.normal.cross(one.along);
        memory.least = 0x1p-43 * std::max({fastest, std::sqrt(size * size_of(k, all)), least_speed});
        memory.at_edge =
            begins && std::hypot(found.rate[f + 1], found.rate[f + 2]) <= 1e-9 * std::hypot(b[f], b[f + 1], b[f + 2]);
        if (begins) memory.since = t;
        memory.put(mode.memory, k);
        mode.slip[at(k)] = begins ? mechanics::contact_state::starts : straight;
    }
    // what of it the motion does not determine are numbers of the mode: those of feet with far less friction than
    // others have, whose cones leave no room for what changes beside a straight line
    std::vector<int> chosen, of_little;
    std::size_t first = rows.size();
    double most = 0.0;
    const auto holds = [&](std::size_t i) {
        return !touched.cones[i].is_line && found.states[i] == ConeState::held && !breaks(candidates[i]);
    };
    for (std::size_t i = 0; i < candidates.size(); ++i)
        if (holds(i)) most = std::max(most, touched.cones[i].mu);
    for (std::size_t i = 0; i < candidates.size(); ++i) {
        if (!holds(i)) continue;
        const int k = candidates[i];
        const bool has_little = touched.cones[i].mu < taking::far_less * most;
        for (int axis = 0; axis < 3; ++axis) (has_little ? of_little : rows).push_back(conditions_->held_row(k, axis));
        mode.slip[at(k)] = held;
    }
    chosen = mechanics::independent_rows(*tree_, *conditions_, rows, all, first);
    if (!of_little.empty()) {
        first = chosen.size();
        std::ranges::copy(of_little, std::back_inserter(chosen));
        chosen = mechanics::independent_rows(*tree_, *conditions_, chosen, all, first);
    }
    const auto is_chosen = [&](int row) { return std::binary_search(chosen.begin(), chosen.end(), row); };
    for (std::size_t i = 0; i < candidates.size(); ++i) {
        const int k = candidates[i];
        if (is_held(mode.slip[at(k)])) {
            for (int axis = 0; axis < 3; ++axis)
                if (is_chosen(conditions_->held_row(k, axis))) mode.slip[at(k)] += static_cast<signed char>(1 << axis);
        } else if (!is_rough(k) && found.states[i] != ConeState::open) {
            mode.slip[at(k)] = is_chosen(conditions_->normal_row(k)) ? pushes : rests;
        } else if (slides(mode.slip[at(k)]) && !is_chosen(conditions_->normal_row(k))) {
            // one of many forces that give this motion, if its friction does what that of the others would
            if (!makes_no_difference(mode, touched, i, chosen)) {
                mode.impossible = not_unique(sharing_with(k, candidates, chosen, all));
                return false;
            }
            mode.slip[at(k)] = mechanics::contact_state::given(mode.slip[at(k)]);
        }
    }
    return hold_by_friction(before, mode, t, touched, found.force, all, may_be_on_edges);
}

}  // namespace rbdyn::inline RBDYN_FORM
