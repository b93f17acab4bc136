// In which order the orders of a series are computed where a program is larger than the caches.
//
// Order after order through all instructions, each order fetches every series from memory. A body of a chain needs its
// neighbours alone: its coefficients k need those below k of the bodies beside it. So the instructions are put in a
// row, along the chain, and the row is cut into chunks, each so long that no instruction needs more of the order before
// than the next chunk has. Order k then runs one chunk behind order k - 1, and finds at hand what that has left (time
// skewing: Wolf, "More iteration space tiling", Supercomputing 1989; Wonnacott, International Journal of Parallel
// Programming 30, 2002). Sums keep their lanes, and each instruction computes what it always does from the same
// numbers: the same bits.
//
// Each acceleration of bodies that are joined is made of those of all others, so that an order has to be whole before
// the next one begins. The row is cut all the same: what an instruction reads is then written just before, at the same
// order, and the series of its products follow one another in memory (streamed_series.hpp).
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/expression/program.hpp"
#include "rbdyn/expression/schedule.hpp"

namespace rbdyn::inline RBDYN_FORM {

/// A schedule cut into chunks along its program.
class Wavefront {
public:
    /// Stages, and places of `inputs` whose next coefficients come of the rates that are known then.
    struct Chunk {
        Schedule::Range stages, inputs;
    };

    /// Of a program whose output i is the derivative of input i. Leaves the schedule as it is, and no chunks, if there
    /// would be one alone. `fewest`: a row that repeats itself in so many chunks is worth to be skewed, however short
    /// it is (0: none is); `is_large`: whether others are worth to be cut.
    Wavefront(const Program& program, Schedule& schedule, int order, std::size_t fewest = 0, bool is_large = true);

    std::vector<Chunk> chunks;
    std::vector<int> inputs;
    /// Whether chunk c is computed at order k when c + k is next, of these the lowest order first; else order after
    /// order through all chunks, for orders 0 .. `order` would be at work on too much of them at a time.
    bool is_skewed = false;

private:
    /// A sum with what comes with it, another instruction, or an input.
    struct Part {
        enum class Kind : std::uint8_t { sum, other, input } kind;
        std::uint32_t stage, index;
        std::uint32_t key;  // the last instruction that it has, or that what it needs has
    };

    /// All parts, what is needed before what needs it.
    static std::vector<Part> parts_of(const Program& program, const Schedule& schedule);
    /// After so many parts others of the same kinds follow, again and again; 0: they do not.
    static std::size_t period(const Schedule& schedule, const std::vector<Part>& row);
    /// By how many places an input comes behind one who needs it, at most.
    static std::size_t reach(const Program& program, const Schedule& schedule, const std::vector<Part>& row);
    /// Takes a schedule's lists apart and puts them together again, chunk by chunk.
    void cut(const std::vector<Part>& row, std::size_t length, Schedule& schedule);

    // instructions of a chunk share the price of going from one to the next
    static constexpr std::size_t shortest = 64, shortest_alike = 32;
    static constexpr std::size_t part_at_work = 2;
    // of a period: code of a chunk is to stay in the first cache
    static constexpr std::size_t longest = 256;
    // of a row that is cut for what is read soon alone
    static constexpr std::size_t plain = 256;
};

}  // namespace rbdyn::inline RBDYN_FORM
