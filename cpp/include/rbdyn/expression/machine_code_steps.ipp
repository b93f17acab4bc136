// Definitions of rbdyn/expression/machine_code_writer.hpp: what is no combination, as SeriesEvaluator::compute().
#pragma once

#include "rbdyn/expression/machine_code_writer.hpp"

#include <bit>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <vector>

#include "rbdyn/expression/assembler.hpp"
#include "rbdyn/expression/program.hpp"
#include "rbdyn/expression/series_evaluator.hpp"
#include "rbdyn/series/coefficients.hpp"

#ifdef RBDYN_WRITES_MACHINE_CODE
namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE void MachineCodeWriter::step(const Step& s) {
    // order 0 is another formula
    if (order_ == Order::first && s.code != Code::divide) {
        forget();
        return call(s);
    }
    switch (s.code) {
        case Code::divide: return quotient(s);
        case Code::sine_cosine:
        case Code::hyperbolic:
        case Code::exponential: return by_slope(s);
        case Code::power: return power(s);
        case Code::norm: return norm(s);
        default: forget(); return call(s);
    }
}

/// By the evaluator.
RBDYN_INLINE void MachineCodeWriter::call(const Step& s) {
    using enum machine_code::Register;
    c_.leave_four();
    c_.move(di, At{sp, 0});
    c_.move(dx, At{di, offsetof(Frame, k)});
    c_.move(di, At{di, offsetof(Frame, self)});
    if (repetition_ != nullptr) {
        c_.move(ax, At{sp, 0});
        c_.move(si, At{ax, offsetof(Frame, steps)});
        c_.add(si,
               static_cast<std::int32_t>(sizeof s) * static_cast<std::int32_t>(&s - (e_.steps_.data() + model_.steps)));
    } else {
        c_.move(si, reinterpret_cast<std::uint64_t>(&s));
    }
    c_.move(ax, reinterpret_cast<std::uint64_t>(&SeriesEvaluator::compute_wide));
    c_.call(ax);
    set_registers();
}

RBDYN_INLINE void MachineCodeWriter::dots(std::initializer_list<Factors> factors, int before, int more) {
    using enum machine_code::Register;
    using When = Assembler::When;
    const auto each = [&](const auto& write) {
        Vector sum = 0;
        for (const Factors& f : factors) write(sum++, f);
    };
    const auto at = [](At place, int by) { return Assembler::beyond(place, 8 * by); };
    c_.move(cx, r8);
    if (more != 0) c_.add(cx, more);
    each([&](Vector sum, const Factors&) { c_.move_four(sum, zero); });
    c_.compare(cx, 4);
    const std::size_t to_rest = c_.jump_if(When::below);
    std::vector<std::size_t> to_sum;
    for (int j = 0; j + 4 <= e_.top_ + more; j += 4) {
        if (j > 0) {
            c_.compare(cx, j + 4);
            to_sum.push_back(c_.jump_if(When::below));
        }
        each([&](Vector sum, const Factors& f) {
            const Vector to = j == 0 ? sum : Vector(3);
            c_.load_four(3, at(fixed(f.a), j));
            c_.multiply_four(to, 3, at(backwards(f.b->last), before + j));
            if (j > 0) c_.add_four(sum, sum, 3);
        });
    }
    for (const std::size_t from : to_sum) c_.land(from);
    each([&](Vector sum, const Factors&) {
        c_.upper_half(3, sum);
        c_.add_two(sum, sum, 3);
        c_.high_lanes(3, sum, sum);
        c_.add_one(sum, sum, 3);
    });
    c_.land(to_rest);
    // the last ones, of which places are known from the end
    c_.keep(cx, 3);
    for (int left = 3; left > 0; --left) {
        c_.compare(cx, left);
        const std::size_t past = c_.jump_if(When::below);
        each([&](Vector sum, const Factors& f) {
            c_.load(3, at(newest(f.a), more - left));
            c_.multiply_one(3, 3, at(fixed(f.b->last), before + more - left));
            c_.add_one(sum, sum, 3);
        });
        c_.land(past);
    }
}

/// k a_k, also in vector 5; k in 7.
RBDYN_INLINE void MachineCodeWriter::slope(const Step& s) {
    c_.convert(7, Register::r8);
    c_.multiply_one(5, 7, value(s.a.forward, 5));
    c_.store(newest(s.slope), 5);
}

RBDYN_INLINE void MachineCodeWriter::quotient(const Step& s) {
    if (order_ == Order::first) {
        const Vector to = room();
        c_.divide_one(to, value(s.a.forward, 5), value(s.b.forward, 4));
        return give(s.out, to);
    }
    // a_k - b_k q_0 - sum
    dots({{s.b.forward + 1, &s.out}}, 1, -1);
    const Vector to = room();
    c_.load(4, fixed(s.out.forward));
    c_.multiply_one(4, 4, value(s.b.forward, 3));
    c_.subtract_one(to, value(s.a.forward, 5), 4);
    c_.subtract_one(to, to, 0);
    c_.divide_one(to, to, fixed(s.b.forward));
    give(s.out, to);
}

RBDYN_INLINE void MachineCodeWriter::by_slope(const Step& s) {
    using enum machine_code::Register;
    // of what is given first the integral is the other one
    const bool are_two = s.code != Code::exponential;
    slope(s);
    const series::View& b = are_two ? s.out2 : s.out;
    const Vector first = room(), second = are_two ? room() : none;
    c_.multiply_one(first, 5, fixed(b.forward));
    if (are_two) c_.multiply_one(second, 5, fixed(s.out.forward));
    // of order 1 that is all
    std::size_t past = 0;
    if (order_ == Order::odd) {
        c_.compare(r8, 1);
        past = c_.jump_if(Assembler::When::equal);
    }
    if (are_two)
        dots({{s.slope + 2, &b}, {s.slope + 2, &s.out}}, 2, -2);
    else
        dots({{s.slope + 2, &b}}, 2, -2);
    // the factors' coefficients of order k - 1 are read before those of order k are written
    const auto integral = [&](Vector to, Vector sum, const series::View& by) {
        c_.load(4, fixed(s.slope + 1));
        c_.multiply_one(4, 4, Assembler::beyond(newest(by.forward), -8));
        c_.add_one(to, to, 4);
        c_.add_one(to, to, sum);
        c_.divide_one(to, to, 7);
    };
    integral(first, 0, b);
    if (are_two) integral(second, 1, s.out);
    if (order_ == Order::odd) c_.land(past);
    if (are_two) {
        c_.move(di, At{sp, 0});
        if (s.code == Code::sine_cosine) c_.multiply_one(second, second, At{di, offsetof(Frame, minus_one)});
        give(s.out2, second);
    }
    give(s.out, first);
}

RBDYN_INLINE void MachineCodeWriter::power(const Step& s) {
    slope(s);
    dots({{s.slope + 1, &s.out}, {s.a.forward + 1, &s.out}}, 1, 0);
    c_.divide_one(0, 0, 7);
    c_.move(Register::cx, std::bit_cast<std::uint64_t>(s.value + 1.0));
    c_.move(4, Register::cx);
    c_.multiply_one(4, 4, 0);
    const Vector to = room();
    c_.subtract_one(to, 4, 1);
    c_.divide_one(to, to, fixed(s.a.forward));
    give(s.out, to);
}

RBDYN_INLINE void MachineCodeWriter::norm(const Step& s) {
    // one that begins at zero is the evaluator's, which is rare
    forget();
    std::ptrdiff_t place = 0;
    if (repetition_ != nullptr) {
        c_.move(Register::di, At{Register::sp, 0});
        c_.move(Register::cx, At{Register::di, offsetof(Frame, states)});
        place = static_cast<std::ptrdiff_t>(sizeof *s.valuation) * (s.valuation - e_.valuations_.data());
    } else {
        c_.move(Register::cx, reinterpret_cast<std::uint64_t>(s.valuation));
    }
    c_.compare_short(At{Register::cx, place}, 0);
    const std::size_t from = c_.jump_if(Assembler::When::not_equal);
    dots({{s.a.forward, &s.a}, {s.b.forward, &s.b}, {s.c.forward, &s.c}}, 0, 1);
    for (const Vector part : {Vector(0), Vector(1), Vector(2)}) c_.add_one(5, part == 0 ? zero : Vector(5), part);
    dots({{s.out.forward + 1, &s.out}}, 1, -1);
    c_.load(4, fixed(s.out.forward));
    c_.add_one(4, 4, 4);
    c_.subtract_one(5, 5, 0);
    c_.divide_one(5, 5, 4);
    c_.store(newest(s.out.forward), 5);
    c_.store(backwards(s.out.last), 5);
    detours_.push_back({from, c_.size(), &s, order_});
}

}  // namespace rbdyn::inline RBDYN_FORM
#endif
