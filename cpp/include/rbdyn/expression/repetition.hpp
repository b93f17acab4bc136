// Where the row of a program's chunks (wavefront.hpp) repeats itself: chunks of the same instructions, whose places are
// those of one of them, moved.
//
// The bodies of a chain are computed alike. Slots of one kind lie as far from one chunk to the next as they all do:
// those that chunks make, inputs, and what is the same for all. So an operand is a distance from where one of a few
// kinds begins, the same in each chunk. Weights are looked up in a table, for bodies may differ in them.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/expression/series_evaluator.hpp"

namespace rbdyn::inline RBDYN_FORM {

class Repetition {
public:
    static constexpr std::size_t kinds = 3;  // of slots

    /// Of an evaluator whose program is cut into chunks.
    explicit Repetition(const SeriesEvaluator& series);

    /// The chunk that others are like.
    std::size_t model() const { return model_; }
    /// How many chunks are like it, itself among them.
    std::size_t count() const { return count_; }

    /// Where a chunk's own begin: slots by kind and lanes in bytes, sums, steps, states and weights in places.
    struct Chunk {
        std::array<std::ptrdiff_t, kinds> slots;
        std::ptrdiff_t lanes, sums, steps, states, weights;
    };
    /// None of chunks that are unlike.
    const Chunk* chunk(std::size_t c) const { return is_like_[c] != 0 ? &chunks_[c] : nullptr; }

    /// Asks for what a chunk's slots are in, if it is like the model.
    void fetch(std::size_t c, const double* storage) const;

    /// Of a place in the storage [bytes], in the model's slots: which kind it is and how far from where that begins.
    std::pair<std::size_t, std::ptrdiff_t> slot(std::ptrdiff_t place) const;
    /// By what holds a weight (a term, a combination, a series in lanes): its place in the table; none: it is 1 or -1.
    std::optional<std::ptrdiff_t> weight(const void* holder) const;

    /// The table for a program's scalars.
    void write_table(std::span<const double> scalars, std::vector<double>& table) const;

private:
    enum class Unless : std::uint8_t { never, one, one_or_minus };
    /// Looked up unless it is such a constant.
    struct Weight {
        int scalar;
        const void* holder;
        Unless unless;
    };
    /// What a chunk is like.
    struct Shape {
        std::vector<std::int64_t> tokens;
        std::vector<std::ptrdiff_t> slots, lanes, states;
        std::vector<Weight> weights;
        std::ptrdiff_t sums = -1, steps = -1;  // the first ones

        void clear();
    };
    void write(const SeriesEvaluator& series, std::size_t chunk, Shape& shape) const;
    /// Tells kinds of slots from how they move from the model to the next chunk; whether there are no more than
    /// `kinds`.
    bool tell_kinds(const Shape& model, const Shape& next);
    /// Which lines of a cache the model's slots before a place are in.
    void tell_lines(std::ptrdiff_t row, std::ptrdiff_t end);
    /// Whether slots of two kinds, moved by so much against one another, are the same.
    bool meet(std::size_t a, std::size_t b, std::ptrdiff_t by) const;
    /// Where its own begin, if a chunk is like the model.
    std::optional<Chunk> like(const Shape& model, const Shape& other) const;

    std::size_t model_, count_ = 0;
    std::vector<char> is_like_;
    std::vector<Chunk> chunks_;
    std::map<std::ptrdiff_t, std::size_t> kind_of_;           // by the beginning of a slot of the model
    std::vector<std::size_t> kind_at_;                        // by its slots in the order of a shape
    std::array<std::ptrdiff_t, kinds> begin_{};               // the model's
    std::array<std::vector<std::ptrdiff_t>, kinds> of_kind_;  // slots of the model, in ascending order
    std::array<std::vector<std::ptrdiff_t>, kinds> lines_;    // of a cache, in bytes from where each kind begins
    std::map<const void*, std::ptrdiff_t> weight_of_;
    std::vector<int> table_;  // scalars, row after row; or what Schedule says of one and zero
};

}  // namespace rbdyn::inline RBDYN_FORM
