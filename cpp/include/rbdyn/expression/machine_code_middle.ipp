// Definitions of rbdyn/expression/machine_code_writer.hpp: the middles of products, which are most of them.
//
// Of an even order k > 0 and of k + 1 all but what coefficient k adds is known at order k - 1. It is computed there,
// behind the sums of that order: what an order waits for, one operation for the other, leaves a processor idle
// meanwhile. There the stages of a program (schedule.hpp) are no order any more, so that products of several sums, even
// of different stages, that leave lanes empty share four lanes; coefficients are packed for that as they are laid out.
#pragma once

#include "rbdyn/expression/machine_code_writer.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "rbdyn/expression/assembler.hpp"
#include "rbdyn/expression/schedule.hpp"
#include "rbdyn/expression/series_evaluator.hpp"
#include "rbdyn/series/product_sums.hpp"

#ifdef RBDYN_WRITES_MACHINE_CODE
namespace rbdyn::inline RBDYN_FORM {

/// The lanes of a product that are not times zero, from the first to the last one of them; all four if they cannot be
/// moved.
RBDYN_INLINE MachineCodeWriter::Share MachineCodeWriter::lanes_of(const series::LaneProduct& p) const {
    constexpr int all = static_cast<int>(Schedule::lanes);
    int first = 0, last = all - 1;
    for (std::size_t i = 0; i < e_.lane_series_.size(); ++i) {
        if (e_.lane_series_[i].to != p.x) continue;
        const auto is_zero = [&](int l) {
            return e_.lane_weights_[i][static_cast<std::size_t>(l)].scalar == Schedule::zero;
        };
        while (first < last && is_zero(first)) ++first;
        while (last > first && is_zero(last)) --last;
    }
    if (first == 1) first = 0;
    return {0, first, first, last - first + 1};
}

/// Which lanes each product's middle has, and which products have them together: the widest first, each where there is
/// room.
RBDYN_INLINE void MachineCodeWriter::share_middles() {
    constexpr int all = static_cast<int>(Schedule::lanes);
    const auto& products = e_.lane_products_;
    shares_.resize(products.size());
    for (std::size_t i = 0; i < products.size(); ++i) shares_[i] = lanes_of(products[i]);
    struct Room {
        std::vector<std::size_t> products;
        int lanes;
    };
    std::vector<Room> rooms;
    for (int lanes = all; lanes > 0; --lanes)
        for (std::size_t i = 0; i < products.size(); ++i) {
            if (shares_[i].lanes != lanes) continue;
            auto room = rooms.end();
            if (lanes < all) room = std::ranges::find_if(rooms, [&](const Room& r) { return r.lanes + lanes <= all; });
            if (room == rooms.end()) room = rooms.insert(rooms.end(), {{}, 0});
            shares_[i].lane = room->lanes;
            room->lanes += lanes;
            room->products.push_back(i);
        }
    for (const Room& room : rooms) {
        Middle m{products[room.products.front()].x, products[room.products.front()].y, middles_.size(),
                 *std::ranges::max_element(room.products), -1};
        const bool is_shared = room.products.size() > 1;
        if (is_shared) m.packed = packed_++;
        for (const std::size_t i : room.products) {
            Share& share = shares_[i];
            share.middle = middles_.size();
            if (!is_shared) share = {middles_.size(), 0, 0, all};
            if (!is_shared) continue;
            packings_.push_back({products[i].x, 2 * m.packed, share});
            packings_.push_back({products[i].y, 2 * m.packed + 1, share});
        }
        middles_.push_back(m);
    }
}

RBDYN_INLINE std::size_t MachineCodeWriter::room_for_middles() const {
    return static_cast<std::size_t>(in_packed(2 * packed_) / 32) + 1;
}

/// The lanes of a product in its middle: those of its own, with others' beside them.
RBDYN_INLINE MachineCodeWriter::At MachineCodeWriter::middle_of(const Share& share, int part) const {
    return {machine_code::Register::r11,
            in_middles(share.middle) + 32 * part + 8 * static_cast<std::ptrdiff_t>(share.lane - share.first)};
}

/// Newest coefficients, laid out in a register, to where middles read them.
RBDYN_INLINE void MachineCodeWriter::pack(const series::LaneValues* series, Vector from) {
    using enum machine_code::Register;
    bool is_first = true;
    for (const Packing& p : packings_) {
        if (p.series != series) continue;
        if (is_first) {
            c_.move(cx, r12);
            c_.subtract(cx, r13);
            c_.add(cx, r11);
            is_first = false;
        }
        const At low{cx, in_packed(p.packed) + 8 * static_cast<std::ptrdiff_t>(p.share.lane)},
            high{cx, low.distance + 16};
        Vector lanes = from;
        if (p.share.first == 2 && p.share.lanes == 2) {
            c_.upper_half(low, lanes);
            continue;
        }
        if (p.share.first >= 2) {
            c_.upper_half(1, from);
            lanes = 1;
        }
        if (p.share.first == 3) {
            c_.store_high(low, lanes);
        } else if (p.share.lanes == 1) {
            c_.store(low, lanes);
        } else {
            c_.store_two(low, lanes);
            if (p.share.lanes == 2) continue;
            c_.upper_half(1, from);
            c_.store(high, 1);
        }
    }
}

/// Where the middles of the even order to come are: of 64 bytes each pair (middle()), so many are passed over.
RBDYN_INLINE void MachineCodeWriter::set_middles() {
    using enum machine_code::Register;
    if (repetition_ == nullptr) c_.move(r11, At{di, offsetof(Frame, middles)});
    if (order_ != (are_ahead() ? Order::odd : Order::even)) return;
    c_.move(r10, static_cast<std::uint64_t>(64 * pairs()));
    c_.move(cx, r8);
    if (are_ahead()) c_.add(cx, 1);
    c_.compare(cx, At{di, offsetof(Frame, end)});
    const std::size_t past = c_.jump_if(Assembler::When::at_least);
    c_.shift_right(cx, 1);
    c_.add(cx, -1);
    c_.shift_left(cx, 6);
    c_.subtract(r10, cx);
    c_.land(past);
    c_.address(ax, At{r13, 64});
    c_.subtract(ax, r10);
    c_.address(dx, At{r12, before_middle()});
    c_.add(dx, r10);
}

/// Of the even order after this one, or of this one if it is even. In a and b what it adds to that order, in c and d to
/// the next one.
RBDYN_INLINE void MachineCodeWriter::middle(const Middle& m) {
    using enum machine_code::Register;
    constexpr Vector a = 0, b = 1, c = 2, d = 3, even = 4, odd = 5, product = 6, above = 7;
    const bool is_packed = m.packed >= 0;
    const std::ptrdiff_t x = is_packed ? in_packed(2 * m.packed) : in_lanes(m.x),
                         y = is_packed ? in_packed(2 * m.packed + 1) : in_lanes(m.y);
    // what is packed is elsewhere
    const auto go = [&](Register from, Register to) {
        for (const Register r : {ax, dx}) {
            c_.add(r, to);
            c_.subtract(r, from);
        }
    };
    if (is_packed) {
        go(r13, r11);
        c_.move(di, r12);
        c_.subtract(di, r13);
        c_.add(di, r11);
    }
    c_.load_four(above, At{is_packed ? di : r12, y + before_middle()});
    c_.multiply_four(b, above, At{is_packed ? r11 : r13, x + 32});
    for (const Vector sum : {a, c, d}) c_.clear(sum);
    if (pairs() > 0) {
        const std::size_t start = c_.place(cx);
        c_.add(cx, r10);
        c_.jump(cx);
        c_.land(start);
    }
    for (int i = 0; i < pairs(); ++i) {
        const auto left = [&](int by) { return Assembler::far({ax, x + 64 * i + 32 * by}); };
        const auto right = [&](int by) { return Assembler::far({dx, y - 64 * i - 32 * by}); };
        c_.load_four(even, left(0));
        c_.multiply_four(product, even, right(1));
        c_.add_four(a, a, product);
        c_.multiply_four(product, even, above);
        c_.add_four(c, c, product);
        c_.load_four(odd, left(1));
        c_.load_four(above, right(2));
        c_.multiply_four(product, odd, above);
        c_.add_four(b, b, product);
        c_.multiply_four(product, odd, right(1));
        c_.add_four(d, d, product);
    }
    if (!are_ahead()) return;
    for (const Vector sum : {a, b, c, d}) c_.store_four(At{r11, in_middles(m.index) + 32 * sum}, sum);
    if (is_packed) go(r11, r13);
}

}  // namespace rbdyn::inline RBDYN_FORM
#endif
