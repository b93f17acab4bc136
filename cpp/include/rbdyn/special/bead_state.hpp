// Where a bead is and how it moves, on its rail or off it, in numbers of any type.
//
// Notation: c(u) the rail's curve, u its parameter, w = du/dt; a rail that moves carries it along, r = R(t) c + d(t):
//     v = R c' w + R' c + d'
//     a = R (c' w' + c'' w^2) + A,   A = 2 R' c' w + R'' c + d''
// Conventions: all vectors in the axes of the view; those of the curve are the rail's own, which a rail at rest shares
// with the view.
#pragma once

#include <memory>
#include <utility>

#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/double_double_vector.hpp"
#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/curve/point.hpp"
#include "rbdyn/scene/rigid_motion.hpp"
#include "rbdyn/special/single_state.hpp"

namespace rbdyn::inline RBDYN_FORM {

/// A rail that moves, at a time.
template <class S>
struct RailFrame {
    RigidPlacement<S> at, rate, second;

    RailFrame(const RigidMotion& motion, const S& t, const Placement& view)
        : at(seen(motion.at<S>(t), view, true)),
          rate(seen(motion.rate<S>(t), view, false)),
          second(seen(motion.second<S>(t), view, false)) {}

private:
    /// With A the axes of the view and o its origin: A^T R A, and A^T (R o + d - o) for the placement itself.
    static RigidPlacement<S> seen(const RigidPlacement<S>& p, const Placement& view, bool is_placement) {
        const Matrix3Of<DoubleDouble> exact = view.exact_axes();
        const Matrix3& a = view.axes;
        const auto entry = [&](int i, int j) { return exactly<S>(exact(i, j)); };
        RigidPlacement<S> out;
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j) {
                S sum = S(0.0);
                for (int k = 0; k < 3; ++k)
                    for (int l = 0; l < 3; ++l)
                        if (a(k, i) != 0.0 && a(l, j) != 0.0) sum += p.row[k][l] * (entry(k, i) * entry(l, j));
                out.row[i][j] = sum;
            }
        Vector3Of<S> d = p.displacement;
        for (int k = 0; k < 3; ++k) {
            for (int l = 0; l < 3; ++l)
                if (view.origin[l] != 0.0) d[k] += p.row[k][l] * S(view.origin[l]);
            if (is_placement && view.origin[k] != 0.0) d[k] -= S(view.origin[k]);
        }
        for (int i = 0; i < 3; ++i) {
            S sum = S(0.0);
            for (int k = 0; k < 3; ++k)
                if (a(k, i) != 0.0) sum += d[k] * entry(k, i);
            out.displacement[i] = sum;
        }
        return out;
    }
};

/// Place and velocity of a bead, and where it is on its rail; in flight it is on none.
template <class S>
struct BeadState : SingleState<S> {
    using SingleState<S>::r, SingleState<S>::v;
    CurvePoint<S> curve;
    S w = S(0.0);
    std::shared_ptr<const RailFrame<S>> frame;  // of a rail that moves

    BeadState(const Vector3Of<S>& place, const Vector3Of<S>& velocity) : SingleState<S>(place, velocity) {}
    BeadState(const CurvePoint<S>& point, const S& rate, std::shared_ptr<const RailFrame<S>> moving)
        : curve(point), frame(std::move(moving)) {
        r = frame ? frame->at.moved(curve.position) : curve.position;
        set_rate(rate);
    }

    /// Another rate of the parameter, at the same place.
    void set_rate(const S& rate) {
        w = rate;
        v = curve.first * w;
        if (frame) v = frame->at.turned(v) + frame->rate.moved(curve.position);
    }
    /// A: the acceleration the rail's motion gives, beside that along and across it.
    Vector3Of<S> transport() const {
        if (!frame) return {S(0.0), S(0.0), S(0.0)};
        return frame->rate.turned(curve.first) * (S(2.0) * w) + frame->second.moved(curve.position);
    }
    Vector3Of<S> acceleration(const S& w_rate) const {
        const Vector3Of<S> relative = curve.first * w_rate + curve.second * (w * w);
        return frame ? Vector3Of<S>(frame->at.turned(relative) + transport()) : relative;
    }
    /// A vector of the view in the rail's own axes, and back.
    Vector3Of<S> in_rail(const Vector3Of<S>& f) const { return frame ? frame->at.turned_back(f) : f; }
    Vector3Of<S> in_view(const Vector3Of<S>& f) const { return frame ? frame->at.turned(f) : f; }
};

}  // namespace rbdyn::inline RBDYN_FORM
