// Definitions of rbdyn/expression/machine_code_writer.hpp.
#pragma once

#include "rbdyn/expression/machine_code_writer.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <optional>
#include <span>
#include <vector>

#include "rbdyn/expression/assembler.hpp"
#include "rbdyn/expression/code_memory.hpp"
#include "rbdyn/expression/program.hpp"
#include "rbdyn/expression/schedule.hpp"
#include "rbdyn/expression/series_evaluator.hpp"
#include "rbdyn/series/coefficients.hpp"
#include "rbdyn/series/product_sums.hpp"

#ifdef RBDYN_WRITES_MACHINE_CODE
namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE MachineCodeWriter::MachineCodeWriter(const SeriesEvaluator& series, const Repetition* repetition)
    : e_(series), repetition_(repetition) {
    if (repetition_ != nullptr) model_ = *repetition_->chunk(repetition_->model());
    if (are_ahead()) share_middles();
}

RBDYN_INLINE bool MachineCodeWriter::takes(const SeriesEvaluator& e) {
    const std::size_t products = e.lane_products_.size(), middle = static_cast<std::size_t>(e.top_) / 2;
    const std::size_t about = products * (64 * middle + 200) + 100 * e.lane_series_.size() + 20 * e.terms_.size() +
                              800 * e.steps_.size() + 30 * e.motion_.size();
    return e.wavefront_ == nullptr && e.program_->calls().empty() && about < CodeMemory::most;
}

RBDYN_INLINE std::span<const std::uint8_t> MachineCodeWriter::write() {
    using enum machine_code::Register;
    constexpr Register saved[] = {bx, bp, r12, r13, r14, r15};
    for (const Register r : saved) c_.push(r);
    c_.push(di);
    c_.move(ax, At{di, offsetof(Frame, k)});
    c_.shift_left(ax, 3);
    c_.move(bx, At{di, offsetof(Frame, storage)});
    c_.move(bp, bx);
    c_.add(bx, ax);
    c_.subtract(bp, ax);
    c_.shift_left(ax, 2);
    c_.move(r13, At{di, offsetof(Frame, lanes)});
    c_.move(r12, r13);
    c_.add(r12, ax);
    c_.move(r14, At{di, offsetof(Frame, series)});
    c_.move(r15, At{di, offsetof(Frame, sums)});
    c_.compare(At{di, offsetof(Frame, k)}, 0);
    const std::size_t to_first = c_.jump_if(Assembler::When::equal);
    c_.keep(ax, 32);
    load_carried(0);
    const std::size_t to_even = c_.jump_if(Assembler::When::equal), to_odd = c_.jump();
    c_.land(to_first);
    load_carried(0);
    order(Order::first);
    // of what repeats itself, an order alone
    const auto over = [this] { return repetition_ != nullptr ? c_.jump() : c_.jump_if(Assembler::When::at_least); };
    const std::size_t from_first = over();
    c_.land(to_odd);
    const std::size_t odd_start = c_.size();
    order(Order::odd);
    const std::size_t from_odd = over();
    c_.land(to_even);
    order(Order::even);
    if (repetition_ == nullptr) c_.jump_if(Assembler::When::below, odd_start);
    c_.land(from_first);
    c_.land(from_odd);
    c_.leave_four();
    c_.pop(di);
    for (auto r = std::rbegin(saved); r != std::rend(saved); ++r) c_.pop(*r);
    c_.leave();
    for (const Detour& d : detours_) {
        c_.land(d.from);
        order_ = d.order;
        call(*d.step);
        c_.land(c_.jump(), d.back);
    }
    return c_.bytes();
}

RBDYN_INLINE MachineCodeWriter::At MachineCodeWriter::next_of(const series::LaneSum& s) const {
    const series::LaneSum* const first = e_.lane_sums_.data() + model_.sums;
    return {Register::r15, reinterpret_cast<const char*>(&s.next) - reinterpret_cast<const char*>(first)};
}

RBDYN_INLINE MachineCodeWriter::At MachineCodeWriter::slot(Register base, const double* p) const {
    if (repetition_ == nullptr) return {base, in_storage(p)};
    constexpr Register index[Repetition::kinds] = {Register::sp, Register::r11, Register::r14};
    const auto [kind, distance] = repetition_->slot(in_storage(p));
    return {base, distance, false, index[kind]};
}

RBDYN_INLINE std::optional<MachineCodeWriter::At> MachineCodeWriter::weight(const void* holder,
                                                                            std::ptrdiff_t scalar) const {
    if (repetition_ != nullptr) {
        const std::optional<std::ptrdiff_t> place = repetition_->weight(holder);
        return place ? std::optional(At{Register::si, 8 * *place}) : std::nullopt;
    }
    if (std::abs(e_.program_->constant(static_cast<int>(scalar))) == 1.0) return std::nullopt;
    return At{Register::si, 8 * scalar};
}

RBDYN_INLINE MachineCodeWriter::Vector MachineCodeWriter::value(const double* slot, Vector otherwise) {
    const Vector x = known(key(slot));
    if (x != none) return x;
    c_.load(otherwise, newest(slot));
    return otherwise;
}

RBDYN_INLINE MachineCodeWriter::Vector MachineCodeWriter::value(const series::LaneValues* p, Vector otherwise) {
    const Vector x = known(key(p));
    if (x != none) return x;
    c_.load_four(otherwise, At{Register::r12, in_lanes(p)});
    return otherwise;
}

RBDYN_INLINE void MachineCodeWriter::give(double* out, Vector from) {
    c_.store(newest(out), from);
    know(from, key(out));
}

RBDYN_INLINE void MachineCodeWriter::give(const series::View& out, Vector from) {
    give(out.forward, from);
    c_.store(backwards(out.last), from);
}

RBDYN_INLINE void MachineCodeWriter::order(Order which) {
    using enum machine_code::Register;
    order_ = which;
    forget();
    are_carried_ = true;
    set_registers();
    if (repetition_ != nullptr) {
        const auto [first, last] = e_.wavefront_->chunks[repetition_->model()].stages;
        for (std::size_t b = e_.first_block_[first]; b < e_.first_block_[last]; ++b) block(e_.blocks_[b]);
        return integrate();
    }
    for (const SeriesEvaluator::Block& b : e_.blocks_) block(b);
    integrate();
    c_.move(r8, At{di, offsetof(Frame, k)});
    c_.add(r8, 1);
    c_.move(At{di, offsetof(Frame, k)}, r8);
    c_.add(bx, 8);
    c_.add(bp, -8);
    c_.add(r12, 32);
    c_.compare(r8, At{di, offsetof(Frame, last)});
}

/// Those that do not outlive a call.
RBDYN_INLINE void MachineCodeWriter::set_registers() {
    using enum machine_code::Register;
    c_.move(di, At{sp, 0});
    c_.move(si, At{di, offsetof(Frame, scalars)});
    c_.move(r8, At{di, offsetof(Frame, k)});
    c_.move(r9, At{di, offsetof(Frame, storage)});
    if (repetition_ != nullptr) {
        c_.move(r11, At{di, offsetof(Frame, second)});
        c_.move(r14, At{di, offsetof(Frame, third)});
    }
    c_.clear(zero);
    set_middles();
}

RBDYN_INLINE void MachineCodeWriter::integrate() {
    using enum machine_code::Register;
    c_.move(di, At{sp, 0});
    c_.compare(At{di, offsetof(Frame, integrates)}, 0);
    const std::size_t to_given = c_.jump_if(Assembler::When::equal);
    std::span<const SeriesEvaluator::Motion> all{e_.motion_.data(), e_.motion_.size()};
    if (repetition_ != nullptr) {
        c_.move(r8, At{di, offsetof(Frame, k)});
        c_.add(r8, 1);
        c_.convert(0, r8);
        c_.load(1, At{di, offsetof(Frame, unit)});
        c_.divide_one(0, 1, 0);
        const auto [first, last] = e_.wavefront_->chunks[repetition_->model()].inputs;
        all = all.subspan(first, last - first);
    } else {
        c_.move(ax, At{di, offsetof(Frame, k)});
        c_.shift_left(ax, 3);
        c_.move(cx, At{di, offsetof(Frame, factors)});
        c_.add(ax, cx);
        c_.load(0, At{ax, 0});
    }
    std::size_t i = 0;
    for (const SeriesEvaluator::Motion& m : all) {
        const Vector carried = carrier(i++), to = carried != none ? carried : Vector(1);
        c_.multiply_one(to, 0, value(m.rate, 1));
        c_.store(Assembler::beyond(newest(m.input), 8), to);
        if (repetition_ != nullptr && m.last != nullptr) c_.store(Assembler::beyond(backwards(m.last), -8), to);
    }
    const std::size_t past = c_.jump();
    c_.land(to_given);
    load_carried(1);
    c_.land(past);
}

RBDYN_INLINE MachineCodeWriter::Vector MachineCodeWriter::carried(std::ptrdiff_t wanted) const {
    std::size_t i = 0;
    for (const SeriesEvaluator::Motion& m : e_.motion_) {
        const Vector at = carrier(i++);
        if (at == none || key(m.input) == wanted) return at;
    }
    return none;
}

RBDYN_INLINE void MachineCodeWriter::load_carried(int order) {
    std::size_t i = 0;
    for (const SeriesEvaluator::Motion& m : e_.motion_)
        if (const Vector at = carrier(i++); at != none) c_.load(at, newest(m.input + order));
}

RBDYN_INLINE void MachineCodeWriter::block(const SeriesEvaluator::Block& b) {
    using Kind = SeriesEvaluator::Kind;
    if (b.kind == Kind::steps) are_carried_ = false;
    const auto each = [&b]<class T>(const T*, const auto& write) {
        for (const T* one = static_cast<const T*>(b.first); one != b.last; ++one) write(*one);
    };
    switch (b.kind) {
        case Kind::copies: each(e_.copies_.data(), [this](const series::View& v) { copy(v); }); break;
        case Kind::sums: each(e_.sums_.data(), [this](const SeriesEvaluator::Sums& s) { sums(s); }); break;
        case Kind::linear:
            each(e_.linear_.data(), [this](const SeriesEvaluator::Linear& l) {
                const Vector to = room();
                terms(l.first, l.last, zero, to);
                give(l.out, to);
            });
            break;
        case Kind::mixed: each(e_.mixed_.data(), [this](const SeriesEvaluator::Mixed& m) { mixed(m, nullptr); }); break;
        case Kind::steps: each(e_.steps_.data(), [this](const Step& s) { step(s); }); break;
    }
}

RBDYN_INLINE void MachineCodeWriter::copy(const series::View& v) { c_.store(backwards(v.last), value(v.forward, 0)); }

/// The sum begins with zero or a constant, as that of the lists: of a zero the sign is the same.
RBDYN_INLINE void MachineCodeWriter::terms(const Term* first, const Term* last, Vector sum, Vector to) {
    for (; first != last; ++first, sum = to) {
        const Vector x = known(key(first->series));
        const std::optional<At> at = weight(first, first->weight);
        if (!at) {
            const bool adds = e_.program_->constant(static_cast<int>(first->weight)) > 0.0;
            const auto add = [&](auto which) { adds ? c_.add_one(to, sum, which) : c_.subtract_one(to, sum, which); };
            x != none ? add(x) : add(newest(first->series));
        } else {
            c_.load(0, *at);
            x != none ? c_.multiply_one(0, 0, x) : c_.multiply_one(0, 0, newest(first->series));
            c_.add_one(to, sum, 0);
        }
    }
}

RBDYN_INLINE void MachineCodeWriter::mixed(const SeriesEvaluator::Mixed& m, const series::LaneSum* from) {
    const Vector to = room();
    const bool has_constant = order_ == Order::first && m.weight >= 0;
    if (has_constant)
        c_.load(to, repetition_ != nullptr ? *weight(&m, m.weight)
                                           : At{Register::si, 8 * static_cast<std::ptrdiff_t>(m.weight)});
    Vector sum = has_constant ? to : zero;
    terms(m.first, m.last, sum, to);
    if (m.first != m.last) sum = to;
    for (const double* l = m.lane; l != m.lane_end; ++l, sum = to)
        c_.add_one(to, sum, lane(static_cast<int>(l - reinterpret_cast<const double*>(&from->sum))));
    give(m.out, to);
}

// --- sums of products in lanes ---

RBDYN_INLINE MachineCodeWriter::Vector MachineCodeWriter::lane(int l) {
    if (l == 0) return sum_lanes;
    const auto to = static_cast<Vector>(l);
    if ((lanes_there_ >> l & 1) != 0) return to;
    if (l == 1) c_.high_lanes(to, sum_lanes, sum_lanes);
    if (l == 2) c_.upper_half(to, sum_lanes);
    if (l == 3) {
        const Vector low = lane(2);
        c_.high_lanes(to, low, low);
    }
    lanes_there_ |= 1 << l;
    return to;
}

RBDYN_INLINE void MachineCodeWriter::give_lane(int l, Vector to) {
    if (l == 0) return c_.move_four(to, sum_lanes);
    if (l == 2) return c_.upper_half(to, sum_lanes);
    const Vector low = lane(l - 1);
    c_.high_lanes(to, low, low);
}

RBDYN_INLINE void MachineCodeWriter::sums(const SeriesEvaluator::Sums& s) {
    for (const auto* x = s.series; x != s.series_end; ++x) gather(*x);
    for (const auto* x = s.spread; x != s.spread_end; ++x) spread(*x);
    are_carried_ = false;
    for (const auto* sum = s.sum; sum != s.sum_end; ++sum) {
        switch (order_) {
            case Order::first: first(*sum); break;
            case Order::odd: odd(*sum); break;
            case Order::even: even(*sum); break;
        }
        lanes_there_ = 0;
        const auto* const first = reinterpret_cast<const double*>(&sum->sum);
        for (const auto* l = s.lane; l != s.lane_end; ++l) {
            if (l->sum < first || l->sum >= first + 4) continue;
            const Vector to = room();
            give_lane(static_cast<int>(l->sum - first), to);
            give(l->out, to);
        }
        for (const auto* m = s.mixed; m != s.mixed_end; ++m)
            if (m->lane >= first && m->lane < first + 4) mixed(*m, sum);
    }
    if (order_ == Order::odd && are_ahead())
        for (std::size_t i = 0; i < middles_.size(); ++i) {
            const series::LaneProduct* const last = &e_.lane_products_[middles_[i].last];
            if (last >= s.sum->first && last < (s.sum_end - 1)->last) middle(middles_[i]);
        }
}

RBDYN_INLINE void MachineCodeWriter::pair(const double* low, const double* high, Vector to) {
    if (low == high && known(key(low)) == none) return c_.load_twice(to, newest(low));
    const Vector first = value(low, to), second = known(key(high));
    second != none ? c_.low_lanes(to, first, second) : c_.load_high(to, first, newest(high));
}

RBDYN_INLINE void MachineCodeWriter::gather(const series::LaneSeries& s) {
    const std::ptrdiff_t i = &s - e_.lane_series_.data();
    const Schedule::Series& weights = e_.lane_weights_[static_cast<std::size_t>(i)];
    const std::optional<std::ptrdiff_t> place = repetition_ != nullptr ? repetition_->weight(&s) : std::nullopt;
    const bool are_halves_same = s.from[0] == s.from[2] && s.from[1] == s.from[3];
    const bool is_weighted =
        repetition_ != nullptr ? place.has_value() : std::ranges::any_of(weights, [this](const Schedule::Weighted& w) {
            return w.scalar != Schedule::one && (w.scalar < 0 || e_.program_->constant(w.scalar) != 1.0);
        });
    // a register whose old value may be among those that are laid out is written last
    const bool are_all_same = are_halves_same && s.from[0] == s.from[1];
    const Vector x = are_all_same ? known(key(s.from[0])) : none;
    if (!are_all_same) {
        pair(s.from[0], s.from[1], 0);
        if (!are_halves_same) pair(s.from[2], s.from[3], 1);
    }
    const Vector to = room(), laid = is_weighted ? Vector(0) : to;
    if (!are_all_same)
        c_.join(laid, 0, are_halves_same ? 0 : 1);
    else
        x != none ? c_.spread(laid, x) : c_.spread(laid, newest(s.from[0]));
    constexpr std::ptrdiff_t each = sizeof s, weight = offsetof(series::LaneSeries, weight);
    if (is_weighted)
        c_.multiply_four(to, 0, place ? At{Register::si, 8 * *place} : At{Register::r14, i * each + weight});
    c_.store_four(At{Register::r12, in_lanes(s.to)}, to);
    know(to, key(s.to));
    pack(s.to, to);
}

RBDYN_INLINE void MachineCodeWriter::spread(const series::LaneSpread& s) {
    const Vector from = known(key(s.from)), to = room();
    from != none ? c_.spread(to, from) : c_.spread(to, newest(s.from));
    c_.store_four(At{Register::r12, in_lanes(s.to)}, to);
    know(to, key(s.to));
    pack(s.to, to);
}

/// Order 0: products of the first coefficients.
RBDYN_INLINE void MachineCodeWriter::first(const series::LaneSum& s) {
    for (const auto* p = s.first; p != s.last; ++p) {
        const Vector x = value(p->x, 4), y = value(p->y, 5);
        c_.multiply_four(0, x, y);
        c_.add_four(sum_lanes, p == s.first ? zero : sum_lanes, 0);
    }
    c_.store_four(next_of(s), zero);
}

RBDYN_INLINE void MachineCodeWriter::odd(const series::LaneSum& s) {
    c_.load_four(sum_lanes, next_of(s));
    for (const auto* p = s.first; p != s.last; ++p) {
        const Vector x = value(p->x, 4), y = value(p->y, 5);
        c_.multiply_four(0, y, At{Register::r13, in_lanes(p->x)});
        c_.multiply_four(1, x, At{Register::r13, in_lanes(p->y)});
        c_.add_four(0, 0, 1);
        c_.add_four(sum_lanes, sum_lanes, 0);
    }
}

/// To the middles (middle()) comes what the newest coefficients add, last, for they come late.
RBDYN_INLINE void MachineCodeWriter::even(const series::LaneSum& s) {
    using enum machine_code::Register;
    // of order k in a and b, of order k + 1 in c and d
    constexpr Vector a = 0, b = 1, c = 2, d = 3;
    const auto add = [this](Vector first, Vector second, Vector third, Vector fourth, bool is_first) {
        c_.add_four(first, first, second);
        c_.add_four(sum_lanes, is_first ? zero : sum_lanes, first);
        c_.add_four(third, third, fourth);
        c_.add_four(next_lanes, is_first ? zero : next_lanes, third);
    };
    for (const auto* p = s.first; p != s.last; ++p) {
        const std::ptrdiff_t x = in_lanes(p->x), y = in_lanes(p->y);
        if (!are_ahead()) middle({p->x, p->y, 0, 0, -1});
        const Vector x_k = value(p->x, 4), y_k = value(p->y, 5);
        if (!are_ahead()) {
            c_.multiply_four(6, y_k, At{r13, x + 32});
            c_.add_four(c, c, 6);
            c_.multiply_four(7, x_k, At{r13, y + 32});
            c_.add_four(d, d, 7);
            c_.multiply_four(6, y_k, At{r13, x});
            c_.add_four(a, a, 6);
            c_.multiply_four(7, x_k, At{r13, y});
            c_.add_four(b, b, 7);
            add(a, b, c, d, p == s.first);
            continue;
        }
        const Share& share = shares_[static_cast<std::size_t>(p - e_.lane_products_.data())];
        c_.multiply_four(c, y_k, At{r13, x + 32});
        c_.multiply_four(d, x_k, At{r13, y + 32});
        c_.multiply_four(a, y_k, At{r13, x});
        c_.multiply_four(b, x_k, At{r13, y});
        // other lanes are another product's
        const auto own = static_cast<std::uint8_t>(((1 << share.lanes) - 1) << share.first);
        for (const Vector part : {a, b, c, d}) {
            if (share.lanes == static_cast<int>(Schedule::lanes)) {
                c_.add_four(part, part, middle_of(share, part));
            } else {
                c_.blend(6, zero, middle_of(share, part), own);
                c_.add_four(part, part, 6);
            }
        }
        add(a, b, c, d, p == s.first);
    }
    c_.store_four(next_of(s), next_lanes);
}

}  // namespace rbdyn::inline RBDYN_FORM
#endif
