// Definitions of rbdyn/curve/curve.hpp.
#pragma once

#include "rbdyn/curve/curve.hpp"

#include <cmath>
#include <optional>
#include <string>
#include <variant>

#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/double_double_functions.hpp"
#include "rbdyn/basics/error.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/curve/arc_length.hpp"
#include "rbdyn/curve/axes.hpp"
#include "rbdyn/curve/checks.hpp"
#include "rbdyn/curve/circle.hpp"
#include "rbdyn/curve/exact_length.hpp"
#include "rbdyn/curve/helix.hpp"
#include "rbdyn/curve/line.hpp"
#include "rbdyn/curve/parabola.hpp"
#include "rbdyn/curve/point.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE Domain Curve::domain() const {
    return asked([](const auto& form) { return form.domain(); });
}

RBDYN_INLINE bool Curve::closed() const {
    return asked([](const auto& form) { return form.closed(); });
}

RBDYN_INLINE double Curve::period() const {
    return asked([](const auto& form) {
        if constexpr (requires { form.period(); })
            return form.period();
        else
            return 0.0;
    });
}

RBDYN_INLINE bool Curve::straight() const {
    return asked([](const auto& form) { return form.straight(); });
}

RBDYN_INLINE bool Curve::always_regular() const {
    const auto& kind = *kind_;
    return std::holds_alternative<Line>(kind) || std::holds_alternative<Circle>(kind) ||
           std::holds_alternative<Parabola>(kind) || std::holds_alternative<Helix>(kind);
}

RBDYN_INLINE std::string Curve::name() const {
    return asked([](const auto& form) { return form.name(); });
}

RBDYN_INLINE double Curve::length(double u0, double u1) const {
    curves::require_finite(name(), "parameter u0", u0);
    curves::require_finite(name(), "parameter u1", u1);
    return plain_length(u0, u1);
}

RBDYN_INLINE double Curve::parameter_at(double u0, double arc_length) const {
    curves::require_finite(name(), "parameter u0", u0);
    curves::require_finite(name(), "arc length", arc_length);
    return curves::parameter_at(Way{*this}, u0, arc_length, name());
}

RBDYN_INLINE DoubleDouble Curve::exact_parameter_at(double u0, double arc_length) const {
    const double u = parameter_at(u0, arc_length);
    const auto speed = [&](long double at) { return std::sqrt(own(at).speed_squared); };
    const DoubleDouble exact = curves::refined_parameter(speed, u0, arc_length, u);
    return exact.hi >= domain().begin && exact.hi <= domain().end ? exact : DoubleDouble(u);
}

RBDYN_INLINE Frenet Curve::frenet(double u) const {
    require_regular(u);
    const CurvePoint<double> p = own(u);
    const auto straight = straight_binormal(u);
    const Vector3 tangent = curves::unit(p.first);
    Vector3 binormal = straight ? *straight : curves::unit(p.first_cross_second);
    // where r' and r'' are nearly parallel their product is across them to fewer digits than a frame should be
    binormal = curves::unit(binormal - tangent.dot(binormal) * tangent);
    return {in_world(tangent), in_world(binormal.cross(tangent)), in_world(binormal)};
}

RBDYN_INLINE double Curve::curvature(double u) const {
    require_regular(u);
    if (straight_binormal(u)) return 0.0;
    const CurvePoint<double> p = own(u);
    const double speed = curves::norm(p.first);
    return curves::norm(p.first_cross_second) / speed / speed / speed;
}

RBDYN_INLINE double Curve::torsion(double u) const {
    require_regular(u);
    if (straight_binormal(u)) return 0.0;
    const Vector3 product = own(u).first_cross_second;
    return curves::unit(product).dot(third(u)) / curves::norm(product);
}

RBDYN_INLINE bool Curve::jumps_at(double u) const {
    return asked([&](const auto& form) {
        if constexpr (requires { form.jumps_at(u); })
            return form.jumps_at(u);
        else
            return false;
    });
}

RBDYN_INLINE void Curve::require_regular(double u) const {
    curves::require_finite(name(), "parameter", u);
    const bool regular = asked([&](const auto& form) { return form.regular_at(u); });
    require(regular, name(), "parameter", u,
            "the curve has a cusp there, |r'| = " + text(curves::norm(own(u).first)) +
                ", and no tangent: choose a parameter where r' is not zero");
    require(!jumps_at(u), name(), "parameter", u,
            "the curve or its tangent jumps there, and no motion goes on: choose a parameter beside it");
}

RBDYN_INLINE Vector3 Curve::third(double u) const {
    return asked([&](const auto& form) { return form.third(u); });
}

RBDYN_INLINE double Curve::plain_length(double u0, double u1) const {
    return asked([&](const auto& form) { return form.length(u0, u1); });
}

RBDYN_INLINE std::optional<Vector3> Curve::straight_binormal(double u) const {
    return asked([&](const auto& form) { return form.straight_binormal(u); });
}

}  // namespace rbdyn::inline RBDYN_FORM
