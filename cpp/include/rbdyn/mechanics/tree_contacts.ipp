// Definitions of rbdyn/mechanics/tree_model.hpp: which contacts are closed in a mode, how large and fast what they
// join is, and which rows hold them.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "rbdyn/basics/double_double_functions.hpp"
#include "rbdyn/mechanics/contact_state.hpp"
#include "rbdyn/mechanics/speed_rounding.hpp"
#include "rbdyn/mechanics/touched.hpp"
#include "rbdyn/mechanics/tree_model.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE bool TreeModel::bounces_among_bouncing(int contact) const {
    const mechanics::ContactLaw& one = conditions_->contacts()[at(contact)];
    const auto is_joined = [&](int body) { return body >= 0 && (body == one.a.body || body == one.b.body); };
    // what is struck through its centre of mass is not turned
    const auto is_central = [&](const mechanics::Anchor& on, bool is_plane) {
        if (on.body < 0) return true;
        const mechanics::Node& n = tree_->node(on.body);
        return n.is_point || (!is_plane && on.point == n.center);
    };
    return std::ranges::all_of(conditions_->contacts(), [&](const mechanics::ContactLaw& c) {
        if (!(is_joined(c.a.body) || is_joined(c.b.body))) return true;
        return c.restitution > 0.0 && c.part == mechanics::ContactLaw::Part::ball && is_central(c.a, false) &&
               is_central(c.b, c.surface == mechanics::ContactLaw::Surface::plane);
    });
}

RBDYN_INLINE std::vector<int> TreeModel::rows_in(const Mode& mode) const {
    std::vector<int> rows = used_rows(mode);
    for (int k = 0; k < contacts(); ++k)
        if (mode.slip[at(k)] == pushes || mechanics::contact_state::slides(mode.slip[at(k)]))
            rows.push_back(conditions_->normal_row(k));
    for (int k = 0; k < contacts(); ++k)
        for (int axis = 0; axis < 3; ++axis)
            if (mechanics::contact_state::is_row(mode.slip[at(k)], axis))
                rows.push_back(conditions_->held_row(k, axis));
    for (int e = 0; e < resistances(); ++e)
        for (int k = 0; k < 2; ++k)
            if (mechanics::contact_state::is_row(resisting(mode, e), k))
                rows.push_back(conditions_->resistance_row(e, k));
    for (int i = 0; i < static_cast<int>(joints_.size()); ++i)
        if (mode.slip[at(first_joint() + i)] == mechanics::joint_state::held) rows.push_back(conditions_->joint_row(i));
    return rows;
}

RBDYN_INLINE std::vector<int> TreeModel::kept_rows(const Mode& mode) const {
    std::vector<int> rows = rows_in(mode);
    std::erase_if(rows, [&](int r) {
        const int joint = r - conditions_->joint_row(0);
        return joint >= 0 && (contacts() == 0 || !joints_[at(joint)].drive.is_zero());
    });
    return rows;
}

RBDYN_INLINE std::vector<int> TreeModel::closed_in(const Mode& mode,
                                                   const std::vector<mechanics::Moving<double>>& all) const {
    if (!conditions_->is_rough()) return kept_rows(mode);
    std::vector<int> rows = rows_;
    for (const int r : kept_rows(mode))
        if (r >= conditions_->joint_row(0)) rows.push_back(r);
    const std::size_t first = rows.size();
    for (int k = 0; k < contacts(); ++k)
        if (mode.slip[at(k)] != flies && !mechanics::contact_state::is_given(mode.slip[at(k)]))
            rows.push_back(conditions_->normal_row(k));
    return mechanics::independent_rows(*tree_, *conditions_, rows, all, first);
}

RBDYN_INLINE double TreeModel::size_of(int contact, const std::vector<mechanics::Moving<double>>& all) const {
    const mechanics::ContactLaw& c = conditions_->contacts()[at(contact)];
    // where both meet far from the origin their places have its rounding: what is known of a size to 1e-12 is known of
    // these to some units in the last place
    constexpr double of_places = 0x1p-6;
    const Vector3 a = tree_->point<double>(c.a, all).place, b = tree_->point<double>(c.b, all).place;
    double size = std::max((a - b).norm(), of_places * std::max(a.norm(), b.norm()));
    size = std::max({size, static_cast<double>(c.radius), static_cast<double>(c.surface_radius)});
    for (const mechanics::Anchor* end : {&c.a, &c.b})
        if (end->body >= 0)
            size = std::max(size, (rounded(end->point) - rounded(tree_->node(end->body).center)).norm());
    return size;
}

RBDYN_INLINE bool TreeModel::feel_each_other(int contact, int other, const Mode& mode, double t,
                                             std::span<const double> x) const {
    const auto all = moving(mode, t, x);
    const auto every = conditions_->rows<double>(*tree_, all);
    std::vector<mechanics::Row<double>> rows;
    std::size_t first = 0;  // of those of the other one
    for (const int k : {contact, other}) {
        first = rows.size();
        rows.push_back(every[at(conditions_->normal_row(k))]);
        for (int axis = 0; axis < 3 && is_rough(k); ++axis) rows.push_back(every[at(conditions_->held_row(k, axis))]);
    }
    const mechanics::Square a = friction::Coupled(*tree_, all, constraints_of(mode, every), rows, rows).matrix();
    for (std::size_t i = 0; i < first; ++i)
        for (std::size_t j = first; j < rows.size(); ++j)
            if (std::abs(a[i][j]) > 1e-9 * std::sqrt(std::abs(a[i][i] * a[j][j]))) return true;
    return false;
}

RBDYN_INLINE double TreeModel::least_size(const Mode& mode, const std::vector<mechanics::Moving<double>>& all) const {
    double least = 0.0;
    for (int k = 0; k < contacts(); ++k)
        if (mode.slip[at(k)] != flies) {
            const double size = size_of(k, all);
            if (size > 0.0 && !(least > 0.0 && least <= size)) least = size;
        }
    return least;
}

RBDYN_INLINE double TreeModel::speed_of(int contact, const std::vector<mechanics::Moving<double>>& all) const {
    const mechanics::ContactLaw& c = conditions_->contacts()[at(contact)];
    double speed = 0.0;
    for (const mechanics::Anchor* end : {&c.a, &c.b})
        if (end->body >= 0) {
            const mechanics::Moving<double>& m = all[at(end->body)];
            const double arm = rounded(end->point).norm() + static_cast<double>(c.radius);
            speed = std::max(speed, safe_norm(m.velocity) + safe_norm(m.omega) * arm);
        }
    return speed;
}

RBDYN_INLINE double TreeModel::fastest_of(int contact, double t, std::span<const double> x,
                                          std::span<const double> largest,
                                          const std::vector<mechanics::Moving<double>>& all) const {
    const mechanics::ContactLaw& c = conditions_->contacts()[at(contact)];
    const auto velocity = [&](const std::vector<double>& state) {
        return c.touching<double>(*tree_, moving(t, state)).velocity;
    };
    std::vector<double> one(x.begin(), x.end());
    std::fill(one.begin() + tree_->positions(), one.end(), 0.0);
    const Vector3 still = velocity(one);
    double sum = 0.0;
    std::vector<bool> is_taken(at(bodies()), false);
    for (const int side : {c.a.body, c.b.body})
        for (int i = side; i >= 0 && !largest.empty() && !is_taken[at(i)]; i = tree_->node(i).parent) {
            const mechanics::Node& n = tree_->node(i);
            is_taken[at(i)] = true;
            for (int k = n.v; k < n.v + n.joint.velocities(); ++k) {
                const std::size_t place = at(tree_->positions() + k);
                one[place] = largest[place];
                sum += Vector3(velocity(one) - still).norm();
                one[place] = 0.0;
            }
        }
    return std::max(sum, speed_of(contact, all));
}

RBDYN_INLINE std::vector<std::vector<double>> TreeModel::coupling(const std::vector<mechanics::Moving<double>>& all,
                                                                  const std::vector<int>& of) const {
    const auto every = conditions_->rows<double>(*tree_, all);
    std::vector<mechanics::Row<double>> rows;
    for (const int k : of) rows.push_back(every[at(conditions_->normal_row(k))]);
    return friction::Coupled(*tree_, all, constraints_of(every), rows, rows).matrix();
}

RBDYN_INLINE std::pair<std::vector<double>, std::vector<double>> TreeModel::opening(const Mode& mode, double t,
                                                                                    std::span<const double> x,
                                                                                    const std::vector<int>& of) const {
    const mechanics::TreeState state = look(mode, t, x);
    const auto rows = conditions_->rows<double>(*tree_, state.moving);
    std::pair<std::vector<double>, std::vector<double>> result;
    for (const int k : of) {
        const auto [sum, size] = acceleration_along(rows[at(conditions_->normal_row(k))], state);
        result.first.push_back(sum);
        const double curved = mechanics::speed_rounding(speed_of(k, state.moving), size_of(k, state.moving));
        result.second.push_back(1e-13 * (size + curved));
    }
    return result;
}

RBDYN_INLINE std::pair<double, double> TreeModel::acceleration_along(const mechanics::Row<double>& row,
                                                                     const mechanics::TreeState& state) {
    double sum = row.bias, size = std::abs(row.bias);
    const auto take = [&](int body, const Wrench<double>& on) {
        if (body < 0) return;
        const mechanics::Moving<double>& m = state.moving[at(body)];
        const mechanics::TreeState::Body& b = state.bodies[at(body)];
        const mechanics::Twist<double> linear{b.angular_acceleration - m.bias_turn, b.origin_acceleration - m.bias};
        sum += mechanics::power(linear, on);
        size += b.angular_acceleration.norm() * on.moment.norm() + b.origin_acceleration.norm() +
                m.bias_turn.norm() * on.moment.norm() + m.bias.norm();
    };
    take(row.a, row.on_a);
    take(row.b, row.on_b);
    return {sum, size};
}

RBDYN_INLINE int TreeModel::force_of(const Mode& mode, int contact) {
    if (mode.equations == nullptr) return -1;
    for (const Guard& guard : mode.equations->guards)
        if (guard.contact == contact && guard.kind == EventKind::detach) return guard.output;
    return -1;
}

RBDYN_INLINE double TreeModel::forces_at(int contact, const mechanics::TreeState& state) const {
    const mechanics::ContactLaw& c = conditions_->contacts()[at(contact)];
    const double size = size_of(contact, state.moving);
    double forces = 0.0;
    for (const int body : {c.a.body, c.b.body}) {
        if (body < 0) continue;
        const Wrench<double>& effort = state.bodies[at(body)].effort;
        forces += effort.force.norm() + (size > 0.0 ? effort.moment.norm() / size : 0.0) +
                  static_cast<double>(tree_->node(body).mass) *
                      mechanics::speed_rounding(speed_of(contact, state.moving), size);
    }
    return forces;
}

RBDYN_INLINE std::string TreeModel::lies_flat(const std::vector<int>& closed,
                                              const std::vector<mechanics::Moving<double>>& all, double most) const {
    for (const int k : closed) {
        const mechanics::ContactLaw& c = conditions_->contacts()[at(k)];
        // on a ball it touches with its face
        if (c.part != mechanics::ContactLaw::Part::disc || c.surface == mechanics::ContactLaw::Surface::ball) continue;
        const Vector3 axis = all[at(c.a.body)].to_world(exactly<double>(c.axis));
        // in a bowl it is flat where the centre of that is above its own
        const bool is_in_bowl = c.surface == mechanics::ContactLaw::Surface::bowl;
        const Vector3 apart = tree_->point<double>(c.b, all).place - tree_->point<double>(c.a, all).place;
        const double tilt = is_in_bowl ? axis.cross(apart).norm() / std::max(apart.norm(), 0x1p-1022)
                                       : axis.cross(c.touching<double>(*tree_, all).normal).norm();
        if (tilt < most || (is_in_bowl && tilt < 2.0 * mechanics::nearest::least_tilt))
            return "the disc of " + c.name + " has come to lie flat, but for " + text(tilt) +
                   " rad: all of its rim touches, and no one point of it goes on";
    }
    return {};
}

}  // namespace rbdyn::inline RBDYN_FORM
