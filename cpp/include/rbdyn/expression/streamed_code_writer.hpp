// Writes the machine code of a streamed series (streamed_code.hpp): for each kind of stages a piece for order 0, one
// for odd and one for even orders, and what products of even orders have in common.
//
// A piece reads its operands, goes on behind what it has made, and jumps to the piece of the stage that is next.
// Registers: di: values of this order; bx: the next one to be made; r15: lines of orders 0 and 1; bp: the next one to
// be laid out; r9: how far from there those of this order are; r11: those of this order; r12: operands; r13: what of
// the coming order is known, of the next sum; r14: code of products; si, r8: weights, of combinations and of series;
// r10: a step. bx, bp and r12 to r15 outlive a call.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <span>
#include <vector>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/expression/assembler.hpp"
#include "rbdyn/expression/code_memory.hpp"
#include "rbdyn/expression/program.hpp"
#include "rbdyn/expression/stream_kinds.hpp"
#include "rbdyn/expression/streamed_code.hpp"

#ifdef RBDYN_WRITES_MACHINE_CODE
namespace rbdyn::inline RBDYN_FORM {

class StreamedCodeWriter {
public:
    StreamedCodeWriter(const SeriesEvaluator& series, const StreamKinds& kinds) : e_(series), kinds_(kinds) {}

    /// Whether lines of all orders are near enough to one another.
    static bool takes(const SeriesEvaluator& series);
    std::span<const std::uint8_t> write();
    // where in the code things are: pieces of an order; what products, quotients and sines are, by order
    const std::vector<std::size_t>& pieces(std::size_t order) const { return pieces_[order]; }
    const std::vector<std::size_t>& products() const { return products_; }
    const std::vector<std::size_t>& quotients() const { return quotients_; }
    const std::vector<std::size_t>& sines() const { return sines_; }

private:
    using At = machine_code::At;
    using Register = machine_code::Register;
    using Vector = machine_code::Vector;
    using Assembler = machine_code::Assembler;
    using Frame = StreamedCode::Frame;
    using Index = StreamKinds::Index;
    using Order = StreamedCode::Order;
    struct Combination {
        bool has_constant;
        std::span<const Index> terms;
        Index lanes, first_lane, place;
        std::ptrdiff_t first_operand;
    };
    struct Lane {
        Index lane, place;
    };

    static constexpr Index lanes_of_sum = 4;
    static constexpr Vector sum_lanes = 8, next_lanes = 9, first_lane = 10, zero = 15;

    std::ptrdiff_t row() const;  // from one pair of orders to the next [bytes]
    void begin();
    void load();
    void end();
    void go_on();
    void left();
    void piece(const StreamKinds::Kind& kind);
    void series(Index bits, Index line);
    void spread(Index line);
    void sum(std::span<const Index> products, Index index);
    /// A factor of a product, of orders 0 and 1 and of this order.
    struct Factor {
        At first, newest;
    };
    Factor factor(Index line, Register in);
    /// A lane of the sum computed last, in a register.
    Vector lane(Index l);
    void copy(Index l, Index place);
    void combination(const Combination& c);
    void product(int k);

    // what is no combination (streamed_code_steps.ipp)
    void step(Code code);
    void quotient(int k);
    void sine(int k);
    /// For each the sum of products of coefficients that lie from where a register points, and of those where another
    /// one does, in vectors 0, 1, ...; 4 is used.
    void dots(At first, std::initializer_list<At> others, int count);

    /// The next operand of the piece, in a register.
    void operand(Register to);
    At line_of_order(Index line) const;
    void call(std::uint64_t function);

    const SeriesEvaluator& e_;
    const StreamKinds& kinds_;
    Assembler c_;
    Order order_ = Order::first;
    std::ptrdiff_t read_ = 0;  // operands of a piece so far
    unsigned lanes_there_ = 0;
    std::array<std::vector<std::size_t>, StreamedCode::orders> pieces_;
    std::vector<std::size_t> products_, quotients_, sines_;
};

}  // namespace rbdyn::inline RBDYN_FORM
#endif
