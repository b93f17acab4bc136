// Definitions of rbdyn/expression/stream_kinds.hpp.
#pragma once

#include "rbdyn/expression/stream_kinds.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <numeric>
#include <unordered_map>
#include <utility>
#include <vector>

#include "rbdyn/expression/program.hpp"
#include "rbdyn/expression/schedule.hpp"
#include "rbdyn/expression/series_evaluator.hpp"
#include "rbdyn/expression/streamed_series.hpp"
#include "rbdyn/series/product_sums.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE void StreamKinds::give(std::size_t count, std::size_t size) {
    const std::size_t bytes = count * size;
    are_short_ = are_short_ && bytes <= std::numeric_limits<Index>::max();
    operands.push_back(static_cast<Index>(bytes));
}

RBDYN_INLINE StreamKinds::StreamKinds(const SeriesEvaluator& e) {
    struct Hash {
        std::size_t operator()(const std::vector<Index>& shape) const {
            std::uint64_t all = 0;
            for (const Index token : shape) {
                all = (all ^ token) * 0x9e3779b97f4a7c15U;
                all ^= all >> 29U;
            }
            return static_cast<std::size_t>(all);
        }
    };
    std::unordered_map<std::vector<Index>, Index, Hash> known;
    const StreamedSeries& s = *e.stream_;
    const std::size_t stages = s.stages_.size();
    kind_of_.reserve(stages);
    first_operand_.reserve(stages);
    places_.reserve(stages);
    operands.reserve(2 * s.series_.size() + s.combinations_.size() + s.terms_.size() + 2 * stages);
    Place at{};
    at.made = s.first_made_;
    std::size_t chunk = 0;
    const auto end_chunks = [&] {
        for (; chunk < s.ends_.size() && s.ends_[chunk] == at.stage; ++chunk) operands.push_back(entry(chunk_ends));
    };
    end_chunks();
    while (at.stage < stages) {
        places_.push_back(at);
        first_operand_.push_back(static_cast<Index>(operands.size()));
        operands.push_back(0);
        shape_.clear();
        add(e, s, at);
        // room for what tells where lists go on
        if (operands.size() == first_operand_.back() + 1) {
            operands.push_back(0);
            shape_.push_back(0);
        }
        const auto [found, is_new] = known.try_emplace(shape_, static_cast<Index>(kinds_.size()));
        if (is_new) kinds_.push_back({shape_, 0, false});
        ++kinds_[found->second].stages;
        kind_of_.push_back(found->second);
        ++at.stage;
        places_.back().next_operand = static_cast<Index>(operands.size());
        end_chunks();
    }
    give(operands.size(), sizeof(Index));
    operands.pop_back();
}

RBDYN_INLINE void StreamKinds::add(const SeriesEvaluator& e, const StreamedSeries& s, Place& at) {
    const StreamedSeries::Stage& stage = s.stages_[at.stage];
    shape_.insert(shape_.end(),
                  {stage.series, stage.spreads, stage.sums, stage.lanes, stage.combinations, stage.steps});
    for (Index i = 0; i < stage.series; ++i, ++at.series) {
        const auto& [from, weight] = s.series_[at.series];
        const auto is_one = [&](const Schedule::Weighted& w) {
            return w.scalar == Schedule::one || (w.scalar >= 0 && e.program_->constant(w.scalar) == 1.0);
        };
        const bool weighted = !std::ranges::all_of(s.weight_scalars_[weight], is_one), low = from[0] == from[1],
                   high = from[2] == from[3], halves = from[0] == from[2] && from[1] == from[3];
        shape_.push_back((weighted ? is_weighted : 0) | (low ? are_low_same : 0) | (high ? are_high_same : 0) |
                         (halves ? are_halves_same : 0));
        give(from[0], sizeof(double));
        if (!low) give(from[1], sizeof(double));
        if (!halves) give(from[2], sizeof(double));
        if (!halves && !high) give(from[3], sizeof(double));
        if (weighted) give(weight, sizeof(series::LaneValues));
    }
    for (Index i = 0; i < stage.spreads; ++i) give(s.spreads_[at.spread++], sizeof(double));
    add_sums(s, at);
    add_combinations(e, s, at);
    at.line += stage.series + stage.spreads;
    at.made += stage.lanes + stage.combinations;
    for (Index i = 0; i < stage.steps; ++i, ++at.step) {
        const auto [reads, writes] = s.operands_[at.step];
        const Code code = s.steps_[at.step]->code;
        shape_.push_back(static_cast<Index>(code));
        give(at.step, sizeof(SeriesEvaluator::Step));
        give(at.row, 1);
        for (Index read = 0; read < reads && has_own_code(code); ++read)
            give(s.step_rows_[at.row + read].place, sizeof(double));
        at.row += reads + writes;
        at.made += writes;
    }
}

RBDYN_INLINE void StreamKinds::add_sums(const StreamedSeries& s, Place& at) {
    const StreamedSeries::Stage& stage = s.stages_[at.stage];
    for (Index i = 0; i < stage.sums; ++i) {
        const Index size = s.sizes_[at.sum++];
        shape_.push_back(size);
        for (Index p = 0; p < size; ++p, ++at.product)
            for (const Index line : {s.products_[at.product].x, s.products_[at.product].y}) {
                const bool is_here = line >= at.line && line < at.line + stage.series + stage.spreads;
                shape_.push_back(is_here ? line - at.line : elsewhere);
                if (!is_here) give(line, sizeof(StreamedSeries::Line));
            }
    }
}

RBDYN_INLINE void StreamKinds::add_combinations(const SeriesEvaluator& e, const StreamedSeries& s, Place& at) {
    const StreamedSeries::Stage& stage = s.stages_[at.stage];
    for (Index i = 0; i < stage.lanes; ++i) shape_.push_back(s.lanes_[at.lane++]);
    for (Index i = 0; i < stage.combinations; ++i) {
        const StreamedSeries::Combination& c = s.combinations_[at.combination++];
        const bool has_constant = c.weight >= 0;
        shape_.insert(shape_.end(), {has_constant ? 1U : 0U, c.terms});
        if (has_constant) give(static_cast<std::size_t>(c.weight), sizeof(double));
        for (Index t = 0; t < c.terms; ++t) {
            const auto [place, weight] = s.terms_[at.term++];
            const double value = e.program_->constant(static_cast<int>(weight));
            shape_.push_back(value == 1.0 ? plus_one : value == -1.0 ? minus_one : any);
            give(place, sizeof(double));
            if (shape_.back() == any) give(weight, sizeof(double));
        }
        shape_.insert(shape_.end(), {c.lanes, c.lanes > 0 ? c.first_lane : 0});
    }
}

RBDYN_INLINE std::size_t StreamKinds::choose(std::size_t longest_together) {
    std::vector<std::size_t> order(kinds_.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::ranges::stable_sort(order,
                             [this](std::size_t a, std::size_t b) { return kinds_[a].stages > kinds_[b].stages; });
    std::size_t length = 0, with_code = 0;
    for (const std::size_t k : order) {
        Kind& kind = kinds_[k];
        length += kind.shape.size();
        if (length > longest_together) break;
        kind.has_code = true;
        with_code += kind.stages;
    }
    for (std::size_t i = 0; i < kind_of_.size(); ++i) {
        const Index kind = kind_of_[i], first = first_operand_[i];
        operands[first] = entry(kinds_[kind].has_code ? first_kind + kind : by_lists);
        if (kinds_[kind].has_code) continue;
        operands[first + 1] = static_cast<Index>(left.size());
        left.push_back(places_[i]);
    }
    return with_code;
}

}  // namespace rbdyn::inline RBDYN_FORM
