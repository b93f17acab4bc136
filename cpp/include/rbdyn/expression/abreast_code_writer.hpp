// Writes the machine code of a tape (abreast_code.hpp), one order of odd k and one of even k.
//
// Registers: bx: coefficient k of the first row; r13: its coefficient 0; r12: weights; r14, r15: sums, and what is
// known of the next ones; r8, r9: their parts; bp: k in all lanes, k + 1 behind it; r10: k.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/expression/abreast_code.hpp"
#include "rbdyn/expression/abreast_tape.hpp"
#include "rbdyn/expression/assembler.hpp"
#include "rbdyn/expression/code_memory.hpp"
#include "rbdyn/expression/known_registers.hpp"

#ifdef RBDYN_WRITES_MACHINE_CODE
namespace rbdyn::inline RBDYN_FORM::abreast {

/// What the code is given.
struct AbreastCode::Frame {
    Tape::Block *cells, *weights, *sums, *nexts, *parts, *next_parts;
    const Tape::Block* numbers;
    Tape* tape;
    const double* unit;
    std::int64_t integrates, k, last;
};

class AbreastCodeWriter {
public:
    explicit AbreastCodeWriter(const Tape& tape)
        : t_(tape),
          v_(tape.vector),
          is_wide_(tape.vector == 64),
          c_(is_wide_ ? 8 : 4),
          registers_(is_wide_ ? 16 : 13, is_wide_ ? 16 : 3) {}

    /// Whether all is in it, and it is no longer than what a processor holds near.
    static bool takes(const Tape& tape);
    std::span<const std::uint8_t> write();

private:
    using At = machine_code::At;
    using Register = machine_code::Register;
    using Vector = machine_code::Vector;
    using Assembler = machine_code::Assembler;
    using Frame = AbreastCode::Frame;
    using Place = Tape::Place;

    // vectors 0 to 11 are for what is computed; those from 13 on, or from 16, hold newest coefficients and sums
    static constexpr Vector zero = 12, none = machine_code::KnownRegisters::none;

    // where things are
    At newest(Place row) const { return {Register::bx, row}; }
    At before(Place row, int by) const { return {Register::bx, row - by * v_}; }
    At first(Place row, int k) const { return {Register::r13, row + k * v_}; }
    At weight(Place at) const { return {Register::r12, at}; }
    At sum(Place at) const { return {Register::r14, at}; }
    At next(std::size_t index) const { return {Register::r15, static_cast<Place>(index) * v_}; }
    At part(Place at) const { return {Register::r8, at}; }
    At next_part(Place at) const { return {Register::r9, at}; }
    At order() const { return {Register::bp, 0}; }
    int one(Place weight) const { return t_.ones[static_cast<std::size_t>(weight / v_)]; }

    // what is in registers: of rows, and of sums
    static Place key(Place place, bool is_series) { return 2 * place + (is_series ? 0 : 1); }
    Vector known(Place key) const { return registers_.known(key); }
    Vector room() { return registers_.room(); }
    void know(Vector at, Place key) { registers_.know(at, key); }
    void forget() { registers_.forget(); }
    /// A newest coefficient in a register: its own or the one offered.
    Vector value(Place row, Vector otherwise);
    /// Stores a newest coefficient, in a register of room().
    void give(Place row, Vector from);

    void one_order(bool is_even);
    void set_registers();
    void integrate();
    void scale(const Tape::Scale& s);
    void single(const Tape::Product& p);
    void pair(const Tape::Pair& p);
    /// Goes through the middle of products, from x[2] in ax and y[k - 1] in dx on.
    template <class Body>
    void middle(Place x, Place y, const Body& body);
    void even(const Tape::Sum& s, std::size_t index);
    void odd(const Tape::Sum& s, std::size_t index);
    void combination(const Tape::Combination& c);

    // what is no combination, as abreast_run.hpp
    void other(const Tape::Other& s);
    void call(const Tape::Other& s);
    /// sum_{j < n} a[j] b[-j] for n in cx; vectors 0 to 4 are used.
    void dot(At a, At b, Vector to);
    /// n = k + more
    void dot(At a, At b, int more, Vector to);
    void quotient(const Tape::Other& s);
    void root(const Tape::Other& s);
    void norm(const Tape::Other& s);
    void slope(const Tape::Other& s);
    Vector integral(Place slope, Place b);
    void by_slope(const Tape::Other& s);
    void power(const Tape::Other& s);

    const Tape& t_;
    Place v_;  // bytes of a vector
    bool is_wide_;
    Assembler c_;
    machine_code::KnownRegisters registers_;
    bool is_even_ = false;
};

}  // namespace rbdyn::inline RBDYN_FORM::abreast
#endif
