// Random numbers that are the same everywhere.
#pragma once

#include <cmath>
#include <cstdint>

#include "rbdyn/basics/vector.hpp"

namespace rbdyn::test {

/// Whole and real numbers from a counter (Steele, Lea and Flood's SplitMix64): the same with every library.
class Random {
public:
    explicit Random(std::uint64_t seed) : state_(seed) {}
    std::uint64_t bits() {
        std::uint64_t z = state_ += 0x9e3779b97f4a7c15ULL;
        z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
        z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
        return z ^ (z >> 31);
    }
    double uniform(double lo, double hi) { return lo + (hi - lo) * static_cast<double>(bits() >> 11) * 0x1p-53; }
    double logarithmic(double lo, double hi) { return std::exp(uniform(std::log(lo), std::log(hi))); }
    int whole(int lo, int hi) { return lo + static_cast<int>(bits() % static_cast<std::uint64_t>(hi - lo + 1)); }
    bool chance(double probability) { return uniform(0.0, 1.0) < probability; }
    Vector3 direction() {
        for (;;) {
            const Vector3 v(uniform(-1, 1), uniform(-1, 1), uniform(-1, 1));
            if (v.norm() > 0.1 && v.norm() < 1.0) return v.normalized();
        }
    }

private:
    std::uint64_t state_;
};

}  // namespace rbdyn::test
