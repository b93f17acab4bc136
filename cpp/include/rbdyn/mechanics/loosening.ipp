// Definitions of rbdyn/mechanics/loosening.hpp.
#pragma once

#include "rbdyn/mechanics/loosening.hpp"

#include <algorithm>
#include <cstddef>
#include <optional>
#include <vector>

#include "rbdyn/mechanics/closure.hpp"

namespace rbdyn::inline RBDYN_FORM::mechanics {

RBDYN_INLINE std::optional<double> Loosening::first(const Piece& piece, bool /*fresh*/) const {
    double shut = 0.0;
    for (int k = 1; k <= samples_; ++k) {
        double open = piece.length * k / samples_;
        if (!is_open(piece, open)) {
            shut = open;
            continue;
        }
        for (int i = 0; i < 60; ++i) {
            const double middle = 0.5 * (shut + open);
            (is_open(piece, middle) ? open : shut) = middle;
        }
        return open;
    }
    return std::nullopt;
}

RBDYN_INLINE bool Loosening::is_open(const Piece& piece, double tau) const {
    std::vector<double> x(static_cast<std::size_t>(piece.variables));
    piece.state(tau, x);
    const double t = piece.at(tau).hi;
    const auto opens = [&](const std::vector<double>& at) {
        const auto all = closing::moving<double>(*tree_, t, at);
        return std::any_of(which_.begin(), which_.end(),
                           [&](int k) { return !(conditions_->gap(*tree_, k, all) <= loosest_); });
    };
    if (!opens(x)) return false;
    // what the rows that are used leave open within a step is the error of the step
    std::vector<DoubleDouble> closed(x.begin(), x.end());
    closing::normalize<DoubleDouble>(*tree_, closed);
    close(*tree_, *conditions_, rows_, t, closed, 3);
    return opens(closing::nearest(closed));
}

}  // namespace rbdyn::inline RBDYN_FORM::mechanics
