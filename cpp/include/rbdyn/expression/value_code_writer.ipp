// Definitions of rbdyn/expression/value_code_writer.hpp.
#pragma once

#include "rbdyn/expression/value_code_writer.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <limits>
#include <span>
#include <vector>

#include "rbdyn/expression/assembler.hpp"
#include "rbdyn/expression/code_memory.hpp"
#include "rbdyn/expression/evaluate.hpp"
#include "rbdyn/expression/program.hpp"
#include "rbdyn/expression/value_code.hpp"

#ifdef RBDYN_WRITES_MACHINE_CODE
namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE ValueCodeWriter::ValueCodeWriter(const Program& program)
    : p_(program), uses_(static_cast<std::size_t>(program.slots())) {
    forget();
    int index = 0;
    for (const Instruction& i : p_.instructions()) {
        each_operand(i, [&](int slot) { uses_[at(slot)].push_back(index); });
        calls_ = calls_ || is_called(i.code);
        ++index;
    }
    if (p_.outputs() >= p_.inputs())
        for (int k = 0; k < p_.inputs(); ++k) uses_[at(p_.output(k))].push_back(index);
}

RBDYN_INLINE bool ValueCodeWriter::takes(const Program& program) {
    // one that is called back may throw, and nothing can be thrown through code that no table describes
    if (program.has_calls()) return false;
    std::size_t about = 20 * static_cast<std::size_t>(program.inputs());
    for (const Instruction& i : program.instructions())
        about += static_cast<std::size_t>(40 + 20 * i.terms + 32 * i.products);
    return about < CodeMemory::most;
}

RBDYN_INLINE bool ValueCodeWriter::is_called(Code code) {
    return code != Code::combine && code != Code::divide && code != Code::square_root;
}

template <class F>
void ValueCodeWriter::each_operand(const Instruction& i, const F& f) const {
    if (i.code != Code::combine) {
        for (const int slot : {i.a, i.b, i.c})
            if (slot >= 0) f(slot);
        return;
    }
    for (int k = 0; k < i.terms; ++k) f(p_.terms(i)[k].slot);
    for (int k = 0; k < i.products; ++k) {
        f(p_.products(i)[k].a);
        f(p_.products(i)[k].b);
    }
}

RBDYN_INLINE std::span<const std::uint8_t> ValueCodeWriter::write() {
    using enum machine_code::Register;
    // an odd number, so that calls find the stack as they want it
    constexpr Register saved[] = {bx, bp, r12, r13, r14};
    if (calls_) {
        for (const Register r : saved) c_.push(r);
        const auto keep = [&](Register& in, Register there) {
            c_.move(there, in);
            in = there;
        };
        keep(slots_, bx);
        keep(scalars_, bp);
        keep(instructions_, r12);
        keep(rates_, r13);
        keep(inputs_, r14);
    }
    c_.clear(zero);
    take_inputs();
    for (const Instruction& i : p_.instructions()) {
        instruction(i);
        ++now_;
    }
    give_rates();
    c_.leave_four();
    if (calls_)
        for (auto r = std::rbegin(saved); r != std::rend(saved); ++r) c_.pop(*r);
    c_.leave();
    return c_.bytes();
}

RBDYN_INLINE void ValueCodeWriter::take_inputs() {
    store(p_.time_slot(), 0);
    for (int i = 0; i < p_.inputs();) {
        const std::ptrdiff_t distance = 8 * static_cast<std::ptrdiff_t>(i);
        if (i + 4 <= p_.inputs()) {
            c_.load_four(1, At{inputs_, distance});
            c_.store_four(At{slots_, distance}, 1);
            i += 4;
        } else {
            c_.load(1, At{inputs_, distance});
            store(i++, 1);
        }
    }
    // before functions that use registers of two lanes
    if (calls_) c_.leave_four();
}

/// All lanes of a store: who reads four of them does not wait for four stores.
RBDYN_INLINE void ValueCodeWriter::give_rates() {
    if (p_.outputs() < p_.inputs()) return;
    const auto pair = [this](int first, Vector to) {
        if (first >= p_.inputs()) return zero;
        const Vector low = value(p_.output(first), to);
        if (first + 1 >= p_.inputs()) {
            c_.low_lanes(to, low, zero);
            return to;
        }
        const int second = p_.output(first + 1);
        const Vector high = known(second);
        high != none ? c_.low_lanes(to, low, high) : c_.load_high(to, low, place(second));
        return to;
    };
    for (int i = 0; i < p_.inputs(); i += 4) {
        const Vector low = pair(i, 0), high = pair(i + 2, 1);
        c_.join(0, low, high);
        c_.store_four(At{rates_, 8 * static_cast<std::ptrdiff_t>(i)}, 0);
    }
}

RBDYN_INLINE void ValueCodeWriter::instruction(const Instruction& i) {
    if (is_called(i.code)) return call(i);
    if (i.code == Code::combine) return combine(i);
    const Vector to = room();
    if (i.code == Code::divide) {
        const Vector a = value(i.a, 0);
        with(i.b, [&](auto b) { c_.divide_one(to, a, b); });
    } else {
        c_.root_one(to, value(i.a, 0));
    }
    store(i.out, to);
    know(to, i.out);
}

RBDYN_INLINE void ValueCodeWriter::combine(const Instruction& i) {
    const Vector to = room();
    Vector sum = zero;
    if (i.weight >= 0) {
        c_.load(to, weight(i.weight));
        sum = to;
    }
    const auto add = [&](double factor, auto x) {
        factor < 0.0 ? c_.subtract_one(to, sum, x) : c_.add_one(to, sum, x);
        sum = to;
    };
    const auto is_one = [](double factor) { return factor == 1.0 || factor == -1.0; };
    for (int k = 0; k < i.terms; ++k) {
        const Term& term = p_.terms(i)[k];
        const double factor = p_.constant(term.weight);
        if (is_one(factor)) {
            with(term.slot, [&](auto x) { add(factor, x); });
        } else {
            const Vector x = value(term.slot, 0);
            c_.multiply_one(0, x, weight(term.weight));
            add(1.0, Vector(0));
        }
    }
    for (int k = 0; k < i.products; ++k) {
        const ProductTerm& term = p_.products(i)[k];
        const double factor = p_.constant(term.weight);
        product(0, term.a, term.b);
        if (!is_one(factor)) c_.multiply_one(0, 0, weight(term.weight));
        add(is_one(factor) ? factor : 1.0, Vector(0));
    }
    store(i.out, sum);
    know(to, sum == to ? i.out : free);
}

RBDYN_INLINE void ValueCodeWriter::call(const Instruction& i) {
    using enum machine_code::Register;
    using Called = void(const Instruction&, double*);
    const auto function = [&]() -> Called* {
        switch (i.code) {
            case Code::norm: return &compute_by<Code::norm>;
            case Code::sine_cosine: return &compute_by<Code::sine_cosine>;
            case Code::hyperbolic: return &compute_by<Code::hyperbolic>;
            case Code::tangent: return &compute_by<Code::tangent>;
            case Code::angle: return &compute_by<Code::angle>;
            case Code::exponential: return &compute_by<Code::exponential>;
            case Code::logarithm: return &compute_by<Code::logarithm>;
            case Code::expm1: return &compute_by<Code::expm1>;
            case Code::log1p: return &compute_by<Code::log1p>;
            case Code::arsinh: return &compute_by<Code::arsinh>;
            case Code::artanh: return &compute_by<Code::artanh>;
            default: return &compute_by<Code::power>;
        }
    };
    c_.address(di, At{instructions_, static_cast<std::ptrdiff_t>(sizeof i) * (&i - p_.instructions().data())});
    c_.move(si, slots_);
    c_.move(ax, reinterpret_cast<std::uint64_t>(function()));
    c_.call(ax);
    forget();
    c_.clear(zero);
}

RBDYN_INLINE ValueCodeWriter::At ValueCodeWriter::place(int slot) const {
    return {slot < p_.inputs() ? inputs_ : slots_, 8 * static_cast<std::ptrdiff_t>(slot)};
}

RBDYN_INLINE ValueCodeWriter::Vector ValueCodeWriter::known(int slot) const {
    for (std::size_t k = 0; k < slot_of_.size(); ++k)
        if (slot_of_[k] == slot) return static_cast<Vector>(first_known + k);
    return none;
}

RBDYN_INLINE ValueCodeWriter::Vector ValueCodeWriter::value(int slot) {
    if (const Vector x = known(slot); x != none) return x;
    const int again = next_use(slot, now_ + 1);
    const std::size_t place_of_it = farthest();
    const int there = slot_of_[place_of_it];
    if (again == std::numeric_limits<int>::max() || there == taken || (there != free && next_use(there, now_) <= again))
        return none;
    const auto to = static_cast<Vector>(first_known + place_of_it);
    c_.load(to, place(slot));
    know(to, slot);
    return to;
}

RBDYN_INLINE ValueCodeWriter::Vector ValueCodeWriter::value(int slot, Vector otherwise) {
    if (const Vector x = value(slot); x != none) return x;
    c_.load(otherwise, place(slot));
    return otherwise;
}

RBDYN_INLINE int ValueCodeWriter::next_use(int slot, int from) const {
    const std::vector<int>& uses = uses_[at(slot)];
    const auto next = std::lower_bound(uses.begin(), uses.end(), from);
    return next == uses.end() ? std::numeric_limits<int>::max() : *next;
}

RBDYN_INLINE std::size_t ValueCodeWriter::farthest() const {
    std::size_t best = 0;
    int farthest_use = -1;
    for (std::size_t k = 0; k < slot_of_.size(); ++k) {
        if (slot_of_[k] == free) return k;
        const int use = slot_of_[k] == taken ? -1 : next_use(slot_of_[k], now_);
        if (use > farthest_use) {
            farthest_use = use;
            best = k;
        }
    }
    return best;
}

RBDYN_INLINE ValueCodeWriter::Vector ValueCodeWriter::room() {
    const std::size_t k = farthest();
    slot_of_[k] = taken;
    return static_cast<Vector>(first_known + k);
}

RBDYN_INLINE void ValueCodeWriter::product(Vector to, int a, int b) {
    const Vector first = value(a, to);
    with(b, [&](auto second) { c_.multiply_one(to, first, second); });
}

}  // namespace rbdyn::inline RBDYN_FORM
#endif
