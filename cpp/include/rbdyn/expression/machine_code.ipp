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

RBDYN_INLINE std::unique_ptr<const MachineCode> MachineCode::of(const SeriesEvaluator& series) {
    if (!MachineCodeWriter::takes(series)) return nullptr;
    MachineCodeWriter writer(series);
    std::optional<CodeMemory> memory = CodeMemory::of(writer.write());
    return memory ? std::unique_ptr<const MachineCode>(new MachineCode(std::move(*memory))) : nullptr;
}

RBDYN_INLINE void MachineCode::run(SeriesEvaluator& s, int first, int last, bool integrates) const {
    Frame frame{s.storage_.data(),
                s.lanes_.data(),
                s.lane_series_.data(),
                s.lane_sums_.data(),
                s.scalars_.data(),
                &s,
                s.unit_,
                -1.0,
                integrates ? 1 : 0,
                first,
                last};
    reinterpret_cast<void (*)(Frame*)>(memory_.start())(&frame);
}

#else

RBDYN_INLINE std::unique_ptr<const MachineCode> MachineCode::of(const SeriesEvaluator&) { return nullptr; }
RBDYN_INLINE void MachineCode::run(SeriesEvaluator&, int, int, bool) const {}

#endif

}  // namespace rbdyn::inline RBDYN_FORM
