// Writes the machine code of a program's values (value_code.hpp): one instruction after the other, in their order.
//
// What was computed is stored in its slot, and stays in a register as long as there is none whose value is wanted
// sooner: an evaluation is a chain of sums, and reading what was just written takes as long as adding to it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/expression/assembler.hpp"
#include "rbdyn/expression/code_memory.hpp"
#include "rbdyn/expression/program.hpp"

#ifdef RBDYN_WRITES_MACHINE_CODE
namespace rbdyn::inline RBDYN_FORM {

class ValueCodeWriter {
public:
    explicit ValueCodeWriter(const Program& program);

    /// Whether code would be shorter than what a processor holds near, and all can be in it.
    static bool takes(const Program& program);
    std::span<const std::uint8_t> write();

private:
    using At = machine_code::At;
    using Register = machine_code::Register;
    using Vector = machine_code::Vector;

    // vectors 0 and 1 are for what is computed, those from `first_known` on hold slots
    static constexpr Vector first_known = 2, known_count = 13, zero = 15, none = 255;
    static constexpr int free = -1, taken = -2;

    static bool is_called(Code code);
    template <class F>
    void each_operand(const Instruction& i, const F& f) const;
    void take_inputs();
    void give_rates();
    void instruction(const Instruction& i);
    void combine(const Instruction& i);
    /// By a function of the library.
    void call(const Instruction& i);

    // where things are
    static std::size_t at(int slot) { return static_cast<std::size_t>(slot); }
    At place(int slot) const;
    At weight(int index) const { return {scalars_, 8 * static_cast<std::ptrdiff_t>(index)}; }
    void store(int slot, Vector from) { c_.store(At{slots_, 8 * static_cast<std::ptrdiff_t>(slot)}, from); }

    // slots that are in registers
    Vector known(int slot) const;
    /// The same, or loaded because it is wanted again; none: read where it is.
    Vector value(int slot);
    /// The same; loaded into the register offered.
    Vector value(int slot, Vector otherwise);
    /// When a slot is read next, from an instruction on; what never is, far away.
    int next_use(int slot, int from) const;
    std::size_t farthest() const;
    Vector room();
    void know(Vector at, int slot) { slot_of_[static_cast<std::size_t>(at - first_known)] = slot; }
    void forget() { slot_of_.fill(free); }
    /// One instruction with an operand that is in a register or read where it is.
    template <class Write>
    void with(int slot, const Write& write) {
        const Vector x = value(slot);
        x != none ? write(x) : write(place(slot));
    }
    /// to = a * b
    void product(Vector to, int a, int b);

    const Program& p_;
    machine_code::Assembler c_;
    bool calls_ = false;
    Register slots_ = Register::di, inputs_ = Register::si, scalars_ = Register::dx, instructions_ = Register::cx,
             rates_ = Register::r8;
    std::vector<std::vector<int>> uses_;  // by slot, ascending
    std::array<int, known_count> slot_of_{};
    int now_ = 0;
};

}  // namespace rbdyn::inline RBDYN_FORM
#endif
