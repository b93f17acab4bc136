// Machine code of one chunk of a program that repeats itself, run for each that is like it (docs/decisions/28).
//
// What a chain of any length computes is then code of a few bodies, which stays in a processor's first cache, and at
// hand as decoded instructions. Chunks that are unlike, where the chain begins and ends, are left to the lists. The
// same operations in the same order: the same bits.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/expression/code_memory.hpp"
#include "rbdyn/expression/repetition.hpp"

namespace rbdyn::inline RBDYN_FORM {

class RepeatedCode {
public:
    /// Chunks are cut for it where there are so many, of programs with so many instructions.
    static constexpr std::size_t fewest_chunks = 6, fewest_instructions = 200;
    /// Whether this library can make any, and this processor can run it.
    static bool is_usable() { return CodeMemory::is_built() && CodeMemory::is_usable(); }
    /// Of an evaluator's chunks; none where they do not repeat themselves, or there is none to be had.
    static std::unique_ptr<RepeatedCode> of(const SeriesEvaluator& series);

    void set_weights(std::span<const double> scalars) { repetition_.write_table(scalars, table_); }
    /// Order k of a chunk, and the next one of its inputs unless k is the last; false: it is for the lists.
    bool run(SeriesEvaluator& series, std::size_t chunk, int k) const;

private:
    RepeatedCode(Repetition repetition, CodeMemory memory)
        : repetition_(std::move(repetition)), memory_(std::move(memory)) {}

    Repetition repetition_;
    CodeMemory memory_;
    std::vector<double> table_;
};

}  // namespace rbdyn::inline RBDYN_FORM
