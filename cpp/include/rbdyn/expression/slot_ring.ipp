// Definitions of rbdyn/expression/slot_ring.hpp.
#pragma once

#include "rbdyn/expression/slot_ring.hpp"

#include <algorithm>
#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "rbdyn/expression/operands.hpp"
#include "rbdyn/expression/program.hpp"
#include "rbdyn/expression/schedule.hpp"
#include "rbdyn/expression/wavefront.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE std::unique_ptr<const SlotRing> SlotRing::of(const Program& program, const Schedule& schedule,
                                                          const Wavefront& wavefront, int top, std::size_t behind,
                                                          std::span<const int> rows) {
    const auto at = [](int i) { return static_cast<std::size_t>(i); };
    constexpr std::size_t none = static_cast<std::size_t>(-1), most_apart = 4, fewest_periods = 3;
    const std::size_t slots = at(program.slots()), count = wavefront.chunks.size();
    const auto is_made = [](const Instruction& i) {
        // what has no terms is written once, or never
        return i.code != Code::combine || i.terms > 0 || i.products > 0;
    };
    // of each slot the chunk that makes it, and the last one that reads it
    std::vector<std::size_t> maker(slots, none), last_reader(slots, 0);
    std::vector<std::vector<int>> made(count);
    for (std::size_t c = 0; c < count; ++c) {
        const auto take = [&](const Instruction& i) {
            operands::reads(program, i, [&](int slot) { last_reader[at(slot)] = c; });
            if (!is_made(i)) return;
            const auto make = [&](int slot) {
                maker[at(slot)] = c;
                made[c].push_back(slot);
            };
            operands::writes(program, i, make);
        };
        const Wavefront::Chunk& chunk = wavefront.chunks[c];
        for (std::size_t s = chunk.stages.first; s < chunk.stages.last; ++s) {
            const Schedule::Stage& stage = schedule.stages[s];
            for (std::size_t i = stage.combinations.first; i < stage.combinations.last; ++i)
                take(*schedule.combinations[i].instruction);
            for (std::size_t i = stage.others.first; i < stage.others.last; ++i) take(*schedule.others[i]);
        }
        for (std::size_t i = chunk.inputs.first; i < chunk.inputs.last; ++i)
            last_reader[at(program.output(wavefront.inputs[i]))] = c;
    }
    std::unique_ptr<SlotRing> ring(new SlotRing);
    std::size_t apart = 0, area = 0, far = 0;
    std::ptrdiff_t all = 0;
    for (std::size_t c = 0; c < count; ++c) {
        std::erase_if(made[c], [&](int slot) {
            // what is for all, say
            const bool stays = last_reader[at(slot)] > c + most_apart;
            if (stays) maker[at(slot)] = none;
            far += stays ? 1 : 0;
            return stays;
        });
        std::ranges::sort(made[c]);
        std::size_t own = 0;
        for (const int slot : made[c]) {
            own += at(rows[at(slot)]);
            apart = std::max(apart, std::max(last_reader[at(slot)], c) - c);
        }
        area = std::max(area, own);
        all += static_cast<std::ptrdiff_t>(own);
    }
    // where each chunk has such a one its slots are of two kinds, and code of what repeats itself has registers for few
    if (2 * far > count) return nullptr;
    ring->period_ = apart + behind;
    if (count < fewest_periods * ring->period_ || 2 * static_cast<std::ptrdiff_t>(ring->period_ * area) > all)
        return nullptr;
    ring->places_.resize(slots);
    ring->kept_.assign(slots, -1);
    for (std::size_t slot = 0; slot < slots; ++slot) {
        if (maker[slot] != none) continue;
        ring->places_[slot] = ring->kept_[slot] = ring->size_;
        ring->size_ += rows[slot];
    }
    // of outputs that are no rates
    const int outputs = program.outputs() + static_cast<int>(program.switches().size());
    for (int i = operands::moving(program); i < outputs; ++i) {
        std::ptrdiff_t& kept = ring->kept_[at(program.output(i))];
        if (kept >= 0) continue;
        kept = ring->size_;
        ring->size_ += top + 1;
    }
    constexpr std::ptrdiff_t line = 8;
    ring->begin_ = ring->size_ = (ring->size_ + line - 1) / line * line;
    for (std::size_t c = 0; c < count; ++c) {
        std::ptrdiff_t next = ring->begin_ + static_cast<std::ptrdiff_t>(c % ring->period_ * area);
        for (const int slot : made[c]) {
            ring->places_[at(slot)] = next;
            next += rows[at(slot)];
            if (ring->kept_[at(slot)] >= 0) ring->copies_.push_back({ring->places_[at(slot)], ring->kept_[at(slot)]});
        }
        ring->copies_before_.push_back(ring->copies_.size());
    }
    ring->size_ += static_cast<std::ptrdiff_t>(ring->period_ * area);
    return ring;
}

}  // namespace rbdyn::inline RBDYN_FORM
