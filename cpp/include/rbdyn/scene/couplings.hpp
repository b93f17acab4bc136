// Couplings: forces between two points.
#pragma once

#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <variant>

#include "rbdyn/expression/elementary.hpp"
#include "rbdyn/expression/given.hpp"

namespace rbdyn {

/// A spring with a damper along it: -(stiffness (length - rest_length) + damping d(length)/dt) along the line of its
/// ends. stiffness [N/m], rest_length [m], damping [kg/s].
struct Spring {
    Given stiffness = 0.0;
    Given rest_length = 0.0;
    Given damping = 0.0;

    bool present() const { return !stiffness.is_zero() || !damping.is_zero(); }
    bool operator==(const Spring&) const = default;
    /// With the numbers of the user's as they are now.
    Spring frozen() const {
        const Spring result{stiffness.frozen(), rest_length.frozen(), damping.frozen()};
        result.validate();
        return result;
    }
    void give(GivenNumbers& numbers) const {
        for (const Given* number : {&stiffness, &rest_length, &damping}) number->give(numbers);
    }
    void validate() const {
        for (auto [name, value] : {std::pair{"stiffness", stiffness.now()}, std::pair{"rest_length", rest_length.now()},
                                   std::pair{"damping", damping.now()}})
            require(std::isfinite(value) && value >= 0.0, "Spring", name, value, "it is zero or positive and finite");
    }

    /// Force on the first end; `d` and `v`: position and velocity of the first end relative to the second.
    /// Along a straight way through the second end the direction is a sign, locked between passages; elsewhere the two
    /// ends may not meet.
    Vector3Of<Expression> operator()(const Vector3Of<Expression>& d, const Vector3Of<Expression>& v) const {
        using S = Expression;
        const S k = stiffness.in<S>(), c = damping.in<S>(), tension = k * rest_length.in<S>();
        Vector3Of<S> force = d * -k;
        if (tension.is_zero() && c.is_zero()) return force;
        if (const int only = only_component(d); only >= 0) {
            if (!tension.is_zero()) force[only] += tension * locked_sign(d[only], "length of a spring");
            force[only] -= c * v[only];
            return force;
        }
        const S l = length(d, "length of a spring");
        if (!tension.is_zero()) force += d * (tension / l);
        if (!c.is_zero()) force -= d * (c * dot<S>(d, v) / (l * l));
        return force;
    }
    /// In numbers: where the ends meet, |d| within rounding of numbers of the given size, the direction is that of what
    /// comes next.
    Vector3 operator()(const Vector3& d, const Vector3& v, double size = 0.0) const {
        const double l = d.norm(), speed = v.norm();
        const bool apart = l > 8.0 * std::numeric_limits<double>::epsilon() * size;
        const Vector3 along = apart ? Vector3(d / l) : speed > 0.0 ? Vector3(v / speed) : Vector3(0, 0, 0);
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

/// Whether a coupling does anything.
inline bool is_present(const Coupling& coupling) {
    return std::visit([](const auto& c) { return c.present(); }, coupling);
}

}  // namespace rbdyn
