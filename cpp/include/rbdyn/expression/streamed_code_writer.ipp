// Definitions of rbdyn/expression/streamed_code_writer.hpp.
#pragma once

#include "rbdyn/expression/streamed_code_writer.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include "rbdyn/expression/assembler.hpp"
#include "rbdyn/expression/code_memory.hpp"
#include "rbdyn/expression/program.hpp"
#include "rbdyn/expression/series_evaluator.hpp"
#include "rbdyn/expression/stream_kinds.hpp"
#include "rbdyn/expression/streamed_code.hpp"
#include "rbdyn/expression/streamed_series.hpp"

#ifdef RBDYN_WRITES_MACHINE_CODE
namespace rbdyn::inline RBDYN_FORM {

namespace streamed_codes {

inline constexpr machine_code::Register saved[] = {machine_code::Register::bx,  machine_code::Register::bp,
                                                   machine_code::Register::r12, machine_code::Register::r13,
                                                   machine_code::Register::r14, machine_code::Register::r15};
// in bytes
inline constexpr std::ptrdiff_t number = sizeof(double), lanes = sizeof(series::LaneValues), line = 2 * lanes,
                                operand = sizeof(StreamKinds::Index);

}  // namespace streamed_codes

RBDYN_INLINE std::ptrdiff_t StreamedCodeWriter::row() const {
    return streamed_codes::line * static_cast<std::ptrdiff_t>(e_.stream_->row_);
}

RBDYN_INLINE bool StreamedCodeWriter::takes(const SeriesEvaluator& e) {
    const auto most = static_cast<std::size_t>(std::numeric_limits<std::int32_t>::max());
    return e.stream_->row_ < most / streamed_codes::line / (static_cast<std::size_t>(e.top_) / 2 + 2);
}

RBDYN_INLINE std::span<const std::uint8_t> StreamedCodeWriter::write() {
    begin();
    const std::size_t at_end = c_.size();
    end();
    const std::size_t at_left = c_.size();
    left();
    for (const Order order : {Order::first, Order::odd, Order::even}) {
        order_ = order;
        std::vector<std::size_t>& pieces = pieces_[static_cast<std::size_t>(order)];
        pieces = {at_end, at_left};
        for (const StreamKinds::Kind& kind : kinds_.kinds()) {
            pieces.push_back(c_.size());
            if (kind.has_code) piece(kind);
            if (c_.size() > CodeMemory::most) return c_.bytes();
        }
    }
    for (int k = 0; k <= e_.top_; ++k) {
        products_.push_back(c_.size());
        if (k % 2 == 0) product(k);
        quotients_.push_back(c_.size());
        quotient(k);
        sines_.push_back(c_.size());
        if (k > 0) sine(k);
    }
    return c_.bytes();
}

RBDYN_INLINE void StreamedCodeWriter::begin() {
    using enum machine_code::Register;
    for (const Register r : streamed_codes::saved) c_.push(r);
    c_.push(di);
    c_.move(bx, At{di, offsetof(Frame, made)});
    c_.move(bp, At{di, offsetof(Frame, line)});
    c_.move(r12, At{di, offsetof(Frame, operand)});
    c_.move(r13, At{di, offsetof(Frame, next)});
    c_.move(r14, At{di, offsetof(Frame, product)});
    c_.move(r15, At{di, offsetof(Frame, lines)});
    load();
    go_on();
}

/// What does not outlive a call.
RBDYN_INLINE void StreamedCodeWriter::load() {
    using enum machine_code::Register;
    c_.move(ax, At{sp, 0});
    c_.move(di, At{ax, offsetof(Frame, now)});
    c_.move(r9, At{ax, offsetof(Frame, newest)});
    c_.address(r11, At{r9, 0});
    c_.add(r11, r15);
    c_.move(si, At{ax, offsetof(Frame, scalars)});
    c_.move(r8, At{ax, offsetof(Frame, weights)});
    c_.clear(zero);
}

/// To the next stage.
RBDYN_INLINE void StreamedCodeWriter::go_on() {
    using enum machine_code::Register;
    c_.move_short(ax, At{r12, 0});
    c_.move(cx, At{sp, 0});
    c_.move(cx, At{cx, offsetof(Frame, pieces)});
    c_.move(ax, At{cx, 0, false, ax});
    c_.add(r12, static_cast<std::int32_t>(streamed_codes::operand));
    c_.jump(ax);
}

RBDYN_INLINE void StreamedCodeWriter::end() {
    using enum machine_code::Register;
    c_.leave_four();
    c_.pop(di);
    c_.move(At{di, offsetof(Frame, made)}, bx);
    c_.move(At{di, offsetof(Frame, line)}, bp);
    c_.move(At{di, offsetof(Frame, operand)}, r12);
    c_.move(At{di, offsetof(Frame, next)}, r13);
    for (auto r = std::rbegin(streamed_codes::saved); r != std::rend(streamed_codes::saved); ++r) c_.pop(*r);
    c_.leave();
}

/// A stage by the lists.
RBDYN_INLINE void StreamedCodeWriter::left() {
    using enum machine_code::Register;
    c_.move(di, At{sp, 0});
    c_.move(At{di, offsetof(Frame, made)}, bx);
    c_.move(At{di, offsetof(Frame, line)}, bp);
    c_.move(At{di, offsetof(Frame, next)}, r13);
    c_.move_short(si, At{r12, 0});
    call(reinterpret_cast<std::uint64_t>(&StreamedCode::stage));
    c_.move(di, At{sp, 0});
    c_.move(bx, At{di, offsetof(Frame, made)});
    c_.move(bp, At{di, offsetof(Frame, line)});
    c_.move(r12, At{di, offsetof(Frame, operand)});
    c_.move(r13, At{di, offsetof(Frame, next)});
    load();
    go_on();
}

RBDYN_INLINE void StreamedCodeWriter::call(std::uint64_t function) {
    c_.leave_four();
    c_.move(Register::ax, function);
    c_.call(Register::ax);
}

RBDYN_INLINE void StreamedCodeWriter::operand(Register to) {
    c_.move_short(to, At{Register::r12, streamed_codes::operand * read_++});
}

RBDYN_INLINE StreamedCodeWriter::At StreamedCodeWriter::line_of_order(Index line) const {
    return {Register::bp, streamed_codes::line * line + (order_ == Order::odd ? streamed_codes::lanes : 0), false,
            Register::r9};
}

RBDYN_INLINE void StreamedCodeWriter::piece(const StreamKinds::Kind& kind) {
    using enum machine_code::Register;
    using namespace streamed_codes;
    const Index* token = kind.shape.data();
    const Index laid_out = token[0], spreads = token[1], sums = token[2], lane_count = token[3],
                combinations = token[4], steps = token[5];
    token += 6;
    read_ = 0;
    for (Index i = 0; i < laid_out; ++i) series(*token++, i);
    for (Index i = 0; i < spreads; ++i) spread(laid_out + i);
    // operands of combinations come after those of all sums
    std::vector<std::span<const Index>> products;
    std::ptrdiff_t next_operand = read_;
    for (Index s = 0; s < sums; ++s) {
        products.emplace_back(token + 1, 2 * static_cast<std::size_t>(*token));
        token += 1 + products.back().size();
        next_operand += std::ranges::count(products.back(), StreamKinds::elsewhere);
    }
    std::vector<Lane> copied;
    for (Index i = 0; i < lane_count; ++i) copied.push_back({*token++, i});
    std::vector<Combination> combined;
    for (Index i = 0; i < combinations; ++i) {
        Combination c{token[0] != 0, {token + 2, token[1]}, 0, 0, lane_count + i, next_operand};
        token += 2 + c.terms.size();
        c.lanes = *token++;
        c.first_lane = *token++;
        next_operand += (c.has_constant ? 1 : 0) + static_cast<std::ptrdiff_t>(c.terms.size()) +
                        std::ranges::count(c.terms, StreamKinds::any);
        combined.push_back(c);
    }
    for (Index s = 0; s < sums; ++s) {
        sum(products[s], s);
        const Index first = lanes_of_sum * s, last = first + lanes_of_sum;
        for (const Lane& l : copied)
            if (l.lane >= first && l.lane < last) copy(l.lane - first, l.place);
        for (const Combination& c : combined)
            if (c.lanes > 0 && c.first_lane >= first && c.first_lane < last) combination(c);
    }
    for (const Combination& c : combined)
        if (c.lanes == 0) combination(c);
    read_ = next_operand;
    const auto go = [this](Register r, std::ptrdiff_t by) {
        if (by != 0) c_.add(r, static_cast<std::int32_t>(by));
    };
    go(bx, number * (lane_count + combinations));
    go(bp, line * (laid_out + spreads));
    go(r13, lanes * sums);
    for (Index i = 0; i < steps; ++i) step(static_cast<Code>(*token++));
    go(r12, streamed_codes::operand * std::max<std::ptrdiff_t>(read_, 1));
    go_on();
}

RBDYN_INLINE void StreamedCodeWriter::series(Index bits, Index line) {
    using enum machine_code::Register;
    const auto value = [this] {
        operand(ax);
        return At{di, 0, false, ax};
    };
    const auto pair = [&](Vector to, bool are_same) {
        if (are_same) return c_.load_twice(to, value());
        c_.load(to, value());
        c_.load_high(to, to, value());
    };
    const bool low_same = (bits & StreamKinds::are_low_same) != 0,
               halves_same = (bits & StreamKinds::are_halves_same) != 0;
    if (low_same && halves_same) {
        c_.spread(0, value());
    } else {
        pair(0, low_same);
        if (!halves_same) pair(1, (bits & StreamKinds::are_high_same) != 0);
        c_.join(0, 0, halves_same ? 0 : 1);
    }
    if ((bits & StreamKinds::is_weighted) != 0) {
        operand(ax);
        c_.multiply_four(0, 0, At{r8, 0, false, ax});
    }
    c_.store_four(line_of_order(line), 0);
}

RBDYN_INLINE void StreamedCodeWriter::spread(Index line) {
    using enum machine_code::Register;
    operand(ax);
    c_.spread(0, At{di, 0, false, ax});
    c_.store_four(line_of_order(line), 0);
}

RBDYN_INLINE StreamedCodeWriter::Factor StreamedCodeWriter::factor(Index line, Register in) {
    using enum machine_code::Register;
    if (line != StreamKinds::elsewhere) return {At{bp, streamed_codes::line * line}, line_of_order(line)};
    operand(in);
    return {At{r15, 0, false, in}, At{r11, order_ == Order::odd ? streamed_codes::lanes : 0, false, in}};
}

RBDYN_INLINE void StreamedCodeWriter::sum(std::span<const Index> products, Index index) {
    using enum machine_code::Register;
    const At next{r13, streamed_codes::lanes * index};
    if (order_ == Order::odd) {
        c_.load_four(sum_lanes, next);
    } else {
        c_.clear(sum_lanes);
        c_.clear(next_lanes);
    }
    for (std::size_t i = 0; i < products.size(); i += 2) {
        const Factor x = factor(products[i], ax), y = factor(products[i + 1], dx);
        switch (order_) {
            case Order::first:
                c_.load_four(0, x.first);
                c_.multiply_four(0, 0, y.first);
                c_.add_four(sum_lanes, sum_lanes, 0);
                break;
            case Order::odd:
                c_.load_four(0, x.first);
                c_.multiply_four(0, 0, y.newest);
                c_.load_four(1, x.newest);
                c_.multiply_four(1, 1, y.first);
                c_.add_four(0, 0, 1);
                c_.add_four(sum_lanes, sum_lanes, 0);
                break;
            case Order::even:
                c_.address(ax, x.first);
                c_.address(dx, y.first);
                c_.call(r14);
                break;
        }
    }
    lanes_there_ = 1;
    if (order_ != Order::odd) c_.store_four(next, next_lanes);
}

/// As StreamedSeries::even_order(), of a product whose factors' lines of orders 0 and 1 are where ax and dx point: in
/// a and b what it adds to the sum, in c and d what it adds to the next one.
RBDYN_INLINE void StreamedCodeWriter::product(int k) {
    const int half = k / 2;
    using enum machine_code::Register;
    constexpr Vector a = 0, b = 1, c = 2, d = 3, even = 4, odd = 5, above = 6, times = 7;
    const auto left = [this](int i, int odd_one) { return At{ax, row() * i + streamed_codes::lanes * odd_one}; };
    const auto right = [this](int i, int odd_one) {
        return At{dx, -row() * i + streamed_codes::lanes * odd_one, false, r9};
    };
    const auto add = [this](Vector sum, Vector x, const auto& y) {
        c_.multiply_four(times, x, y);
        c_.add_four(sum, sum, times);
    };
    c_.load_four(above, right(1, 1));
    c_.multiply_four(b, above, left(0, 1));
    for (const Vector sum : {a, c, d}) c_.clear(sum);
    for (int i = 1; i < half; ++i) {
        c_.load_four(even, left(i, 0));
        add(a, even, right(i, 0));
        add(c, even, above);
        c_.load_four(odd, left(i, 1));
        c_.load_four(above, right(i + 1, 1));
        add(b, odd, above);
        add(d, odd, right(i, 0));
    }
    c_.load_four(even, At{ax, 0, false, r9});
    c_.load_four(odd, At{dx, 0, false, r9});
    add(c, odd, left(0, 1));
    add(d, even, At{dx, streamed_codes::lanes});
    add(a, odd, left(0, 0));
    add(b, even, At{dx, 0});
    c_.add_four(a, a, b);
    c_.add_four(sum_lanes, sum_lanes, a);
    c_.add_four(c, c, d);
    c_.add_four(next_lanes, next_lanes, c);
    c_.leave();
}

RBDYN_INLINE StreamedCodeWriter::Vector StreamedCodeWriter::lane(Index l) {
    if (l == 0) return sum_lanes;
    const auto to = static_cast<Vector>(first_lane + l);
    if ((lanes_there_ >> l & 1U) != 0) return to;
    if (l == 2)
        c_.upper_half(to, sum_lanes);
    else
        c_.high_lanes(to, lane(l - 1), lane(l - 1));
    lanes_there_ |= 1U << l;
    return to;
}

RBDYN_INLINE void StreamedCodeWriter::copy(Index l, Index place) {
    const At to{machine_code::Register::bx, streamed_codes::number * place};
    l % 2 == 0 ? c_.store(to, lane(l)) : c_.store_high(to, lane(l - 1));
}

/// The sum begins with zero or a constant, as that of the lists.
RBDYN_INLINE void StreamedCodeWriter::combination(const Combination& combined) {
    using enum machine_code::Register;
    constexpr Vector to = 0, term = 1;
    Vector sum = zero;
    std::ptrdiff_t& read = read_;
    const std::ptrdiff_t before = std::exchange(read, combined.first_operand);
    if (combined.has_constant && order_ == Order::first) {
        operand(ax);
        c_.load(to, At{si, 0, false, ax});
        sum = to;
    } else if (combined.has_constant) {
        ++read;
    }
    for (const Index factor : combined.terms) {
        operand(ax);
        const At value{di, 0, false, ax};
        if (factor == StreamKinds::plus_one) {
            c_.add_one(to, sum, value);
        } else if (factor == StreamKinds::minus_one) {
            c_.subtract_one(to, sum, value);
        } else {
            operand(cx);
            c_.load(term, At{si, 0, false, cx});
            c_.multiply_one(term, term, value);
            c_.add_one(to, sum, term);
        }
        sum = to;
    }
    for (Index l = 0; l < combined.lanes; ++l, sum = to)
        c_.add_one(to, sum, lane(combined.first_lane % lanes_of_sum + l));
    c_.store(At{bx, streamed_codes::number * combined.place}, sum);
    read = before;
}

}  // namespace rbdyn::inline RBDYN_FORM
#endif
