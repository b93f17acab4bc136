// Definitions of rbdyn/closed_form/linear_system.hpp.
#pragma once

#include "rbdyn/closed_form/linear_system.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <memory>
#include <numeric>
#include <optional>
#include <span>
#include <vector>

#include "rbdyn/basics/dense.hpp"
#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/double_double_functions.hpp"
#include "rbdyn/basics/instant.hpp"
#include "rbdyn/closed_form/forced_modes.hpp"
#include "rbdyn/closed_form/linear_flow.hpp"
#include "rbdyn/closed_form/linear_modes.hpp"
#include "rbdyn/closed_form/symmetric_modes.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE bool LinearSystem::is_polynomial() const {
    std::vector<bool> known(rows.size(), false);
    for (bool goes_on = true; goes_on;) {
        goes_on = false;
        // velocities come last, and positions depend on them
        for (std::size_t i = rows.size(); i-- > 0;) {
            if (known[i] || !std::all_of(rows[i].begin(), rows[i].end(),
                                         [&](const Entry& e) { return known[static_cast<std::size_t>(e.column)]; }))
                continue;
            known[i] = goes_on = true;
        }
    }
    return std::find(known.begin(), known.end(), false) == known.end();
}

RBDYN_INLINE bool LinearSystem::is_finite() const {
    const auto finite = [](const DoubleDouble& value) { return std::isfinite(value.hi); };
    return std::ranges::all_of(constants, finite) && std::ranges::all_of(start, finite) &&
           std::ranges::all_of(rows, [&](const auto& row) {
               return std::ranges::all_of(row, [&](const Entry& e) { return finite(e.value); });
           });
}

RBDYN_INLINE std::vector<DoubleDouble> LinearSystem::rates() const {
    std::vector<DoubleDouble> result = constants;
    for (std::size_t i = 0; i < rows.size(); ++i)
        for (const Entry& e : rows[i]) result[i] += e.value * start[static_cast<std::size_t>(e.column)];
    return result;
}

}  // namespace rbdyn::inline RBDYN_FORM

namespace rbdyn::inline RBDYN_FORM::linear {

RBDYN_INLINE EvenChange::EvenChange(int place, const DoubleDouble& start, const DoubleDouble& rate)
    : place_(place), start_(start), rate_(rate) {}

RBDYN_INLINE void EvenChange::state(Instant since, std::span<double> x) const {
    x[at(place_)] = static_cast<double>(start_ + DoubleDouble(since) * rate_);
}

RBDYN_INLINE void EvenChange::add_errors(double, std::span<double>) const {}

RBDYN_INLINE double EvenChange::fastest() const { return 0.0; }

RBDYN_INLINE std::vector<std::vector<int>> blocks(const LinearSystem& system) {
    std::vector<int> heads(at(system.size()));
    std::iota(heads.begin(), heads.end(), 0);
    const auto head = [&](int i) {
        while (heads[at(i)] != i) i = heads[at(i)] = heads[at(heads[at(i)])];
        return i;
    };
    for (int i = 0; i < system.size(); ++i)
        for (const LinearSystem::Entry& e : system.rows[at(i)]) {
            const auto [first, second] = std::minmax({head(i), head(e.column)});
            heads[at(second)] = first;
        }
    std::vector<std::vector<int>> result;
    std::vector<int> place(heads.size());
    for (int i = 0; i < system.size(); ++i) {
        const int first = head(i);
        if (first == i) {
            place[at(i)] = static_cast<int>(result.size());
            result.emplace_back();
        }
        result[at(place[at(first)])].push_back(i);
    }
    return result;
}

RBDYN_INLINE std::optional<SecondOrder> second_order(const LinearSystem& system, const std::vector<int>& block,
                                                     int own) {
    SecondOrder result;
    std::vector<int> index(at(system.size()), -1);
    for (const int i : block) {
        if (i >= own) {
            result.drivers.push_back(i);
            continue;
        }
        if (index[at(i)] >= 0) continue;
        const auto& row = system.rows[at(i)];
        if (row.size() != 1 || row[0].value != DoubleDouble(1.0) || system.constants[at(i)].hi != 0.0)
            return std::nullopt;
        const int velocity = row[0].column;
        if (velocity == i || velocity >= own || index[at(velocity)] >= 0) return std::nullopt;
        index[at(i)] = index[at(velocity)] = static_cast<int>(result.positions.size());
        result.positions.push_back(i);
        result.velocities.push_back(velocity);
    }
    if (result.positions.empty()) return std::nullopt;
    const int n = static_cast<int>(result.positions.size());
    result.stiffness = result.damping = WideMatrix(n);
    for (int i = 0; i < n; ++i)
        for (const LinearSystem::Entry& e : system.rows[at(result.velocities[at(i)])]) {
            if (e.column >= own) continue;
            const int j = index[at(e.column)];
            (result.positions[at(j)] == e.column ? result.stiffness : result.damping)(i, j) -= e.value;
        }
    return result;
}

}  // namespace rbdyn::inline RBDYN_FORM::linear

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE LinearBlocks solve(const LinearSystem& system, int own) {
    using linear::at;
    LinearBlocks result;
    const std::vector<DoubleDouble> rates = system.rates();
    // directions of space often have the same matrix
    WideMatrix last;
    std::shared_ptr<const SymmetricModes> modes;
    for (const std::vector<int>& block : linear::blocks(system)) {
        const int first = block.front(), size = static_cast<int>(block.size());
        if (size == 1 && system.rows[at(first)].empty()) {
            result.blocks.push_back(std::make_unique<const linear::EvenChange>(first, system.start[at(first)],
                                                                               system.constants[at(first)]));
            continue;
        }
        if (size > most_in_block) {
            result.too_large = size;
            return result;
        }
        const auto pairs = linear::second_order(system, block, own);
        // of few variables that are forced one flow is set up as quickly as many
        if (pairs && (pairs->drivers.empty() || size > most_in_flow)) {
            const auto symmetric = LinearModes::symmetric(pairs->stiffness);
            const auto damping = LinearModes::proportional(pairs->damping, pairs->stiffness);
            if (symmetric && damping) {
                if (pairs->positions.size() > at(most_modes) || pairs->drivers.size() > at(most_in_flow)) {
                    result.too_large = size;
                    return result;
                }
                if (!modes || !(last == symmetric->matrix)) {
                    modes = std::make_shared<const SymmetricModes>(symmetric_modes(symmetric->matrix));
                    last = symmetric->matrix;
                }
                if (!pairs->drivers.empty()) {
                    result.by_modes = false;
                    result.blocks.push_back(
                        std::make_unique<const ForcedModes>(system, *pairs, *symmetric, *modes, *damping));
                    continue;
                }
                // the force at the start and at rest: what damping adds to it is the mode's
                std::vector<DoubleDouble> pull = linear::gathered(rates, pairs->velocities);
                const std::vector<DoubleDouble> speeds = linear::gathered(system.start, pairs->velocities);
                for (int i = 0; i < size / 2; ++i)
                    for (int j = 0; j < size / 2; ++j) pull[at(i)] += pairs->damping(i, j) * speeds[at(j)];
                result.blocks.push_back(std::make_unique<const LinearModes>(
                    pairs->positions, pairs->velocities, *symmetric, modes, *damping, pull,
                    linear::gathered(system.start, pairs->positions), speeds));
                continue;
            }
        }
        if (size > most_in_flow) {
            result.too_large = size;
            return result;
        }
        result.by_modes = false;
        std::vector<int> index(at(system.size()), -1);
        for (int i = 0; i < size; ++i) index[at(block[at(i)])] = i;
        WideMatrix a(size);
        for (int i = 0; i < size; ++i)
            for (const LinearSystem::Entry& e : system.rows[at(block[at(i)])]) a(i, index[at(e.column)]) = e.value;
        result.blocks.push_back(std::make_unique<const LinearFlow>(block, a, linear::gathered(rates, block),
                                                                   linear::gathered(system.start, block)));
    }
    return result;
}

}  // namespace rbdyn::inline RBDYN_FORM
