// Where a part of a body is nearest to a surface, and how both move there.
//
// A convex part about a centre c reaches h(n) far against a direction n, at the point c - s, s = grad h: a sphere rho
// n, a disc across m the rim, r w/|w| with w = n - (n.m) m, an ellipsoid Q n/h with Q = sum a_i^2 e_i e_i^T. On a plane
// with normal n the gap is n.(c - c0) - h. On a sphere with centre c0 it is |d| - R, d = c - s - c0 to the point of the
// part that is nearest to c0, n = d/|d|; in a bowl R - |d| with the farthest one and the opposite n
// (nearest_point.hpp).
//
// gap' = n.u, u the velocity of the part's material point relative to the surface's. It is differentiated along the
// point of contact p, which moves on both: u' = (a + alpha x r + omega x (p' - v)) of the part, less the same of the
// surface.
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/double_double_functions.hpp"
#include "rbdyn/basics/double_double_vector.hpp"
#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/expression/expression.hpp"
#include "rbdyn/expression/given.hpp"
#include "rbdyn/mechanics/accelerate.hpp"
#include "rbdyn/mechanics/moving.hpp"
#include "rbdyn/mechanics/nearest_point.hpp"
#include "rbdyn/mechanics/tree.hpp"

namespace rbdyn::inline RBDYN_FORM {

namespace mechanics {

/// Two bodies at their contact, seen from the world.
template <class S>
struct Touching {
    int a = -1, b = -1;
    Vector3Of<S> place, arm_a, arm_b;            // of the point; from P of each body, or from the world's origin
    Vector3Of<S> aside_a, aside_b;               // of these what a force along the normal turns by
    S along_a = S(0.0), along_b = S(0.0);        // and what is left, along the normal
    Vector3Of<S> normal, normal_rate;            // from the surface to the part
    Vector3Of<S> velocity, bias;                 // u, and what of its rate is not linear in accelerations of joints
    Vector3Of<S> turning, turn_bias;             // the angular velocity of a relative to b, and the same of its rate
    Vector3Of<S> tangents[2], tangent_rates[2];  // of a plane: two directions along it that turn with it
    S gap = S(0.0);
    S flat = S(1.0);              // of a disc that touches with its rim: the sine squared of its tilt
    bool is_along_plane = false;  // the axes of what is held
    bool is_in_plane = false;     // both move in one plane, as joints have them, with this normal
    Vector3Of<S> across = none<S>();

    /// Where it moves along the surface, of what moves in one plane.
    Vector3Of<S> way() const { return cross<S>(across, normal); }
    /// The condition on what does not move.
    Row<S> no_row() const { return row(none<S>(), none<S>()); }
    /// The condition on accelerations along a direction that turns at a rate.
    Row<S> row(const Vector3Of<S>& along, const Vector3Of<S>& along_rate) const {
        Row<S> r{a, b, {}, {}, dot<S>(along, bias) + dot<S>(along_rate, velocity)};
        r.on_a = on_a(along);
        r.on_b = on_b(along);
        return r;
    }
    /// An axis that what is held is told along: of the world, or two along the plane and its normal; of what moves in
    /// one plane its way there, across it, and the normal.
    Vector3Of<S> held_axis(int k) const {
        if (is_in_plane) return k == 0 ? way() : k == 1 ? across : normal;
        if (is_along_plane) return k < 2 ? tangents[k] : normal;
        Vector3Of<S> e = none<S>();
        e[k] = S(1.0);
        return e;
    }
    /// The condition on accelerations along it.
    Row<S> held_row(int k) const {
        if (is_in_plane && k == 1) return no_row();
        if (is_in_plane) return row(held_axis(k), k == 0 ? Vector3Of<S>(cross<S>(across, normal_rate)) : normal_rate);
        if (!is_along_plane) return row(held_axis(k), none<S>());
        return row(held_axis(k), k < 2 ? tangent_rates[k] : normal_rate);
    }
    /// The condition on angular accelerations about a direction that turns at a rate.
    Row<S> turning_row(const Vector3Of<S>& about, const Vector3Of<S>& about_rate) const {
        Row<S> r{a, b, {}, {}, dot<S>(about, turn_bias) + dot<S>(about_rate, turning)};
        r.on_a.moment = about;
        r.on_b.moment = -about;
        return r;
    }
    /// What a torque on a, from b, adds to a row's force.
    void add_torque(Row<S>& row, const Vector3Of<S>& torque) const {
        row.on_a.moment += torque;
        row.on_b.moment -= torque;
    }
    /// What a force on a, from b, does to each.
    Wrench<S> on_a(const Vector3Of<S>& force) const { return wrench(aside_a, along_a, force); }
    Wrench<S> on_b(const Vector3Of<S>& force) const { return wrench(aside_b, along_b, -force); }
    /// The velocity along the surface.
    Vector3Of<S> slip() const {
        if (is_in_plane) return way() * dot<S>(way(), velocity);
        return velocity - normal * dot<S>(normal, velocity);
    }

private:
    // n x n is exactly zero: no rounding of a force along the normal turns what it passes through the centre of
    Wrench<S> wrench(const Vector3Of<S>& aside, const S& along, const Vector3Of<S>& force) const {
        Wrench<S> w;
        w.force = force;
        w.moment = cross<S>(aside, force) + cross<S>(normal, force) * along;
        return w;
    }
};

/// A torque of a contact against rolling, or against pivoting. An idle one resists nothing: it holds what does not roll
/// and is not turned about the normal, so that it stands still.
struct Resistance {
    int contact = -1;
    bool pivots = false, idle = false;

    int rows() const { return pivots ? 1 : 2; }
    /// The directions it acts about: two along the surface, or the normal.
    template <class S>
    Vector3Of<S> about(const Touching<S>& t, int k) const {
        return pivots ? t.normal : t.tangents[k];
    }
    template <class S>
    Row<S> row(const Touching<S>& t, int k) const {
        return pivots ? t.turning_row(t.normal, t.normal_rate) : t.turning_row(t.tangents[k], t.tangent_rates[k]);
    }
};

struct ContactLaw {
    enum class Part { ball, disc, ellipsoid };
    enum class Surface { plane, ball, bowl };

    std::string name;
    Part part = Part::ball;
    Surface surface = Surface::plane;
    Anchor a, b;                               // centre of the part; a point of the plane, or the surface's centre
    DoubleDouble radius, surface_radius;       // of a ball or a disc; of a ball or a bowl
    Vector3Of<DoubleDouble> axis{}, normal{};  // of a disc, axes of a; of a plane, axes of b
    Vector3Of<DoubleDouble> given{};           // of a plane: its normal as it was given, as it is or in powers of two
    Vector3Of<DoubleDouble> own[3] = {};       // of an ellipsoid: its axes, each as long as its semi-axis, axes of a
    std::optional<nearest::OfEllipsoid> nearest_of;  // of an ellipsoid on a ball or in a bowl
    bool is_gone = false;                            // taken away: it never closes
    double restitution = 0.0;
    Given mu_static, mu_dynamic;
    Given rolling, pivoting;                   // torques over N that resist turning along the surface and about n [m]
    Vector3Of<DoubleDouble> tangents[2] = {};  // of a plane: two directions along it, axes of b
    // what is held there is told along these and the normal: friction far smaller than the load, which another axis
    // would mix with it, is then known by digits of its own. Planes that start across an axis of the world have its
    // axes
    bool is_along_plane = false;
    // of bodies that joints keep in one plane, which leans: its normal, in the world. Nothing moves along it but by
    // rounding, and what joints bear there is no friction
    std::optional<Vector3Of<DoubleDouble>> across;

    bool is_rough() const { return !mu_static.is_zero(); }
    /// Friction without bound, where what sticks would have to be pulled: it slides as with ever larger coefficients,
    /// whose motions tend to one, by one over the coefficient. This one is as near to it as rounding; of several feet
    /// in space the limit leaves open how they share what little load there is, and the largest that tells is less.
    static constexpr double alone = 0x1p46, one_of_several = 0x1p20;
    std::vector<int> beside;  // of a body in space: its other contacts whose friction has no bound
    bool never_slips() const { return !std::isfinite(static_cast<double>(mu_dynamic)); }
    /// With what it slides. `touches`: of a contact, whether it does.
    template <class Touches>
    double sliding(const Touches& touches) const {
        if (!never_slips()) return static_cast<double>(mu_dynamic);
        return std::ranges::any_of(beside, touches) ? one_of_several : alone;
    }

    /// What has the sign of the gap, and up to twice its size: of a ball on a plane by the normal as it was given,
    /// which no root has rounded. What slides far along a plane is held to it by no more digits than its normal has.
    template <class S>
    S sign(const Tree& tree, const std::vector<Moving<S>>& all, const Touching<S>& touching) const {
        if (surface != Surface::plane || part != Part::ball) return touching.gap;
        Moving<S> on;
        if (b.body >= 0) on = all[static_cast<std::size_t>(b.body)];
        const Vector3Of<S> apart = tree.point<S>(a, all).place - tree.point<S>(b, all).place;
        const DoubleDouble length = sqrt(dot<DoubleDouble>(given, given));
        return dot<S>(on.to_world(exactly<S>(given)), apart) - exactly<S>(DoubleDouble(radius * length));
    }

    template <class S>
    Touching<S> touching(const Tree& tree, const std::vector<Moving<S>>& all) const {
        using std::sqrt;
        Touching<S> result;
        result.a = a.body;
        result.b = b.body;
        result.is_along_plane = is_along_plane;
        result.is_in_plane = across.has_value();
        if (across) result.across = exactly<S>(*across);
        Moving<S> on;
        if (b.body >= 0) on = all[static_cast<std::size_t>(b.body)];
        const Moving<S>& of = all[static_cast<std::size_t>(a.body)];
        const auto center = tree.point<S>(a, all), foot = tree.point<S>(b, all);
        const Vector3Of<S> apart = center.place - foot.place;
        const Vector3Of<S> moving = center.velocity - foot.velocity;
        Vector3Of<S> s = none<S>(), s_rate = none<S>();
        S reach = exactly<S>(radius);
        const auto turned = [&](const Vector3Of<DoubleDouble>& fixed) {
            const Vector3Of<S> world = of.to_world(exactly<S>(fixed));
            return nearest::Led<S>{world, cross<S>(of.omega, world)};
        };
        if (surface == Surface::plane) {
            result.normal = on.to_world(exactly<S>(normal));
            result.normal_rate = cross<S>(on.omega, result.normal);
        } else {
            Vector3Of<S> d = apart, d_rate = moving;
            S far;
            if (part == Part::ball) {
                far = sqrt(dot<S>(apart, apart));
            } else {
                const bool is_bowl = surface == Surface::bowl;
                const NearestPoint<S> point =
                    part == Part::disc
                        ? nearest::of_disc<S>(turned(axis), reach, {apart, moving}, is_bowl)
                        : nearest_of->of<S>({turned(own[0]), turned(own[1]), turned(own[2])}, {apart, moving});
                s = point.s;
                s_rate = point.s_rate;
                far = point.far;
                if (is_bowl && part == Part::disc) result.flat = point.flat;
                d = apart - s;
                d_rate = moving - s_rate;
                reach = S(0.0);
            }
            const S sign(surface == Surface::bowl ? -1.0 : 1.0);
            result.normal = d * (sign / far);
            result.normal_rate = Vector3Of<S>(d_rate - result.normal * dot<S>(result.normal, d_rate)) * (sign / far);
            result.along_b = far * sign - reach;
            result.gap = (far - exactly<S>(surface_radius)) * sign - reach;
        }
        const Vector3Of<S>&n = result.normal, &n_rate = result.normal_rate;
        if (part == Part::ball) {
            s = n * reach;
            s_rate = n_rate * reach;
        } else if (surface == Surface::plane && part == Part::disc) {
            const auto [m, m_rate] = turned(axis);
            const S along = dot<S>(n, m), along_rate = dot<S>(n_rate, m) + dot<S>(n, m_rate);
            const Vector3Of<S> w = n - m * along, w_rate = n_rate - m * along_rate - m_rate * along;
            result.flat = dot<S>(w, w);
            const S length = sqrt(result.flat);
            const Vector3Of<S> unit_w = w * (S(1.0) / length);
            s = unit_w * reach;
            s_rate = Vector3Of<S>(w_rate - unit_w * dot<S>(unit_w, w_rate)) * (reach / length);
            reach = reach * length;
        } else if (surface == Surface::plane) {
            Vector3Of<S> qn = none<S>(), qn_rate = none<S>();
            for (const auto& one : own) {
                const auto [e, e_rate] = turned(one);
                const S along = dot<S>(e, n), along_rate = dot<S>(e_rate, n) + dot<S>(e, n_rate);
                qn += e * along;
                qn_rate += e_rate * along + e * along_rate;
            }
            const S h = sqrt(dot<S>(n, qn)), inverse = S(1.0) / h;
            // h' = s.n', for s is the gradient of h, and what the part itself turns
            const S h_rate = (dot<S>(n_rate, qn) + dot<S>(n, qn_rate)) * S(0.5) * inverse;
            s = qn * inverse;
            s_rate = Vector3Of<S>(qn_rate - s * h_rate) * inverse;
            reach = h;
        }
        if (surface == Surface::plane) {
            result.gap = dot<S>(n, apart) - reach;
            for (int k = 0; k < 2; ++k) {
                result.tangents[k] = on.to_world(exactly<S>(tangents[k]));
                result.tangent_rates[k] = cross<S>(on.omega, result.tangents[k]);
            }
        }
        result.turning = of.omega - on.omega;
        result.turn_bias = of.bias_turn - on.bias_turn;
        result.place = center.place - s;
        const Vector3Of<S> place_rate = center.velocity - s_rate;
        result.arm_a = center.arm - s;
        result.arm_b = b.body >= 0 ? Vector3Of<S>(result.place - on.place) : result.place;
        result.aside_a = part == Part::ball ? center.arm : result.arm_a;
        if (part == Part::ball) result.along_a = -reach;
        result.aside_b = surface == Surface::plane ? result.arm_b : b.body >= 0 ? foot.arm : foot.place;
        result.velocity = of.velocity_at(result.arm_a) - on.velocity_at(result.arm_b);
        const auto bias = [&](const Moving<S>& m, const Vector3Of<S>& arm) {
            return Vector3Of<S>(m.bias + cross<S>(m.bias_turn, arm) +
                                cross<S>(m.omega, Vector3Of<S>(place_rate - m.velocity)));
        };
        result.bias = bias(of, result.arm_a);
        if (b.body >= 0) result.bias = result.bias - bias(on, result.arm_b);
        return result;
    }
};

}  // namespace mechanics

}  // namespace rbdyn::inline RBDYN_FORM
