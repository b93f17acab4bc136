// Definitions of rbdyn/expression/abreast_code_writer.hpp.
#pragma once

#include "rbdyn/expression/abreast_code_writer.hpp"

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <span>

#include "rbdyn/expression/abreast_tape.hpp"
#include "rbdyn/expression/assembler.hpp"
#include "rbdyn/expression/code_memory.hpp"
#include "rbdyn/expression/program.hpp"

#ifdef RBDYN_WRITES_MACHINE_CODE
namespace rbdyn::inline RBDYN_FORM::abreast {

RBDYN_INLINE bool AbreastCodeWriter::takes(const Tape& t) {
    const std::size_t about = 500 * t.singles.size() + 800 * t.pairs.size() + 60 * t.products.size() +
                              60 * t.scales.size() + 60 * t.sums.size() + 40 * t.multiples.size() +
                              40 * t.combinations.size() + 1000 * t.others.size() + 60 * t.motion.size();
    return CodeMemory::is_usable() && about < CodeMemory::most;
}

RBDYN_INLINE std::span<const std::uint8_t> AbreastCodeWriter::write() {
    using enum machine_code::Register;
    constexpr Register saved[] = {bx, bp, r12, r13, r14, r15};
    for (const Register r : saved) c_.push(r);
    c_.push(di);
    c_.move(ax, At{di, offsetof(Frame, k)});
    c_.move(dx, ax);
    c_.shift_left(dx, static_cast<std::uint8_t>(std::countr_zero(static_cast<std::uint64_t>(v_))));
    c_.move(r13, At{di, offsetof(Frame, cells)});
    c_.move(bx, r13);
    c_.add(bx, dx);
    c_.move(bp, At{di, offsetof(Frame, numbers)});
    c_.add(bp, dx);
    c_.move(r12, At{di, offsetof(Frame, weights)});
    c_.move(r14, At{di, offsetof(Frame, sums)});
    c_.move(r15, At{di, offsetof(Frame, nexts)});
    c_.keep(ax, 1);
    const std::size_t to_even = c_.jump_if(Assembler::When::equal);
    const std::size_t first = c_.size();
    one_order(false);
    const std::size_t to_end = c_.jump_if(Assembler::When::at_least);
    c_.land(to_even);
    one_order(true);
    c_.jump_if(Assembler::When::below, first);
    c_.land(to_end);
    c_.leave_four();
    c_.pop(di);
    for (auto r = std::rbegin(saved); r != std::rend(saved); ++r) c_.pop(*r);
    c_.leave();
    return c_.bytes();
}

RBDYN_INLINE AbreastCodeWriter::Vector AbreastCodeWriter::value(Place row, Vector otherwise) {
    const Vector x = known(key(row, true));
    if (x != none) return x;
    c_.load_all(otherwise, newest(row));
    return otherwise;
}

RBDYN_INLINE void AbreastCodeWriter::give(Place row, Vector from) {
    c_.store_all(newest(row), from);
    know(from, key(row, true));
}

RBDYN_INLINE void AbreastCodeWriter::one_order(bool is_even) {
    using enum machine_code::Register;
    is_even_ = is_even;
    forget();
    set_registers();
    Tape::Ends from;
    for (const Tape::Ends& to : t_.stages) {
        for (std::size_t i = from.scales; i < to.scales; ++i) scale(t_.scales[i]);
        if (is_even) {
            for (std::size_t i = from.singles; i < to.singles; ++i) single(t_.singles[i]);
            for (std::size_t i = from.pairs; i < to.pairs; ++i) pair(t_.pairs[i]);
        }
        for (std::size_t i = from.sums; i < to.sums; ++i) is_even ? even(t_.sums[i], i) : odd(t_.sums[i], i);
        for (std::size_t i = from.combinations; i < to.combinations; ++i) combination(t_.combinations[i]);
        for (std::size_t i = from.others; i < to.others; ++i) other(t_.others[i]);
        from = to;
    }
    integrate();
    c_.move(di, At{sp, 0});
    c_.add(r10, 1);
    c_.move(At{di, offsetof(Frame, k)}, r10);
    c_.add(bx, static_cast<std::int32_t>(v_));
    c_.add(bp, static_cast<std::int32_t>(v_));
    c_.compare(r10, At{di, offsetof(Frame, last)});
}

/// Those that do not outlive a call.
RBDYN_INLINE void AbreastCodeWriter::set_registers() {
    using enum machine_code::Register;
    c_.move(di, At{sp, 0});
    c_.move(r8, At{di, offsetof(Frame, parts)});
    c_.move(r9, At{di, offsetof(Frame, next_parts)});
    c_.move(r10, At{di, offsetof(Frame, k)});
    c_.clear(zero);
}

RBDYN_INLINE void AbreastCodeWriter::integrate() {
    using enum machine_code::Register;
    c_.move(di, At{sp, 0});
    c_.compare(At{di, offsetof(Frame, integrates)}, 0);
    const std::size_t past = c_.jump_if(Assembler::When::equal);
    c_.move(ax, At{di, offsetof(Frame, unit)});
    c_.load_all(0, At{ax, 0});
    c_.divide_all(0, 0, At{bp, v_});
    for (const auto& [input, rate] : t_.motion) {
        const Vector x = known(key(rate, true));
        x != none ? c_.multiply_all(1, 0, x) : c_.multiply_all(1, 0, newest(rate));
        c_.store_all(before(input, -1), 1);
    }
    c_.land(past);
}

RBDYN_INLINE void AbreastCodeWriter::scale(const Tape::Scale& s) {
    const Vector x = value(s.a, 0), to = room();
    c_.multiply_all(to, x, weight(s.weight));
    give(s.out, to);
}

// --- sums of products ---

template <class Body>
void AbreastCodeWriter::middle(Place x, Place y, const Body& body) {
    using enum machine_code::Register;
    c_.address(ax, first(x, 2));
    c_.address(dx, before(y, 1));
    c_.address(cx, newest(x));
    c_.compare(ax, cx);
    const std::size_t past = c_.jump_if(Assembler::When::equal);
    const std::size_t again = c_.size();
    body();
    c_.add(ax, static_cast<std::int32_t>(2 * v_));
    c_.add(dx, static_cast<std::int32_t>(-2 * v_));
    c_.compare(ax, cx);
    c_.jump_if(Assembler::When::not_equal, again);
    c_.land(past);
}

/// As series::abreast::even_order().
RBDYN_INLINE void AbreastCodeWriter::single(const Tape::Product& p) {
    using enum machine_code::Register;
    constexpr Vector a = 0, b = 1, c = 2, d = 3, above = 8, first_right = 9, second_right = 10, t = 11;
    const auto add = [&](Vector to, Vector right, At left) {
        c_.multiply_all(t, right, left);
        c_.add_all(to, to, t);
    };
    c_.load_all(above, before(p.y, 1));
    c_.multiply_all(b, above, first(p.x, 1));
    for (const Vector sum : {a, c, d}) c_.clear(sum);
    middle(p.x, p.y, [&] {
        c_.load_all(first_right, At{dx, -v_});
        c_.load_all(second_right, At{dx, -2 * v_});
        add(a, first_right, At{ax, 0});
        add(c, above, At{ax, 0});
        add(b, second_right, At{ax, v_});
        add(d, first_right, At{ax, v_});
        c_.move_all(above, second_right);
    });
    const Vector x_k = value(p.x, 9), y_k = value(p.y, 10);
    add(c, y_k, first(p.x, 1));
    add(d, x_k, first(p.y, 1));
    add(a, y_k, first(p.x, 0));
    add(b, x_k, first(p.y, 0));
    c_.add_all(a, a, b);
    c_.store_all(part(p.part), a);
    c_.add_all(c, c, d);
    c_.store_all(next_part(p.part), c);
}

RBDYN_INLINE void AbreastCodeWriter::pair(const Tape::Pair& p) {
    using enum machine_code::Register;
    constexpr Vector a = 0, b = 1, c = 2, d = 3, e = 4, f = 5, g = 6, h = 7, above = 8, first_right = 9,
                     second_right = 10, t = 11;
    const auto add = [&](Vector to, Vector right, At left) {
        c_.multiply_all(t, right, left);
        c_.add_all(to, to, t);
    };
    c_.load_all(above, before(p.y, 1));
    c_.multiply_all(b, above, first(p.x, 1));
    c_.multiply_all(f, above, first(p.z, 1));
    for (const Vector sum : {a, c, d, e, g, h}) c_.clear(sum);
    const Place z = p.z - p.x;
    middle(p.x, p.y, [&] {
        c_.load_all(first_right, At{dx, -v_});
        c_.load_all(second_right, At{dx, -2 * v_});
        add(a, first_right, At{ax, 0});
        add(c, above, At{ax, 0});
        add(b, second_right, At{ax, v_});
        add(d, first_right, At{ax, v_});
        add(e, first_right, At{ax, z});
        add(g, above, At{ax, z});
        add(f, second_right, At{ax, z + v_});
        add(h, first_right, At{ax, z + v_});
        c_.move_all(above, second_right);
    });
    const Vector x_k = value(p.x, 8), z_k = value(p.z, 9), y_k = value(p.y, 10);
    add(c, y_k, first(p.x, 1));
    add(d, x_k, first(p.y, 1));
    add(a, y_k, first(p.x, 0));
    add(b, x_k, first(p.y, 0));
    add(g, y_k, first(p.z, 1));
    add(h, z_k, first(p.y, 1));
    add(e, y_k, first(p.z, 0));
    add(f, z_k, first(p.y, 0));
    c_.add_all(a, a, b);
    c_.store_all(part(p.part), a);
    c_.add_all(c, c, d);
    c_.store_all(next_part(p.part), c);
    c_.add_all(e, e, f);
    c_.store_all(part(p.part + v_), e);
    c_.add_all(g, g, h);
    c_.store_all(next_part(p.part + v_), g);
}

RBDYN_INLINE void AbreastCodeWriter::even(const Tape::Sum& s, std::size_t index) {
    const Vector to = room();
    Vector sum_now = zero, sum_next = zero;
    for (Place i = s.first; i < s.last; ++i, sum_now = to, sum_next = 0) {
        const Tape::Product& p = t_.products[static_cast<std::size_t>(i)];
        c_.add_all(to, sum_now, part(p.part));
        c_.add_all(0, sum_next, next_part(p.part));
    }
    if (s.first == s.last) {
        c_.move_all(to, zero);
        c_.move_all(0, zero);
    }
    c_.store_all(next(index), 0);
    c_.store_all(s.is_series ? newest(s.out) : sum(s.out), to);
    know(to, key(s.out, s.is_series));
}

RBDYN_INLINE void AbreastCodeWriter::odd(const Tape::Sum& s, std::size_t index) {
    const Vector to = room();
    c_.load_all(to, next(index));
    for (Place i = s.first; i < s.last; ++i) {
        const Tape::Product& p = t_.products[static_cast<std::size_t>(i)];
        const Vector x = value(p.x, 2), y = value(p.y, 3);
        c_.multiply_all(0, y, first(p.x, 0));
        c_.multiply_all(1, x, first(p.y, 0));
        c_.add_all(0, 0, 1);
        c_.add_all(to, to, 0);
    }
    c_.store_all(s.is_series ? newest(s.out) : sum(s.out), to);
    know(to, key(s.out, s.is_series));
}

/// The sum begins with zero, as that of the lists: of a zero the sign is the same.
RBDYN_INLINE void AbreastCodeWriter::combination(const Tape::Combination& c) {
    const Vector to = room();
    Vector all = zero;
    for (Place i = c.first; i < c.last; ++i, all = to) {
        const Tape::Multiple& m = t_.multiples[static_cast<std::size_t>(i)];
        const Vector x = known(key(m.series, true));
        const int is_one = one(m.weight);
        const auto add = [&](auto which) { is_one > 0 ? c_.add_all(to, all, which) : c_.subtract_all(to, all, which); };
        if (is_one != 0) {
            x != none ? add(x) : add(newest(m.series));
        } else {
            const Vector y = value(m.series, 0);
            c_.multiply_all(0, y, weight(m.weight));
            c_.add_all(to, all, 0);
        }
    }
    for (Place own = c.first_sum; own != c.last_sum; own += v_, all = to) {
        const Vector x = known(key(own, false));
        x != none ? c_.add_all(to, all, x) : c_.add_all(to, all, sum(own));
    }
    if (all == zero) c_.move_all(to, zero);
    give(c.out, to);
}

}  // namespace rbdyn::inline RBDYN_FORM::abreast
#endif
