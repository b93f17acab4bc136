// Definitions of rbdyn/expression/abreast_code_writer.hpp: what is no combination, as in abreast_run.hpp.
#pragma once

#include "rbdyn/expression/abreast_code_writer.hpp"

#include <bit>
#include <cstddef>
#include <cstdint>

#include "rbdyn/expression/abreast_tape.hpp"
#include "rbdyn/expression/assembler.hpp"
#include "rbdyn/expression/code_memory.hpp"
#include "rbdyn/expression/program.hpp"

#ifdef RBDYN_WRITES_MACHINE_CODE
namespace rbdyn::inline RBDYN_FORM::abreast {

RBDYN_INLINE void AbreastCodeWriter::other(const Tape::Other& s) {
    switch (s.code) {
        case Code::combine:
        case Code::call: return;
        case Code::divide: return quotient(s);
        case Code::square_root: return root(s);
        case Code::norm: return norm(s);
        case Code::sine_cosine:
        case Code::hyperbolic:
        case Code::exponential: return by_slope(s);
        case Code::power: return power(s);
        default: return call(s);
    }
}

/// By the list.
RBDYN_INLINE void AbreastCodeWriter::call(const Tape::Other& s) {
    using enum machine_code::Register;
    forget();
    c_.leave_four();
    c_.move(di, At{sp, 0});
    c_.move(dx, At{di, offsetof(Frame, k)});
    c_.move(di, At{di, offsetof(Frame, tape)});
    c_.move(si, reinterpret_cast<std::uint64_t>(&s));
    c_.move(ax, reinterpret_cast<std::uint64_t>(t_.instruct));
    c_.call(ax);
    set_registers();
}

RBDYN_INLINE void AbreastCodeWriter::dot(At a, At b, Vector to) {
    using enum machine_code::Register;
    using When = Assembler::When;
    c_.address(ax, a);
    c_.address(dx, b);
    c_.clear(to);
    const auto product = [&](Vector at, int j) {
        c_.load_all(at, At{ax, j * v_});
        c_.multiply_all(at, at, At{dx, -j * v_});
    };
    const auto go_on = [&](int by) {
        c_.add(ax, static_cast<std::int32_t>(by * v_));
        c_.add(dx, static_cast<std::int32_t>(-by * v_));
        c_.add(cx, -by);
    };
    c_.compare(cx, 4);
    const std::size_t to_rest = c_.jump_if(When::below);
    for (int j = 0; j < 4; ++j) product(static_cast<Vector>(j), j);
    go_on(4);
    const std::size_t again = c_.size();
    c_.compare(cx, 4);
    const std::size_t to_sum = c_.jump_if(When::below);
    for (int j = 0; j < 4; ++j) {
        product(4, j);
        c_.add_all(static_cast<Vector>(j), static_cast<Vector>(j), 4);
    }
    go_on(4);
    c_.land(c_.jump(), again);
    c_.land(to_sum);
    c_.add_all(0, 0, 2);
    c_.add_all(1, 1, 3);
    c_.add_all(to, 0, 1);
    c_.land(to_rest);
    const std::size_t one_more = c_.size();
    c_.compare(cx, 1);
    const std::size_t to_end = c_.jump_if(When::below);
    product(4, 0);
    c_.add_all(to, to, 4);
    go_on(1);
    c_.land(c_.jump(), one_more);
    c_.land(to_end);
}

RBDYN_INLINE void AbreastCodeWriter::dot(At a, At b, int more, Vector to) {
    c_.move(Register::cx, Register::r10);
    if (more != 0) c_.add(Register::cx, more);
    dot(a, b, to);
}

RBDYN_INLINE void AbreastCodeWriter::quotient(const Tape::Other& s) {
    // a_k - b_k q_0 - sum
    dot(first(s.b, 1), before(s.out, 1), -1, 5);
    const Vector b = value(s.b, 0), a = value(s.a, 1), to = room();
    c_.multiply_all(2, b, first(s.out, 0));
    c_.subtract_all(to, a, 2);
    c_.subtract_all(to, to, 5);
    c_.divide_all(to, to, first(s.b, 0));
    give(s.out, to);
}

RBDYN_INLINE void AbreastCodeWriter::root(const Tape::Other& s) {
    using enum machine_code::Register;
    c_.move(cx, r10);
    c_.add(cx, -1);
    c_.shift_right(cx, 1);
    dot(first(s.out, 1), before(s.out, 1), 5);
    c_.add_all(5, 5, 5);
    if (is_even_) {
        c_.move(ax, r10);
        c_.shift_left(ax, static_cast<std::uint8_t>(std::countr_zero(static_cast<std::uint64_t>(v_)) - 1));
        c_.add(ax, r13);
        c_.load_all(0, At{ax, s.out});
        c_.multiply_all(0, 0, 0);
        c_.add_all(5, 5, 0);
    }
    const Vector a = value(s.a, 1), to = room();
    c_.subtract_all(to, a, 5);
    c_.load_all(0, first(s.out, 0));
    c_.add_all(0, 0, 0);
    c_.divide_all(to, to, 0);
    give(s.out, to);
}

RBDYN_INLINE void AbreastCodeWriter::norm(const Tape::Other& s) {
    // one that begins at zero is told at order 0
    Vector square = zero;
    for (const Place part : {s.a, s.b, s.c}) {
        dot(first(part, 0), newest(part), 1, 5);
        c_.add_all(6, square, 5);
        square = 6;
    }
    dot(first(s.out, 1), before(s.out, 1), -1, 5);
    const Vector to = room();
    c_.subtract_all(to, 6, 5);
    c_.load_all(0, first(s.out, 0));
    c_.add_all(0, 0, 0);
    c_.divide_all(to, to, 0);
    give(s.out, to);
}

/// k a_k
RBDYN_INLINE void AbreastCodeWriter::slope(const Tape::Other& s) {
    const Vector a = value(s.a, 0), to = room();
    c_.multiply_all(to, a, order());
    give(s.slope, to);
}

RBDYN_INLINE AbreastCodeWriter::Vector AbreastCodeWriter::integral(Place slope, Place b) {
    dot(first(slope, 2), before(b, 2), -2, 5);
    const Vector newest_slope = value(slope, 0), to = room();
    c_.multiply_all(to, newest_slope, first(b, 0));
    c_.load_all(1, first(slope, 1));
    c_.multiply_all(1, 1, before(b, 1));
    c_.add_all(to, to, 1);
    c_.add_all(to, to, 5);
    c_.divide_all(to, to, order());
    return to;
}

RBDYN_INLINE void AbreastCodeWriter::by_slope(const Tape::Other& s) {
    slope(s);
    if (s.code == Code::exponential) return give(s.out, integral(s.slope, s.out));
    // of what is given first the integral is the other one
    const Vector sine = integral(s.slope, s.out2), cosine = integral(s.slope, s.out);
    if (s.code == Code::sine_cosine) {
        c_.move(Register::cx, std::bit_cast<std::uint64_t>(-1.0));
        c_.move(0, Register::cx);
        c_.spread_all(0, 0);
        c_.multiply_all(cosine, cosine, 0);
    }
    give(s.out2, cosine);
    give(s.out, sine);
}

RBDYN_INLINE void AbreastCodeWriter::power(const Tape::Other& s) {
    slope(s);
    dot(first(s.slope, 1), before(s.out, 1), 0, 5);
    c_.divide_all(6, 5, order());
    dot(first(s.a, 1), before(s.out, 1), 0, 5);
    c_.move(Register::cx, std::bit_cast<std::uint64_t>(s.value + 1.0));
    c_.move(0, Register::cx);
    c_.spread_all(0, 0);
    c_.multiply_all(6, 6, 0);
    const Vector to = room();
    c_.subtract_all(to, 6, 5);
    c_.divide_all(to, to, first(s.a, 0));
    give(s.out, to);
}

}  // namespace rbdyn::inline RBDYN_FORM::abreast
#endif
