// Rails of a tree that a bead may leave: where they push, and where it comes back.
//
// A bead that flies comes back to a rail of what stands still where its path meets the curve (model/rail_landing.hpp),
// to one of a body that moves where the height over the curve passes zero, in the curve's axes: y over a line, y - a
// x^2 over a parabola, R^2 - x^2 - y^2 inside a circle. Other curves have no such height, and only let go there.
#pragma once

#include <memory>
#include <optional>

#include "rbdyn/basics/double_double_vector.hpp"
#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/curve/circle.hpp"
#include "rbdyn/curve/curve.hpp"
#include "rbdyn/curve/one_side.hpp"
#include "rbdyn/curve/parabola.hpp"
#include "rbdyn/mechanics/moving.hpp"
#include "rbdyn/model/rail_landing.hpp"

namespace rbdyn::inline RBDYN_FORM {

namespace mechanics {

struct LooseRail {
    int body = -1, parent = -1;  // of the rail; -1: the world
    Curve curve;
    Vector3Of<DoubleDouble> held{};                        // P of the parent, from the origin of its axes
    std::optional<curves::OneSide> side = std::nullopt;    // none: it holds on both
    bool is_still = true;                                  // nothing moves what it is on
    std::shared_ptr<const RailLanding> landing = nullptr;  // on what stands still

    bool has_height() const {
        return curve.straight() || curve.as<Circle>() != nullptr || curve.as<Parabola>() != nullptr;
    }

    /// A place of the world in the axes of the side.
    template <class S>
    Vector3Of<S> own(const Vector3Of<S>& place, const Moving<S>& on) const {
        const Vector3Of<S> in_parent =
            (parent < 0 ? place : Vector3Of<S>(on.to_body(Vector3Of<S>(place - on.place)) + exactly<S>(held))) -
            exactly<S>(widened(curve.placement().origin));
        Vector3Of<S> result = none<S>();
        for (int k = 0; k < 3; ++k)
            for (int i = 0; i < 3; ++i)
                if (side->axes(i, k) != 0.0) result[k] += in_parent[i] * S(side->axes(i, k));
        return result;
    }
    /// How far it is over the curve, on the side that it may be on, in units of its own.
    template <class S>
    S height(const Vector3Of<S>& place, const Moving<S>& on) const {
        const Vector3Of<S> r = own<S>(place, on);
        S over = r[1];
        if (const Circle* circle = curve.as<Circle>())
            over = S(circle->radius) * S(circle->radius) - (r[0] * r[0] + r[1] * r[1]);
        else if (const Parabola* parabola = curve.as<Parabola>())
            over = r[1] - S(parabola->a) * (r[0] * r[0]);
        return over * S(side->sign);
    }
    /// b x r' of a bead on it, from r': along n, |r'| as long.
    template <class S>
    Vector3Of<S> pushing(const Vector3Of<S>& along, const Moving<S>& on) const {
        const Vector3Of<S> binormal = exactly<S>(widened(side->binormal()));
        return cross<S>(parent < 0 ? binormal : on.to_world(binormal), along);
    }
};

}  // namespace mechanics

}  // namespace rbdyn::inline RBDYN_FORM
