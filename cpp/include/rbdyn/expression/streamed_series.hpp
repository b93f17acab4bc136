// Runs the series of a program that is larger than the caches, and of which each order has to be whole before the next.
//
// What such a program costs is what it fetches from memory, once an order. So all of it lies in the order in which it
// is read: instructions as lists of small numbers; coefficients of one order of all slots side by side, as they are
// made; the series of products two orders to a line of a cache, and after the lines of one pair of orders those of the
// next. Each order then reads a few streams from one end to the other. What a slot's coefficients are is put together
// where they are asked for. The same operations in the same order as by SeriesEvaluator's lists: the same bits.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/large_memory.hpp"
#include "rbdyn/expression/program.hpp"
#include "rbdyn/expression/schedule.hpp"
#include "rbdyn/expression/wavefront.hpp"
#include "rbdyn/series/lanes.hpp"
#include "rbdyn/series/product_sums.hpp"

namespace rbdyn::inline RBDYN_FORM {

class SeriesEvaluator;
class StreamedCode;  // streamed_code.hpp

class StreamedSeries {
public:
    /// Of a schedule that is cut, of a program without calls. `backwards`: slots of which steps read the backward copy
    /// that no step writes, in ascending order.
    StreamedSeries(const Program& program, const Schedule& schedule, const Wavefront& wavefront, int max_order,
                   std::span<const int> backwards);
    ~StreamedSeries();

    std::size_t bytes() const { return lines_.size() * sizeof(Line) + values_.size() * sizeof(double); }
    /// What is made of its program beside.
    std::size_t bytes_of_lists() const;
    /// From now on by machine code, if there is any to be had; or by lists alone.
    void make_code(SeriesEvaluator& series);
    void drop_code();
    bool has_code() const { return code_ != nullptr; }
    void set_weights(std::span<const double> scalars);

    /// Writes the coefficients of a slot to `row`, if they are not there.
    void give(int slot, double* row) {
        const Index place = made_at_[static_cast<std::size_t>(slot)];
        if (place != none && given_[static_cast<std::size_t>(slot)] != newest_) write(slot, place, row);
    }
    /// Instructions that are steps, in the order in which they are computed.
    const std::vector<const Instruction*>& steps() const { return steps_; }

    // orders first .. last - 1 of all slots of an evaluator, in code for four lanes of a register and for two
    static void plain(SeriesEvaluator& series, int first, int last, bool integrates);
    static void wide(SeriesEvaluator& series, int first, int last, bool integrates);

private:
    friend class StreamedCode;
    friend class StreamedCodeWriter;
    friend class StreamKinds;
    using Index = std::uint32_t;
    static constexpr Index none = static_cast<Index>(-1);
    /// How many of each kind come next.
    struct Stage {
        Index series = 0, spreads = 0, sums = 0, lanes = 0, combinations = 0, steps = 0;
    };
    /// Four places side by side, each times a weight.
    struct Series {
        Index from[4], weight;
    };
    struct Product {
        Index x, y;
    };
    /// A constant (weight -1: none), multiples of places, lanes of sums.
    struct Combination {
        std::int32_t weight;
        Index terms, first_lane, lanes;
    };
    struct Weighted {
        Index place, weight;
    };
    /// A place and the series of its slot.
    struct Row {
        Index place, slot;
        bool is_copied;  // backwards, too
    };
    /// What a step reads and writes.
    struct Operands {
        Index reads, writes;
    };
    /// An input whose next coefficient comes of a rate.
    struct Motion {
        Index rate, input;
    };
    /// Coefficients of two orders.
    struct alignas(64) Line {
        series::Quad orders[2];
    };
    struct Cursor;

    void write(int slot, Index place, double* row);
    template <class Lanes>
    static void run(SeriesEvaluator& series, int first, int last, bool integrates);
    template <class Lanes>
    void advance(SeriesEvaluator& series, int k, bool integrates);
    template <class Lanes>
    void advance_stage(SeriesEvaluator& series, const Stage& stage, Cursor& at, int k);
    template <class Lanes>
    void advance_step(SeriesEvaluator& series, Cursor& at, int k);
    /// Where an order begins in each list.
    Cursor begin(int k);
    void first_order(const Stage& stage, Cursor& at);
    void even_order(const Stage& stage, Cursor& at, int k);
    void odd_order(const Stage& stage, Cursor& at, int k);
    void take_rows(SeriesEvaluator& series, const std::vector<Row>& rows, int k);
    double* values(int k) { return values_.data() + static_cast<std::size_t>(k) * places_; }

    std::size_t places_ = 0, row_ = 0;  // from one order's values, from one pair's lines to the next
    LargeVector<double> values_;
    LargeVector<Line> lines_;
    std::vector<series::LaneValues> next_;  // what of the coming order is known, by sum
    std::vector<series::LaneValues> sums_;  // of one stage

    std::vector<Index> ends_;  // of chunks, in stages; of their inputs
    std::vector<Index> input_ends_;
    std::vector<Stage> stages_;
    std::vector<Series> series_;
    std::vector<Index> spreads_;
    std::vector<Index> sizes_;  // products of each sum
    std::vector<Product> products_;
    std::vector<Index> lanes_;
    std::vector<Combination> combinations_;
    std::vector<Weighted> terms_;
    std::vector<const Instruction*> steps_;
    std::vector<Operands> operands_;
    std::vector<Row> step_rows_;
    std::vector<Motion> motion_;
    std::vector<Row> inputs_, others_;  // inputs that move, and all else that no instruction here computes
    Index first_made_ = 0;
    std::vector<Index> made_at_;        // place by slot, of those that combinations make; none of others
    std::vector<std::uint64_t> given_;  // by slot: which of all runs its row is of
    std::uint64_t newest_ = 0;
    int orders_ = 0;  // that are known
    std::vector<Schedule::Series> weight_scalars_;
    std::vector<series::LaneValues> weights_;
    std::unique_ptr<StreamedCode> code_;
    bool may_have_code_ = true;
};

}  // namespace rbdyn::inline RBDYN_FORM
