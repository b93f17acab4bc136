// Machine code made for one program's values: what Evaluator<double> reads from lists is written out as instructions.
//
// The same operations in the same order, without fused multiply-add: the same bits (docs/decisions/24). It is made
// where code for series is (machine_code.hpp); functions of the C library are called as from the lists.
#pragma once

#include <atomic>
#include <cstddef>
#include <memory>
#include <utility>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/expression/code_memory.hpp"

namespace rbdyn::inline RBDYN_FORM {

class Program;
struct Instruction;

class ValueCode {
public:
    /// After so many evaluations of a program code is made: about what making it costs in what it gains.
    static constexpr int evaluations = 256;
    /// Rates are written so many at a time.
    static constexpr std::size_t lanes = 4;
    static constexpr std::size_t padded(std::size_t count) { return (count + lanes - 1) / lanes * lanes; }

    /// None where there is none to be had, or it would not pay.
    static std::unique_ptr<const ValueCode> of(const Program& program);

    /// Computes all slots. `rates`: of a program with as many outputs as inputs, or more, these outputs; then zeros up
    /// to padded().
    void run(const Instruction* instructions, const double* scalars, double t, const double* x, double* slots,
             double* rates) const {
        function_(slots, x, scalars, instructions, rates, t);
    }
    std::size_t size() const { return memory_.size(); }

private:
    using Function = void(double* slots, const double* x, const double* scalars, const Instruction* instructions,
                          double* rates, double t);
    explicit ValueCode(CodeMemory memory)
        : memory_(std::move(memory)), function_(reinterpret_cast<Function*>(memory_.start())) {}

    CodeMemory memory_;
    Function* function_;
};

/// A program's, for any number of threads. A copy of the program has none yet.
class KeptValueCode {
public:
    KeptValueCode() = default;
    KeptValueCode(const KeptValueCode&) {}
    KeptValueCode& operator=(const KeptValueCode& other);
    ~KeptValueCode();

    /// If it was made.
    const ValueCode* get() const { return code_.load(std::memory_order_acquire); }
    /// After so many more evaluations.
    const ValueCode* after(const Program& program, int evaluations) const;

private:
    void clear();

    mutable std::atomic<const ValueCode*> code_ = nullptr;
    mutable std::atomic<int> evaluations_ = 0;
    mutable std::atomic<bool> is_refused_ = false;
};

}  // namespace rbdyn::inline RBDYN_FORM
