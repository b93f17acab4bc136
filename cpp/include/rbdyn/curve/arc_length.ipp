// Definitions of rbdyn/curve/arc_length.hpp.
#pragma once

#include "rbdyn/curve/arc_length.hpp"

#include <cstddef>

namespace rbdyn::inline RBDYN_FORM::curves {

RBDYN_INLINE RulePair::RulePair() {
    constexpr std::size_t middle = points / 2;
    for (std::size_t i = 0; i <= middle; ++i)
        for (const std::size_t k : {middle - i, middle + i}) {
            node[k] = k < middle ? -rule_nodes[i].at : rule_nodes[i].at;
            kronrod[k] = rule_nodes[i].kronrod;
            gauss[k] = rule_nodes[i].gauss;
        }
    for (std::size_t k = 0; k < points; ++k) {
        long double product = 1.0L;
        for (std::size_t j = 0; j < points; ++j)
            if (j != k) product *= (1.0L - node[j]) / (static_cast<long double>(node[k]) - node[j]);
        at_end[k] = static_cast<double>(product);
    }
}

}  // namespace rbdyn::inline RBDYN_FORM::curves
