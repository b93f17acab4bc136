// Definitions of rbdyn/statics/tree_forces.hpp: what forces and their slopes are sums of.
#pragma once

#include <cmath>
#include <cstddef>
#include <optional>
#include <span>
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

RBDYN_INLINE RoundingSizes TreeForces::sizes_of(const Program& program, const std::vector<double>& q) {
    std::vector<double> parameters;
    set_signs(program, parameters, q);
    RoundingSizes sizes(program);
    sizes.set_parameters(parameters);
    sizes(0.0, q);
    return sizes;
}

RBDYN_INLINE std::vector<double> TreeForces::force_sizes(const Wide& place) {
    const std::vector<double> q = nearest(place);
    if (distinguishes_) record(q);
    const RoundingSizes sizes = sizes_of(program_, q);
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
    const RoundingSizes sizes = sizes_of(program, q);
    for (const Change<double>& c : all)
        for (int i = 0; i < n && first[at(c.position)] >= 0; ++i)
            result(i, c.freedom) += std::abs(c.rate) * sizes.size(first[at(c.position)] + i);
    return result;
}

}  // namespace rbdyn::inline RBDYN_FORM::statics
