// The lengths of steps of several motions abreast, one in each lane of a vector: what log_step() (step_length.hpp)
// gives each of them alone, bit for bit, by the same operations.
//
// Motions of which a coefficient counts as zero, or is rounding of a polynomial that was computed as more, are rare,
// and are left to log_step().
#pragma once

#include "rbdyn/series/abreast.hpp"
#include "rbdyn/series/step_length.hpp"

#ifdef RBDYN_HAS_LANES
#include <cstddef>
#include <cstdint>
#include <cstring>

#include "rbdyn/basics/form.hpp"

namespace rbdyn::inline RBDYN_FORM::series::abreast {

/// Whole numbers as wide as vectors of doubles, by their number of lanes.
template <std::size_t lanes>
struct Whole;
template <>
struct Whole<4> {
    using type = std::int64_t __attribute__((vector_size(32), aligned(32), may_alias));
};
template <>
struct Whole<8> {
    using type = std::int64_t __attribute__((vector_size(64), aligned(64), may_alias));
};
template <class Lanes>
using WholeOf = typename Whole<sizeof(Lanes) / sizeof(double)>::type;

template <class Lanes>
RBDYN_ABREAST void bits_of(const Lanes& x, WholeOf<Lanes>& bits) {
    std::memcpy(&bits, &x, sizeof bits);
}
template <class Lanes>
RBDYN_ABREAST void of_bits(const WholeOf<Lanes>& bits, Lanes& x) {
    std::memcpy(&x, &bits, sizeof x);
}

/// As rough_log2_ratio().
template <class Lanes>
RBDYN_ABREAST void rough_log2_ratio(const Lanes& a, const Lanes& b, Lanes& out) {
    using Bits = WholeOf<Lanes>;
    Bits of_a, of_b;
    bits_of(a, of_a);
    bits_of(b, of_b);
    // a whole number as a double, rounded once: both halves stand behind a power of two of their own (2^52, 2^84 +
    // 2^63)
    const Bits difference = of_a - of_b,
               low = (difference & std::int64_t{0xffffffff}) | std::int64_t{0x4330000000000000},
               high = static_cast<Bits>(static_cast<Bits>((difference >> 32) & std::int64_t{0xffffffff}) ^
                                        std::int64_t{0x4530000080000000});
    Lanes low_half, high_half;
    of_bits(low, low_half);
    of_bits(high, high_half);
    out = ((high_half - (0x1p84 + 0x1p63 + 0x1p52)) + low_half) * 0x1p-52;
}

/// As rough_exp2().
template <class Lanes>
RBDYN_ABREAST void rough_exp2(const Lanes& x, Lanes& out) {
    using Bits = WholeOf<Lanes>;
    const Lanes low = Lanes{} - 1022.0, high = Lanes{} + 1023.0, least = x < low ? low : x;
    const Lanes y = (least > high ? high : least) + 1023.0, up = y + 0x1p52, nearest = up - 0x1p52;
    // below what it was rounded to: the whole part is one less
    const Bits is_above = nearest > y;
    Bits whole;
    bits_of(up, whole);
    whole = whole - std::int64_t{0x4330000000000000} + is_above;
    const Lanes one = Lanes{} + 1.0, zero{}, part = 1.0 + ((y - nearest) + (is_above ? one : zero));
    Bits bits;
    bits_of(part, bits);
    of_bits(static_cast<Bits>(bits + ((whole - 1023) << 52)), out);
}

/// log_step() of sizes of order p >= 4; `is_known`: zero where it is another one that log_step() has to find.
template <class Lanes>
RBDYN_ABREAST void log_step(const Lanes* size, int p, const Lanes& scale, const Lanes& log_tolerance, Lanes& out,
                            WholeOf<Lanes>& is_known) {
    const int middle = p / 2;
    is_known = size[1] > least_size;
    for (int k = p - 3; k <= p; ++k) is_known &= size[k] > least_size;
    for (int k = middle - 1; k <= middle + 1; ++k) is_known &= size[k] > least_size;
    Lanes ratio, log_radius, reach;
    for (int k = p; k >= p - 3; --k) {
        rough_log2_ratio(size[1], size[k], ratio);
        const Lanes quotient = ratio / static_cast<double>(k - 1);
        log_radius = k == p ? quotient : quotient < log_radius ? quotient : log_radius;
    }
    rough_exp2(log_radius, reach);
    reach = 0.3 * reach;
    const Lanes within = reach * (size[1] + reach * (size[2] + reach * size[3])),
                wide = scale < within ? within : scale;
    is_known &= wide > least_size;
    Lanes log_length, largest;
    for (int k = p; k >= p - 3; --k) {
        rough_log2_ratio(wide, size[k], ratio);
        const Lanes allowed =
            k >= p - 1 ? log_tolerance : log_tolerance * static_cast<double>(k) / static_cast<double>(p);
        const Lanes quotient = (allowed + ratio) / static_cast<double>(k);
        log_length = k == p ? quotient : quotient < log_length ? quotient : log_length;
    }
    for (int k = middle - 1; k <= middle + 1; ++k) {
        rough_log2_ratio(wide, size[k], ratio);
        const Lanes term = static_cast<double>(k) * log_length - ratio;
        largest = k == middle - 1 ? term : largest < term ? term : largest;
    }
    is_known &= ~(largest < 0.75 * log_tolerance);
    out = log_length;
}

/// Lanes of a and b, which are 0 to 3 and 4 to 7, in an order.
template <int... lanes>
RBDYN_ABREAST void pick(const Four& a, const Four& b, Four& out) {
#if defined(__clang__)
    out = __builtin_shufflevector(a, b, lanes...);
#else
    using Places = std::int64_t __attribute__((vector_size(32)));
    out = __builtin_shuffle(a, b, Places{lanes...});
#endif
}

/// Coefficients 0 .. count - 1 of a series of several motions, to a row of each: four by four.
template <class Lanes>
RBDYN_ABREAST void rows(const Lanes* c, int count, double* const* to) {
    constexpr int lanes = sizeof(Lanes) / sizeof(double), four = 4;
    for (int first = 0; first < lanes; first += four) {
        const auto* const from = reinterpret_cast<const Four*>(c) + first / four;
        constexpr int next = lanes / four;
        int k = 0;
        for (; k + four <= count; k += four) {
            const Four a = from[k * next], b = from[(k + 1) * next], d = from[(k + 2) * next], e = from[(k + 3) * next];
            Four p, q, r, s, row[four];
            pick<0, 4, 2, 6>(a, b, p);
            pick<1, 5, 3, 7>(a, b, q);
            pick<0, 4, 2, 6>(d, e, r);
            pick<1, 5, 3, 7>(d, e, s);
            pick<0, 1, 4, 5>(p, r, row[0]);
            pick<0, 1, 4, 5>(q, s, row[1]);
            pick<2, 3, 6, 7>(p, r, row[2]);
            pick<2, 3, 6, 7>(q, s, row[3]);
            for (int l = 0; l < four; ++l)
                if (to[first + l] != nullptr) std::memcpy(to[first + l] + k, &row[l], sizeof row[l]);
        }
        for (; k < count; ++k)
            for (int l = 0; l < four; ++l)
                if (to[first + l] != nullptr) to[first + l][k] = from[k * next][l];
    }
}

}  // namespace rbdyn::inline RBDYN_FORM::series::abreast

#endif
