// The foot of a point that is held on a curve: the place of the curve where the point is.
//
// The curve is fixed in a body b, at x_b + R_b r(u), or in the world. Its parameter u is a variable of the motion that
// has no mass and no velocity of its own; it follows the point p that is held,
//     u' = tau . (v_p - v_b)/|tau|^2,   tau = R_b r'(u),   v_b the velocity of b at the foot.
// The foot moves like a bead on a rail, and what is held are the two directions across tau,
//     n_1 = e x tau/|e x tau|,   n_2 = tau x n_1/|tau|,
// e a direction fixed in b that no tangent of the curve has (`aside`): so they are smooth all along, and never become
// one. Across the axes of a plane curve e is the normal of its plane.
// Invariant: constants that derive from the user's doubles are numbers of 32 digits.
#pragma once

#include <cmath>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/double_double_vector.hpp"
#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/curve/axes.hpp"
#include "rbdyn/curve/curve.hpp"
#include "rbdyn/curve/point.hpp"
#include "rbdyn/mechanics/accelerate.hpp"
#include "rbdyn/mechanics/anchor.hpp"
#include "rbdyn/mechanics/moving.hpp"

namespace rbdyn::inline RBDYN_FORM {

namespace mechanics {

struct Foot {
    std::string name;                  // of the constraint
    Anchor held;                       // the point
    int on = -1;                       // the body that the curve is fixed in; -1: the world
    Vector3Of<DoubleDouble> origin{};  // of the curve's coordinates, from P of that body, in its axes
    Curve curve;
    Vector3Of<DoubleDouble> aside{};  // e, in the curve's own axes
    int q = 0;                        // its parameter among the positions

    /// Where it is and how it moves, from all bodies and all positions. Its axes are those of b; its joint is tau, and
    /// behind it n_1 and n_2.
    template <class S>
    Moving<S> move(const std::vector<Moving<S>>& all, const S* positions) const {
        const CurvePoint<S> c = curve.at<S>(positions[q], Placement{});
        const Moving<S> b = body<S>(on, all);
        Moving<S> foot = carried<S>(b, Vector3Of<S>(exactly<S>(origin) + c.position));
        const Vector3Of<S> along = b.to_world(c.first);
        const S w = dot<S>(along, Vector3Of<S>(velocity_of_point<S>(all) - foot.velocity)) / c.speed_squared;
        const Vector3Of<S> sliding = along * w;
        foot.velocity += sliding;
        foot.bias += Vector3Of<S>(cross<S>(b.omega, sliding) * S(2.0)) + Vector3Of<S>(b.to_world(c.second) * (w * w));
        const auto [first, second] = across<S>(positions[q]);
        foot.joint = {{none<S>(), along}, {none<S>(), foot.to_world(first)}, {none<S>(), foot.to_world(second)}};
        return foot;
    }
    /// u'.
    template <class S>
    S rate(const std::vector<Moving<S>>& all, const Moving<S>& foot) const {
        const Moving<S> b = body<S>(on, all);
        const Vector3Of<S> along = foot.joint.front().move,
                           arm = on < 0 ? foot.place : Vector3Of<S>(foot.place - b.place);
        return dot<S>(along, Vector3Of<S>(velocity_of_point<S>(all) - b.velocity_at(arm))) / dot<S>(along, along);
    }
    /// How far the parameter is from where the point is nearest, to first order.
    template <class S>
    S off(const std::vector<Moving<S>>& all, const Moving<S>& foot) const {
        const Vector3Of<S> along = foot.joint.front().move;
        return dot<S>(along, Vector3Of<S>(place_of_point<S>(all) - foot.place)) / dot<S>(along, along);
    }
    /// A part of the curve by its parameter that tells how large it is: a quarter, or 1 of one without end.
    double part() const {
        if (curve.closed()) return 0.25 * curve.period();
        const Domain d = curve.domain();
        return std::isfinite(d.begin) && std::isfinite(d.end) ? 0.25 * (d.end - d.begin) : 1.0;
    }

    /// The parameters where the curve is nearest to a point of its coordinates: one, but where it meets itself.
    static std::vector<double> nearest(const Curve& curve, const Vector3& point);
    /// A direction in a curve's own axes that no tangent of it has, as far from all of them as there is one.
    static Vector3 direction_aside(const Curve& curve);

private:
    static std::size_t at(int i) { return static_cast<std::size_t>(i); }
    /// n_1 and n_2 in the axes of b.
    template <class S>
    std::pair<Vector3Of<S>, Vector3Of<S>> across(const S& u) const {
        using std::sqrt;
        const CurvePoint<S> c = curve.own<S>(u);
        const Vector3Of<S> e = exactly<S>(aside), m = cross<S>(e, c.first);
        const S along = dot<S>(e, c.first);
        Vector3Of<S> first = m, second = e;
        if (is_nothing(along)) {
            first = m * (S(1.0) / sqrt(c.speed_squared));
        } else {
            const S part = S(1.0) / sqrt(dot<S>(m, m));
            first = m * part;
            second = Vector3Of<S>(e * c.speed_squared - c.first * along) * (part / sqrt(c.speed_squared));
        }
        if constexpr (std::is_same_v<S, double>)
            return {curves::turned<S>(curve.placement().axes, first),
                    curves::turned<S>(curve.placement().axes, second)};
        else
            return {curves::turned<S>(curve.placement().exact_axes(), first),
                    curves::turned<S>(curve.placement().exact_axes(), second)};
    }
    template <class S>
    static Moving<S> body(int i, const std::vector<Moving<S>>& all) {
        return i < 0 ? Moving<S>{} : all[at(i)];
    }
    template <class S>
    Vector3Of<S> place_of_point(const std::vector<Moving<S>>& all) const {
        return all[at(held.body)].place + all[at(held.body)].to_world(exactly<S>(held.point));
    }
    template <class S>
    Vector3Of<S> velocity_of_point(const std::vector<Moving<S>>& all) const {
        const Moving<S>& a = all[at(held.body)];
        return a.velocity_at(a.to_world(exactly<S>(held.point)));
    }
};

}  // namespace mechanics

}  // namespace rbdyn::inline RBDYN_FORM
