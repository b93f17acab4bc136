// The scales of a motion so far: what an error is measured against, whatever units describe it.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <vector>

#include "rbdyn/model/equations.hpp"

namespace rbdyn {

/// Extent and largest magnitude of every state variable since the run began.
class MotionScales {
public:
    void resize(std::size_t variables) { variables_.resize(variables); }

    /// Takes a state into account.
    void widen(std::span<const double> x) {
        for (std::size_t i = 0; i < x.size(); ++i) {
            Variable& v = variables_[i];
            v.low = std::min(v.low, x[i]);
            v.high = std::max(v.high, x[i]);
            v.magnitude = std::max(v.magnitude, std::abs(x[i]));
        }
    }

    /// Extent of positions, largest magnitude of velocities; 0 before there is motion.
    double scale(const VariableGroup& group) const {
        double scale = group.is_position ? 0.0 : group.steady;
        for (int i = group.first; i < group.first + group.count; ++i) {
            const Variable& v = variables_[static_cast<std::size_t>(i)];
            scale = std::max(scale, group.is_position ? v.high - v.low : v.magnitude);
        }
        return scale;
    }

    /// Largest number that stands for the group, whose rounding nothing can undo.
    double magnitude(const VariableGroup& group) const {
        double magnitude = group.steady;
        for (int i = group.first; i < group.first + group.count; ++i)
            magnitude = std::max(magnitude, variables_[static_cast<std::size_t>(i)].magnitude);
        return magnitude;
    }

private:
    struct Variable {
        double low = std::numeric_limits<double>::infinity(), high = -low, magnitude = 0.0;
    };
    std::vector<Variable> variables_;
};

}  // namespace rbdyn
