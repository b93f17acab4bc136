// Where a flying bead comes back to the rail it left (curve/crossing.hpp), on the pieces of an engine.
//
// Conventions: a piece holds the bead's position in the axes of the view; the curve is looked at in its own axes, whose
// third is the normal of its plane; those of a straight one are turned about it, towards where the rail pushes.
// A bead beside the plane flies past the curve: it may come back only while all of its path lies in the plane within
// rounding.
#pragma once

#include <array>
#include <cmath>
#include <limits>
#include <mutex>
#include <optional>
#include <utility>

#include "rbdyn/curve/crossing.hpp"
#include "rbdyn/curve/one_side.hpp"
#include "rbdyn/model/equations.hpp"
#include "rbdyn/series/piece.hpp"

namespace rbdyn {

class RailLanding : public Locator {
public:
    /// `side`: where the bead may be. `parameter`, `position`: the first of the state variables that hold where the
    /// bead left its rail, and its place in the view.
    RailLanding(const Curve& curve, const curves::OneSide& side, const Placement& view, int parameter, int position)
        : curve_(curve),
          finder_(curve, curve.closed() ? curve.period() : 0.0),
          side_(side.sign > 0.0 ? 1 : -1),
          turn_(side.axes.transpose() * view.axes),
          shift_(side.axes.transpose() * (view.origin - curve.placement().origin)),
          parameter_(parameter),
          position_(position) {}

    std::optional<double> first(const Piece& piece, bool fresh) const override {
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
        const auto landing = finder_.first_landing({x.data(), y.data(), order, piece.length}, side_, last, just_left);
        if (!landing || !meets(x, y, z, order, landing->tau)) return std::nullopt;
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
    using Path = std::array<double, curves::max_path_degree + 1>;

    /// Whether a path in the plane but for rounding, that of axes and of a long flight, is there at a time.
    static bool meets(const Path& x, const Path& y, const Path& z, int order, double tau) {
        constexpr double rounding = 1e-9;
        double off = 0.0, size = 0.0, power = 1.0;
        for (int k = 0; k <= order; ++k, power *= tau) {
            const auto i = static_cast<std::size_t>(k);
            off += z[i] * power;
            size += (std::abs(x[i]) + std::abs(y[i])) * power;
        }
        return std::abs(off) <= rounding * size;
    }

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
