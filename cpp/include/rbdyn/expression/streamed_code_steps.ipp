// Definitions of rbdyn/expression/streamed_code_writer.hpp: what is no combination, as SeriesEvaluator::compute().
//
// Quotients and sines are code of their own for each order, of which all sums are as long as they are: no order is
// looked at while it is computed. What else there is, and sines of order 0, is called.
#pragma once

#include "rbdyn/expression/streamed_code_writer.hpp"

#include <cstddef>
#include <cstdint>
#include <initializer_list>

#include "rbdyn/expression/assembler.hpp"
#include "rbdyn/expression/program.hpp"
#include "rbdyn/expression/series_evaluator.hpp"
#include "rbdyn/expression/streamed_code.hpp"
#include "rbdyn/series/coefficients.hpp"

#ifdef RBDYN_WRITES_MACHINE_CODE
namespace rbdyn::inline RBDYN_FORM {

/// Operands: which step, its first row, what it reads if it has code of its own.
RBDYN_INLINE void StreamedCodeWriter::step(Code code) {
    using enum machine_code::Register;
    constexpr std::ptrdiff_t number = sizeof(double);
    const bool has_code = StreamKinds::has_own_code(code) && (order_ != Order::first || code == Code::divide);
    if (!has_code) {
        operand(si);
        operand(dx);
        c_.move(di, At{sp, 0});
        c_.add(si, At{di, offsetof(Frame, steps)});
        c_.move(cx, bx);
        call(reinterpret_cast<std::uint64_t>(&StreamedCode::step));
        c_.move(bx, ax);
        if (StreamKinds::has_own_code(code)) read_ += code == Code::divide ? 2 : 1;
        // of a step that is next the operands are read by what load() loads
        load();
        return;
    }
    const Vector first = 2, second = 3;
    operand(r10);
    ++read_;
    c_.move(cx, At{sp, 0});
    c_.add(r10, At{cx, offsetof(Frame, steps)});
    operand(ax);
    c_.load(first, At{di, 0, false, ax});
    if (code == Code::divide) {
        operand(ax);
        c_.load(second, At{di, 0, false, ax});
    }
    const std::size_t place = code == Code::divide ? offsetof(Frame, quotient) : offsetof(Frame, sine);
    c_.move(cx, At{cx, static_cast<std::ptrdiff_t>(place)});
    c_.call(cx);
    c_.store(At{bx, 0}, first);
    if (code != Code::divide) c_.store(At{bx, number}, second);
    c_.add(bx, static_cast<std::int32_t>(code == Code::divide ? number : 2 * number));
}

RBDYN_INLINE void StreamedCodeWriter::dots(At first, std::initializer_list<At> others, int count) {
    constexpr Vector factor = 4, times = 5;
    const auto each = [&](const auto& write) {
        Vector sum = 0;
        for (const At& other : others) write(sum++, other);
    };
    const auto at = [](At place, int j) {
        return Assembler::beyond(place, static_cast<std::ptrdiff_t>(sizeof(double)) * j);
    };
    int j = 0;
    for (; j + 4 <= count; j += 4) {
        c_.load_four(factor, at(first, j));
        each([&](Vector sum, At other) {
            const Vector to = j == 0 ? sum : times;
            c_.multiply_four(to, factor, at(other, j));
            if (j > 0) c_.add_four(sum, sum, times);
        });
    }
    each([&](Vector sum, At) {
        if (j == 0) return c_.clear(sum);
        c_.upper_half(times, sum);
        c_.add_two(sum, sum, times);
        c_.high_lanes(times, sum, sum);
        c_.add_one(sum, sum, times);
    });
    for (; j < count; ++j) {
        c_.load(factor, at(first, j));
        each([&](Vector sum, At other) {
            c_.multiply_one(times, factor, at(other, j));
            c_.add_one(sum, sum, times);
        });
    }
}

/// r10: the step; vectors 2 and 3: coefficients of what is divided and of what it is divided by; 2: of the quotient.
RBDYN_INLINE void StreamedCodeWriter::quotient(int k) {
    using enum machine_code::Register;
    using Step = SeriesEvaluator::Step;
    constexpr Vector sum = 0, a = 2, b = 3, first = 4;
    constexpr std::ptrdiff_t number = sizeof(double);
    constexpr std::size_t forward = offsetof(series::View, forward), last = offsetof(series::View, last);
    c_.move(ax, At{r10, offsetof(Step, b) + forward});
    c_.move(cx, At{r10, offsetof(Step, out) + forward});
    c_.move(dx, At{r10, offsetof(Step, out) + last});
    c_.store(At{ax, number * k}, b);
    if (k > 0) {
        dots(At{ax, number}, {At{dx, number * (1 - k)}}, k - 1);
        c_.load(first, At{cx, 0});
        c_.multiply_one(first, first, b);
        c_.subtract_one(a, a, first);
        c_.subtract_one(a, a, sum);
    }
    c_.divide_one(a, a, At{ax, 0});
    c_.store(At{cx, number * k}, a);
    c_.store(At{dx, -number * k}, a);
    c_.leave();
}

/// r10: the step; vector 2: a coefficient of the angle; 2 and 3: of its sine and cosine.
RBDYN_INLINE void StreamedCodeWriter::sine(int k) {
    using enum machine_code::Register;
    using Step = SeriesEvaluator::Step;
    constexpr Vector angle = 2, sums[] = {0, 1}, results[] = {2, 3}, term = 4, slope = 6, order = 7, minus_one = 10;
    constexpr std::ptrdiff_t number = sizeof(double);
    constexpr std::size_t forward = offsetof(series::View, forward), last = offsetof(series::View, last);
    // of the sine comes the integral of the cosine, of that the sine's
    constexpr std::size_t views[] = {offsetof(Step, out), offsetof(Step, out2)};
    const At factors[] = {{cx, 0}, {dx, 0}};
    c_.move(cx, At{sp, number});  // behind where the code goes on
    c_.load(order, At{cx, offsetof(Frame, order)});
    c_.load(minus_one, At{cx, offsetof(Frame, minus_one)});
    c_.move(ax, At{r10, offsetof(Step, slope)});
    c_.move(cx, At{r10, static_cast<std::ptrdiff_t>(views[1] + last)});
    c_.move(dx, At{r10, static_cast<std::ptrdiff_t>(views[0] + last)});
    c_.multiply_one(slope, order, angle);
    c_.store(At{ax, number * k}, slope);
    if (k > 1) dots(At{ax, 2 * number}, {{cx, number * (2 - k)}, {dx, number * (2 - k)}}, k - 2);
    for (const int i : {0, 1}) {
        c_.multiply_one(results[i], slope, factors[i]);
        if (k == 1) continue;
        c_.load(term, At{ax, number});
        c_.multiply_one(term, term, Assembler::beyond(factors[i], number * (1 - k)));
        c_.add_one(results[i], results[i], term);
        c_.add_one(results[i], results[i], sums[i]);
        c_.divide_one(results[i], results[i], order);
    }
    c_.multiply_one(results[1], results[1], minus_one);
    c_.store(At{dx, -number * k}, results[0]);
    c_.store(At{cx, -number * k}, results[1]);
    for (const int i : {0, 1}) {
        c_.move(ax, At{r10, static_cast<std::ptrdiff_t>(views[i] + forward)});
        c_.store(At{ax, number * k}, results[i]);
    }
    c_.leave();
}

}  // namespace rbdyn::inline RBDYN_FORM
#endif
