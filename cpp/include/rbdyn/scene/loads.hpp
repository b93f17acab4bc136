// Loads on one body and couplings between two points.
#pragma once

#include <cmath>
#include <limits>
#include <string>
#include <type_traits>
#include <utility>
#include <variant>

#include "rbdyn/expression/function.hpp"

namespace rbdyn {

/// A force [N] in world axes: constant, or any function (t, position, velocity) over the number type.
class Force {
public:
    Force(const Vector3& constant) : constant_(constant) {
        for (int i = 0; i < 3; ++i)
            require(std::isfinite(constant[i]), "Force", "component " + std::to_string(i), constant[i],
                    "a force is finite; give it in N");
    }
    /// From a recorded function of (t, x, y, z, vx, vy, vz) with three results.
    explicit Force(Function function) : function_(std::move(function)) {
        if (function_.inputs() != 7 || function_.outputs() != 3)
            throw InvalidInput("Force: the function has " + std::to_string(function_.outputs()) +
                               " results; a force has three components, in N");
    }
    /// [](const auto& t, const auto& position, const auto& velocity) { return Vector3Of<...>{...}; }
    template <class F>
    requires std::is_invocable_v < F, const Expression&, const Vector3Of<Expression>
    &, const Vector3Of<Expression>& > Force(F f)
        : Force(Function::record(7, [&](const std::vector<Expression>& x) {
              const Vector3Of<Expression> r =
                  f(x[0], Vector3Of<Expression>{x[1], x[2], x[3]}, Vector3Of<Expression>{x[4], x[5], x[6]});
              return std::vector<Expression>{r[0], r[1], r[2]};
          })) {}

    bool is_constant() const { return !function_; }
    const Vector3& constant() const { return constant_; }
    /// Depends on the body's velocity.
    bool depends_on_velocity() const {
        return function_ && (function_.depends_on(4) || function_.depends_on(5) || function_.depends_on(6));
    }

    template <class S>
    Vector3Of<S> operator()(const S& t, const Vector3Of<S>& r, const Vector3Of<S>& v) const {
        if (!function_) return constant_.template cast<S>();
        const S x[7] = {t, r[0], r[1], r[2], v[0], v[1], v[2]};
        const std::vector<S> f = function_(std::span<const S>(x, 7));
        return {f[0], f[1], f[2]};
    }

private:
    Vector3 constant_ = Vector3::Zero();
    Function function_;
};

/// Resistance of a medium at rest: -(linear + quadratic |v|) v. linear [kg/s], quadratic [kg/m].
struct Drag {
    double linear = 0.0;
    double quadratic = 0.0;

    bool present() const { return linear != 0.0 || quadratic != 0.0; }
    void validate() const {
        for (auto [name, value] : {std::pair{"linear", linear}, std::pair{"quadratic", quadratic}})
            require(std::isfinite(value) && value >= 0.0, "Drag", name, value,
                    "a resistance is zero or positive and finite; a driving force is a Force");
    }
};

using Load = std::variant<Force, Drag>;

/// A spring with a damper along it: -(stiffness (length - rest_length) + damping d(length)/dt) along the line of its
/// ends. stiffness [N/m], rest_length [m], damping [kg/s].
struct Spring {
    double stiffness = 0.0;
    double rest_length = 0.0;
    double damping = 0.0;

    void validate() const {
        for (auto [name, value] :
             {std::pair{"stiffness", stiffness}, std::pair{"rest_length", rest_length}, std::pair{"damping", damping}})
            require(std::isfinite(value) && value >= 0.0, "Spring", name, value, "it is zero or positive and finite");
    }

    /// Force on the first end; `d` and `v`: position and velocity of the first end relative to the second.
    /// Along a straight way through the second end the direction is a sign, locked between passages; elsewhere the two
    /// ends may not meet.
    Vector3Of<Expression> operator()(const Vector3Of<Expression>& d, const Vector3Of<Expression>& v) const {
        using S = Expression;
        const double tension = stiffness * rest_length;
        Vector3Of<S> force = d * S(-stiffness);
        if (tension == 0.0 && damping == 0.0) return force;
        if (const int only = only_component(d); only >= 0) {
            if (tension != 0.0) force[only] += S(tension) * locked_sign(d[only], "direction of a spring");
            force[only] -= S(damping) * v[only];
            return force;
        }
        const S l = length(d, "length of a spring");
        if (tension != 0.0) force += d * (S(tension) / l);
        if (damping != 0.0) force -= d * (S(damping) * dot<S>(d, v) / (l * l));
        return force;
    }
    /// In numbers: where the ends meet, |d| within rounding of numbers of the given size, the direction is that of what
    /// comes next.
    Vector3 operator()(const Vector3& d, const Vector3& v, double size = 0.0) const {
        const double l = d.norm(), speed = v.norm();
        const bool apart = l > 8.0 * std::numeric_limits<double>::epsilon() * size;
        const Vector3 along = apart ? Vector3(d / l) : speed > 0.0 ? Vector3(v / speed) : Vector3::Zero().eval();
        return -(stiffness * (l - rest_length) + damping * along.dot(v)) * along;
    }

private:
    /// The one component of a recorded vector that does not vanish identically, or -1.
    static int only_component(const Vector3Of<Expression>& d) {
        int only = -1;
        for (int i = 0; i < 3; ++i)
            if (!d[i].is_zero()) only = only < 0 ? i : 3;
        return only < 3 ? only : -1;
    }
};

using Coupling = std::variant<Spring>;

}  // namespace rbdyn
