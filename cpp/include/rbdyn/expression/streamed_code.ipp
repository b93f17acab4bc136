// Definitions of rbdyn/expression/streamed_code.hpp.
#pragma once

#include "rbdyn/expression/streamed_code.hpp"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "rbdyn/expression/code_memory.hpp"
#include "rbdyn/expression/series_evaluator.hpp"
#include "rbdyn/expression/stream_kinds.hpp"
#include "rbdyn/expression/streamed_code_writer.hpp"
#include "rbdyn/expression/streamed_series.hpp"

namespace rbdyn::inline RBDYN_FORM {

#ifdef RBDYN_WRITES_MACHINE_CODE

RBDYN_INLINE std::unique_ptr<StreamedCode> StreamedCode::of(SeriesEvaluator& series) {
    StreamKinds kinds(series);
    const std::size_t stages = series.stream_->stages_.size();
    if (!kinds.are_short() || !StreamedCodeWriter::takes(series) || 2 * kinds.choose(StreamKinds::longest) < stages)
        return nullptr;
    StreamedCodeWriter writer(series, kinds);
    const std::span<const std::uint8_t> bytes = writer.write();
    if (bytes.size() > CodeMemory::most) return nullptr;
    std::optional<CodeMemory> memory = CodeMemory::of(bytes);
    if (!memory) return nullptr;
    std::unique_ptr<StreamedCode> code(new StreamedCode(series, std::move(kinds), std::move(*memory)));
    code->start_ = reinterpret_cast<void (*)(Frame*)>(code->memory_.start());
    const auto start = reinterpret_cast<std::uint64_t>(code->memory_.start());
    const auto addresses = [start](const std::vector<std::size_t>& places) {
        std::vector<std::uint64_t> all;
        for (const std::size_t place : places) all.push_back(start + place);
        return all;
    };
    for (std::size_t order = 0; order < orders; ++order) code->pieces_[order] = addresses(writer.pieces(order));
    code->products_ = addresses(writer.products());
    code->quotients_ = addresses(writer.quotients());
    code->sines_ = addresses(writer.sines());
    return code;
}

RBDYN_INLINE void StreamedCode::begin(int k) {
    StreamedSeries& s = *series_.stream_;
    const Order order = k == 0 ? Order::first : k % 2 != 0 ? Order::odd : Order::even;
    frame_.now = s.values(k);
    frame_.made = frame_.now + s.first_made_;
    frame_.lines = frame_.line = s.lines_.data();
    frame_.newest =
        static_cast<std::ptrdiff_t>(static_cast<std::size_t>(k / 2) * s.row_ * sizeof(StreamedSeries::Line));
    frame_.operand = kinds_.operands.data();
    frame_.next = s.next_.data();
    frame_.scalars = series_.scalars_.data();
    frame_.weights = s.weights_.data();
    frame_.pieces = pieces_[static_cast<std::size_t>(order)].data();
    const auto at = static_cast<std::size_t>(k);
    frame_.product = products_[at];
    frame_.quotient = quotients_[at];
    frame_.sine = sines_[at];
    frame_.steps = series_.steps_.data();
    frame_.self = this;
    frame_.k = k;
    frame_.order = k;
    frame_.minus_one = -1.0;
}

#else

RBDYN_INLINE std::unique_ptr<StreamedCode> StreamedCode::of(SeriesEvaluator&) { return nullptr; }
RBDYN_INLINE void StreamedCode::begin(int) {}

#endif

RBDYN_INLINE std::size_t StreamedCode::bytes() const {
    return kinds_.operands.size() * sizeof(Index) + kinds_.left.size() * sizeof(StreamKinds::Place);
}

}  // namespace rbdyn::inline RBDYN_FORM
