// Where a flying bead comes back to the rail it left (curve/crossing.hpp), on the pieces of an engine.
//
// Conventions: a piece holds the bead's position in the axes of the view; the curve is looked at in its own axes, whose
// third is the normal of its plane. A bead beside the plane meets the wall that stands on the curve across the plane.
#pragma once

#include <array>
#include <cmath>
#include <limits>
#include <mutex>
#include <optional>
#include <utility>

#include "rbdyn/curve/crossing.hpp"
#include "rbdyn/model/equations.hpp"
#include "rbdyn/series/piece.hpp"

namespace rbdyn {

class RailLanding : public Locator {
public:
    /// `binormal`: of the axes in which the bead may only be where the normal b x t points, in the world. `parameter`,
    /// `position`: the first of the state variables that hold where the bead left its rail, and its place in the view.
    RailLanding(const Curve& curve, const Vector3& binormal, const Placement& view, int parameter, int position)
        : curve_(curve),
          finder_(curve, curve.closed() ? curve.period() : 0.0),
          side_(column(curve.placement().axes, 2).dot(binormal) > 0.0 ? 1 : -1),
          turn_(curve.placement().axes.transpose() * view.axes),
          shift_(curve.placement().axes.transpose() * (view.origin - curve.placement().origin)),
          parameter_(parameter),
          position_(position) {}

    std::optional<double> first(const Piece& piece, bool fresh) const override {
        const std::lock_guard lock(mutex_);
        const int order = piece.order;
        std::array<double, curves::max_path_degree + 1> x{}, y{};
        for (int k = 0; k <= order; ++k) {
            const Vector3 c{piece.variable(position_)[k], piece.variable(position_ + 1)[k],
                            piece.variable(position_ + 2)[k]};
            Vector3 own = turn_ * c;
            if (k == 0) own += shift_;
            x[static_cast<std::size_t>(k)] = own.x();
            y[static_cast<std::size_t>(k)] = own.y();
        }
        const double last = piece.variable(parameter_)[0];
        bool just_left = false;
        if (fresh) {
            const Vector3 place = curve_.own<double>(last).position;
            const double size = std::abs(x[0]) + std::abs(y[0]) + place.norm();
            just_left = std::hypot(x[0] - place.x(), y[0] - place.y()) <= 64.0 * epsilon * size;
        }
        const auto landing = finder_.first_landing({x.data(), y.data(), order, piece.length}, side_, last, just_left);
        if (!landing) return std::nullopt;
        last_ = landing->u;
        return landing->tau;
    }

    /// The parameter of the curve at a place on it, in the view: that of the landing just found.
    double place(const Vector3& r) const {
        const std::lock_guard lock(mutex_);
        const Vector3 p = turn_ * r + shift_;
        double u = last_;
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

private:
    static constexpr double epsilon = std::numeric_limits<double>::epsilon();

    Curve curve_;
    mutable curves::LandingFinder finder_;
    int side_;
    Matrix3 turn_;
    Vector3 shift_;
    int parameter_, position_;
    mutable std::mutex mutex_;
    mutable double last_ = 0.0;
};

}  // namespace rbdyn
