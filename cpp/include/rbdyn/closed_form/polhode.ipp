// Definitions of rbdyn/closed_form/polhode.hpp.
#pragma once

#include "rbdyn/closed_form/polhode.hpp"

#include <array>
#include <cmath>
#include <cstddef>

#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/sort_few.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/closed_form/carlson.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE bool Polhode::constant(const Vector3Of<DoubleDouble>& moments, const Vector3Of<DoubleDouble>& omega) {
    for (int i = 0; i < 3; ++i) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        if (omega[j].hi != 0.0 && omega[k].hi != 0.0 && moments[j] != moments[k]) return false;
    }
    return true;
}

RBDYN_INLINE Polhode::Polhode(const Vector3Of<DoubleDouble>& moments, const Vector3Of<DoubleDouble>& omega) {
    const auto square = [](const DoubleDouble& x) { return x * x; };
    std::array<int, 3> order{0, 1, 2};
    sort_few<int>(order, [&](int i, int j) { return moments[i] < moments[j]; });
    const auto [a, b, c] = order;
    const DoubleDouble by_a = moments[a] * (moments[b] - moments[a]) * square(omega[a]);
    const DoubleDouble by_c = moments[c] * (moments[c] - moments[b]) * square(omega[c]);
    const DoubleDouble d = by_a - by_c;
    difference = std::abs(d.hi);

    axis = d.hi > 0.0 ? std::array{c, b, a} : std::array{a, b, c};
    const bool back = omega[axis[0]].hi < 0.0, down = omega[axis[2]].hi < 0.0;
    const bool left_handed = (axis[1] - axis[0] + 3) % 3 != 1;
    reversed = {back, (back != down) != left_handed, down};
    const auto component = [&](std::size_t i) { return reversed[i] ? -omega[axis[i]] : omega[axis[i]]; };
    const DoubleDouble w1 = component(0), w2 = component(1), w3 = component(2);
    i1 = moments[axis[0]];
    i2 = moments[b];
    i3 = moments[axis[2]];
    const DoubleDouble d32 = i3 - i2, d31 = i3 - i1, d21 = i2 - i1;
    sign = d32.hi > 0.0 ? 1.0 : -1.0;

    const DoubleDouble alpha2 = square(w1) + i2 * d32 / (i1 * d31) * square(w2);
    const DoubleDouble gamma2 = square(w3) + i2 * d21 / (i3 * d31) * square(w2);
    alpha = sqrt(alpha2);
    beta = sqrt(alpha2 * (i1 * d31) / (i2 * d32));
    gamma = sqrt(gamma2);
    const DoubleDouble whole = i3 * d32 * gamma2;
    m = i1 * d21 * alpha2 / whole;
    m1 = abs(d) / abs(whole);
    mu = gamma * sqrt(d31 * d32 / (i1 * i2));
    quarter = double_double::half_pi / elliptic::arithmetic_geometric_mean(1.0, sqrt(m1));
    quarter1 = double_double::half_pi / elliptic::arithmetic_geometric_mean(1.0, sqrt(m));
    u0 = sign * w2 / beta * elliptic::carlson_f(square(w1) / alpha2, square(w3) / gamma2, 1.0);

    momentum1 = i1 * alpha;
    momentum3 = i3 * gamma;
    momentum = sqrt(square(momentum1) + square(momentum3));
    energy2 = i1 * square(w1) + i2 * square(w2) + i3 * square(w3);
}

}  // namespace rbdyn::inline RBDYN_FORM
