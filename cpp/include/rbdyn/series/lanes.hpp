// Numbers side by side: two or four lanes of a vector.
//
// Code in four lanes is compiled twice, for processors that have them (AVX2) and for all others: it is inlined into a
// function of each. Both do the same operations in the same order, without fused multiply-add: the same bits.
#pragma once

#include <cstring>

#include "rbdyn/basics/form.hpp"

#if (defined(__GNUC__) || defined(__clang__)) && defined(__x86_64__)
#define RBDYN_WIDE_LANES 1
#define RBDYN_INLINE_LANES [[gnu::always_inline]] inline
#elif defined(__GNUC__) || defined(__clang__)
#define RBDYN_INLINE_LANES [[gnu::always_inline]] inline
#else
#define RBDYN_INLINE_LANES inline
#endif

namespace rbdyn::inline RBDYN_FORM::series {

/// Two lanes; a loop over them is left alone by compilers that do not look for it.
#if defined(__GNUC__) || defined(__clang__)
using Pair = double __attribute__((vector_size(16)));
using Quad = double __attribute__((vector_size(32), aligned(32)));
#else
struct Pair {
    double lanes[2];
    double operator[](int i) const { return lanes[i]; }
    Pair operator*(const Pair& b) const { return {lanes[0] * b[0], lanes[1] * b[1]}; }
    Pair operator+(const Pair& b) const { return {lanes[0] + b[0], lanes[1] + b[1]}; }
    Pair& operator+=(const Pair& b) { return *this = *this + b; }
};
struct alignas(32) Quad {
    double lanes[4];
    double operator[](int i) const { return lanes[i]; }
    Quad operator*(const Quad& b) const { return {lanes[0] * b[0], lanes[1] * b[1], lanes[2] * b[2], lanes[3] * b[3]}; }
    Quad operator+(const Quad& b) const { return {lanes[0] + b[0], lanes[1] + b[1], lanes[2] + b[2], lanes[3] + b[3]}; }
    Quad& operator+=(const Quad& b) { return *this = *this + b; }
};
#endif

// copies, for doubles in an array lie at any multiple of eight bytes
inline Pair pair_at(const double* a) {
    Pair pair;
    std::memcpy(&pair, a, sizeof pair);
    return pair;
}
inline void set_pair(double* a, const Pair& pair) { std::memcpy(a, &pair, sizeof pair); }

/// Four lanes of a sum of products of doubles: on every processor, in registers of two.
class FourByTwo {
public:
    RBDYN_INLINE_LANES FourByTwo(const double* a, const double* b)
        : low_(pair_at(a) * pair_at(b)), high_(pair_at(a + 2) * pair_at(b + 2)) {}
    RBDYN_INLINE_LANES void add(const double* a, const double* b) {
        low_ += pair_at(a) * pair_at(b);
        high_ += pair_at(a + 2) * pair_at(b + 2);
    }
    RBDYN_INLINE_LANES double sum() const {
        const Pair both = low_ + high_;
        return both[0] + both[1];
    }

private:
    Pair low_, high_;
};

#ifdef RBDYN_WIDE_LANES
/// The same, where there are registers of four.
class Four {
public:
    RBDYN_INLINE_LANES Four(const double* a, const double* b) : all_(at(a).lanes * at(b).lanes) {}
    RBDYN_INLINE_LANES void add(const double* a, const double* b) { all_ += at(a).lanes * at(b).lanes; }
    RBDYN_INLINE_LANES double sum() const {
        Pair half[2];
        std::memcpy(half, &all_, sizeof half);
        const Pair both = half[0] + half[1];
        return both[0] + both[1];
    }

private:
    // a struct, for clang forgets the alignment of a type that has only a name
    struct __attribute__((packed, may_alias)) Unaligned {
        double lanes __attribute__((vector_size(32)));
    };
    RBDYN_INLINE_LANES static const Unaligned& at(const double* a) { return *reinterpret_cast<const Unaligned*>(a); }
    Quad all_;
};
#endif

}  // namespace rbdyn::inline RBDYN_FORM::series
