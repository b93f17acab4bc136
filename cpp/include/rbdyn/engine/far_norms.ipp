// Definitions of rbdyn/engine/far_norms.hpp.
#pragma once

#include "rbdyn/engine/far_norms.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include "rbdyn/expression/program.hpp"
#include "rbdyn/expression/series_evaluator.hpp"
#include "rbdyn/model/equations.hpp"
#include "rbdyn/series/piece.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE FarNorms::FarNorms(const Equations& equations, const std::vector<int>& guards) {
    const Program& program = equations.program;
    for (const int g : guards) {
        const Guard& guard = equations.guards[static_cast<std::size_t>(g)];
        const Instruction* norm = guard.is_watched() ? nullptr : program.norm(guard.output);
        if (norm == nullptr) continue;
        const std::size_t components = components_.size(), multiples = multiples_.size();
        const bool is_linear = std::ranges::all_of(std::array{norm->a, norm->b, norm->c},
                                                   [&](int slot) { return slot < 0 || take(program, slot); });
        if (is_linear) {
            norms_.push_back({g, components, components_.size()});
        } else {
            components_.resize(components);
            multiples_.resize(multiples);
        }
    }
    if (norms_.empty()) return;
    is_far_.assign(equations.guards.size(), 0);
    are_all_ = norms_.size() == guards.size();
}

RBDYN_INLINE bool FarNorms::take(const Program& program, int slot) {
    const std::size_t first = multiples_.size();
    int weight = -1;
    if (slot < program.inputs()) {
        multiples_.push_back({slot, itself});
    } else {
        const Instruction* sum = program.maker(slot);
        if (sum == nullptr || sum->code != Code::combine || sum->products > 0) return false;
        weight = sum->weight;
        for (int k = 0; k < sum->terms; ++k) {
            const Term& term = program.terms(*sum)[k];
            if (term.slot >= program.inputs()) return false;
            multiples_.push_back({term.slot, term.weight});
        }
    }
    components_.push_back({weight, first, multiples_.size()});
    return true;
}

RBDYN_INLINE bool FarNorms::look(const Piece& piece, const SeriesEvaluator& series) {
    bool all = are_all_;
    for (const Norm& norm : norms_) {
        const bool is = is_far(norm, piece, series);
        is_far_[static_cast<std::size_t>(norm.guard)] = is ? 1 : 0;
        all = all && is;
    }
    return all;
}

RBDYN_INLINE bool FarNorms::is_far(const Norm& norm, const Piece& piece, const SeriesEvaluator& series) const {
    // of that the rounding of its terms, and what the polynomials are off, are less
    constexpr double share = 0.75;
    double start = 0.0, change = 0.0;
    for (std::size_t i = norm.first; i < norm.last; ++i) {
        const Component& part = components_[i];
        double at_start = part.weight < 0 ? 0.0 : series.weight(part.weight), changes = 0.0, size = std::abs(at_start);
        for (int k = piece.order; k > 0; --k) {
            double sum = 0.0;
            for (std::size_t m = part.first; m < part.last; ++m) {
                const Multiple& one = multiples_[m];
                sum += (one.weight == itself ? 1.0 : series.weight(one.weight)) * piece.variable(one.variable)[k];
            }
            changes = (changes + std::abs(sum)) * piece.length;
        }
        for (std::size_t m = part.first; m < part.last; ++m) {
            const Multiple& one = multiples_[m];
            const double term =
                (one.weight == itself ? 1.0 : series.weight(one.weight)) * piece.variable(one.variable)[0];
            at_start += term;
            size += std::abs(term);
        }
        // nor is there a difference that is rounding
        if (std::abs(at_start) < 0x1p-40 * size) at_start = 0.0;
        start += at_start * at_start;
        change += changes * changes;
    }
    // false also of what is no number
    return std::isfinite(start) && change < share * share * start;
}

}  // namespace rbdyn::inline RBDYN_FORM
