// Definitions of rbdyn/engine/stiffness.hpp.
#pragma once

#include "rbdyn/engine/stiffness.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numeric>
#include <span>
#include <vector>

#include "rbdyn/engine/band.hpp"
#include "rbdyn/engine/motion_scales.hpp"
#include "rbdyn/expression/state_jacobian.hpp"
#include "rbdyn/model/equations.hpp"
#include "rbdyn/series/piece.hpp"

namespace rbdyn::inline RBDYN_FORM {

namespace stiffness {

inline double dot(std::span<const double> a, std::span<const double> b) {
    return std::inner_product(a.begin(), a.end(), b.begin(), 0.0);
}

/// |a - b| / |b|
inline double apart(std::span<const double> a, std::span<const double> b) {
    double sum = 0.0;
    for (std::size_t i = 0; i < a.size(); ++i) sum += (a[i] - b[i]) * (a[i] - b[i]);
    const double size = dot(b, b);
    return size > 0.0 ? std::sqrt(sum / size) : std::numeric_limits<double>::infinity();
}

/// The larger root of z^2 + b z + c with its real part, of v, J v, J^2 v that nearly satisfy it.
struct Root {
    double size, real;
};
inline Root root_of(std::span<const double> v, std::span<const double> jv, std::span<const double> jjv) {
    const double vv = dot(v, v), vw = dot(v, jv), ww = dot(jv, jv), vz = dot(v, jjv), wz = dot(jv, jjv);
    const double determinant = vv * ww - vw * vw;
    // one direction alone
    constexpr double parallel = 1e-8;
    if (!(determinant > parallel * vv * ww)) return {std::sqrt(ww / vv), vw / vv};
    const double b = -(vv * wz - vw * vz) / determinant, c = -(ww * vz - vw * wz) / determinant;
    const double discriminant = 0.25 * b * b - c;
    if (discriminant < 0.0) return {std::sqrt(c), -0.5 * b};
    const double larger = -0.5 * b - std::copysign(std::sqrt(discriminant), b);
    return {std::abs(larger), larger};
}

}  // namespace stiffness

RBDYN_INLINE Stiffness::Stiffness(const Equations& equations)
    : equations_(equations), jacobian_(equations.program), scale_(at(equations.variables()), 1.0) {}

RBDYN_INLINE void Stiffness::differentiate(double t, std::span<const double> x) {
    jacobian_.differentiate(t, x);
    entries_.assign(jacobian_.entries().begin(), jacobian_.entries().end());
    double* entry = entries_.data();
    for (int i = 0; i < jacobian_.size(); ++i)
        for (const int j : jacobian_.columns(i)) *entry++ *= scale_[at(j)] / scale_[at(i)];
}

RBDYN_INLINE void Stiffness::apply(std::span<const double> v, std::span<double> out) const {
    const double* entry = entries_.data();
    for (int i = 0; i < jacobian_.size(); ++i) {
        double sum = 0.0;
        for (const int j : jacobian_.columns(i)) sum += *entry++ * v[at(j)];
        out[at(i)] = sum;
    }
}

RBDYN_INLINE double Stiffness::solving() const {
    if (solving_ > 0.0) return solving_;
    const int n = jacobian_.size();
    solving_ = static_cast<double>(n) * n;
    if (!jacobian_.is_sparse()) return solving_;
    const int width = BandOrder::of(jacobian_.rows(), jacobian_.columns()).width;
    if (BandMatrix::pays(n, width)) solving_ = static_cast<double>(BandMatrix::size(n, width));
    return solving_;
}

RBDYN_INLINE bool Stiffness::may_rule(const Piece& step, const Equations& equations, const MotionScales& scales) {
    const int p = step.order;
    double last = 0.0, before = 0.0;
    for (const VariableGroup& group : equations.groups) {
        const double scale = scales.scale(group);
        if (!(scale > 0.0)) continue;
        for (int i = group.first; i < group.first + group.count; ++i) {
            last = std::max(last, std::abs(step.variable(i)[p]) / scale);
            before = std::max(before, std::abs(step.variable(i)[p - 2]) / scale);
        }
    }
    const double least = least_reach(p) / step.length;
    return static_cast<double>(p) * (p - 1) * last > least * least * before;
}

RBDYN_INLINE bool Stiffness::rules(const Piece& step, std::span<const double> parameters, Program::Rounding rounding,
                                   const MotionScales& scales) {
    const int n = step.variables, p = step.order;
    std::vector<double> x(at(n)), last(at(n)), next(at(n)), first(at(n)), second(at(n));
    for (const VariableGroup& group : equations_.groups) {
        const double scale = scales.scale(group);
        for (int i = group.first; i < group.first + group.count; ++i) scale_[at(i)] = scale > 0.0 ? scale : 1.0;
    }
    fast_.resize(at(n));
    for (int i = 0; i < n; ++i) {
        const double* c = step.variable(i);
        x[at(i)] = c[0];
        fast_[at(i)] = c[p - 2] / scale_[at(i)];
        last[at(i)] = (p - 1) * c[p - 1] / scale_[at(i)];
        next[at(i)] = static_cast<double>(p) * (p - 1) * c[p] / scale_[at(i)];
    }
    jacobian_.set_parameters(parameters, rounding);
    differentiate(step.start.hi, x);
    for (double& entry : entries_) entry *= step.unit;
    apply(fast_, first);
    apply(first, second);
    // the step is short, and J is another at its end: so much of it is not linear
    constexpr double linear = 0.25;
    if (!(stiffness::apart(first, last) < linear && stiffness::apart(second, next) < linear)) return false;
    // what is slower dies out beside it
    constexpr int iterations = 24;
    for (int k = 0; k < iterations; ++k) {
        fast_.swap(first);
        first.swap(second);
        const double size = std::sqrt(stiffness::dot(first, first));
        for (std::size_t i = 0; i < first.size(); ++i) {
            fast_[i] /= size;
            first[i] /= size;
        }
        apply(first, second);
    }
    const stiffness::Root lambda = stiffness::root_of(fast_, first, second);
    fast_ = second;
    reach_ = lambda.size * step.length;
    const bool is_at_limit = reach_ > least_reach(p);
    // BDF of order 5 damps what is nearer to the real axis than to the imaginary one, of lower orders more
    return is_at_limit && lambda.real < -0.3 * lambda.size;
}

RBDYN_INLINE double Stiffness::rate(double t, std::span<const double> x) {
    differentiate(t, x);
    std::vector<double> next(fast_.size());
    constexpr int settling = 4, counted = 8;
    double growth = 0.0;
    for (int k = 0; k < settling + counted; ++k) {
        apply(fast_, next);
        const double size = std::sqrt(stiffness::dot(next, next) / stiffness::dot(fast_, fast_));
        if (!(size > 0.0) || !std::isfinite(size)) return 0.0;
        if (k >= settling) growth += std::log2(size);
        for (std::size_t i = 0; i < next.size(); ++i) fast_[i] = next[i] / size;
    }
    return std::exp2(growth / counted);
}

}  // namespace rbdyn::inline RBDYN_FORM
