// Definitions of rbdyn/expression/machine_code.hpp.
#pragma once

#include "rbdyn/expression/machine_code.hpp"

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <memory>
#include <span>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/expression/machine_code_writer.hpp"
#include "rbdyn/expression/series_evaluator.hpp"

#ifdef RBDYN_WRITES_MACHINE_CODE
#include <sys/mman.h>
#endif

namespace rbdyn::inline RBDYN_FORM {

#ifdef RBDYN_WRITES_MACHINE_CODE

RBDYN_INLINE bool MachineCode::is_built() { return true; }

RBDYN_INLINE std::unique_ptr<const MachineCode> MachineCode::of(const SeriesEvaluator& series) {
    if (!MachineCodeWriter::takes(series)) return nullptr;
    MachineCodeWriter writer(series);
    const std::span<const std::uint8_t> bytes = writer.write();
    void* memory = mmap(nullptr, bytes.size(), PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    if (memory == MAP_FAILED) return nullptr;
    std::unique_ptr<const MachineCode> code(new MachineCode(memory, bytes.size()));
    std::memcpy(memory, bytes.data(), bytes.size());
    if (mprotect(memory, bytes.size(), PROT_READ | PROT_EXEC) != 0) return nullptr;
    return code;
}

RBDYN_INLINE MachineCode::~MachineCode() { munmap(memory_, size_); }

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
    reinterpret_cast<void (*)(Frame*)>(memory_)(&frame);
}

#else

RBDYN_INLINE bool MachineCode::is_built() { return false; }
RBDYN_INLINE std::unique_ptr<const MachineCode> MachineCode::of(const SeriesEvaluator&) { return nullptr; }
RBDYN_INLINE MachineCode::~MachineCode() = default;
RBDYN_INLINE void MachineCode::run(SeriesEvaluator&, int, int, bool) const {}

#endif

}  // namespace rbdyn::inline RBDYN_FORM
