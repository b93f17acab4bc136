// Machine code made for one program's series: what SeriesEvaluator reads from lists is written out as instructions.
//
// The same operations in the same order, without fused multiply-add: the same bits (docs/decisions/23). For processors
// with AVX2 under Linux; all others go on with the lists, as do programs larger than pays. The memory is never to be
// written and run at a time; where a system forbids it altogether, there is no code.
#pragma once

#include <cstddef>
#include <memory>
#include <utility>
#include <vector>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/large_memory.hpp"
#include "rbdyn/expression/code_memory.hpp"
#include "rbdyn/series/product_sums.hpp"

namespace rbdyn::inline RBDYN_FORM {

class SeriesEvaluator;
class MachineCodeWriter;  // machine_code_writer.hpp

class MachineCode {
public:
    /// After so many expansions of an evaluator code is made: about twice what making it costs in what it gains.
    static constexpr int expansions = 64;
    /// Whether this library can make any (its CMake option RBDYN_MACHINE_CODE).
    static bool is_built() { return CodeMemory::is_built(); }
    /// Of an evaluator's lists; none where there is none to be had, or it would not pay.
    static std::unique_ptr<MachineCode> of(const SeriesEvaluator& series);

    /// Orders first .. last - 1 of the evaluator.
    void run(SeriesEvaluator& series, int first, int last, bool integrates);
    /// Whether it can do an order by itself: an even one needs what the code computed at the one before it.
    bool can_begin(int order) const { return order == 0 || order % 2 != 0 || order == known_middles_; }
    /// The lists have computed an order.
    void pass() { known_middles_ = -1; }
    std::size_t size() const { return memory_.size(); }

private:
    friend class MachineCodeWriter;
    friend class RepeatedCode;
    struct Frame;
    MachineCode(CodeMemory memory, std::size_t middles, int top)
        : memory_(std::move(memory)), middles_(middles), factors_(static_cast<std::size_t>(top) + 1) {}

    CodeMemory memory_;
    LargeVector<series::LaneValues> middles_;  // machine_code_middle.ipp
    int known_middles_ = -1;                   // of that order
    double unit_ = 0.0;
    std::vector<double> factors_;  // by which a rate's coefficient k is its variable's k + 1, in that unit
};

}  // namespace rbdyn::inline RBDYN_FORM
