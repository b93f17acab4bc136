// An input of bytes, read as numbers and choices; where it ends all are zero.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <string_view>

#include "rbdyn/basics/vector.hpp"

namespace rbdyn::fuzz {

class Bytes {
public:
    explicit Bytes(std::string_view bytes) : bytes_(bytes) {}

    bool is_over() const { return bytes_.empty(); }
    unsigned byte() {
        if (bytes_.empty()) return 0;
        const auto first = static_cast<unsigned char>(bytes_.front());
        bytes_.remove_prefix(1);
        return first;
    }
    /// 0 to count - 1.
    int choice(int count) { return static_cast<int>(byte()) % count; }
    std::size_t place(std::size_t count) { return count == 0 ? 0 : (byte() * 256U + byte()) % count; }
    /// Three of four are plain: halves from -4 to 4; the others are those that break things.
    double number() {
        constexpr double infinity = std::numeric_limits<double>::infinity();
        constexpr std::array<double, 16> odd = {
            0.0,  -0.0, 1e-300, 5e-324, 1e300, -1e300,      infinity, std::numeric_limits<double>::quiet_NaN(),
            1e-9, 1e9,  1e-16,  1e16,   -1.0,  1.0 + 1e-15, 0.1,      3.141592653589793};
        const unsigned first = byte();
        if (first < 192) return 0.5 * (static_cast<double>(first % 17) - 8.0);
        return odd[first % odd.size()];
    }
    double positive() { return std::abs(number()); }
    Vector3 vector() {
        const double x = number(), y = number();
        return {x, y, number()};
    }
    std::string_view rest() const { return bytes_; }

private:
    std::string_view bytes_;
};

}  // namespace rbdyn::fuzz
