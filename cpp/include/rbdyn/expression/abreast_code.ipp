// Definitions of rbdyn/expression/abreast_code.hpp.
#pragma once

#include "rbdyn/expression/abreast_code.hpp"

#include <cstddef>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "rbdyn/expression/abreast_code_writer.hpp"
#include "rbdyn/expression/abreast_tape.hpp"
#include "rbdyn/expression/code_memory.hpp"

namespace rbdyn::inline RBDYN_FORM::abreast {

#ifdef RBDYN_WRITES_MACHINE_CODE

RBDYN_INLINE std::unique_ptr<const AbreastCode> AbreastCode::of(const Tape& tape, int order) {
    if (!AbreastCodeWriter::takes(tape)) return nullptr;
    AbreastCodeWriter writer(tape);
    std::optional<CodeMemory> memory = CodeMemory::of(writer.write());
    if (!memory) return nullptr;
    const std::size_t lanes = static_cast<std::size_t>(tape.vector) / sizeof(double),
                      count = (static_cast<std::size_t>(order) + 2) * lanes;
    std::vector<Tape::Block> numbers((count + Tape::most - 1) / Tape::most);
    for (std::size_t i = 0; i < count; ++i)
        numbers[i / Tape::most].lanes[i % Tape::most] = static_cast<double>(i / lanes);
    return std::unique_ptr<const AbreastCode>(new AbreastCode(std::move(*memory), std::move(numbers)));
}

RBDYN_INLINE void AbreastCode::run(Tape& tape, int order, bool whole) const {
    const auto run = [&](int first, int last, bool integrates) {
        Frame frame{tape.cells.data(), tape.weights.data(),   tape.sum.data(), tape.next.data(),
                    tape.part.data(),  tape.next_part.data(), numbers_.data(), &tape,
                    tape.unit.lanes,   integrates ? 1 : 0,    first,           last};
        reinterpret_cast<void (*)(Frame*)>(memory_.start())(&frame);
    };
    if (first_order < order) run(first_order, order, true);
    if (whole) run(order, order + 1, false);
}

#else

RBDYN_INLINE std::unique_ptr<const AbreastCode> AbreastCode::of(const Tape&, int) { return nullptr; }
RBDYN_INLINE void AbreastCode::run(Tape&, int, bool) const {}

#endif

}  // namespace rbdyn::inline RBDYN_FORM::abreast
