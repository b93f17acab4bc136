// Which stages of a streamed series (streamed_series.hpp) are of one kind, so that one machine code computes them all.
//
// Links that hang from one another are computed in passes along them: outwards, inwards, and outwards again. In the
// row of stages the passes are mixed, and each repeats itself after a length of its own. So a stage is told by what it
// consists of alone: how many series, sums of how many products, combinations of how many terms, which lanes go where,
// which weights are one. All else, places and weights, is in a list of operands, in the order in which code of that
// kind reads it: of a chain, a tree, or any program whose stages are of few kinds.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/expression/program.hpp"
#include "rbdyn/expression/streamed_series.hpp"

namespace rbdyn::inline RBDYN_FORM {

class StreamKinds {
public:
    using Index = std::uint32_t;

    /// Of an evaluator that has a stream.
    explicit StreamKinds(const SeriesEvaluator& series);

    /// Whether all distances are as short as operands are.
    bool are_short() const { return are_short_; }

    struct Kind {
        /// What its code is written from. How many series, spread series, sums, lanes, combinations and steps; then
        ///   of each series the bits below;
        ///   of each sum how many products, and of these two factors each: which series of this stage it is, those
        ///   that are spread behind the others, or `elsewhere`;
        ///   of each lane that is copied which one it is;
        ///   of each combination whether it has a constant, how many terms, a Factor for each, how many lanes, and the
        ///   first one;
        ///   of each step its code.
        std::vector<Index> shape;
        std::size_t stages = 0;
        bool has_code = false;
    };
    static constexpr Index is_weighted = 1, are_low_same = 2, are_high_same = 4, are_halves_same = 8;
    static constexpr Index elsewhere = static_cast<Index>(-1);
    enum Factor : Index { plus_one, minus_one, any };
    const std::vector<Kind>& kinds() const { return kinds_; }

    /// Code is for the kinds that have most stages, as long as their shapes together are not too long; all other stages
    /// are left to the lists. How many stages have code.
    std::size_t choose(std::size_t longest_together);
    static constexpr std::size_t longest = 3000;

    /// Steps that are not called; of others none is.
    static constexpr bool has_own_code(Code code) { return code == Code::divide || code == Code::sine_cosine; }

    // pieces of code: where a chunk ends; where a stage is left to the lists, of which the first operand tells which
    // one it is; those of kinds
    static constexpr Index chunk_ends = 0, by_lists = 1, first_kind = 2;
    /// As an operand: where in a table of addresses its code is.
    static constexpr Index entry(Index piece) { return piece * static_cast<Index>(sizeof(std::uint64_t)); }
    /// Of each stage: its piece of code, then places, lines and weights in bytes from where all of them begin; of a
    /// step which one it is, the first of its rows, and where what it reads is if it has code of its own.
    std::vector<Index> operands;
    /// Where a stage that is left to the lists begins in each of them; where the next one's operands do.
    struct Place {
        Index stage, series, spread, sum, product, lane, combination, term, step, row, made, line, next_operand;
    };
    std::vector<Place> left;

private:
    void add(const SeriesEvaluator& series, const StreamedSeries& stream, Place& at);
    void add_sums(const StreamedSeries& stream, Place& at);
    void add_combinations(const SeriesEvaluator& series, const StreamedSeries& stream, Place& at);
    void give(std::size_t count, std::size_t size);

    std::vector<Kind> kinds_;
    std::vector<Index> kind_of_, first_operand_;  // by stage
    std::vector<Index> shape_;                    // of the stage that is looked at
    std::vector<Place> places_;
    bool are_short_ = true;
};

}  // namespace rbdyn::inline RBDYN_FORM
