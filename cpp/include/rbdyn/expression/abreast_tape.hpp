// What SeriesAbreast computes: the instructions of a program laid out for vectors.
#pragma once

#include <array>
#include <cstddef>
#include <utility>
#include <vector>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/expression/program.hpp"

namespace rbdyn::inline RBDYN_FORM::abreast {

class AbreastCode;  // abreast_code.hpp

/// What is computed at each order, in its order: stage by stage, and in a stage one kind after the other. Where things
/// are is said in bytes from the first one on: of a series its coefficient 0.
struct Tape {
    static constexpr std::size_t most = 8;  // lanes
    using Place = std::ptrdiff_t;

    /// A series times a weight.
    struct Scale {
        Place out, a, weight;
    };
    /// A product, and the place of its part of a sum. Those of two with a factor in common are side by side.
    struct Product {
        Place x, y, part;
    };
    struct Pair {
        Place x, z, y, part;
    };
    /// Of products [first, last); `series`: it is one by itself.
    struct Sum {
        Place first, last, out;
        bool is_series;
    };
    /// A constant, multiples of series and sums.
    struct Multiple {
        Place series, weight;
    };
    struct Combination {
        Place out, constant;  // -1: none
        Place first, last, first_sum, last_sum;
    };
    struct Other {
        Code code;
        Place out, out2, a, b, c, slope;  // 0 of those that it has not
        Place weight;
        double value;
        bool is_raised;  // of an exponential: it is b ^ c
    };
    struct Ends {
        std::size_t scales = 0, singles = 0, pairs = 0, sums = 0, combinations = 0, others = 0;
    };
    struct alignas(64) Block {
        double lanes[most];
    };
    /// Of some inputs together, by order.
    struct Sizes {
        int first = 0, count = 0;
        std::vector<Block> values;
        Block log_step{}, is_known{};  // of the steps that they allow; bits other than zero where that is known
        bool has_steps = false;
    };

    /// The lanes of all blocks, one behind the other.
    static double* lanes_of(std::vector<Block>& blocks) { return reinterpret_cast<double*>(blocks.data()); }
    static const double* lanes_of(const std::vector<Block>& blocks) {
        return reinterpret_cast<const double*>(blocks.data());
    }

    std::vector<Scale> scales;
    std::vector<Product> products, singles;
    std::vector<Pair> pairs;
    std::vector<Sum> sums;
    std::vector<Multiple> multiples;
    std::vector<Combination> combinations;
    std::vector<Other> others;
    std::vector<Ends> stages;                     // where each of them ends
    std::vector<std::pair<Place, Place>> motion;  // an input and its rate
    std::vector<Place> outputs;                   // all, also switches
    int rows = 0, sum_count = 0, part_count = 0;
    Place vector = 0, stride = 0, time = -1;  // bytes of a vector, of a series
    // vectors one after the other, whatever their width
    std::vector<Block> cells, sum, next, weights, part, next_part;
    Block t{}, unit{}, check{};
    std::array<bool, most> begins_at_zero{};  // a norm
    std::vector<Sizes> all_sizes;
    Block places{};  // of these increments
    std::vector<Block> increments_there, powers;
    std::size_t known_sizes = 0;  // those of the expansion
    /// By weight: what is one or minus one in the program; 0: anything.
    std::vector<signed char> ones;
    void (*run)(Tape&, int order, bool whole, const AbreastCode* code) = nullptr;
    /// The sizes of `count` series together, from the one at a place on: by order.
    void (*sizes)(Tape&, Place first, int count, int order, Block* out) = nullptr;
    /// How long steps may be by these sizes.
    void (*log_steps)(Sizes&, int order, const Block& scale, const Block& log_tolerance) = nullptr;
    /// What each of the first `count` series adds up to from its coefficient 1 on, at a place of each motion's own.
    void (*increments)(Tape&, int count, int order, const Block& place, Block* out) = nullptr;
    /// A series' coefficients to a row of each motion; those without one are left out.
    void (*to_rows)(Tape&, Place series, int count, double* const* to) = nullptr;
    /// Coefficient k of what one of the others gives.
    void (*instruct)(Tape&, const Other&, int k) = nullptr;

    template <class Lanes>
    static Lanes* in(std::vector<Block>& blocks) {
        return reinterpret_cast<Lanes*>(blocks.data());
    }
    template <class Lanes>
    static Lanes& in(Block& block) {
        return reinterpret_cast<Lanes&>(block);
    }
};

/// Lists what a program computes, in the order of SeriesEvaluator, on a tape whose vectors and series have their sizes.
void write(const Program& program, Tape& tape);

}  // namespace rbdyn::inline RBDYN_FORM::abreast
