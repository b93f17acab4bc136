// Definitions of rbdyn/closed_form/forced_modes.hpp.
#pragma once

#include "rbdyn/closed_form/forced_modes.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <memory>
#include <numeric>
#include <span>
#include <utility>
#include <vector>

#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/instant.hpp"
#include "rbdyn/closed_form/linear_flow.hpp"
#include "rbdyn/closed_form/linear_modes.hpp"
#include "rbdyn/closed_form/linear_system.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE ForcedModes::ForcedModes(const LinearSystem& system, const linear::SecondOrder& block,
                                      const LinearModes::Symmetric& s, const SymmetricModes& modes,
                                      const std::pair<DoubleDouble, DoubleDouble>& damping)
    : positions_(block.positions),
      velocities_(block.velocities),
      start_(linear::gathered(system.start, positions_)),
      of_mode_(2 + block.drivers.size()),
      value_error_(modes.error) {
    using linear::at;
    const int n = s.matrix.size(), m = static_cast<int>(block.drivers.size());
    const std::vector<DoubleDouble> all = system.rates(), pull = linear::gathered(all, velocities_),
                                    speeds = linear::gathered(system.start, velocities_);
    // the forces in time, alike for all modes
    std::vector<int> index(at(system.size()), -1);
    for (int j = 0; j < m; ++j) index[at(block.drivers[at(j)])] = 2 + j;
    WideMatrix a(2 + m);
    std::vector<DoubleDouble> start(of_mode_), rates(of_mode_);
    for (int j = 0; j < m; ++j) {
        const int place = block.drivers[at(j)];
        for (const LinearSystem::Entry& e : system.rows[at(place)]) a(2 + j, index[at(e.column)]) += e.value;
        start[at(2 + j)] = system.start[at(place)];
        rates[at(2 + j)] = all[at(place)];
    }
    std::vector<int> places(of_mode_);
    std::iota(places.begin(), places.end(), 0);
    a(0, 1) = 1.0;
    for (int k = 0; k < n; ++k) {
        const DoubleDouble stiffness = modes.values[at(k)];
        for (int j = 0; j <= m + 1; ++j) a(1, j) = 0.0;
        a(1, 0) = -stiffness;
        a(1, 1) = -(damping.first + damping.second * stiffness);
        start[1] = rates[1] = 0.0;
        for (int i = 0; i < n; ++i) {
            const DoubleDouble shape = modes.vectors(i, k) * s.scales[at(i)];
            start[1] += shape * speeds[at(i)];
            rates[1] += shape * pull[at(i)];
            for (const LinearSystem::Entry& e : system.rows[at(velocities_[at(i)])])
                if (const int j = index[at(e.column)]; j >= 0) a(1, j) += shape * e.value;
            shapes_.push_back(static_cast<double>(modes.vectors(i, k) / s.scales[at(i)]));
        }
        rates[0] = start[1];
        modes_.push_back(std::make_unique<const LinearFlow>(places, a, rates, start));
    }
}

RBDYN_INLINE void ForcedModes::state(Instant since, std::span<double> x) const {
    const std::size_t n = positions_.size();
    const auto at = [](int i) { return static_cast<std::size_t>(i); };
    for (std::size_t i = 0; i < n; ++i) x[at(positions_[i])] = x[at(velocities_[i])] = 0.0;
    std::vector<double> y(of_mode_);
    const double* shape = shapes_.data();
    for (const auto& mode : modes_) {
        mode->state(since, y);
        for (std::size_t i = 0; i < n; ++i, ++shape) {
            x[at(positions_[i])] += *shape * y[0];
            x[at(velocities_[i])] += *shape * y[1];
        }
    }
    for (std::size_t i = 0; i < n; ++i) {
        double& q = x[at(positions_[i])];
        q = start_[i].hi + (start_[i].lo + q);
    }
}

RBDYN_INLINE void ForcedModes::add_errors(double since, std::span<double> errors) const {
    constexpr double epsilon = std::numeric_limits<double>::epsilon();
    const auto at = [](int i) { return static_cast<std::size_t>(i); };
    std::vector<double> y(of_mode_), e(of_mode_);
    const double* shape = shapes_.data();
    for (const auto& mode : modes_) {
        std::ranges::fill(e, 0.0);
        mode->state({since, 0.0}, y);
        mode->add_errors(since, e);
        // what an error of the mode's stiffness makes of it, at most: as at resonance
        const double rate = mode->fastest(), late = value_error_ * 0.5 * since * std::min(since, 1.0 / rate),
                     far = std::abs(y[0]) + std::abs(y[1]) / rate;
        for (std::size_t i = 0; i < positions_.size(); ++i, ++shape) {
            const double size = std::abs(*shape);
            errors[at(positions_[i])] += size * (e[0] + epsilon * std::abs(y[0]) + late * far);
            errors[at(velocities_[i])] += size * (e[1] + epsilon * std::abs(y[1]) + late * rate * far);
        }
    }
}

RBDYN_INLINE double ForcedModes::fastest() const {
    double rate = 0.0;
    for (const auto& mode : modes_) rate = std::max(rate, mode->fastest());
    return rate;
}

}  // namespace rbdyn::inline RBDYN_FORM
