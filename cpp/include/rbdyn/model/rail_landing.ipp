// Definitions of rbdyn/model/rail_landing.hpp.
#pragma once

#include "rbdyn/model/rail_landing.hpp"

#include <array>
#include <cmath>
#include <cstddef>
#include <mutex>
#include <optional>

#include "rbdyn/basics/vector.hpp"
#include "rbdyn/curve/crossing.hpp"
#include "rbdyn/curve/curve.hpp"
#include "rbdyn/curve/gap.hpp"
#include "rbdyn/curve/one_side.hpp"
#include "rbdyn/curve/point.hpp"
#include "rbdyn/series/piece.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE RailLanding::RailLanding(const Curve& curve, const curves::OneSide& side, const Placement& view,
                                      int parameter, int position, int velocity)
    : curve_(curve),
      finder_(curve, curve.closed() ? curve.period() : 0.0),
      side_(side.sign > 0.0 ? 1 : -1),
      turn_(side.axes.transpose() * view.axes),
      shift_(side.axes.transpose() * (view.origin - curve.placement().origin)),
      parameter_(parameter),
      position_(position),
      velocity_(velocity) {}

RBDYN_INLINE std::optional<double> RailLanding::first(const Piece& piece, bool fresh) const {
    const std::lock_guard lock(mutex_);
    const int order = piece.order;
    std::array<double, curves::max_path_degree + 1> x{}, y{}, z{};
    for (int k = 0; k <= order; ++k) {
        const Vector3 c{piece.variable(position_)[k], piece.variable(position_ + 1)[k],
                        piece.variable(position_ + 2)[k]};
        Vector3 own = turn_ * c;
        if (k == 0) own += shift_;
        x[static_cast<std::size_t>(k)] = own.x();
        y[static_cast<std::size_t>(k)] = own.y();
        z[static_cast<std::size_t>(k)] = own.z();
    }
    const double last = piece.variable(parameter_)[0];
    bool just_left = false;
    if (fresh) {
        const Vector3 place = curve_.own<double>(last).position;
        const double size = std::abs(x[0]) + std::abs(y[0]) + place.norm();
        just_left = std::hypot(x[0] - place.x(), y[0] - place.y()) <= 64.0 * epsilon * size;
    }
    Path doubt{};
    for (int k = 1; k <= order && just_left; ++k)
        for (int i = 0; i < 3; ++i)
            doubt[static_cast<std::size_t>(k)] +=
                std::abs(piece.variable(position_ + i)[k] - piece.unit * piece.variable(velocity_ + i)[k - 1] / k);
    const auto landing =
        finder_.first_landing({x.data(), y.data(), order, piece.length, doubt.data()}, side_, last, just_left);
    if (!landing || !meets(x, y, z, order, landing->tau)) return std::nullopt;
    return landing->tau;
}

RBDYN_INLINE double RailLanding::place(const Vector3& r, double last) const {
    const std::lock_guard lock(mutex_);
    const Vector3 p = turn_ * r + shift_;
    double u = finder_.parameter_at(p.x(), p.y(), last);
    for (int i = 0; i < 8; ++i) {
        const CurvePoint<double> c = curve_.own<double>(u);
        const Vector3 away = p - c.position;
        const double slope = c.speed_squared - away.dot(c.second);
        if (!(slope > 0.0)) break;
        const double next = u + away.dot(c.first) / slope;
        if (next == u) break;
        u = next;
    }
    return u;
}

RBDYN_INLINE bool RailLanding::meets(const Path& x, const Path& y, const Path& z, int order, double tau) {
    constexpr double rounding = 1e-9;
    double off = 0.0, size = 0.0, power = 1.0;
    for (int k = 0; k <= order; ++k, power *= tau) {
        const auto i = static_cast<std::size_t>(k);
        off += z[i] * power;
        size += (std::abs(x[i]) + std::abs(y[i])) * power;
    }
    return std::abs(off) <= rounding * size;
}

}  // namespace rbdyn::inline RBDYN_FORM
