// Machine code of a streamed series (streamed_series.hpp), written once for all stages of a kind (stream_kinds.hpp).
//
// Lists and code share all that outlives an order, so that each stage and each order may be computed by either. The
// same operations in the same order: the same bits (docs/decisions/32).
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/expression/code_memory.hpp"
#include "rbdyn/expression/series_evaluator.hpp"
#include "rbdyn/expression/stream_kinds.hpp"
#include "rbdyn/expression/streamed_series.hpp"

namespace rbdyn::inline RBDYN_FORM {

class StreamedCodeWriter;  // streamed_code_writer.hpp

class StreamedCode {
public:
    /// Of an evaluator that has a stream; none where its stages are of too many kinds, or there is none to be had.
    static std::unique_ptr<StreamedCode> of(SeriesEvaluator& series);

    /// Order k begins.
    void begin(int k);
    /// The next chunk of it.
    void run() { start_(&frame_); }
    std::size_t bytes() const;

private:
    friend class StreamedCodeWriter;
    using Index = StreamKinds::Index;
    enum class Order : std::uint8_t { first, odd, even };
    static constexpr std::size_t orders = 3;
    /// What the code is given, and where it goes on.
    struct Frame {
        double *now, *made;                  // values of this order; the next one to be made
        StreamedSeries::Line *lines, *line;  // of orders 0 and 1: the first one, the next one to be laid out
        std::ptrdiff_t newest;               // from there to those of this order [bytes]
        const Index* operand;
        series::LaneValues* next;
        const double* scalars;
        const series::LaneValues* weights;
        const std::uint64_t* pieces;            // of code
        std::uint64_t product, quotient, sine;  // code of this order
        const SeriesEvaluator::Step* steps;
        StreamedCode* self;
        std::int64_t k;
        double order, minus_one;
    };
    StreamedCode(SeriesEvaluator& series, StreamKinds kinds, CodeMemory memory)
        : series_(series), kinds_(std::move(kinds)), memory_(std::move(memory)) {}

    // called by the code: the place behind what a step has made; a stage that is left to the lists
    static double* step(const Frame* frame, const SeriesEvaluator::Step* step, std::uint64_t row, double* made);
    static void stage(Frame* frame, std::uint64_t left);

    SeriesEvaluator& series_;
    StreamKinds kinds_;
    CodeMemory memory_;
    void (*start_)(Frame*) = nullptr;
    std::vector<std::uint64_t> pieces_[orders];
    std::vector<std::uint64_t> products_, quotients_, sines_;  // by order
    Frame frame_{};
};

}  // namespace rbdyn::inline RBDYN_FORM
