// The few instructions of x86-64 processors with AVX2 that machine code is made of (machine_code.hpp, value_code.hpp),
// and those of AVX-512 that do the same in eight lanes (abreast_code.hpp).
//
// Source of the encodings: Intel 64 and IA-32 Architectures Software Developer's Manual, volume 2, sections 2.1 to 2.3
// and 2.7.
#pragma once

#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <span>
#include <vector>

#include "rbdyn/basics/form.hpp"

namespace rbdyn::inline RBDYN_FORM::machine_code {

/// Registers of integers, by their numbers in the encoding.
enum class Register : std::uint8_t { ax, cx, dx, bx, sp, bp, si, di, r8, r9, r10, r11, r12, r13, r14, r15 };

/// What lies at a distance from where a register points, or one and another register's number of bytes beyond that.
struct At {
    Register base;
    std::ptrdiff_t distance;
    bool is_far = false;            // encoded in as many bytes whatever the distance
    Register index = Register::sp;  // the other register, of vectors in up to four lanes; sp: there is none
};

/// A register of vectors: all four lanes, or two, or the first one alone. With eight lanes there are 32 of them.
using Vector = std::uint8_t;

class Assembler {
public:
    /// `lanes`: of vectors that are whole, 4 or 8.
    explicit Assembler(int lanes = 4) : has_eight_(lanes == 8) {}

    static At far(At at) { return {at.base, at.distance, true, at.index}; }
    static At beyond(At at, std::ptrdiff_t by) { return {at.base, at.distance + by, at.is_far, at.index}; }
    std::span<const std::uint8_t> bytes() const { return {bytes_.data(), size_}; }
    std::size_t size() const { return size_; }

    // one lane
    void load(Vector to, At from) { vex(to, 0, from, Map::plain, Prefix::f2, false, 0x10); }
    void store(At to, Vector from) { vex(from, 0, to, Map::plain, Prefix::f2, false, 0x11); }
    void add_one(Vector to, Vector a, Vector b) { vex(to, a, b, Map::plain, Prefix::f2, false, 0x58); }
    void add_one(Vector to, Vector a, At b) { vex(to, a, b, Map::plain, Prefix::f2, false, 0x58); }
    void subtract_one(Vector to, Vector a, Vector b) { vex(to, a, b, Map::plain, Prefix::f2, false, 0x5c); }
    void subtract_one(Vector to, Vector a, At b) { vex(to, a, b, Map::plain, Prefix::f2, false, 0x5c); }
    void multiply_one(Vector to, Vector a, Vector b) { vex(to, a, b, Map::plain, Prefix::f2, false, 0x59); }
    void multiply_one(Vector to, Vector a, At b) { vex(to, a, b, Map::plain, Prefix::f2, false, 0x59); }
    void divide_one(Vector to, Vector a, Vector b) { vex(to, a, b, Map::plain, Prefix::f2, false, 0x5e); }
    void divide_one(Vector to, Vector a, At b) { vex(to, a, b, Map::plain, Prefix::f2, false, 0x5e); }
    void root_one(Vector to, Vector a) { vex(to, a, a, Map::plain, Prefix::f2, false, 0x51); }
    /// An integer of 64 bits as a double.
    void convert(Vector to, Register from) { vex(to, to, index(from), Map::plain, Prefix::f2, false, 0x2a, true); }
    void move(Vector to, Register from) { vex(to, 0, index(from), Map::plain, Prefix::x66, false, 0x6e, true); }

    // two lanes
    void load_high(Vector to, Vector low, At from) { vex(to, low, from, Map::plain, Prefix::x66, false, 0x16); }
    void store_high(At to, Vector from) { vex(from, 0, to, Map::plain, Prefix::x66, false, 0x17); }
    void load_twice(Vector to, At from) { vex(to, 0, from, Map::plain, Prefix::f2, false, 0x12); }
    void low_lanes(Vector to, Vector a, Vector b) { vex(to, a, b, Map::plain, Prefix::x66, false, 0x14); }
    void high_lanes(Vector to, Vector a, Vector b) { vex(to, a, b, Map::plain, Prefix::x66, false, 0x15); }
    void clear(Vector to) { vex(to, to, to, Map::plain, Prefix::x66, false, 0x57); }
    void store_two(At to, Vector from) { vex(from, 0, to, Map::plain, Prefix::x66, false, 0x11); }
    void add_two(Vector to, Vector a, Vector b) { vex(to, a, b, Map::plain, Prefix::x66, false, 0x58); }

    // four lanes
    void load_four(Vector to, At from) { vex(to, 0, from, Map::plain, Prefix::x66, true, 0x10); }
    void store_four(At to, Vector from) { vex(from, 0, to, Map::plain, Prefix::x66, true, 0x11); }
    void move_four(Vector to, Vector from) { vex(to, 0, from, Map::plain, Prefix::x66, true, 0x28); }
    void add_four(Vector to, Vector a, Vector b) { vex(to, a, b, Map::plain, Prefix::x66, true, 0x58); }
    void add_four(Vector to, Vector a, At b) { vex(to, a, b, Map::plain, Prefix::x66, true, 0x58); }
    void multiply_four(Vector to, Vector a, Vector b) { vex(to, a, b, Map::plain, Prefix::x66, true, 0x59); }
    void multiply_four(Vector to, Vector a, At b) { vex(to, a, b, Map::plain, Prefix::x66, true, 0x59); }
    void spread(Vector to, At from) { vex(to, 0, from, Map::x38, Prefix::x66, true, 0x19); }
    void spread(Vector to, Vector from) { vex(to, 0, from, Map::x38, Prefix::x66, true, 0x19); }
    void join(Vector to, Vector low, Vector high) {
        vex(to, low, high, Map::x3a, Prefix::x66, true, 0x18);
        put({1});
    }
    void upper_half(Vector to, Vector from) {
        vex(from, 0, to, Map::x3a, Prefix::x66, true, 0x19);
        put({1});
    }
    void upper_half(At to, Vector from) {
        vex(from, 0, to, Map::x3a, Prefix::x66, true, 0x19);
        put({1});
    }
    /// Of b the lanes whose bit is set, of a the others.
    void blend(Vector to, Vector a, At b, std::uint8_t bits) {
        vex(to, a, b, Map::x3a, Prefix::x66, true, 0x0d);
        put({bits});
    }
    // all lanes
    void load_all(Vector to, At from) { all(to, 0, from, 0x10); }
    void store_all(At to, Vector from) { all(from, 0, to, 0x11); }
    void move_all(Vector to, Vector from) { all(to, 0, from, 0x28); }
    void add_all(Vector to, Vector a, Vector b) { all(to, a, b, 0x58); }
    void add_all(Vector to, Vector a, At b) { all(to, a, b, 0x58); }
    void subtract_all(Vector to, Vector a, Vector b) { all(to, a, b, 0x5c); }
    void subtract_all(Vector to, Vector a, At b) { all(to, a, b, 0x5c); }
    void multiply_all(Vector to, Vector a, Vector b) { all(to, a, b, 0x59); }
    void multiply_all(Vector to, Vector a, At b) { all(to, a, b, 0x59); }
    void divide_all(Vector to, Vector a, Vector b) { all(to, a, b, 0x5e); }
    void divide_all(Vector to, Vector a, At b) { all(to, a, b, 0x5e); }
    void spread_all(Vector to, Vector from) { all(to, 0, from, 0x19, Map::x38); }

    /// Before other code, which may use registers of two lanes.
    void leave_four() { put({0xc5, 0xf8, 0x77}); }

    // integers
    void move(Register to, Register from) { whole(from, to, 0x89); }
    void move(Register to, At from) { memory(to, from, 0x8b); }
    void move(At to, Register from) { memory(from, to, 0x89); }
    /// An integer of 32 bits, the others zero.
    void move_short(Register to, At from) {
        if (index(to) > 7 || index(from.base) > 7)
            put({static_cast<std::uint8_t>(0x40 | (index(to) > 7 ? 4 : 0) | (index(from.base) > 7 ? 1 : 0))});
        put({0x8b});
        place_of(index(to), from);
    }
    void address(Register to, At from) { memory(to, from, 0x8d); }
    void add(Register to, Register from) { whole(from, to, 0x01); }
    void add(Register to, At from) { memory(to, from, 0x03); }
    void subtract(Register to, Register from) { whole(from, to, 0x29); }
    void compare(Register a, Register b) { whole(b, a, 0x39); }
    void compare(Register a, At b) { memory(a, b, 0x3b); }
    void add(Register to, std::int32_t number) { by_number(to, 0, number); }
    void compare(At a, std::int32_t number) {
        prefix(false, index(a.base) > 7);
        put({0x81});
        place_of(7, a);
        number_of(number);
    }
    /// An integer of 32 bits.
    void compare_short(At a, std::int32_t number) {
        if (index(a.base) > 7) put({0x41});
        put({0x81});
        place_of(7, a);
        number_of(number);
    }
    void compare(Register a, std::int32_t number) { by_number(a, 7, number); }
    void keep(Register from, std::int32_t mask) { by_number(from, 4, mask); }
    void shift_left(Register to, std::uint8_t by) {
        prefix(false, index(to) > 7);
        put({0xc1, static_cast<std::uint8_t>(0xe0 | (index(to) & 7)), by});
    }
    void shift_right(Register to, std::uint8_t by) {
        prefix(false, index(to) > 7);
        put({0xc1, static_cast<std::uint8_t>(0xe8 | (index(to) & 7)), by});
    }
    void move(Register to, std::uint64_t number) {
        prefix(false, index(to) > 7);
        put({static_cast<std::uint8_t>(0xb8 | (index(to) & 7))});
        for (int i = 0; i < 8; ++i) put({static_cast<std::uint8_t>(number >> (8 * i))});
    }
    void push(Register r) {
        if (index(r) > 7) put({0x41});
        put({static_cast<std::uint8_t>(0x50 | (index(r) & 7))});
    }
    void pop(Register r) {
        if (index(r) > 7) put({0x41});
        put({static_cast<std::uint8_t>(0x58 | (index(r) & 7))});
    }
    void call(Register r) {
        if (index(r) > 7) put({0x41});
        put({0xff, static_cast<std::uint8_t>(0xd0 | (index(r) & 7))});
    }
    void jump(Register r) {
        if (index(r) > 7) put({0x41});
        put({0xff, static_cast<std::uint8_t>(0xe0 | (index(r) & 7))});
    }
    void leave() { put({0xc3}); }

    // jumps: to what is known, or to what land() tells later
    enum class When : std::uint8_t { equal = 0x84, not_equal = 0x85, below = 0x8c, at_least = 0x8d };
    std::size_t jump_if(When when) {
        put({0x0f, static_cast<std::uint8_t>(when)});
        return open();
    }
    std::size_t jump() {
        put({0xe9});
        return open();
    }
    void jump_if(When when, std::size_t to) { land(jump_if(when), to); }
    /// The address of a place in the code.
    std::size_t place(Register to) {
        prefix(index(to) > 7, false);
        put({0x8d, static_cast<std::uint8_t>((index(to) & 7) << 3 | 5)});
        return open();
    }
    void land(std::size_t from) { land(from, size()); }
    void land(std::size_t from, std::size_t to) {
        const auto distance = static_cast<std::uint32_t>(to - from - 4);
        for (std::size_t i = 0; i < 4; ++i) bytes_[from + i] = static_cast<std::uint8_t>(distance >> (8 * i));
    }

private:
    enum class Map : std::uint8_t { plain = 1, x38 = 2, x3a = 3 };
    enum class Prefix : std::uint8_t { none = 0, x66 = 1, f3 = 2, f2 = 3 };

    static std::uint8_t index(Register r) { return static_cast<std::uint8_t>(r); }
    void put(std::initializer_list<std::uint8_t> bytes) {
        if (size_ + bytes.size() > bytes_.size()) bytes_.resize(2 * bytes_.size());
        for (const std::uint8_t byte : bytes) bytes_[size_++] = byte;
    }
    std::size_t open() {
        put({0, 0, 0, 0});
        return size() - 4;
    }
    void vex_prefix(std::uint8_t reg, std::uint8_t second, std::uint8_t rm, Map map, Prefix prefix, bool four,
                    bool wide, std::uint8_t x = 0) {
        const auto last = static_cast<std::uint8_t>((~second & 15) << 3 | (four ? 4 : 0) | static_cast<int>(prefix));
        if (map == Map::plain && rm < 8 && x < 8 && !wide) {
            put({0xc5, static_cast<std::uint8_t>((reg < 8 ? 0x80 : 0) | last)});
        } else {
            put({0xc4,
                 static_cast<std::uint8_t>((reg < 8 ? 0x80 : 0) | (x < 8 ? 0x40 : 0) | (rm < 8 ? 0x20 : 0) |
                                           static_cast<int>(map)),
                 static_cast<std::uint8_t>((wide ? 0x80 : 0) | last)});
        }
    }
    void vex(Vector reg, Vector second, Vector rm, Map map, Prefix prefix, bool four, std::uint8_t code,
             bool wide = false) {
        vex_prefix(reg, second, rm, map, prefix, four, wide);
        put({code, static_cast<std::uint8_t>(0xc0 | (reg & 7) << 3 | (rm & 7))});
    }
    void vex(Vector reg, Vector second, At rm, Map map, Prefix prefix, bool four, std::uint8_t code) {
        vex_prefix(reg, second, index(rm.base), map, prefix, four, false, index(rm.index));
        put({code});
        place_of(reg, rm);
    }
    void all(Vector reg, Vector second, Vector rm, std::uint8_t code, Map map = Map::plain) {
        if (!has_eight_) return vex(reg, second, rm, map, Prefix::x66, true, code);
        evex_prefix(reg, second, static_cast<std::uint8_t>(rm & 15), rm < 16, map);
        put({code, static_cast<std::uint8_t>(0xc0 | (reg & 7) << 3 | (rm & 7))});
    }
    void all(Vector reg, Vector second, At rm, std::uint8_t code) {
        if (!has_eight_) return vex(reg, second, rm, Map::plain, Prefix::x66, true, code);
        evex_prefix(reg, second, index(rm.base), true, Map::plain);
        put({code});
        place_of(reg, rm, 64);
    }
    /// Of 64 bytes and doubles. `is_low`: the operand is none of the registers from 16 on.
    void evex_prefix(Vector reg, Vector second, std::uint8_t rm, bool is_low, Map map) {
        put({0x62,
             static_cast<std::uint8_t>(((reg & 8) == 0 ? 0x80 : 0) | (is_low ? 0x40 : 0) | (rm < 8 ? 0x20 : 0) |
                                       (reg < 16 ? 0x10 : 0) | static_cast<int>(map)),
             static_cast<std::uint8_t>(0x85 | (~second & 15) << 3),
             static_cast<std::uint8_t>(0x40 | (second < 16 ? 8 : 0))});
    }
    /// The operand's byte, and the distance; a short one is counted in units.
    void place_of(std::uint8_t reg, At at, std::ptrdiff_t unit = 1) {
        const auto low = static_cast<std::uint8_t>(index(at.base) & 7);
        const bool is_short =
            !at.is_far && at.distance % unit == 0 && at.distance >= -128 * unit && at.distance < 128 * unit;
        const bool has_index = at.index != Register::sp;
        put({static_cast<std::uint8_t>((is_short ? 0x40 : 0x80) | (reg & 7) << 3 | (has_index ? 4 : low))});
        if (has_index || low == 4) put({static_cast<std::uint8_t>((index(at.index) & 7) << 3 | low)});
        if (is_short)
            put({static_cast<std::uint8_t>(at.distance / unit)});
        else
            number_of(static_cast<std::int32_t>(at.distance));
    }
    void prefix(bool reg, bool rm) { put({static_cast<std::uint8_t>(0x48 | (reg ? 4 : 0) | (rm ? 1 : 0))}); }
    void whole(Register reg, Register rm, std::uint8_t code) {
        prefix(index(reg) > 7, index(rm) > 7);
        put({code, static_cast<std::uint8_t>(0xc0 | (index(reg) & 7) << 3 | (index(rm) & 7))});
    }
    void memory(Register reg, At at, std::uint8_t code) {
        prefix(index(reg) > 7, index(at.base) > 7);
        put({code});
        place_of(index(reg), at);
    }
    void by_number(Register r, std::uint8_t code, std::int32_t number) {
        prefix(false, index(r) > 7);
        put({0x81, static_cast<std::uint8_t>(0xc0 | code << 3 | (index(r) & 7))});
        number_of(number);
    }
    void number_of(std::int32_t number) {
        const auto bits = static_cast<std::uint32_t>(number);
        put({static_cast<std::uint8_t>(bits), static_cast<std::uint8_t>(bits >> 8),
             static_cast<std::uint8_t>(bits >> 16), static_cast<std::uint8_t>(bits >> 24)});
    }

    bool has_eight_;
    // longer than what is written so far
    std::vector<std::uint8_t> bytes_ = std::vector<std::uint8_t>(1U << 14);
    std::size_t size_ = 0;
};

}  // namespace rbdyn::inline RBDYN_FORM::machine_code
