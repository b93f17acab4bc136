// Formulas at random.
#pragma once

#include <cstddef>
#include <random>
#include <vector>

#include "rbdyn/rbdyn.hpp"

namespace rbdyn::test {

/// Formulas at random of nine numbers: two of the user's, the time, a place and a velocity.
class RandomFormula {
public:
    explicit RandomFormula(unsigned seed) : engine_(seed) {}

    Expression operator()(int depth, const std::vector<Expression>& x) {
        if (depth == 0 || draw(6) == 0) return draw(4) == 0 ? Expression(constants[at(draw(5))]) : x[at(draw(9))];
        const auto next = [&] { return (*this)(depth - 1, x); };
        const Expression a = next();
        switch (draw(11)) {
            case 0:
            case 1: return a + next();
            case 2:
            case 3: return a * next();
            case 4: return a - next();
            case 5: return a / (2.5 + sin(next()));
            case 6: return sin(a);
            case 7: return exp(cos(a));
            case 8: return abs(a);
            case 9: return where(a > 0.0, next(), next());
            default: return max(a, next());
        }
    }
    int draw(int count) { return std::uniform_int_distribution<int>(0, count - 1)(engine_); }

private:
    static constexpr double constants[] = {1.0, -1.0, 0.5, 2.0, 0.3};
    static std::size_t at(int i) { return static_cast<std::size_t>(i); }
    std::mt19937 engine_;
};

}  // namespace rbdyn::test
