// Where the series lie that the chunks of a skewed row make (wavefront.hpp), for one who looks at states and outputs
// alone.
//
// A chunk's own series are read by its neighbours, and until its last order is computed, so many fronts after its first
// one. From then on nobody looks at them: a chunk so many chunks later has its own in their places. What goes through
// memory once a step is then the state, and outputs, which are copied where they stay when a chunk is done; all else
// stays in the second cache.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/expression/program.hpp"
#include "rbdyn/expression/schedule.hpp"
#include "rbdyn/expression/wavefront.hpp"

namespace rbdyn::inline RBDYN_FORM {

class SlotRing {
public:
    /// Of a row that is cut into chunks, whose orders 0 .. `top` are run through so that a chunk is done `behind`
    /// chunks before one that begins. `rows`: room for the series of each slot, in doubles. None where it would not be
    /// much less than that of all.
    static std::unique_ptr<const SlotRing> of(const Program& program, const Schedule& schedule,
                                              const Wavefront& wavefront, int top, std::size_t behind,
                                              std::span<const int> rows);

    /// Where the series of a slot are computed, in doubles.
    std::ptrdiff_t place(int slot) const { return places_[static_cast<std::size_t>(slot)]; }
    /// Where they stay; -1: nowhere.
    std::ptrdiff_t kept(int slot) const { return kept_[static_cast<std::size_t>(slot)]; }
    /// All of it; from `begin` on it is what chunks share.
    std::ptrdiff_t size() const { return size_; }
    std::ptrdiff_t begin() const { return begin_; }
    std::size_t bytes() const {
        return (places_.size() + kept_.size() + copies_before_.size()) * sizeof places_[0] +
               copies_.size() * sizeof copies_[0];
    }
    /// After so many chunks places are the same again.
    std::size_t period() const { return period_; }

    struct Copy {
        std::ptrdiff_t from, to;
    };
    /// What stays of a chunk's series.
    std::span<const Copy> copies(std::size_t chunk) const {
        return std::span(copies_).subspan(copies_before_[chunk], copies_before_[chunk + 1] - copies_before_[chunk]);
    }

private:
    SlotRing() = default;

    std::vector<std::ptrdiff_t> places_, kept_;
    std::vector<Copy> copies_;
    std::vector<std::size_t> copies_before_{0};  // by chunk
    std::ptrdiff_t begin_ = 0, size_ = 0;
    std::size_t period_ = 0;
};

}  // namespace rbdyn::inline RBDYN_FORM
