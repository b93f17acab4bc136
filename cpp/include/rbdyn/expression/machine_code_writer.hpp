// Writes the machine code of an evaluator's lists (machine_code.hpp): order 0, one order of odd k and one of even k.
//
// Registers: bx, bp: coefficient k of slot 0, forwards and backwards; r9: its coefficient 0; r12: lane values of order
// k; r13: those of order 0; r14: the series in lanes, with their weights; r15: their sums; si: weights; r8: k; r11: the
// middles of products. Of an odd order, ax, dx and r10 tell where the coefficients of the next ones' middles are.
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
    series::LaneValues* middles;
    const double* factors;
    double minus_one;
    std::int64_t integrates, k, last, end;  // end: of the orders of which middles are wanted
    // of chunks that repeat themselves
    double unit = 0.0;
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
    /// What middles take, and what is packed for them, in vectors.
    std::size_t room_for_middles() const;

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
    // what lays out series uses 0 and 1
    static constexpr Vector first_carried = 2, carried_count = 8;

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
    Vector known(std::ptrdiff_t key) const {
        const Vector x = registers_.known(key);
        return x == none && are_carried_ ? carried(key) : x;
    }
    Vector room() { return registers_.room(); }
    void know(Vector at, std::ptrdiff_t key) { registers_.know(at, key); }
    void forget() {
        registers_.forget();
        are_carried_ = false;
    }
    /// In a register: its own or the one offered.
    Vector value(const double* slot, Vector otherwise);
    Vector value(const series::LaneValues* p, Vector otherwise);
    /// Stores what was computed of a slot in a register of room().
    void give(double* out, Vector from);
    void give(const series::View& out, Vector from);
    /// The register in which an order finds the newest coefficient of a variable; none: in none. They are there until
    /// what is computed needs their places.
    Vector carrier(std::size_t motion) const {
        return repetition_ == nullptr && motion < carried_count ? static_cast<Vector>(first_carried + motion) : none;
    }
    Vector carried(std::ptrdiff_t key) const;
    /// Loads them: order k, or what will be k.
    void load_carried(int order);

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
    // middles of products (machine_code_middle.ipp)
    struct Middle {
        const series::LaneValues *x, *y;
        std::size_t index, last;  // last product: it is computed behind that one's sum
        int packed;               // which pair of series; -1: none, those of its product
    };
    /// Of a product in a middle: from where on, and which of its own lanes.
    struct Share {
        std::size_t middle;
        int lane, first, lanes;
    };
    struct Packing {
        const series::LaneValues* series;
        int packed;
        Share share;
    };
    Share lanes_of(const series::LaneProduct& p) const;
    void share_middles();
    void pack(const series::LaneValues* series, Vector from);
    void set_middles();
    void middle(const Middle& m);
    At middle_of(const Share& share, int part) const;
    /// Whether middles are computed an order before they are asked for: where there are so many that they would not
    /// stay near the processor until then they are computed when they are, in registers.
    bool are_ahead() const { return repetition_ == nullptr && e_.lane_products_.size() <= most_ahead; }
    static constexpr std::size_t most_ahead = 20;
    /// From an order's lanes to those of the order before its middles.
    std::ptrdiff_t before_middle() const { return are_ahead() ? 0 : -32; }
    // behind one vector, for who reads lanes before the first one
    static std::ptrdiff_t in_middles(std::size_t middle) { return 32 + 128 * static_cast<std::ptrdiff_t>(middle); }
    std::ptrdiff_t in_packed(int packed) const { return in_middles(middles_.size()) + 32 * (e_.top_ + 1) * packed; }
    /// Pairs of coefficients of a product's middle, at most.
    int pairs() const { return e_.top_ > 3 ? (e_.top_ - 2) / 2 : 0; }
    /// A lane of the sum computed last, in a register.
    Vector lane(int l);
    /// The same in that register.
    void give_lane(int l, Vector to);

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
    std::vector<Share> shares_;  // by product
    std::vector<Middle> middles_;
    std::vector<Packing> packings_;
    int packed_ = 0;
    Assembler c_;
    Order order_ = Order::first;
    int lanes_there_ = 0;  // of the sum computed last: a bit each
    bool are_carried_ = false;
    machine_code::KnownRegisters registers_{first_known, known_count};
    struct Detour {
        std::size_t from, back;
        const Step* step;
        Order order;
    };
    std::vector<Detour> detours_;  // norms that begin at zero
};

}  // namespace rbdyn::inline RBDYN_FORM
#endif
