// Definitions of rbdyn/expression/repeated_code.hpp.
#pragma once

#include "rbdyn/expression/repeated_code.hpp"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <utility>

#include "rbdyn/expression/code_memory.hpp"
#include "rbdyn/expression/machine_code_writer.hpp"
#include "rbdyn/expression/repetition.hpp"
#include "rbdyn/expression/series_evaluator.hpp"

namespace rbdyn::inline RBDYN_FORM {

#ifdef RBDYN_WRITES_MACHINE_CODE

RBDYN_INLINE std::unique_ptr<RepeatedCode> RepeatedCode::of(const SeriesEvaluator& series) {
    Repetition repetition(series);
    if (repetition.count() < fewest_chunks / 2) return nullptr;
    MachineCodeWriter writer(series, &repetition);
    const std::span<const std::uint8_t> bytes = writer.write();
    if (bytes.size() > CodeMemory::most) return nullptr;
    std::optional<CodeMemory> memory = CodeMemory::of(bytes);
    if (!memory) return nullptr;
    std::unique_ptr<RepeatedCode> code(new RepeatedCode(std::move(repetition), std::move(*memory)));
    code->set_weights(series.scalars_);
    return code;
}

RBDYN_INLINE bool RepeatedCode::run(SeriesEvaluator& s, std::size_t chunk, int k) const {
    const Repetition::Chunk* const c = repetition_.chunk(chunk);
    if (c == nullptr) return false;
    // what a chunk's slots are in comes from memory once, in its first order, while those before it are computed
    constexpr std::size_t ahead = 2;
    if (k == 0 && s.is_large()) repetition_.fetch(chunk + ahead, s.storage_.data());
    const auto moved = []<class T>(T* p, std::ptrdiff_t bytes) {
        return reinterpret_cast<T*>(reinterpret_cast<char*>(p) + bytes);
    };
    // one by one: an aggregate is cleared first, which takes as long as an order
    MachineCode::Frame frame;
    frame.storage = moved(s.storage_.data(), c->slots[0]);
    frame.lanes = moved(s.lanes_.data(), c->lanes);
    frame.series = nullptr;
    frame.sums = s.lane_sums_.data() + c->sums;
    frame.scalars = table_.data() + c->weights;
    frame.self = &s;
    frame.middles = nullptr;
    frame.factors = nullptr;
    frame.unit = s.unit_;
    frame.minus_one = -1.0;
    frame.integrates = k < s.top_ ? 1 : 0;
    frame.k = k;
    frame.last = k + 1;
    frame.end = k + 2;
    frame.second = c->slots[1] - c->slots[0];
    frame.third = c->slots[2] - c->slots[0];
    frame.steps = s.steps_.data() + c->steps;
    frame.states = s.valuations_.data() + c->states;
    reinterpret_cast<void (*)(MachineCode::Frame*)>(memory_.start())(&frame);
    return true;
}

#else

RBDYN_INLINE std::unique_ptr<RepeatedCode> RepeatedCode::of(const SeriesEvaluator&) { return nullptr; }
RBDYN_INLINE bool RepeatedCode::run(SeriesEvaluator&, std::size_t, int) const { return false; }

#endif

}  // namespace rbdyn::inline RBDYN_FORM
