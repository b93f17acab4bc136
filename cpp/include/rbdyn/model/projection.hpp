// What integration by steps must not lose: the first integrals that a rigid body's motion has, held by the smallest
// change of the state after every step.
//
// Free of moments (7.54, 7.55): the energy; about the principal axis i with the largest energy,
//     D_i = sum_k I_k (I_k - I_i) w_k^2 = K^2 - 2 I_i E,
// which has no term of that axis, so that nothing cancels near a permanent rotation or a separatrix; and the direction
// of K in the world. Heavy, with a fixed point (7.58): the energy and the angular momentum about the vertical. And
// |q| = 1 always.
//
// Source: Hairer, Lubich, Wanner, Geometric Numerical Integration, IV.4. Residuals are computed in long double, and the
// corrections go into the compensation of the state's sums, so that they are not rounded away.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <span>
#include <vector>

#include "rbdyn/model/rigid_law.hpp"

namespace rbdyn {

class RigidProjection : public Projection {
public:
    /// Holds what a body has at a state: `q`, `v` its first variables. `force`: what acts on it at its centre of mass.
    RigidProjection(const RigidLaw& law, int q, int v, const Vector3& force, std::span<const double> x)
        : follows_axis_(law.follows_axis) {
        const bool is_free = law.kind == RigidLaw::Kind::free;
        attitude_ = q + (is_free ? 3 : 0);
        omega_ = v + (is_free ? 3 : 0);
        for (int i = 0; i < 3; ++i) {
            moment_[at(i)] = law.moments[i];
            arm_[at(i)] = is_free ? 0.0L : law.center[i];
            force_[at(i)] = force[i];
        }
        is_heavy_ = !is_free && !force.isZero(0.0) && !law.center.isZero(0.0);
        const std::vector<double> none(x.size(), 0.0);
        const Now now = look(x, none);
        energy_ = energy(now);
        if (is_heavy_) {
            force_size_ = std::sqrt(dot(force_, force_));
            vertical_ = vertical(now);
            speed_ = std::sqrt(std::abs(dot(now.omega, now.omega)) + force_size_ * norm(arm_) / least());
        } else {
            for (int i = 0; i < 3; ++i) defect_[at(i)] = defect(now, i);
            momentum_ = to_world(now, momentum(now));
            square_ = dot(momentum_, momentum_);
        }
    }

    void apply(std::span<double> x, std::span<double> low) const override {
        Now now = look(x, low);
        const Real shrink = -0.5L * (now.norm - 1.0L);
        Vector turn{}, change{};
        if (is_heavy_)
            hold_heavy(now, change, turn);
        else if (square_ > 0.0L)
            hold_free(now, change, turn);
        const auto& [w, a, b, c] = now.q;
        // q (1, turn/2), turn in the frame
        const Real h[3] = {0.5L * turn[0], 0.5L * turn[1], 0.5L * turn[2]};
        const Real dq[4] = {w * shrink - a * h[0] - b * h[1] - c * h[2], a * shrink + w * h[0] + b * h[2] - c * h[1],
                            b * shrink + w * h[1] + c * h[0] - a * h[2], c * shrink + w * h[2] + a * h[1] - b * h[0]};
        for (int i = 0; i < 4; ++i) add(x, low, attitude_ + i, dq[i]);
        for (int i = 0; i < (follows_axis_ ? 2 : 3); ++i) add(x, low, omega_ + i, change[at(i)]);
    }

private:
    using Real = long double;
    using Vector = std::array<Real, 3>;

    struct Now {
        std::array<Real, 4> q;
        Real norm;     // |q|^2
        Vector omega;  // in the frame
    };

    static std::size_t at(int i) { return static_cast<std::size_t>(i); }
    static Real dot(const Vector& a, const Vector& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
    static Real norm(const Vector& a) { return std::sqrt(dot(a, a)); }
    static Vector cross(const Vector& a, const Vector& b) {
        return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
    }
    static void add(std::span<double> x, std::span<double> low, int i, Real change) {
        const Instant sum = exact_sum(x[at(i)], low[at(i)] + static_cast<double>(change));
        x[at(i)] = sum.hi;
        low[at(i)] = sum.lo;
    }
    Real least() const { return std::min({moment_[0], moment_[1], moment_[2]}); }

    Now look(std::span<const double> x, std::span<const double> low) const {
        Now now;
        const auto value = [&](int i) { return static_cast<Real>(x[at(i)]) + static_cast<Real>(low[at(i)]); };
        now.norm = 0.0L;
        for (int i = 0; i < 4; ++i) {
            now.q[at(i)] = value(attitude_ + i);
            now.norm += now.q[at(i)] * now.q[at(i)];
        }
        for (int i = 0; i < 3; ++i) now.omega[at(i)] = value(omega_ + i);
        return now;
    }
    /// v in the world for v in the frame, and back, by the unit quaternion.
    static Vector to_world(const Now& now, const Vector& v) { return turned(now, v, 1.0L); }
    static Vector to_frame(const Now& now, const Vector& v) { return turned(now, v, -1.0L); }
    static Vector turned(const Now& now, const Vector& v, Real sign) {
        // v + 2 r x (r x v + w v), r the vector part, over |q|^2
        const Vector r{sign * now.q[1], sign * now.q[2], sign * now.q[3]};
        Vector t = cross(r, v);
        for (int i = 0; i < 3; ++i) t[at(i)] += now.q[0] * v[at(i)];
        t = cross(r, t);
        Vector result;
        for (int i = 0; i < 3; ++i) result[at(i)] = v[at(i)] + 2.0L / now.norm * t[at(i)];
        return result;
    }
    Vector momentum(const Now& now) const {
        return {moment_[0] * now.omega[0], moment_[1] * now.omega[1], moment_[2] * now.omega[2]};
    }
    Real energy(const Now& now) const {
        const Real kinetic = 0.5L * dot(momentum(now), now.omega);
        return is_heavy_ ? kinetic - dot(to_frame(now, force_), arm_) : kinetic;
    }
    Real defect(const Now& now, int i) const {
        Real sum = 0.0L;
        for (int k = 0; k < 3; ++k)
            sum += moment_[at(k)] * (moment_[at(k)] - moment_[at(i)]) * now.omega[at(k)] * now.omega[at(k)];
        return sum;
    }
    /// K along the force, times its size.
    Real vertical(const Now& now) const { return dot(momentum(now), to_frame(now, force_)); }

    void hold_free(const Now& now, Vector& change, Vector& turn) const {
        int axis = 0;
        for (int i = 1; i < 3; ++i)
            if (moment_[at(i)] * now.omega[at(i)] * now.omega[at(i)] >
                moment_[at(axis)] * now.omega[at(axis)] * now.omega[at(axis)])
                axis = i;
        const Vector k = momentum(now);
        Vector slope{};  // of D
        for (int i = 0; i < 3; ++i) slope[at(i)] = 2.0L * (moment_[at(i)] - moment_[at(axis)]) * k[at(i)];
        const Real e = energy_ - energy(now), d = defect_[at(axis)] - defect(now, axis);
        // the smallest change of omega with k.change = e and slope.change = d
        const Real kk = dot(k, k), ks = dot(k, slope), ss = dot(slope, slope), det = kk * ss - ks * ks;
        Real a = e / kk, b = 0.0L;
        if (det > 1e-30L * kk * kk * moment_[at(axis)] * moment_[at(axis)]) {
            a = (ss * e - ks * d) / det;
            b = (kk * d - ks * e) / det;
        }
        for (int i = 0; i < 3; ++i) change[at(i)] = a * k[at(i)] + b * slope[at(i)];
        // the turn that brings K back to where it was
        Now then = now;
        for (int i = 0; i < 3; ++i) then.omega[at(i)] += change[at(i)];
        const Vector off = cross(momentum(then), to_frame(now, momentum_));
        for (int i = 0; i < 3; ++i) turn[at(i)] = off[at(i)] / square_;
    }

    void hold_heavy(const Now& now, Vector& change, Vector& turn) const {
        const Vector f = to_frame(now, force_), k = momentum(now);
        // in (omega / speed, turn): a turn t changes f by f x t
        const Vector e_turn = cross(f, arm_), v_turn = cross(k, f);
        const int free = follows_axis_ ? 2 : 3;
        Vector e_omega{}, v_omega{};
        for (int i = 0; i < free; ++i) {
            e_omega[at(i)] = k[at(i)] * speed_;
            v_omega[at(i)] = moment_[at(i)] * f[at(i)] * speed_;
        }
        const Real e = energy_ - energy(now), v = vertical_ - vertical(now);
        const Real ee = dot(e_omega, e_omega) + dot(e_turn, e_turn), vv = dot(v_omega, v_omega) + dot(v_turn, v_turn),
                   ev = dot(e_omega, v_omega) + dot(e_turn, v_turn), det = ee * vv - ev * ev;
        Real a = ee > 0.0L ? e / ee : 0.0L, b = 0.0L;
        if (det > 1e-12L * ee * vv) {
            a = (vv * e - ev * v) / det;
            b = (ee * v - ev * e) / det;
        }
        for (int i = 0; i < 3; ++i) {
            change[at(i)] = (a * e_omega[at(i)] + b * v_omega[at(i)]) * speed_;
            turn[at(i)] = a * e_turn[at(i)] + b * v_turn[at(i)];
        }
    }

    bool follows_axis_, is_heavy_ = false;
    int attitude_, omega_;
    Vector moment_{}, arm_{}, force_{}, momentum_{}, defect_{};
    Real energy_ = 0.0L, vertical_ = 0.0L, force_size_ = 0.0L, speed_ = 1.0L, square_ = 0.0L;
};

/// All that is held in a scene.
class Projections : public Projection {
public:
    explicit Projections(std::vector<RigidProjection> parts) : parts_(std::move(parts)) {}
    void apply(std::span<double> x, std::span<double> low) const override {
        for (const RigidProjection& p : parts_) p.apply(x, low);
    }

private:
    std::vector<RigidProjection> parts_;
};

}  // namespace rbdyn
