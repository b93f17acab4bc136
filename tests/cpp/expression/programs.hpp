// Programs of which machine code is made, and held against the lists.
#pragma once

#include <bit>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "random.hpp"
#include "rbdyn/expression/elementary.hpp"
#include "rbdyn/expression/machine_code.hpp"
#include "rbdyn/expression/program.hpp"
#include "rbdyn/expression/recorder.hpp"

namespace rbdyn::test {

/// Of what is not a number, neither.
inline bool are_same(double a, double b) {
    return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b) || (std::isnan(a) && std::isnan(b));
}

/// Whether this library makes code for this machine; of others there is nothing to be held.
inline bool is_made() {
#ifdef __x86_64__
    return MachineCode::is_built() && __builtin_cpu_supports("avx2");
#else
    return false;
#endif
}

/// Every instruction; norms that may begin at zero.
inline Program everything() {
    Recorder r;
    const Expression x = r.input(0), y = r.input(1), z = r.input(2), t = r.time(), p = r.parameter(r.new_parameter());
    std::vector<Expression> outputs = {p * y * z - 0.3 * x * sin(x) + exp(-x * y) + 0.1 * t,
                                       cos(z) * sqrt(x * x + 2.0) - x / (y * y + 1.0) + 0.25 * (x * x + y * y),
                                       tanh(x - y) + sinh(0.2 * z) * cosh(0.1 * x) - 0.5 * z + p * x * y};
    outputs.push_back(log(x * x + 1.5) + pow(y * y + 0.5, 1.25) + pow(z * z + 0.25, -2.0) + 2.0);
    outputs.back() += expm1(0.5 * x) + log1p(y * y) + asinh(z) + atanh(0.2 * x) + pow(y * y + 0.5, x);
    outputs.push_back(recording::angle(y, x + 4.0) * length({x, y, z}));
    outputs.push_back((x - y) * (x + y) * (z - x) + p);
    outputs.push_back(outputs[0] * outputs[0]);
    return Program(r, outputs, 3);
}

/// Rates of some variables in which some of what came before occurs, with weights that are often one or zero.
inline Program random_program(Random& random, int inputs) {
    Recorder r;
    std::vector<Expression> known;
    for (int i = 0; i < inputs; ++i) known.push_back(r.input(i));
    if (random.chance(0.3)) known.push_back(r.time());
    const Expression p = r.parameter(r.new_parameter());
    const auto some = [&] {
        return known[static_cast<std::size_t>(random.whole(0, static_cast<int>(known.size()) - 1))];
    };
    const auto weight = [&]() -> Expression {
        switch (random.whole(0, 4)) {
            case 0: return 1.0;
            case 1: return -1.0;
            case 2: return p;
            default: return random.uniform(-2.0, 2.0);
        }
    };
    // one draw after the other: no compiler has an order of its own for arguments
    const auto two = [&] {
        const Expression a = some(), b = some();
        return std::pair(a, b);
    };
    const auto product = [&] {
        const auto [a, b] = two();
        return a * b;
    };
    const auto weighted = [&](const Expression& value) {
        const Expression w = weight();
        return w * value;
    };
    const int count = random.whole(3, 25);
    for (int i = 0; i < count; ++i) {
        Expression sum = random.chance(0.3) ? Expression(random.uniform(-1.0, 1.0)) : Expression(0.0);
        for (int term = random.whole(0, 3); term > 0; --term) sum = sum + weighted(some());
        for (int term = random.whole(0, 6); term > 0; --term) sum = sum + weighted(product());
        known.push_back(sum);
        switch (random.whole(0, 11)) {
            case 0: {
                const Expression over = 2.0 + product() * 0.01;
                known.push_back(some() / over);
                break;
            }
            case 1: {
                const auto [a, b] = two();
                known.push_back(sin(a) * cos(b));
                break;
            }
            case 2: {
                const auto [a, b] = two();
                known.push_back(length({a, b, some()}));
                break;
            }
            case 3: {
                const Expression base = product() + 1.0;
                known.push_back(pow(base, random.uniform(-1.0, 2.0)));
                break;
            }
            case 4: known.push_back(exp(0.1 * sin(some()))); break;
            case 5: known.push_back(sqrt(product() + 1.0)); break;
            default: break;
        }
    }
    std::vector<Expression> outputs;
    for (int i = 0; i < inputs; ++i) {
        const Expression value = some();
        outputs.push_back(i % 2 == 0 ? known.back() * (1.0 / (i + 1)) + value : value);
    }
    for (int i = random.whole(0, 3); i > 0; --i) outputs.push_back(some());
    return Program(r, outputs, inputs);
}

}  // namespace rbdyn::test
