// Integrals of either sign, to rounding: the range halved until the Gauss-Kronrod pair of each piece agrees.
//
// The rules and the measure of one piece are those of arc lengths (curve/arc_length.hpp); here pieces may cancel, so
// that errors are weighed by the sizes of all pieces together.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/interruption.hpp"
#include "rbdyn/curve/arc_length.hpp"

namespace rbdyn::inline RBDYN_FORM::curves {

/// The integral of f from a to b. `floor`: the rounding of f itself, times the range. `noise`: relative rounding of f
/// where that is more than usual; f may raise it.
template <class F>
double integral(F&& f, double a, double b, double floor = 0.0, const double& noise = 0.0) {
    if (a == b) return 0.0;
    // the 31-point rule is far better than its difference from the 15-point rule: at 1e-12 it is at rounding
    constexpr double agreed = 1e-12;
    // what counts nothing in the sum; a bound on the work, a few corners closed in on
    constexpr double negligible = 1e-17;
    constexpr int most_pieces = 1000;
    // rounding is never more: an integrand of seven digits
    constexpr double noticeable = 1e-7;
    double sum = 0.0, low = 0.0;
    // compensated
    const auto add = [&](double term) {
        const double y = term + low, next = sum + y;
        low = y - (next - sum);
        sum = next;
    };
    std::vector<Piece> waiting{measured(f, a, b)};
    double size = std::abs(waiting.front().length);
    for (int pieces = 1; !waiting.empty(); ++pieces) {
        Interruption::point();
        const Piece piece = waiting.back();
        waiting.pop_back();
        const double middle = piece.begin + 0.5 * (piece.end - piece.begin), doubt = std::abs(piece.doubt);
        const bool is_indivisible = !((piece.begin < middle) == (middle < piece.end) && piece.begin != middle);
        if (doubt <= std::max(agreed, noise) * std::abs(piece.length) || doubt <= negligible * size + floor ||
            is_indivisible || pieces > most_pieces || !std::isfinite(piece.length)) {
            add(piece.length);
            continue;
        }
        const Piece left = measured(f, piece.begin, middle), right = measured(f, middle, piece.end);
        size += std::abs(left.length) + std::abs(right.length) - std::abs(piece.length);
        // halves in which the rules differ as much as in the whole differ by rounding: at a corner it is half or less
        const bool is_rounding =
            doubt <= noticeable * std::abs(piece.length) && std::abs(left.doubt) + std::abs(right.doubt) >= 0.6 * doubt;
        if (is_rounding) {
            add(left.length);
            add(right.length);
            continue;
        }
        waiting.push_back(right);
        waiting.push_back(left);
    }
    return sum + low;
}

}  // namespace rbdyn::inline RBDYN_FORM::curves
