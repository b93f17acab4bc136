// Definitions of rbdyn/event/record.hpp.
#pragma once

#include "rbdyn/event/record.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "rbdyn/basics/double_double_functions.hpp"
#include "rbdyn/basics/error.hpp"
#include "rbdyn/basics/instant.hpp"
#include "rbdyn/closed_form/closed_form.hpp"
#include "rbdyn/event/event.hpp"
#include "rbdyn/series/lanes.hpp"
#include "rbdyn/series/piece.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE Piece Record::piece(std::size_t index) const {
    const Entry& e = entries_[index];
    return {e.start, e.unit, e.length, variables, e.order, blocks_[e.block].data() + e.offset, e.order + 1};
}

RBDYN_INLINE void Record::append(const Piece& piece, double length, int mode, bool after_event) {
    const auto row = static_cast<std::size_t>(piece.order + 1), count = static_cast<std::size_t>(variables) * row;
    Block& block = block_for(count);
    const std::size_t offset = block.size();
    block.resize(offset + count);
    double* to = block.data() + offset;
    if (piece.stride == 0 || piece.stride == piece.order + 1) {
        std::copy_n(piece.coefficients, count, to);
    } else {
        // rows are too short for a call each
        for (int i = 0; i < variables; ++i, to += row) {
            const double* const from = piece.variable(i);
            std::size_t k = 0;
            for (; k + 2 <= row; k += 2) series::set_pair(to + k, series::pair_at(from + k));
            if (k < row) to[k] = from[k];
        }
    }
    entries_.push_back({piece.start, piece.unit, length, piece.order, mode, blocks_.size() - 1, offset, after_event});
}

RBDYN_INLINE void Record::note(Event event) {
    const auto is_together = [&](const Event& e) {
        return event.instant - e.instant <= 8.0 * std::numeric_limits<double>::epsilon() * std::abs(event.time);
    };
    auto place = events.end();
    // bounces that are left out end later than the instant from which they are
    while (place != events.begin() && std::prev(place)->instant - event.instant >
                                          8.0 * std::numeric_limits<double>::epsilon() * std::abs(event.time))
        --place;
    if (place != events.begin() && is_together(*std::prev(place))) {
        event.instant = std::prev(place)->instant;
        event.time = event.instant.hi;
    }
    while (place != events.begin() && is_together(*std::prev(place)) && comes_before(event, *std::prev(place))) --place;
    events.insert(place, std::move(event));
}

RBDYN_INLINE void Record::keep_only(std::vector<double> times) {
    std::sort(times.begin(), times.end());
    const std::vector<Entry> entries = std::exchange(entries_, {});
    const std::vector<Block> blocks = std::exchange(blocks_, {});
    const std::vector<std::vector<double>> all = std::exchange(windings, {});
    for (std::size_t i = 0; i < entries.size(); ++i) {
        const Entry& e = entries[i];
        const Piece piece{e.start,    e.unit, e.length, variables, e.order, blocks[e.block].data() + e.offset,
                          e.order + 1};
        const auto wanted = std::lower_bound(times.begin(), times.end(), e.start.hi);
        const bool is_wanted = wanted != times.end() && *wanted <= piece.at(e.length).hi;
        if (!is_wanted && i + 1 < entries.size()) continue;
        append(piece, e.length, e.mode, e.after_event);
        if (i < all.size() && !times.empty()) windings.push_back(all[i]);
    }
}

RBDYN_INLINE void Record::clear() {
    entries_.clear();
    if (blocks_.size() > 1) blocks_.erase(blocks_.begin(), blocks_.end() - 1);
    if (!blocks_.empty()) blocks_.back().clear();
}

RBDYN_INLINE void Record::drop_last() {
    blocks_[entries_.back().block].resize(entries_.back().offset);
    blocks_.resize(entries_.back().block + 1);
    entries_.pop_back();
    if (windings.size() > entries_.size()) windings.resize(entries_.size());
}

RBDYN_INLINE void Record::drop_before(double t) {
    if (t <= start || modes.empty()) return;
    Record rest = *this;
    rest.clear();
    rest.windings.clear();
    rest.start = std::min(t, end.hi);
    rest.first_state = state_at(*this, rest.start, Side::after);
    if (!empty()) {
        for (std::size_t i = t < end.hi ? find(t, Side::after) : entries_.size() - 1; i < entries_.size(); ++i) {
            // a piece that was before the others which were kept
            const Piece whole = piece(i);
            if (entries_.size() > 1 && whole.at(whole.length).hi < t) continue;
            rest.append(whole, entries_[i].length, entries_[i].mode, entries_[i].after_event);
            if (i < windings.size()) rest.windings.push_back(windings[i]);
        }
    }
    std::erase_if(rest.events, [&](const Event& e) { return e.time <= t; });
    *this = std::move(rest);
}

RBDYN_INLINE double Record::bytes() const {
    const auto size = [](const auto& all) { return static_cast<double>(all.size() * sizeof(all[0])); };
    double sum = size(entries_) + size(events) + size(modes) + size(windings);
    for (const Block& block : blocks_) sum += size(block);
    if (!windings.empty()) sum += static_cast<double>(windings.size()) * size(windings.back());
    if (!modes.empty()) {
        const Mode& m = modes.back();
        sum += static_cast<double>(modes.size()) * (size(m.slip) + size(m.parameters) + size(m.memory));
    }
    return sum;
}

RBDYN_INLINE std::size_t Record::find(double t, Side side) const {
    // pieces shorter than the spacing of times may begin where the motion ends
    if (t >= end.hi && !entries_.empty()) return entries_.size() - 1;
    const auto later = [&](double time, const Entry& e) {
        return side == Side::after ? time < e.start.hi : time <= e.start.hi;
    };
    auto it = std::upper_bound(entries_.begin(), entries_.end(), t, later);
    return it == entries_.begin() ? 0 : static_cast<std::size_t>(it - entries_.begin()) - 1;
}

RBDYN_INLINE double Record::tau(const Piece& piece, double t) {
    if (t == piece.at(piece.length).hi) return piece.length;
    if (t == piece.start.hi) return 0.0;
    return std::clamp(piece.tau(t), 0.0, piece.length);
}

RBDYN_INLINE Record::Block& Record::block_for(std::size_t count) {
    if (blocks_.empty() || blocks_.back().capacity() - blocks_.back().size() < count) {
        const std::size_t next = blocks_.empty() ? first_block : 4 * blocks_.back().capacity();
        blocks_.emplace_back().reserve(std::max(count, std::min(next, largest_block)));
    }
    return blocks_.back();
}

RBDYN_INLINE std::optional<std::size_t> entry_at(const Record& record, double t, Side side) {
    // a time computed from the end may be its neighbour
    const double near = 4.0 * std::numeric_limits<double>::epsilon() * std::abs(record.end.hi);
    if (!(t >= record.start - near && t <= record.end.hi + near))
        throw InvalidInput("Trajectory: time is " + text(t) + "; this run goes from " + text(record.start) + " to " +
                           text(record.end.hi) + " s");
    if (record.modes.empty()) throw InvalidInput("Trajectory: this run broke off before its start and has no motion");
    if (record.empty() || (record.closed && record.modes.size() == 1)) return std::nullopt;
    // the state at the start is kept always
    if (t <= record.start && t < record.piece(0).start.hi) return std::nullopt;
    const std::size_t index = record.find(t, side);
    const Piece piece = record.piece(index);
    const double rounding = 4.0 * std::numeric_limits<double>::epsilon() * std::abs(t);
    if (const double gap = t - piece.start;
        gap < -std::max(rounding, near) || gap > piece.duration() + std::max(rounding, near)) {
        // a closed form has every time, and one way to move
        if (record.closed) return std::nullopt;
        throw InvalidInput("Trajectory: time is " + text(t) + "; this run kept other times only (keep=)");
    }
    return index;
}

RBDYN_INLINE std::vector<double> state_at(const Record& record, double t, Side side) {
    const auto index = entry_at(record, t, side);
    std::vector<double> x(static_cast<std::size_t>(record.variables));
    if (record.closed) {
        record.closed->state(exact_difference({t, 0.0}, {record.closed_from, 0.0}), x);
        return x;
    }
    if (!index) return record.first_state;
    const Piece piece = record.piece(*index);
    piece.state(Record::tau(piece, t), x);
    return x;
}

}  // namespace rbdyn::inline RBDYN_FORM
