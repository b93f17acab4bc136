// What the tests of the free body share: an integration in numbers of 32 digits to compare with, and differences of
// states measured in those numbers.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "rbdyn/closed_form/free_rotation.hpp"

namespace rbdyn::test {

using Wide = DoubleDouble;
using WideQuaternion = QuaternionOf<Wide>;

inline WideQuaternion unit(const WideQuaternion& q) {
    const Wide n = sqrt(squared_norm(q));
    return {q.w / n, q.x / n, q.y / n, q.z / n};
}

/// The angle between two attitudes [rad], the first a unit quaternion of 32 digits.
inline double angle_between(const WideQuaternion& a, const Quaternion& b) {
    const WideQuaternion d = conjugate(a) * widened(b);
    return 2.0 * std::sqrt(d.x.hi * d.x.hi + d.y.hi * d.y.hi + d.z.hi * d.z.hi);
}
inline double largest_difference(const Vector3Of<Wide>& a, const Vector3& b) {
    double largest = 0.0;
    for (int i = 0; i < 3; ++i) largest = std::max(largest, std::abs((a[i] - b[i]).hi));
    return largest;
}

/// The motion of a free body by Taylor series of order 40 in numbers of 32 digits, straight from Euler's equations and
/// q' = 1/2 q (0, omega), in principal axes.
class WideIntegration {
public:
    WideQuaternion attitude;  // from principal axes to the world
    Vector3Of<Wide> omega;    // principal axes

    WideIntegration(const Vector3Of<Wide>& moments, const WideQuaternion& start, const Vector3Of<Wide>& omega_start)
        : attitude(start), omega(omega_start), moments_(moments) {}

    /// On to t, from where it is.
    void advance(double t) {
        while (t_.hi != t || t_.lo != 0.0) {
            const Wide left = Wide(t) - t_;
            const double h = expand();
            const bool last = std::abs(left.hi) <= h;
            const Wide step = last ? left : Wide(std::copysign(h, left.hi));
            for (int i = 0; i < 3; ++i) omega[i] = sum(w_[static_cast<std::size_t>(i)], step);
            attitude = unit({sum(q_[0], step), sum(q_[1], step), sum(q_[2], step), sum(q_[3], step)});
            t_ = last ? Wide(t) : t_ + step;
        }
    }

private:
    static constexpr int order = 40;
    using Series = std::array<Wide, order + 1>;

    static Wide sum(const Series& c, const Wide& h) {
        Wide value = 0.0;
        for (std::size_t k = order + 1; k-- > 0;) value = value * h + c[k];
        return value;
    }
    static Wide term(const Series& a, const Series& b, std::size_t k) {
        Wide value = 0.0;
        for (std::size_t j = 0; j <= k; ++j) value += a[j] * b[k - j];
        return value;
    }

    /// Series about the present state; the step at which the last terms fall below 2^-106.
    double expand() {
        for (std::size_t i = 0; i < 3; ++i) w_[i][0] = omega[static_cast<int>(i)];
        q_[0][0] = attitude.w, q_[1][0] = attitude.x, q_[2][0] = attitude.y, q_[3][0] = attitude.z;
        for (std::size_t k = 0; k < order; ++k) {
            const Wide f = Wide(1.0) / static_cast<double>(k + 1);
            for (std::size_t i = 0; i < 3; ++i) {
                const std::size_t j = (i + 1) % 3, l = (i + 2) % 3;
                const auto moment = [&](std::size_t n) { return moments_[static_cast<int>(n)]; };
                w_[i][k + 1] = f * (moment(j) - moment(l)) / moment(i) * term(w_[j], w_[l], k);
            }
            const Wide g = 0.5 * f;
            q_[0][k + 1] = -g * (term(q_[1], w_[0], k) + term(q_[2], w_[1], k) + term(q_[3], w_[2], k));
            q_[1][k + 1] = g * (term(q_[0], w_[0], k) + term(q_[2], w_[2], k) - term(q_[3], w_[1], k));
            q_[2][k + 1] = g * (term(q_[0], w_[1], k) + term(q_[3], w_[0], k) - term(q_[1], w_[2], k));
            q_[3][k + 1] = g * (term(q_[0], w_[2], k) + term(q_[1], w_[1], k) - term(q_[2], w_[0], k));
        }
        double rate = 0.0;
        const double size = std::sqrt(dot<Wide>(omega, omega).hi);
        for (std::size_t k = order - 1; k <= order; ++k) {
            double largest = 0.0;
            for (const Series& c : w_) largest = std::max(largest, std::abs(c[k].hi) / size);
            for (const Series& c : q_) largest = std::max(largest, std::abs(c[k].hi));
            rate = std::max(rate, std::pow(largest * 0x1p106, 1.0 / static_cast<double>(k)));
        }
        return 1.0 / rate;
    }

    Vector3Of<Wide> moments_;
    std::array<Series, 3> w_{};
    std::array<Series, 4> q_{};
    Wide t_;
};

}  // namespace rbdyn::test
