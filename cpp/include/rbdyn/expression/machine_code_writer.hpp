// Writes the machine code of an evaluator's lists (machine_code.hpp): order 0, one order of odd k and one of even k.
//
// Registers: bx, bp: coefficient k of slot 0, forwards and backwards; r9: its coefficient 0; r12: lane values of order
// k; r13: those of order 0; r14: the series in lanes, with their weights; r15: their sums; si: weights; r8: k.
// Of an even order, ax, dx and r10 tell where the middle of each product's coefficients is.
//
// Of chunks that repeat themselves (repetition.hpp) it writes one, an order a call: bx, bp, r9, r12, r13, r15 and si, a
// table, begin with what is the chunk's own; r11 and r14: how far from there slots of the other kinds begin.
#pragma once

#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/expression/assembler.hpp"
#include "rbdyn/expression/code_memory.hpp"
#include "rbdyn/expression/known_registers.hpp"
#include "rbdyn/expression/machine_code.hpp"
#include "rbdyn/expression/repetition.hpp"
#include "rbdyn/expression/series_evaluator.hpp"

#ifdef RBDYN_WRITES_MACHINE_CODE
namespace rbdyn::inline RBDYN_FORM {

/// What the code is given.
struct MachineCode::Frame {
    double* storage;
    series::LaneValues* lanes;
    const series::LaneSeries* series;
    series::LaneSum* sums;
    const double* scalars;
    SeriesEvaluator* self;
    double unit, minus_one;
    std::int64_t integrates, k, last;
    // of chunks that repeat themselves
    std::ptrdiff_t second = 0, third = 0;
    const SeriesEvaluator::Step* steps = nullptr;
    const int* states = nullptr;
};

class MachineCodeWriter {
public:
    /// Of all that it has to compute, or of what repeats itself.
    explicit MachineCodeWriter(const SeriesEvaluator& series, const Repetition* repetition = nullptr);

    /// Whether code would be shorter than what a processor holds near, and all is in it.
    static bool takes(const SeriesEvaluator& series);
    std::span<const std::uint8_t> write();

private:
    using At = machine_code::At;
    using Register = machine_code::Register;
    using Vector = machine_code::Vector;
    using Assembler = machine_code::Assembler;
    using Frame = MachineCode::Frame;
    using Step = SeriesEvaluator::Step;
    using Term = SeriesEvaluator::ResolvedTerm;

    // vectors 0 to 7 are for what is computed; `first_known` and the following hold newest coefficients
    static constexpr Vector sum_lanes = 8, next_lanes = 9, first_known = 10, known_count = 5, zero = 15,
                            none = machine_code::KnownRegisters::none;

    // where things are
    std::ptrdiff_t in_storage(const double* p) const { return 8 * (p - e_.storage_.data()); }
    std::ptrdiff_t in_lanes(const series::LaneValues* p) const { return 32 * (p - e_.lanes_.data()); }
    /// A coefficient of order 0 of a slot, from where a register points.
    At slot(Register base, const double* p) const;
    At newest(const double* p) const { return slot(Register::bx, p); }
    At fixed(const double* p) const { return slot(Register::r9, p); }
    At backwards(const double* p) const { return slot(Register::bp, p); }
    /// Where a weight is, by what holds it; none: it is 1 or -1, as its scalar.
    std::optional<At> weight(const void* holder, std::ptrdiff_t scalar) const;
    At next_of(const series::LaneSum& s) const;

    // newest coefficients, and lanes of them, that are in registers
    std::ptrdiff_t key(const double* slot) const { return 2 * in_storage(slot); }
    std::ptrdiff_t key(const series::LaneValues* p) const { return 2 * in_lanes(p) + 1; }
    Vector known(std::ptrdiff_t key) const { return registers_.known(key); }
    Vector room() { return registers_.room(); }
    void know(Vector at, std::ptrdiff_t key) { registers_.know(at, key); }
    void forget() { registers_.forget(); }
    /// In a register: its own or the one offered.
    Vector value(const double* slot, Vector otherwise);
    Vector value(const series::LaneValues* p, Vector otherwise);
    /// Stores what was computed of a slot in a register of room().
    void give(double* out, Vector from);
    void give(const series::View& out, Vector from);

    enum class Order : std::uint8_t { first, odd, even };
    void order(Order which);
    void set_registers();
    void integrate();
    void block(const SeriesEvaluator::Block& b);
    void copy(const series::View& v);
    /// Added to what is in a register.
    void terms(const Term* first, const Term* last, Vector sum, Vector to);
    void mixed(const SeriesEvaluator::Mixed& m, const series::LaneSum* from);

    // sums of products in lanes
    void sums(const SeriesEvaluator::Sums& s);
    void pair(const double* low, const double* high, Vector to);
    void gather(const series::LaneSeries& s);
    void spread(const series::LaneSpread& s);
    void first(const series::LaneSum& s);
    void odd(const series::LaneSum& s);
    void even(const series::LaneSum& s);
    /// Pairs of coefficients of a product's middle, at most.
    int middle() const { return e_.top_ > 3 ? (e_.top_ - 2) / 2 : 0; }
    /// A lane of the sum computed last, in a register.
    Vector lane(int l);

    // what is no combination
    void step(const Step& s);
    void call(const Step& s);
    void quotient(const Step& s);
    void by_slope(const Step& s);
    void power(const Step& s);
    void norm(const Step& s);
    struct Factors {
        const double* a;        // its first coefficient
        const series::View* b;  // read backwards
    };
    /// sum_{j < k + more} a[j] b_{k - before - j} for each, in vectors 0, 1, ...; 3 and 4 are used.
    void dots(std::initializer_list<Factors> factors, int before, int more);
    void slope(const Step& s);

    const SeriesEvaluator& e_;
    const Repetition* repetition_;
    Repetition::Chunk model_{};  // of what repeats itself
    Assembler c_;
    Order order_ = Order::first;
    int lanes_there_ = 0;  // of the sum computed last: a bit each
    machine_code::KnownRegisters registers_{first_known, known_count};
    struct Detour {
        std::size_t from, back;
        const Step* step;
    };
    std::vector<Detour> detours_;  // norms that begin at zero
};

}  // namespace rbdyn::inline RBDYN_FORM
#endif
