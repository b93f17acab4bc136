// What integration by steps must not lose: the first integrals that a rigid body's motion has, held by the smallest
// change of the state after every step.
//
// Free of moments (7.54, 7.55): the energy; about the principal axis i with the largest energy,
//     D_i = sum_k I_k (I_k - I_i) w_k^2 = K^2 - 2 I_i E,
// which has no term of that axis, so that nothing cancels near a permanent rotation or a separatrix; and the direction
// of K in the world. Heavy, with a fixed point (7.58): the energy and the angular momentum about the vertical. And
// |q| = 1 always.
//
// The coefficients of Euler's equations are rounded, the same way in every step: what the steps of a body free of
// moments lack for it is added, too, or it would keep its integrals and fall behind by 1e-17 of its time.
//
// Source: Hairer, Lubich, Wanner, Geometric Numerical Integration, IV.4. Residuals are computed in long double, and the
// corrections go into the compensation of the state's sums, so that they are not rounded away.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/model/equations.hpp"
#include "rbdyn/model/state_map.hpp"

namespace rbdyn::inline RBDYN_FORM {

class TurningLaw;  // turning_law.hpp
class HingeLaw;    // hinge_law.hpp

class RigidProjection : public Projection {
public:
    /// Holds what a body has at a state x + low: `q`, `v` its first variables. Nothing but its weight acts on it.
    RigidProjection(const TurningLaw& law, int q, int v, std::span<const double> x, std::span<const double> low);

    void apply(std::span<double> x, std::span<double> low, double step, double t) const override;

    bool makes_up_for_rounding() const override;

private:
    using Real = long double;
    using Vector = std::array<Real, 3>;
    using Correction = std::array<double, 3>;  // a small one, and what it is made of

    struct Now {
        std::array<Real, 4> q;
        Real norm;     // |q|^2
        Vector omega;  // in the frame
        Vector force;  // there too, of a heavy body
    };

    static std::size_t at(int i) { return static_cast<std::size_t>(i); }
    template <class T>
    static T dot(const std::array<T, 3>& a, const std::array<T, 3>& b) {
        return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    }
    static Real norm(const Vector& a) { return std::sqrt(dot(a, a)); }
    template <class T>
    static std::array<T, 3> cross(const std::array<T, 3>& a, const std::array<T, 3>& b) {
        return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
    }
    static Correction rounded(const Vector& v);
    /// Adds what the rounded coefficients left out in a step.
    void catch_up(std::span<double> x, std::span<double> low, double step) const;
    Real least() const { return std::min({moment_[0], moment_[1], moment_[2]}); }

    Now look(std::span<const double> x, std::span<const double> low) const;
    /// v in the world for v in the frame, and back, by the unit quaternion.
    static Vector to_world(const Now& now, const Vector& v) { return turned(now, v, 1.0L); }
    static Vector to_frame(const Now& now, const Vector& v) { return turned(now, v, -1.0L); }
    static Vector turned(const Now& now, const Vector& v, Real sign);
    Vector momentum(const Now& now) const;
    Real energy(const Now& now) const;
    /// |f| - side f3, without cancellation.
    Real away(const Vector& f) const;
    Real defect(const Now& now, int i) const;
    /// K along the force, times its size.
    Real vertical(const Now& now) const;

    void hold_free(const Now& now, Correction& change, Correction& turn) const;

    void hold_heavy(const Now& now, Correction& change, Correction& turn) const;

    bool follows_axis_, is_heavy_ = false;
    std::array<double, 3> rest_{};  // of the coefficients of Euler's equations
    int attitude_, omega_;
    Vector moment_{}, arm_{}, force_{}, momentum_{}, defect_{};
    Real energy_ = 0.0L, vertical_ = 0.0L, force_size_ = 0.0L, side_ = 1.0L, speed_ = 1.0L, square_ = 0.0L;
};

/// The energy of a heavy body on a hinge (text after 7.60), I psi'^2/2 - F.c, taken from the lowest point on the lower
/// half of the circle and from the highest on the upper, where it is small near rest and near the separatrix.
class HingeProjection : public Projection {
public:
    HingeProjection(const HingeLaw& law, int q, int v, std::span<const double> x, std::span<const double> low);

    void apply(std::span<double> x, std::span<double> low, double /*step*/, double /*t*/) const override;

private:
    using Real = long double;

    static Real value(std::span<const double> x, std::span<const double> low, int i);
    Real energy(std::span<const double> x, std::span<const double> low, bool from_lowest) const;

    int angle_, rate_;
    Real moment_, depth_ = 0.0L, lowest_ = 0.0L, energy_[2];
};

/// All that is held in a scene. The parts see all variables; what is not simulated stays.
class Projections : public Projection {
public:
    /// The map outlives this.
    Projections(const StateMap& map, std::vector<std::unique_ptr<const Projection>> parts);
    void apply(std::span<double> x, std::span<double> low, double step, double t) const override;
    bool makes_up_for_rounding() const override;

private:
    const StateMap& map_;
    std::vector<std::unique_ptr<const Projection>> parts_;
    mutable std::vector<double> x_, low_;  // one engine's own
};

}  // namespace rbdyn::inline RBDYN_FORM
