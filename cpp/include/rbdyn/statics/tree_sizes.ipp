// Definitions of rbdyn/statics/tree_forces.hpp: what forces and their slopes are sums of.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "rbdyn/basics/dense.hpp"
#include "rbdyn/basics/interruption.hpp"
#include "rbdyn/expression/expression.hpp"
#include "rbdyn/expression/program.hpp"
#include "rbdyn/expression/recorder.hpp"
#include "rbdyn/expression/rounding_sizes.hpp"
#include "rbdyn/statics/path_forces.hpp"
#include "rbdyn/statics/tree_forces.hpp"

namespace rbdyn::inline RBDYN_FORM::statics {

RBDYN_INLINE RoundingSizes TreeForces::sizes_of(const Program& program, const std::vector<double>& q,
                                                const std::vector<double>& known) {
    std::vector<double> parameters;
    set_signs(program, parameters, q);
    RoundingSizes sizes(program);
    sizes.set_parameters(parameters);
    sizes(0.0, q, known);
    return sizes;
}

RBDYN_INLINE std::vector<double> TreeForces::known() const {
    const int count = tree().velocities();
    std::vector<double> sizes(at(count)), units(at(count));
    for (const mechanics::Node& n : tree().nodes())
        for (int k = 0; k < n.joint.velocities(); ++k) {
            const int turns = n.joint.attitude();
            sizes[at(n.v + k)] = turns >= 0 && k >= turns ? 1.0 : std::abs(place_[at(n.q + k)].hi);
            units[at(n.v + k)] = unit_of(n, k);
        }
    if (rows_.empty()) return sizes;
    if (!known_.empty()) return known_;
    // what closes the constraints takes back what is at right angles to all motions, in units of each; of many freedoms
    // the largest size is taken
    constexpr std::size_t most = 120;
    if (basis_.size() > most) {
        double largest = 0.0;
        for (std::size_t k = 0; k < sizes.size(); ++k) largest = std::max(largest, sizes[k] / units[k]);
        for (std::size_t k = 0; k < sizes.size(); ++k) known_.push_back(std::max(sizes[k], largest * units[k]));
        return known_;
    }
    std::vector<std::vector<double>> motions;
    for (const Wide& one : basis_) {
        std::vector<double> motion;
        for (std::size_t k = 0; k < sizes.size(); ++k) motion.push_back(one[k].hi / units[k]);
        // twice is enough (Giraud, Langou and Rozloznik, Comput. Math. Appl. 50, 2005)
        double length = 0.0;
        for (int time = 0; time < 2; ++time) {
            for (const std::vector<double>& other : motions) {
                double along = 0.0;
                for (std::size_t k = 0; k < motion.size(); ++k) along += motion[k] * other[k];
                for (std::size_t k = 0; k < motion.size(); ++k) motion[k] -= along * other[k];
            }
            length = 0.0;
            for (const double x : motion) length += x * x;
            for (double& x : motion) x /= std::sqrt(length);
        }
        if (std::isfinite(length) && length > 0.0) motions.push_back(std::move(motion));
    }
    for (std::size_t k = 0; k < sizes.size(); ++k) {
        double sum = 0.0;
        for (std::size_t j = 0; j < sizes.size(); ++j) {
            double share = 0.0;
            for (const std::vector<double>& motion : motions) share += motion[k] * motion[j];
            sum += std::abs(share) * sizes[j] / units[j];
        }
        known_.push_back(std::max(sizes[k], sum * units[k]));
    }
    return known_;
}

RBDYN_INLINE std::vector<double> TreeForces::force_sizes(const Wide& place) {
    const std::vector<double> q = nearest(place);
    if (distinguishes_) record(q);
    std::vector<double> of_positions;
    if (!rows_.empty()) {
        // where it was asked last was no place
        if (place_.empty()) look_at(place);
        const std::vector<double> all = known();
        for (const mechanics::Node& n : tree().nodes()) {
            const int turns = n.joint.attitude();
            for (int k = 0; k < n.joint.positions(); ++k) {
                double size = all[at(n.v + std::min(k, n.joint.velocities() - 1))];
                if (turns >= 0 && k >= turns) {
                    // a turn changes an attitude's four by half of it
                    const auto first = all.begin() + n.v + turns;
                    size = 0.5 * *std::max_element(first, first + 3);
                }
                of_positions.push_back(size);
            }
        }
    }
    const RoundingSizes sizes = sizes_of(program_, q, of_positions);
    std::vector<double> result;
    for (int i = 0; i < freedoms(); ++i) {
        double size = rows_.empty() ? sizes.size(i) : 0.0;
        for (int k = 0; k < tree().velocities() && !rows_.empty(); ++k)
            size += std::abs(static_cast<double>(basis_[at(i)][at(k)])) * sizes.size(k);
        result.push_back(size);
    }
    return result;
}

RBDYN_INLINE std::optional<SquareMatrix> TreeForces::jacobian_sizes() const {
    if (!rows_.empty()) return std::nullopt;
    const std::vector<double> q = nearest(place_);
    const int n = freedoms(), positions = tree().positions();
    Recorder r;
    r.follow(0.0, q, {});
    std::vector<Expression> places, slopes;
    for (int i = 0; i < positions; ++i) places.push_back(r.input(i));
    std::vector<int> first(at(positions), -1);
    const std::vector<Change<double>> all = changes<double>(q);
    for (const Change<double>& c : all) {
        if (first[at(c.position)] >= 0 || !function_->depends_on(c.position)) continue;
        Interruption::point();
        first[at(c.position)] = static_cast<int>(slopes.size());
        for (const Expression& e : slope(c.position)(std::span<const Expression>(places))) slopes.push_back(e);
    }
    SquareMatrix result(n);
    if (slopes.empty()) return result;
    const Program program(r, slopes, positions);
    const RoundingSizes sizes = sizes_of(program, q, {});
    for (const Change<double>& c : all)
        for (int i = 0; i < n && first[at(c.position)] >= 0; ++i)
            result(i, c.velocity) += std::abs(c.rate) * sizes.size(first[at(c.position)] + i);
    return result;
}

}  // namespace rbdyn::inline RBDYN_FORM::statics
