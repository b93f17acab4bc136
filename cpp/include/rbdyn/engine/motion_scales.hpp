// The scales of a motion so far: what an error is measured against, whatever units describe it.
//
// Of bodies that are joined none is followed to digits of its own below a floor in the scale of all: a mass far down a
// chain that moves by 1e-90 of the first would else say how long steps are.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>
#include <vector>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/model/equations.hpp"

namespace rbdyn::inline RBDYN_FORM {

/// The largest size of what is alike, by what it is measured there: a length and an angle, or a place and a speed, are
/// compared by no unit.
class AlikeSizes {
public:
    void take(const VariableGroup& group, double size) {
        if (group.alike == Alike::nothing) return;
        double& whole = most(group.alike);
        whole = std::max(whole, group.measure * size);
    }
    /// The largest as a size of this group, or its own; a rate's is no less than what moves in `duration` as far as
    /// places do, or by a radian.
    double of(const VariableGroup& group, double own, double duration) const {
        if (group.alike == Alike::nothing) return own;
        double whole = most(group.alike);
        if (group.alike == Alike::velocity) whole = std::max(whole, most(Alike::place) / duration);
        if (group.alike == Alike::turning) whole = std::max(whole, 1.0 / duration);
        return std::max(own, whole / group.measure);
    }

    double most(Alike what) const { return most_[static_cast<std::size_t>(what)]; }
    double& most(Alike what) { return most_[static_cast<std::size_t>(what)]; }
    /// Of each kind.
    static constexpr std::size_t kinds = 5;
    std::array<double, kinds>& all() { return most_; }
    const std::array<double, kinds>& all() const { return most_; }

private:
    std::array<double, kinds> most_{};
};

/// Extent and largest magnitude of every state variable since the run began.
class MotionScales {
public:
    void resize(std::size_t variables) { variables_.resize(variables); }

    /// Which variables belong together from here on; they outlive the use of this.
    void follow(std::span<const VariableGroup> groups);

    /// Takes a state into account.
    void widen(std::span<const double> x);

    /// The largest size of each variable.
    std::vector<double> largest() const;

    /// All of it as numbers, and back: as many as that has for these variables.
    std::vector<double> numbers() const;
    void set_numbers(std::span<const double> numbers);
    static std::size_t count(std::size_t variables) { return 3 * variables + AlikeSizes::kinds; }

    /// Extent of positions, largest magnitude of velocities; 0 before there is motion.
    double scale(const VariableGroup& group) const;

    /// Largest number that stands for the group, whose rounding nothing can undo.
    double magnitude(const VariableGroup& group) const;

private:
    struct Variable {
        double low = std::numeric_limits<double>::infinity(), high = -low, magnitude = 0.0;
    };
    // steps are a tenth shorter at most than without it for motion a thousand times this small; for what is asked of
    // motion that is smaller, see least_share()
    static constexpr double floor = 0x1p-20;

    double own(const VariableGroup& group) const;

    std::vector<Variable> variables_;
    std::span<const VariableGroup> groups_;
    bool has_floor_ = false;
    AlikeSizes whole_;
};

inline void MotionScales::widen(std::span<const double> x) {
    for (std::size_t i = 0; i < x.size(); ++i) {
        Variable& v = variables_[i];
        v.low = std::min(v.low, x[i]);
        v.high = std::max(v.high, x[i]);
        v.magnitude = std::max(v.magnitude, std::abs(x[i]));
    }
    if (!has_floor_) return;
    for (const VariableGroup& g : groups_)
        if (g.alike != Alike::nothing) whole_.take(g, own(g));
}

inline double MotionScales::scale(const VariableGroup& group) const {
    if (!has_floor_ || group.alike == Alike::nothing) return own(group);
    return std::max(own(group), floor * whole_.most(group.alike) / group.measure);
}

inline double MotionScales::magnitude(const VariableGroup& group) const {
    double magnitude = group.steady;
    for (int i = group.first; i < group.first + group.count; ++i)
        magnitude = std::max(magnitude, variables_[static_cast<std::size_t>(i)].magnitude);
    return magnitude;
}

inline double MotionScales::own(const VariableGroup& group) const {
    double scale = group.is_position ? 0.0 : group.steady;
    for (int i = group.first; i < group.first + group.count; ++i) {
        const Variable& v = variables_[static_cast<std::size_t>(i)];
        scale = std::max(scale, group.is_position ? v.high - v.low : v.magnitude);
    }
    return scale;
}

}  // namespace rbdyn::inline RBDYN_FORM
