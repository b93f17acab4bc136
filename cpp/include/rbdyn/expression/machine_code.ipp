// Definitions of rbdyn/expression/machine_code.hpp.
#pragma once

#include "rbdyn/expression/machine_code.hpp"

#include <memory>
#include <optional>
#include <utility>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/expression/code_memory.hpp"
#include "rbdyn/expression/machine_code_writer.hpp"
#include "rbdyn/expression/series_evaluator.hpp"

namespace rbdyn::inline RBDYN_FORM {

#ifdef RBDYN_WRITES_MACHINE_CODE

RBDYN_INLINE std::unique_ptr<MachineCode> MachineCode::of(const SeriesEvaluator& series) {
    if (!MachineCodeWriter::takes(series)) return nullptr;
    MachineCodeWriter writer(series);
    std::optional<CodeMemory> memory = CodeMemory::of(writer.write());
    if (!memory) return nullptr;
    return std::unique_ptr<MachineCode>(new MachineCode(std::move(*memory), writer.room_for_middles(), series.top_));
}

RBDYN_INLINE void MachineCode::run(SeriesEvaluator& s, int first, int last, bool integrates) {
    if (s.unit_ != unit_) {
        unit_ = s.unit_;
        for (std::size_t k = 0; k < factors_.size(); ++k) factors_[k] = unit_ / static_cast<double>(k + 1);
    }
    Frame frame{s.storage_.data(),
                s.lanes_.data(),
                s.lane_series_.data(),
                s.lane_sums_.data(),
                s.scalars_.data(),
                &s,
                middles_.data(),
                factors_.data(),
                -1.0,
                integrates ? 1 : 0,
                first,
                last,
                integrates ? last + (s.is_whole_ ? 1 : 0) : s.top_ + 1};
    const auto end = static_cast<int>(frame.end);
    reinterpret_cast<void (*)(Frame*)>(memory_.start())(&frame);
    known_middles_ = last % 2 != 0 ? last - 1 : last < end ? last : -1;
}

#else

RBDYN_INLINE std::unique_ptr<MachineCode> MachineCode::of(const SeriesEvaluator&) { return nullptr; }
RBDYN_INLINE void MachineCode::run(SeriesEvaluator&, int, int, bool) {}

#endif

}  // namespace rbdyn::inline RBDYN_FORM
