// Definitions of rbdyn/closed_form/linear_modes.hpp.
#pragma once

#include "rbdyn/closed_form/linear_modes.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "rbdyn/basics/dense.hpp"
#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/double_double_functions.hpp"
#include "rbdyn/basics/instant.hpp"
#include "rbdyn/closed_form/linear_oscillator.hpp"
#include "rbdyn/closed_form/symmetric_modes.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE std::optional<LinearModes::Symmetric> LinearModes::symmetric(const WideMatrix& k) {
    const int n = k.size();
    Symmetric result{std::vector<DoubleDouble>(at(n)), WideMatrix(n)};
    // squares of the scales, from one coordinate to those it pulls at: s_i^2 K_ij = s_j^2 K_ji
    std::vector<DoubleDouble> squares(at(n));
    for (int first = 0; first < n; ++first) {
        if (squares[at(first)].hi != 0.0) continue;
        squares[at(first)] = 1.0;
        std::vector<int> todo{first};
        while (!todo.empty()) {
            const int i = todo.back();
            todo.pop_back();
            for (int j = 0; j < n; ++j) {
                if (k(i, j).hi == 0.0 && k(j, i).hi == 0.0) continue;
                if (!(k(i, j).hi * k(j, i).hi > 0.0)) return std::nullopt;
                const DoubleDouble square = squares[at(i)] * k(i, j) / k(j, i);
                if (squares[at(j)].hi == 0.0) {
                    squares[at(j)] = square;
                    todo.push_back(j);
                } else if (!(abs(square - squares[at(j)]).hi <= same * square.hi)) {
                    return std::nullopt;
                }
            }
        }
    }
    for (int i = 0; i < n; ++i) result.scales[at(i)] = sqrt(squares[at(i)]);
    for (int i = 0; i < n; ++i)
        for (int j = i; j < n; ++j) {
            const DoubleDouble size = i == j ? abs(k(i, i)) : sqrt(k(i, j) * k(j, i));
            result.matrix(i, j) = result.matrix(j, i) = k(i, j).hi < 0.0 ? -size : size;
        }
    return result;
}

RBDYN_INLINE std::optional<std::pair<DoubleDouble, DoubleDouble>> LinearModes::proportional(const WideMatrix& d,
                                                                                            const WideMatrix& k) {
    const int n = d.size();
    DoubleDouble a = 0.0, b = 0.0;
    // b from the largest entry of K across, or from the widest distance along the diagonal
    int row = -1, column = -1;
    double widest = 0.0;
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j)
            if (i != j && std::abs(k(i, j).hi) > widest) {
                widest = std::abs(k(i, j).hi);
                row = i;
                column = j;
            }
    if (row >= 0) b = d(row, column) / k(row, column);
    a = d(0, 0) - b * k(0, 0);
    // what is rounding of both is no damping, least of all of a mode that nothing else holds
    if (abs(a).hi <= same * abs(d(0, 0)).hi) a = 0.0;
    const double size = std::max(d.largest(), std::abs(b.hi) * k.largest());
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) {
            const DoubleDouble wanted = b * k(i, j) + (i == j ? a : DoubleDouble(0.0));
            if (!(abs(d(i, j) - wanted).hi <= same * size)) return std::nullopt;
        }
    return std::pair(a, b);
}

RBDYN_INLINE LinearModes::LinearModes(std::vector<int> positions, std::vector<int> velocities, const Symmetric& s,
                                      std::shared_ptr<const SymmetricModes> modes,
                                      const std::pair<DoubleDouble, DoubleDouble>& damping,
                                      const std::vector<DoubleDouble>& pull, std::vector<DoubleDouble> start,
                                      const std::vector<DoubleDouble>& rates)
    : positions_(std::move(positions)),
      velocities_(std::move(velocities)),
      start_(std::move(start)),
      value_error_(modes->error) {
    const int n = s.matrix.size();
    for (int k = 0; k < n; ++k) {
        const DoubleDouble stiffness = modes->values[at(k)];
        DoubleDouble force = 0.0, rate = 0.0;
        for (int i = 0; i < n; ++i) {
            const DoubleDouble shape = modes->vectors(i, k) * s.scales[at(i)];
            force += shape * pull[at(i)];
            rate += shape * rates[at(i)];
            shapes_.push_back(static_cast<double>(modes->vectors(i, k) / s.scales[at(i)]));
        }
        const DoubleDouble drag = damping.first + damping.second * stiffness;
        modes_.emplace_back(LinearOscillator::Coefficients{stiffness, drag, force}, 0.0, rate);
        ranges_.push_back(swing(stiffness.hi, drag.hi, force.hi, rate.hi));
        // nor do its rates, of the same energy
        const double radius = ranges_.back().radius;
        rate_ranges_.push_back({0.0, std::isinf(radius) ? radius : radius * std::sqrt(stiffness.hi)});
    }
}

RBDYN_INLINE void LinearModes::state(Instant since, std::span<double> x) const {
    const std::size_t n = positions_.size();
    for (std::size_t i = 0; i < n; ++i) x[at(positions_[i])] = x[at(velocities_[i])] = 0.0;
    const double* shape = shapes_.data();
    for (const LinearOscillator& mode : modes_) {
        const LinearOscillator::State y = mode.at(since);
        for (std::size_t i = 0; i < n; ++i, ++shape) {
            x[at(positions_[i])] += *shape * y.position;
            x[at(velocities_[i])] += *shape * y.velocity;
        }
    }
    for (std::size_t i = 0; i < n; ++i) {
        double& q = x[at(positions_[i])];
        q = start_[i].hi + (start_[i].lo + q);
    }
}

RBDYN_INLINE void LinearModes::add_errors(double since, std::span<double> errors) const {
    const double* shape = shapes_.data();
    for (std::size_t k = 0; k < modes_.size(); ++k) {
        const LinearOscillator& mode = modes_[k];
        const LinearOscillator::State y = mode.at({since, 0.0}), e = mode.errors(since);
        const double rate = mode.fastest(), late = value_error_ * late_by(rate, since);
        // from where it swings about, which is not where it starts
        const double rest = std::isfinite(ranges_[k].radius) ? ranges_[k].middle : 0.0;
        const double far = std::abs(y.position - rest) + (rate > 0.0 ? std::abs(y.velocity) / rate : 0.0);
        for (std::size_t i = 0; i < positions_.size(); ++i, ++shape) {
            // a product and a sum of as many as there are
            const double size = std::abs(*shape);
            errors[at(positions_[i])] += size * (e.position + epsilon * std::abs(y.position) + late * far);
            errors[at(velocities_[i])] += size * (e.velocity + epsilon * std::abs(y.velocity) + late * rate * far);
        }
    }
}

RBDYN_INLINE LinearBlock::Range LinearModes::swing(double stiffness, double damping, double force, double rate) {
    constexpr double unlimited = std::numeric_limits<double>::infinity();
    if (!(stiffness > 0.0) || !(damping >= 0.0)) return {0.0, unlimited};
    const double rest = force / stiffness;
    return {rest, std::hypot(rest, rate / std::sqrt(stiffness))};
}

RBDYN_INLINE LinearBlock::Range LinearModes::range(std::span<const double> weights) const {
    const std::size_t n = positions_.size();
    Range result;
    for (std::size_t i = 0; i < n; ++i) result.middle += weights[at(positions_[i])] * start_[i].hi;
    for (std::size_t k = 0; k < modes_.size(); ++k) {
        double of_place = 0.0, of_rate = 0.0;
        for (std::size_t i = 0; i < n; ++i) {
            of_place += weights[at(positions_[i])] * shapes_[k * n + i];
            of_rate += weights[at(velocities_[i])] * shapes_[k * n + i];
        }
        // what has no share in it does not limit it
        if (of_place != 0.0) {
            result.middle += of_place * ranges_[k].middle;
            result.radius += std::abs(of_place) * ranges_[k].radius;
        }
        if (of_rate != 0.0) result.radius += std::abs(of_rate) * rate_ranges_[k].radius;
    }
    return result;
}

RBDYN_INLINE double LinearModes::fastest() const {
    double rate = 0.0;
    for (const LinearOscillator& mode : modes_) rate = std::max(rate, mode.fastest());
    return rate;
}

}  // namespace rbdyn::inline RBDYN_FORM
