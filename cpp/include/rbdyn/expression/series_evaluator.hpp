// Runs a program in truncated Taylor series, order by order (see series/coefficients.hpp).
//
// Time is measured in units of `unit` seconds from the start of the series, so that coefficients stay near the size
// of what they describe however fast or slow the motion is; powers of two leave every digit unchanged.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/large_memory.hpp"
#include "rbdyn/expression/machine_code.hpp"
#include "rbdyn/expression/program.hpp"
#include "rbdyn/expression/schedule.hpp"
#include "rbdyn/expression/slot_ring.hpp"
#include "rbdyn/expression/streamed_series.hpp"
#include "rbdyn/expression/wavefront.hpp"
#include "rbdyn/series/coefficients.hpp"
#include "rbdyn/series/lanes.hpp"
#include "rbdyn/series/product_sums.hpp"

namespace rbdyn::inline RBDYN_FORM {

class RepeatedCode;  // repeated_code.hpp

class SeriesEvaluator {
public:
    enum class Use : std::uint8_t { any, expansion, states };
    /// Room for series of orders 0 .. max_order; `use`: less room for one who calls none but expand() of max_order, and
    /// less still where it seldom looks at slots that are neither inputs nor outputs: once it does, there are two
    /// evaluators.
    SeriesEvaluator(const Program& program, int max_order, Use use = Use::any);
    SeriesEvaluator(const SeriesEvaluator&) = delete;
    SeriesEvaluator& operator=(const SeriesEvaluator&) = delete;
    ~SeriesEvaluator();

    const Program& program() const { return *program_; }
    /// As if it were new.
    void renew();
    std::size_t bytes() const {
        return storage_.size() * sizeof(double) + lanes_.size() * sizeof(lanes_[0]) +
               places_.size() * sizeof(places_[0]) + (stream_ != nullptr ? stream_->bytes() : 0) +
               (ring_ != nullptr ? ring_->bytes() : 0) + (all_ != nullptr ? all_->bytes() : 0);
    }
    /// What is made of its program beside.
    std::size_t bytes_of_lists() const;
    /// Doubles from one input's coefficients to the next one's.
    int stride() const { return stride_; }

    void set_parameters(std::span<const double> parameters, Program::Rounding rounding = Program::Rounding::nearest);

    /// Starts at time t with a unit of time; state coefficients are given with set_input().
    void begin(double t, double unit);

    void set_input(int variable, int order, double value) { row(variable)[order] = value; }

    /// Gives the inputs their coefficient k + 1 if output i is the derivative of input i.
    void integrate(int k);

    /// Whether the derivatives' coefficients of order k are finite. What is not in one order is not in any higher one.
    bool is_finite(int k) const;

    /// Computes coefficient k of every slot from coefficients 0..k of the inputs.
    void advance(int k) { run_(*this, k, k + 1, false); }

    /// Coefficients 0 .. order of the inputs from their first ones, 0 .. order - 1 of all other slots; `whole`: 0 ..
    /// order of these too.
    void expand(int order, bool whole) {
        if (is_elsewhere_) return all_->expand(order, whole);
        is_whole_ = whole;
        // where orders run one behind the other the last one has at hand what it would fetch from memory by itself
        const bool is_one_behind = wavefront_ != nullptr && stream_ == nullptr && order == top_;
        run_(*this, 0, whole && is_one_behind ? order + 1 : order, true);
        if (whole && !is_one_behind) advance(order);
    }
    /// From now on as on a processor without lanes of four: the same bits.
    void go_without_lanes_of_four();
    /// From now on by machine code (machine_code.hpp) at once, or not at all; else from when it pays. The same bits.
    void use_machine_code(bool is_used);
    bool has_machine_code() const { return code_ != nullptr || repeated_ != nullptr || has_streamed_code(); }
    /// That of chunks that repeat themselves (repeated_code.hpp).
    bool has_repeated_code() const { return repeated_ != nullptr; }
    /// That of stages of a kind (streamed_code.hpp).
    bool has_streamed_code() const { return stream_ != nullptr && stream_->has_code(); }
    /// Whether slots that are neither inputs nor outputs share places, and none has been looked at.
    bool has_ring() const { return ring_ != nullptr && all_ == nullptr; }
    /// Of a program that is larger than the caches: it may have room for one use alone.
    bool is_large() const { return is_large_; }

    /// Coefficients of an output, of a switch, of any slot.
    const double* output(int index) const { return coefficients(program_->output(index)); }
    const double* switch_value(int index) const { return coefficients(program_->switch_output(index)); }
    /// Of a term of a combination, for the parameters given.
    double weight(int index) const { return scalars_[static_cast<std::size_t>(index)]; }
    std::span<const double> weights() const { return scalars_; }
    double unit() const { return unit_; }

    /// Whether a program has functions that soon grow beyond the largest double. What comes near to it is infinite
    /// then, and has no slopes: to what divides by it that is all the same.
    static bool may_overflow(const Program& program);
    static constexpr double largest = 0x1p960;

    const double* coefficients(int slot_index) const;
    /// Those of several slots, one behind the other.
    const double* rows(int first, int count) const {
        if (stream_ != nullptr)
            for (int i = 1; i < count; ++i) coefficients(first + i);
        return coefficients(first);
    }
    /// The same for who computed them elsewhere (series_abreast.hpp).
    double* row(int slot_index) {
        if (ring_ != nullptr) return ring_row(slot_index);
        if (stream_ != nullptr) stream_->give(slot_index, slot(slot_index).forward);
        return slot(slot_index).forward;
    }
    void set_unit(double unit) {
        unit_ = unit;
        if (all_ != nullptr) all_->set_unit(unit);
    }
    /// Whether what is at rest at the zero of a power may stay there; so at first.
    void let_zeros_stay(bool may) {
        zeros_stay_ = may;
        if (all_ != nullptr) all_->let_zeros_stay(may);
    }

private:
    friend class MachineCode;
    friend class MachineCodeWriter;
    friend class RepeatedCode;
    friend class Repetition;
    friend class StreamKinds;
    friend class StreamedCode;
    friend class StreamedCodeWriter;
    friend class StreamedSeries;
    // instructions with their series found once
    struct ResolvedTerm {
        const double* series;
        std::ptrdiff_t weight;
    };
    struct Motion {
        double* input;
        const double* rate;
        double* last;  // of its backward copy, if that is read
    };
    struct Step {
        Code code;
        int weight;
        series::View out, out2, a, b, c;
        double* slope;
        int* valuation;
        double value;
        const Program::Call* call;
    };
    /// A combination that is a constant: its higher coefficients are zero for good.
    struct Constant {
        series::View out;
        int weight;
    };
    /// One that is a lane of a sum.
    struct Lane {
        double* out;
        const double* sum;
    };
    /// One of multiples of slots alone, one or more.
    struct Linear {
        double* out;
        const ResolvedTerm *first, *last;
    };
    /// Any other: a constant (weight -1: none), multiples of slots, lanes of a sum.
    struct Mixed {
        double* out;
        int weight;
        const ResolvedTerm *first, *last;
        const double *lane, *lane_end;
    };
    /// Sums of products and the combinations they are in.
    struct Sums {
        const series::LaneSeries *series, *series_end;
        const series::LaneSpread *spread, *spread_end;
        series::LaneSum *sum, *sum_end;
        const Lane *lane, *lane_end;
        const Mixed *mixed, *mixed_end;
    };
    /// What is computed one after the other, all of one kind. Series are written forwards; those of which the backward
    /// copy is read are copied.
    enum class Kind : std::uint8_t { copies, sums, linear, mixed, steps };
    struct Block {
        Kind kind;
        const void *first, *last;
    };

    /// Where the series of a slot are computed.
    series::View slot(int index);
    std::ptrdiff_t place(int slot_index) const {
        if (ring_ != nullptr) return ring_->place(slot_index);
        return places_.empty() ? static_cast<std::ptrdiff_t>(slot_index) * stride_
                               : places_[static_cast<std::size_t>(slot_index)];
    }
    // of slots that share places (slot_ring.hpp)
    double* ring_row(int slot_index);
    const double* ring_coefficients(int slot_index) const;
    /// The evaluator that has all slots, expanded as this one is if it was not yet.
    SeriesEvaluator& all_slots() const;
    /// A chunk is done, its orders 0 .. orders - 1.
    void keep(std::size_t chunk, int orders);
    /// For each of a schedule's series where its lanes are: in the place of those that no chunk reads any more, if
    /// orders run one behind the other. And how many places there are.
    std::pair<std::vector<std::size_t>, std::size_t> lane_places(const Schedule& schedule) const;
    /// Room for all slots; `is_large`: of those alone of which the backward copy is read or written there is one.
    void make_room(bool is_large, const std::vector<int>& backwards, const Schedule& schedule);

    // code in four lanes (series/lanes.hpp)
    using Run = void (*)(SeriesEvaluator&, int first, int last, bool integrates);
    static Run widest();
    static Run usual();
    static void plain(SeriesEvaluator& series, int first, int last, bool integrates);
    static void wide(SeriesEvaluator& series, int first, int last, bool integrates);
    static void by_code(SeriesEvaluator& series, int first, int last, bool integrates);
    static void compute_wide(SeriesEvaluator& series, const Step& step, int k);
    template <class Lanes>
    void run(int first, int last, bool integrates);
    template <class Lanes>
    void advance_in(std::ptrdiff_t k);
    template <class Lanes>
    void advance_blocks(const Block* block, const Block* end, std::ptrdiff_t k);
    /// What a chunk computes at order k, and the next order of its inputs.
    template <class Lanes>
    void advance_chunk(std::size_t place, int k);
    /// Makes code of chunks that repeat themselves, if it pays from now on.
    void make_repeated();
    /// All orders, one behind the other.
    template <class Lanes>
    void sweep(int orders);
    void set_constants();
    double linear(const ResolvedTerm* first, const ResolvedTerm* last, double sum, std::ptrdiff_t k) const;
    void mixed(const Mixed* first, const Mixed* last, std::ptrdiff_t k) const;

    /// Whether a slot has grown beyond the largest double, or nearly so; it is infinite then.
    bool overflows();
    /// What has is as good as constant to all that divides by it.
    static void flatten(double* out, std::ptrdiff_t k) {
        if (out != nullptr && std::isinf(out[0])) out[k] = 0.0;
    }
    static void flatten(const series::View& out, std::ptrdiff_t k) {
        if (out.forward != nullptr && std::isinf(out[0])) out.set(static_cast<int>(k), 0.0);
    }
    static void flatten(const Block& block, std::ptrdiff_t k);

    /// Coefficient k of the slots of an instruction that is no combination.
    template <class Lanes>
    RBDYN_INLINE_LANES void compute(const Step& i, int k);

    /// A function of the user's has a value and no more.
    void call(const Program::Call& c, int k);

    /// |v| for v = t^m d(t), d(0) not zero: t^m |d(t)|, so that a motion may start from v = 0.
    template <class Lanes>
    RBDYN_INLINE_LANES void norm(const Step& i, const series::View& out, int k);

    void resolve();
    void add_motion(const std::vector<int>& backwards);

    const ResolvedTerm* add_terms(const Instruction& i);

    Step step(const Instruction& i);
    /// Whether a root, or a power, is one of nothing up to coefficient k > 0, and has none itself: what is at rest at
    /// the zero of a force |x|^r, r > 0, stays there. Where the first coefficient that is not zero comes, it has no
    /// series.
    bool stays_at_zero(const Step& i, int k) const {
        return zeros_stay_ && i.a[0] == 0.0 && i.a[k] == 0.0 && i.out[k - 1] == 0.0;
    }

    /// Slots of which the backward copy is read, and that no step writes.
    static std::vector<int> read_backwards(const Program& program);

    const Program* program_;
    int top_, stride_;
    Use use_;
    double time_ = 0.0, unit_ = 1.0;
    mutable LargeVector<double> storage_;  // of what is streamed a row is written when it is asked for
    std::vector<std::ptrdiff_t> places_;   // by slot, in the storage of a program that is larger than the caches
    std::vector<char> is_both_ways_;       // by slot: it has a backward copy
    std::vector<double> scalars_;
    std::vector<int> valuations_;
    std::vector<Block> blocks_;
    std::vector<Constant> constants_;
    LargeVector<series::View> copies_;
    std::vector<Sums> sums_;
    LargeVector<Lane> lane_outputs_;
    LargeVector<Linear> linear_;
    LargeVector<Mixed> with_sums_, mixed_;
    LargeVector<Step> steps_;
    LargeVector<Motion> motion_;
    // of a program that is larger than the caches, or repeats itself
    std::unique_ptr<const Wavefront> wavefront_;
    bool is_large_ = false;
    std::vector<std::size_t> first_block_;  // by stage, after those of the inputs; then the end
    bool may_overflow_ = false, overflows_ = false;
    std::vector<const double*> bases_;  // of powers, where they begin
    bool zeros_stay_ = true;
    LargeVector<ResolvedTerm> terms_;
    LargeVector<series::LaneValues> lanes_;
    LargeVector<series::LaneSeries> lane_series_;
    std::vector<Schedule::Series> lane_weights_;
    LargeVector<series::LaneSpread> lane_spreads_;
    LargeVector<series::LaneProduct> lane_products_;
    LargeVector<series::LaneSum> lane_sums_;
    std::unique_ptr<MachineCode> code_;
    std::unique_ptr<RepeatedCode> repeated_;  // instead of that, of chunks
    bool is_whole_ = false;                   // the expansion that is made
    int expansions_ = 0;                      // so far, until there is code
    Run run_ = usual();
    std::unique_ptr<StreamedSeries> stream_;  // instead of all lists, of a program that is larger than the caches
    // where slots share places
    std::unique_ptr<const SlotRing> ring_;
    std::array<double, 2> checks_{};                // of rates' coefficients 0 and top - 1: zero if all are finite
    mutable std::unique_ptr<SeriesEvaluator> all_;  // once one of them was looked at
    mutable bool is_all_there_ = false;             // this expansion
    bool is_elsewhere_ = false;                     // from the next one on all are made there
    std::vector<double> parameters_;                // for that
    Program::Rounding rounding_ = Program::Rounding::nearest;
};

inline void SeriesEvaluator::integrate(int k) {
    const double factor = unit_ / (k + 1);
    for (const Motion& m : motion_) m.input[k + 1] = m.rate[k] * factor;
}

inline bool SeriesEvaluator::is_finite(int k) const {
    if (ring_ != nullptr && !is_all_there_) return checks_[k > 0 ? 1 : 0] == 0.0;
    if (ring_ != nullptr) return all_->is_finite(k);
    double check = 0.0;
    for (const Motion& m : motion_) check += 0.0 * m.rate[k];
    return check == 0.0;
}

inline const double* SeriesEvaluator::coefficients(int slot_index) const {
    if (ring_ != nullptr) return ring_coefficients(slot_index);
    double* const row = storage_.data() + place(slot_index);
    if (stream_ != nullptr) stream_->give(slot_index, row);
    return row;
}

inline series::View SeriesEvaluator::slot(int index) {
    double* const start = storage_.data() + place(index);
    // a first coefficient is the same from both ends
    const bool is_both_ways = is_both_ways_.empty() || is_both_ways_[static_cast<std::size_t>(index)] != 0;
    return {start, is_both_ways ? start + 2 * top_ + 1 : start};
}

}  // namespace rbdyn::inline RBDYN_FORM
