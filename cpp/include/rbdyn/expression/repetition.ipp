// Definitions of rbdyn/expression/repetition.hpp.
#pragma once

#include "rbdyn/expression/repetition.hpp"

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "rbdyn/expression/program.hpp"
#include "rbdyn/expression/schedule.hpp"
#include "rbdyn/expression/series_evaluator.hpp"
#include "rbdyn/expression/wavefront.hpp"
#include "rbdyn/series/coefficients.hpp"
#include "rbdyn/series/product_sums.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE void Repetition::Shape::clear() {
    tokens.clear();
    slots.clear();
    lanes.clear();
    states.clear();
    weights.clear();
    sums = steps = -1;
}

RBDYN_INLINE Repetition::Repetition(const SeriesEvaluator& e)
    : model_(e.wavefront_->chunks.size() / 2), is_like_(e.wavefront_->chunks.size(), 0), chunks_(is_like_.size()) {
    // where places begin again, neighbours lie elsewhere
    if (const SlotRing* const ring = e.ring_.get())
        model_ = model_ / ring->period() * ring->period() + ring->period() / 2;
    if (model_ + 1 >= is_like_.size()) return;
    Shape model, other;
    write(e, model_, model);
    write(e, model_ + 1, other);
    if (!tell_kinds(model, other)) return;
    constexpr auto size = static_cast<std::ptrdiff_t>(sizeof(double));
    tell_lines(size * (e.top_ + 1), size * (e.ring_ != nullptr ? e.ring_->begin() : e.place(e.program_->slots())));
    // a weight that all have, and that is 1 or -1, needs no place in the table
    std::vector<char> is_known;
    for (const Weight& w : model.weights) {
        const double value = w.scalar == Schedule::one ? 1.0 : w.scalar >= 0 ? e.program_->constant(w.scalar) : 0.0;
        is_known.push_back(value == 1.0 ? w.unless != Unless::never
                                        : value == -1.0 && w.unless == Unless::one_or_minus);
    }
    std::vector<int> scalars;
    bool are_same = true;
    for (std::size_t c = 0; c < is_like_.size(); ++c) {
        other.clear();
        write(e, c, other);
        const std::optional<Chunk> found = like(model, other);
        if (!found) continue;
        chunks_[c] = *found;
        is_like_[c] = 1;
        ++count_;
        for (std::size_t w = 0; w < is_known.size(); ++w) {
            scalars.push_back(other.weights[w].scalar);
            if (scalars.back() == model.weights[w].scalar) continue;
            is_known[w] = 0;
            are_same = false;
        }
    }
    // those of one holder are side by side
    for (std::size_t w = 0; w < is_known.size(); ++w)
        if (is_known[w] == 0) weight_of_[model.weights[w].holder] = -1;
    std::vector<std::size_t> looked_up;
    for (std::size_t w = 0; w < is_known.size(); ++w) {
        const auto found = weight_of_.find(model.weights[w].holder);
        if (found == weight_of_.end()) continue;
        if (found->second < 0) found->second = static_cast<std::ptrdiff_t>(looked_up.size());
        looked_up.push_back(w);
    }
    std::size_t row = 0;
    for (std::size_t c = 0; c < is_like_.size() && (row == 0 || !are_same); ++c) {
        if (is_like_[c] == 0) continue;
        chunks_[c].weights = static_cast<std::ptrdiff_t>(table_.size());
        for (const std::size_t w : looked_up) table_.push_back(scalars[row * is_known.size() + w]);
        ++row;
    }
}

RBDYN_INLINE void Repetition::write(const SeriesEvaluator& e, std::size_t chunk, Shape& to) const {
    using Kind = SeriesEvaluator::Kind;
    const auto in_bytes = [](const auto* p, const auto* from) {
        return static_cast<std::ptrdiff_t>(sizeof *p) * (p - from);
    };
    const auto token = [&to](auto number) { to.tokens.push_back(static_cast<std::int64_t>(number)); };
    const auto row = [&](const double* p) { to.slots.push_back(in_bytes(p, e.storage_.data())); };
    const auto view = [&](const series::View& v) {
        token(v.forward == nullptr ? -1 : v.last - v.forward);
        if (v.forward != nullptr) row(v.forward);
    };
    const auto lane = [&](const series::LaneValues* p) { to.lanes.push_back(in_bytes(p, e.lanes_.data())); };
    const auto terms = [&](const SeriesEvaluator::ResolvedTerm* first, const SeriesEvaluator::ResolvedTerm* last) {
        token(last - first);
        for (; first != last; ++first) {
            row(first->series);
            to.weights.push_back({static_cast<int>(first->weight), first, Unless::one_or_minus});
        }
    };
    // of the first sum
    const double* lanes = nullptr;
    const auto mixed = [&](const SeriesEvaluator::Mixed* first, const SeriesEvaluator::Mixed* last) {
        token(last - first);
        for (; first != last; ++first) {
            row(first->out);
            token(first->weight < 0 ? 0 : 1);
            if (first->weight >= 0) to.weights.push_back({first->weight, first, Unless::never});
            terms(first->first, first->last);
            token(first->lane == nullptr ? 0 : first->lane - lanes);
            token(first->lane_end - first->lane);
        }
    };
    const Wavefront::Chunk& c = e.wavefront_->chunks[chunk];
    for (std::size_t b = e.first_block_[c.stages.first]; b < e.first_block_[c.stages.last]; ++b) {
        const SeriesEvaluator::Block& block = e.blocks_[b];
        token(block.kind);
        const auto each = [&block]<class T>(const T*, const auto& write_one) {
            for (const T* one = static_cast<const T*>(block.first); one != block.last; ++one) write_one(*one);
        };
        switch (block.kind) {
            case Kind::copies: each(e.copies_.data(), view); break;
            case Kind::sums: {
                const auto& s = *static_cast<const SeriesEvaluator::Sums*>(block.first);
                if (to.sums < 0) {
                    to.sums = s.sum - e.lane_sums_.data();
                    lanes = reinterpret_cast<const double*>(&s.sum->sum);
                }
                token(s.series_end - s.series);
                for (const auto* x = s.series; x != s.series_end; ++x) {
                    for (const double* from : x->from) row(from);
                    lane(x->to);
                    const auto at = static_cast<std::size_t>(x - e.lane_series_.data());
                    for (const Schedule::Weighted& w : e.lane_weights_[at])
                        to.weights.push_back({w.scalar, x, Unless::one});
                }
                token(s.spread_end - s.spread);
                for (const auto* x = s.spread; x != s.spread_end; ++x) {
                    row(x->from);
                    lane(x->to);
                }
                token(s.sum_end - s.sum);
                for (const auto* sum = s.sum; sum != s.sum_end; ++sum) {
                    token(sum->last - sum->first);
                    for (const auto* p = sum->first; p != sum->last; ++p) {
                        lane(p->x);
                        lane(p->y);
                    }
                }
                token(s.lane_end - s.lane);
                for (const auto* l = s.lane; l != s.lane_end; ++l) {
                    row(l->out);
                    token(l->sum - lanes);
                }
                mixed(s.mixed, s.mixed_end);
                break;
            }
            case Kind::linear:
                each(e.linear_.data(), [&](const SeriesEvaluator::Linear& l) {
                    row(l.out);
                    terms(l.first, l.last);
                });
                break;
            case Kind::mixed:
                mixed(static_cast<const SeriesEvaluator::Mixed*>(block.first),
                      static_cast<const SeriesEvaluator::Mixed*>(block.last));
                break;
            case Kind::steps:
                each(e.steps_.data(), [&](const SeriesEvaluator::Step& s) {
                    if (to.steps < 0) to.steps = &s - e.steps_.data();
                    token(s.code);
                    for (const series::View* v : {&s.out, &s.out2, &s.a, &s.b, &s.c}) view(*v);
                    token(s.slope == nullptr ? 0 : 1);
                    if (s.slope != nullptr) row(s.slope);
                    token(s.valuation == nullptr ? 0 : 1);
                    if (s.valuation != nullptr) to.states.push_back(s.valuation - e.valuations_.data());
                    token(std::bit_cast<std::int64_t>(s.value));
                });
                break;
        }
    }
    for (std::size_t i = c.inputs.first; i < c.inputs.last; ++i) {
        const SeriesEvaluator::Motion& m = e.motion_[i];
        row(m.input);
        row(m.rate);
        token(m.last == nullptr ? 0 : m.last - m.input);
    }
}

RBDYN_INLINE bool Repetition::tell_kinds(const Shape& model, const Shape& next) {
    if (model.tokens != next.tokens || model.slots.size() != next.slots.size()) return false;
    std::vector<std::pair<std::ptrdiff_t, std::ptrdiff_t>> moves;  // how far, and how many times less
    for (std::size_t i = 0; i < model.slots.size(); ++i) {
        const std::ptrdiff_t by = next.slots[i] - model.slots[i];
        const auto found = std::ranges::find(moves, by, &std::pair<std::ptrdiff_t, std::ptrdiff_t>::second);
        found == moves.end() ? moves.emplace_back(-1, by) : * found = {found->first - 1, by};
    }
    if (moves.empty() || moves.size() > kinds) return false;
    // of the first one addresses are shortest
    std::ranges::sort(moves);
    for (std::size_t i = 0; i < model.slots.size(); ++i) {
        const std::ptrdiff_t by = next.slots[i] - model.slots[i];
        const auto kind = static_cast<std::size_t>(
            std::ranges::find(moves, by, &std::pair<std::ptrdiff_t, std::ptrdiff_t>::second) - moves.begin());
        const auto [known, is_new] = kind_of_.try_emplace(model.slots[i], kind);
        if (known->second != kind) return false;
        kind_at_.push_back(kind);
    }
    for (auto slot = kind_of_.rbegin(); slot != kind_of_.rend(); ++slot) begin_[slot->second] = slot->first;
    for (const auto& [place, kind] : kind_of_) of_kind_[kind].push_back(place);
    return true;
}

RBDYN_INLINE void Repetition::tell_lines(std::ptrdiff_t row, std::ptrdiff_t end) {
    // backward copies are between slots that are neighbours
    constexpr std::ptrdiff_t line = 64, between = 1024;
    for (std::size_t kind = 0; kind < kinds; ++kind) {
        std::ptrdiff_t next = 0;
        for (const std::ptrdiff_t slot : of_kind_[kind]) {
            // what chunks share is at hand
            if (slot >= end) continue;
            const std::ptrdiff_t from = slot - begin_[kind];
            if (from - next > between) next = from;
            for (; next < from + row; next += line) lines_[kind].push_back(next);
        }
    }
}

RBDYN_INLINE void Repetition::fetch(std::size_t c, const double* storage) const {
#if defined(__GNUC__) || defined(__clang__)
    if (c >= is_like_.size() || is_like_[c] == 0) return;
    for (std::size_t kind = 0; kind < kinds; ++kind) {
        const char* const begin = reinterpret_cast<const char*>(storage) + chunks_[c].slots[kind];
        for (const std::ptrdiff_t line : lines_[kind]) __builtin_prefetch(begin + line, 1);
    }
#else
    static_cast<void>(c);
    static_cast<void>(storage);
#endif
}

RBDYN_INLINE bool Repetition::meet(std::size_t a, std::size_t b, std::ptrdiff_t by) const {
    const std::vector<std::ptrdiff_t>&left = of_kind_[a], &right = of_kind_[b];
    if (left.empty() || right.empty() || right.back() + by < left.front() || left.back() < right.front() + by)
        return false;
    return std::ranges::any_of(right,
                               [&](std::ptrdiff_t place) { return std::ranges::binary_search(left, place + by); });
}

RBDYN_INLINE std::optional<Repetition::Chunk> Repetition::like(const Shape& model, const Shape& other) const {
    if (other.tokens != model.tokens || other.slots.size() != model.slots.size() ||
        other.lanes.size() != model.lanes.size() || other.states.size() != model.states.size() ||
        other.weights.size() != model.weights.size())
        return std::nullopt;
    std::array<std::optional<std::ptrdiff_t>, kinds> moved;
    for (std::size_t i = 0; i < model.slots.size(); ++i) {
        const std::ptrdiff_t by = other.slots[i] - model.slots[i];
        std::optional<std::ptrdiff_t>& known = moved[kind_at_[i]];
        if (known.value_or(by) != by) return std::nullopt;
        known = by;
    }
    // slots that are two in the model are not to be one
    for (std::size_t a = 0; a < kinds; ++a)
        for (std::size_t b = a + 1; b < kinds; ++b)
            if (moved[a] && moved[b] && meet(a, b, *moved[b] - *moved[a])) return std::nullopt;
    const auto moves_as_one = [](const std::vector<std::ptrdiff_t>& from, const std::vector<std::ptrdiff_t>& to) {
        for (std::size_t i = 1; i < from.size(); ++i)
            if (to[i] - from[i] != to[0] - from[0]) return false;
        return true;
    };
    if (!moves_as_one(model.lanes, other.lanes) || !moves_as_one(model.states, other.states)) return std::nullopt;
    Chunk chunk{};
    for (std::size_t kind = 0; kind < kinds; ++kind) chunk.slots[kind] = begin_[kind] + moved[kind].value_or(0);
    chunk.lanes = other.lanes.empty() ? 0 : other.lanes[0] - model.lanes[0];
    chunk.sums = std::max<std::ptrdiff_t>(other.sums, 0);
    chunk.steps = std::max<std::ptrdiff_t>(other.steps, 0);
    chunk.states = other.states.empty() ? 0 : other.states[0] - model.states[0];
    return chunk;
}

RBDYN_INLINE std::pair<std::size_t, std::ptrdiff_t> Repetition::slot(std::ptrdiff_t place) const {
    const auto [begin, kind] = *std::prev(kind_of_.upper_bound(place));
    return {kind, place - begin_[kind]};
}

RBDYN_INLINE std::optional<std::ptrdiff_t> Repetition::weight(const void* holder) const {
    const auto found = weight_of_.find(holder);
    return found == weight_of_.end() ? std::nullopt : std::optional(found->second);
}

RBDYN_INLINE void Repetition::write_table(std::span<const double> scalars, std::vector<double>& table) const {
    table.clear();
    for (const int scalar : table_)
        table.push_back(scalar >= 0 ? scalars[static_cast<std::size_t>(scalar)] : scalar == Schedule::one ? 1.0 : 0.0);
}

}  // namespace rbdyn::inline RBDYN_FORM
