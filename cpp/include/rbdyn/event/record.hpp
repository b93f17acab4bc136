// What a run leaves behind: pieces of motion with their modes, events, and the work done.
#pragma once

#include <cstddef>
#include <cstdint>
#include <exception>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/instant.hpp"
#include "rbdyn/basics/large_memory.hpp"
#include "rbdyn/closed_form/closed_form.hpp"
#include "rbdyn/engine/engine.hpp"
#include "rbdyn/event/event.hpp"
#include "rbdyn/event/halt.hpp"
#include "rbdyn/event/keep.hpp"
#include "rbdyn/model/hybrid.hpp"
#include "rbdyn/series/piece.hpp"

namespace rbdyn::inline RBDYN_FORM {

class Record {
public:
    struct Entry {
        Instant start;
        double unit, length;  // s; in units
        int order;
        int mode;
        std::size_t block, offset;
        bool after_event;  // begins where a mode began
    };

    double start = 0.0;
    Instant end;
    Status status = Status::reached_end;
    std::string not_finite;  // what is not finite, or has no motion, if it is known where it came up
    std::vector<Mode> modes;
    std::vector<Event> events;
    std::int64_t handed_on = 0;    // events that were there and are not kept
    std::optional<Instant> doubt;  // from there on rounding alone decided which events follow
    Work work;
    std::vector<EngineChange> changes;  // of the engine, within the run
    int variables = 0;
    std::vector<double> first_state;
    std::exception_ptr thrown;                 // by a function of the user's
    std::shared_ptr<const ClosedForm> closed;  // which then says what the state is
    double closed_from = 0.0;                  // s: when it began
    std::shared_ptr<const Halt> halt;          // what goes on from its end; none if a function of the user's threw
    // where pieces are missing: at the start of each that is kept, what no state says (HybridModel::winding)
    std::vector<std::vector<double>> windings;

    const std::vector<Entry>& entries() const { return entries_; }
    bool empty() const { return entries_.empty(); }

    Piece piece(std::size_t index) const;
    const Mode& mode(std::size_t index) const { return modes[static_cast<std::size_t>(entries_[index].mode)]; }

    void append(const Piece& piece, double length, int mode, bool after_event);
    /// Adds an event after those before it. Events of one instant, closer than rounding, have one time, and an order
    /// that is theirs and not that of the scene's text: watched functions first, then by kind, then by name.
    void note(Event event);
    /// The state at the end of the last piece.
    void last_state(std::span<double> x) const { piece(entries_.size() - 1).state(entries_.back().length, x); }
    /// Forgets all pieces but the last one, and those that hold one of some times, in ascending order.
    void keep_only(std::vector<double> times = {});
    /// Forgets all pieces.
    void clear();
    void drop_last();
    /// Forgets what was before a time within it, events at that time included: then it starts there.
    [[gnu::cold]] void drop_before(double t);

    /// The memory it takes, but for what the heap adds, in bytes.
    double bytes() const;

    /// The piece that holds time t; where two meet, the later one (after) or the earlier one (before).
    std::size_t find(double t, Side side) const;

    /// tau of time t on a piece, not outside it; the times of its ends as doubles are its ends.
    static double tau(const Piece& piece, double t);

private:
    /// Doubles that are written before they are read.
    struct Unwritten : LargeAllocator<double> {
        template <class Other>
        struct rebind {
            using other = std::conditional_t<std::is_same_v<Other, double>, Unwritten, LargeAllocator<Other>>;
        };
        template <class... From>
        void construct(double* place, const From&... from) {
            if constexpr (sizeof...(From) > 0) *place = (from, ...);
        }
    };
    using Block = std::vector<double, Unwritten>;

    // doubles in a block: never moved, for coefficients are most of what a run writes; small at first, and not so large
    // that memory comes from the system a block at a time
    static constexpr std::size_t first_block = 128, largest_block = 1 << 21;

    /// The last block, or a new one if it has no room for `count` more.
    Block& block_for(std::size_t count);

    std::vector<Entry> entries_;
    std::vector<Block> blocks_;
};

/// The index of the entry that holds time t; none if the record has no pieces. Throws InvalidInput for a time it does
/// not hold.
std::optional<std::size_t> entry_at(const Record& record, double t, Side side);

/// The state at a time.
std::vector<double> state_at(const Record& record, double t, Side side);

}  // namespace rbdyn::inline RBDYN_FORM
