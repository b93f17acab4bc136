// A curve r(u) of any kind, as a value: geometry in the world, and the curve in its own axes for recording models.
//
// Notation: t, n, b tangent, normal, binormal (chapter, eqs. 7.9, 7.10), kappa = 1/rho curvature, tau torsion.
//   t = r'/|r'|,  b = r' x r''/|r' x r''|,  n = b x t
//   kappa = |r' x r''|/|r'|^3,  tau = (r' x r'') . r'''/|r' x r''|^2      (db/ds = -tau n)
//
// Conventions: world axes unless the name says own; u outside the domain continues the same formula.
// Degenerate cases: a curve that is straight all along has kappa = tau = 0 and one frame throughout, that of least
// rotation from anywhere: normal nearest to world z, or to world x if vertical. Where kappa is zero at one u alone (an
// inflection) the frame is its limit from the side of smaller u, and kappa = tau = 0. On a straight stretch of a spline
// it is that of the last bend before, or that of a line if there is none. Where r' = 0 (a cusp) or r' jumps (a
// corner) there is no tangent, and asking for one is an error. Invariant: the frame is orthonormal and right-handed,
// never NaN.
//
// To add a kind of curve: a header beside this one, and its name in CurveKinds below.
#pragma once

#include <concepts>
#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <variant>

#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/curve/axes.hpp"
#include "rbdyn/curve/circle.hpp"
#include "rbdyn/curve/cycloid.hpp"
#include "rbdyn/curve/function_curve.hpp"
#include "rbdyn/curve/helix.hpp"
#include "rbdyn/curve/line.hpp"
#include "rbdyn/curve/parabola.hpp"
#include "rbdyn/curve/point.hpp"
#include "rbdyn/curve/polynomial.hpp"
#include "rbdyn/curve/spline.hpp"
#include "rbdyn/expression/function.hpp"
#include "rbdyn/expression/functor.hpp"

namespace rbdyn::inline RBDYN_FORM {

namespace curves {

/// A kind of curve, valid, in the form it is evaluated in: itself, unless it has something to prepare.
template <class Kind>
auto prepared(const Kind& kind) {
    kind.validate();
    if constexpr (requires { kind.form(); }) {
        return kind.form();
    } else {
        return kind;
    }
}

template <class... Kinds>
struct KindList {
    using Kind = std::variant<Kinds...>;
    using Form = std::variant<decltype(prepared(std::declval<Kinds>()))...>;
    template <class Kind>
    static constexpr bool has = (std::same_as<Kind, Kinds> || ...);
};

}  // namespace curves

/// All kinds of curve.
using CurveKinds = curves::KindList<Line, Circle, Parabola, Cycloid, Helix, Polynomial, Spline, FunctionCurve>;

/// A curve of any kind. Made from one of them: Curve rail = Circle{.radius = 1.0, .start = ..., .toward = ...};
class Curve {
    /// f(form) of the form there is: as std::visit, with a tenth of what that takes to compile.
    template <std::size_t i = 0, class F>
    auto asked(const F& f) const {
        if constexpr (i + 1 < std::variant_size_v<CurveKinds::Form>) {
            if (form_->index() != i) return asked<i + 1>(f);
        }
        return f(*std::get_if<i>(form_.get()));
    }

    /// What a search along the curve needs, whatever its kind.
    struct Way {
        const Curve& curve;
        Domain domain() const { return curve.domain(); }
        template <class S>
        CurvePoint<S> own(const S& u) const {
            return curve.own(u);
        }
        Vector3 third(double u) const { return curve.third(u); }
        double length(double u0, double u1) const { return curve.plain_length(u0, u1); }
    };

public:
    // a move copies: what was moved from stays what it was
    Curve(const Curve&) = default;
    Curve& operator=(const Curve&) = default;

    /// Throws InvalidInput if the numbers make no curve.
    template <class Kind>
    requires(CurveKinds::has<Kind>) Curve(const Kind& kind)
        : kind_(std::make_shared<const CurveKinds::Kind>(kind)),
          form_(std::make_shared<const CurveKinds::Form>(curves::prepared(kind))) {
        placement_ = asked([](const auto& form) { return form.placement(); });
    }

    /// From any function of the parameter, recorded: [](const auto& u) { return Vector3Of<...>{u, sin(u), 0.0}; }
    /// Throws InvalidInput if it makes no curve (function_curve.hpp).
    template <class F>
    requires Takes<F, Expression>
    explicit Curve(F&& function, Domain domain = {}, bool closed = false)
        : Curve(FunctionCurve{FunctionCurve::recorded(std::forward<F>(function)), domain, closed, {}}) {}
    template <class F>
    requires(!Takes<F, Expression> && !CurveKinds::has<F> && MeantAsFunctor<F, Curve>) explicit Curve(F, Domain = {},
                                                                                                      bool = false) {
        static_assert(recording::fits<F>,
                      "the function of a Curve is called as f(u), with a number: take it as const auto&");
    }

    /// What it was made from.
    const CurveKinds::Kind& kind() const { return *kind_; }

    Domain domain() const;
    /// Whether the curve comes back to where it started; its parameter counts on.
    bool closed() const;
    /// What the parameter grows by in a round of a closed curve; 0 for one that is not closed.
    double period() const;
    /// The form it is evaluated in, if it is that one.
    template <class Form>
    const Form* as() const {
        return std::get_if<Form>(form_.get());
    }
    /// Whether it is straight all along, and so exactly in its own axes.
    bool straight() const;
    /// Whether r' is finite and not zero everywhere, by its kind.
    bool always_regular() const;
    /// What it is, in words: "circle of radius 0.5".
    std::string name() const;
    /// Where the own axes lie in the world.
    const Placement& placement() const { return placement_; }

    /// The curve in its own axes, in numbers of any type.
    template <class S>
    CurvePoint<S> own(const S& u) const {
        return asked([&](const auto& form) { return form.template own<S>(u); });
    }

    /// The curve in the axes of `view`. Components that are zero there stay exact zeros.
    template <class S>
    CurvePoint<S> at(const S& u, const Placement& view) const {
        const auto seen = [&](const auto& from) {
            CurvePoint<S> p = own(u);
            p.position = curves::turned<S>(from.axes, p.position);
            for (int i = 0; i < 3; ++i) p.position[i] = p.position[i] + exactly<S>(from.origin[i]);
            p.first = curves::turned<S>(from.axes, p.first);
            p.second = curves::turned<S>(from.axes, p.second);
            p.first_cross_second = curves::turned<S>(from.axes, p.first_cross_second);
            return p;
        };
        if constexpr (std::is_same_v<S, double>)
            return seen(curves::seen_from(view, placement_));
        else
            return seen(curves::seen_exactly_from(view, placement_));
    }

    /// r(u), [m].
    Vector3 position(double u) const { return placement_.origin + in_world(own(u).position); }
    /// r'(u).
    Vector3 first(double u) const { return in_world(own(u).first); }
    /// r''(u).
    Vector3 second(double u) const { return in_world(own(u).second); }

    /// Arc length from u0 to u1, negative if u1 < u0, [m]. Relative error about 1e-15; throws InvalidInput for a
    /// parameter that is not finite, Error if 1e-12 is out of reach.
    double length(double u0, double u1) const;

    /// The parameter at a signed arc length [m] from u0, to rounding error: the inverse of length. Throws InvalidInput
    /// if the curve ends before.
    double parameter_at(double u0, double arc_length) const;

    /// The same to long double's digits, some 1e-19 of the length.
    DoubleDouble exact_parameter_at(double u0, double arc_length) const;

    /// Tangent, normal, binormal in the world. Throws InvalidInput at a cusp.
    Frenet frenet(double u) const;

    /// 1/rho, [1/m]; 0 where straight within rounding. Throws InvalidInput at a cusp.
    double curvature(double u) const;

    /// Torsion, [1/m], positive for a right-handed helix; 0 where straight within rounding. Throws InvalidInput at a
    /// cusp.
    double torsion(double u) const;

    /// Whether r or r' jumps at u, within rounding: no motion along the curve goes on there.
    bool jumps_at(double u) const;

    /// Throws InvalidInput unless the curve has a tangent at u.
    void require_regular(double u) const;

    bool operator==(const Curve& other) const { return *form_ == *other.form_ && placement_ == other.placement_; }

private:
    Vector3 third(double u) const;
    double plain_length(double u0, double u1) const;
    std::optional<Vector3> straight_binormal(double u) const;
    Vector3 in_world(const Vector3& own_vector) const { return curves::turned<double>(placement_.axes, own_vector); }

    std::shared_ptr<const CurveKinds::Kind> kind_;
    std::shared_ptr<const CurveKinds::Form> form_;
    Placement placement_;
};

}  // namespace rbdyn::inline RBDYN_FORM
