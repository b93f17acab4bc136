// Definitions of rbdyn/event/closer_look.hpp.
#pragma once

#include "rbdyn/event/closer_look.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>
#include <vector>

#include "rbdyn/expression/program.hpp"
#include "rbdyn/expression/series_evaluator.hpp"
#include "rbdyn/expression/term_sizes.hpp"
#include "rbdyn/series/piece.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE SeriesOnPiece::SeriesOnPiece(const Program& program, int order)
    : series_(program, order), hidden_(program, order), order_(order) {}

RBDYN_INLINE void SeriesOnPiece::expand(const Piece& piece, double tau, double length,
                                        std::span<const double> parameters) {
    series_.set_parameters(parameters);
    series_.begin(piece.at(tau).hi, length * piece.unit);
    const auto n = static_cast<std::size_t>(piece.order);
    std::vector<double> c(n + 1);
    for (int i = 0; i < piece.variables; ++i) {
        std::copy_n(piece.variable(i), n + 1, c.begin());
        // Horner's scheme again and again: powers of what is beyond tau
        for (std::size_t k = 0; k <= n; ++k)
            for (std::size_t j = n; j-- > k;) c[j] += tau * c[j + 1];
        double power = 1.0;
        for (int k = 0; k <= order_; ++k, power *= length)
            series_.set_input(i, k, k <= piece.order ? c[static_cast<std::size_t>(k)] * power : 0.0);
    }
    for (int k = 0; k <= order_; ++k) series_.advance(k);
}

RBDYN_INLINE bool SeriesOnPiece::tells(int output) const {
    // what is left out is less than the last terms, and these are rounding of all
    constexpr double rounding = 16.0 * std::numeric_limits<double>::epsilon();
    const double* c = coefficients(output);
    double largest = 0.0;
    for (int k = 0; k <= order_; ++k) largest = std::max(largest, std::abs(c[k]));
    const double last = order_ > 1 ? std::max(std::abs(c[order_]), 0.1 * std::abs(c[order_ - 1])) : 0.0;
    return last <= rounding * largest && hidden_.held(series_, 1.0) >= 1.0;
}

RBDYN_INLINE void SeriesOnPiece::sizes(int output, double* s) const {
    const TermSizes::Sizes known = TermSizes(series_, order_)(series_.program().output(output));
    std::copy_n(known.begin(), order_ + 1, s);
}

}  // namespace rbdyn::inline RBDYN_FORM
