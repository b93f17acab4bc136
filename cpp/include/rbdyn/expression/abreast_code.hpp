// Machine code made for what SeriesAbreast computes: its tape, written out as instructions of four or eight lanes.
//
// The same operations in the same order, without fused multiply-add: the same bits (docs/decisions/25). Where and when
// there is any: as machine_code.hpp.
#pragma once

#include <cstddef>
#include <memory>
#include <utility>
#include <vector>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/expression/abreast_tape.hpp"
#include "rbdyn/expression/code_memory.hpp"

namespace rbdyn::inline RBDYN_FORM::abreast {

class AbreastCodeWriter;  // abreast_code_writer.hpp

class AbreastCode {
public:
    /// After so many expansions of a tape code is made: by then it would have gained what making it costs, and more.
    static constexpr int expansions = 24;
    /// The orders before are left to the lists.
    static constexpr int first_order = 2;

    /// Of a tape for series of an order; none where there is none to be had, or it would not pay.
    static std::unique_ptr<const AbreastCode> of(const Tape& tape, int order);

    /// Orders first_order .. order - 1 with their integration; `whole`: order, too.
    void run(Tape& tape, int order, bool whole) const;
    std::size_t size() const { return memory_.size(); }

private:
    friend class AbreastCodeWriter;
    struct Frame;
    AbreastCode(CodeMemory memory, std::vector<Tape::Block> numbers)
        : memory_(std::move(memory)), numbers_(std::move(numbers)) {}

    CodeMemory memory_;
    std::vector<Tape::Block> numbers_;  // 0, 1, 2 ..., each in all lanes
};

}  // namespace rbdyn::inline RBDYN_FORM::abreast
