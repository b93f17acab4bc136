// A prescribed rigid motion: r(t) = R(t) r0 + d(t), with its first two derivatives.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/error.hpp"
#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/curve/axes.hpp"
#include "rbdyn/expression/elementary.hpp"
#include "rbdyn/expression/expression.hpp"
#include "rbdyn/expression/function.hpp"
#include "rbdyn/expression/functor.hpp"
#include "rbdyn/expression/node.hpp"

namespace rbdyn::inline RBDYN_FORM {

/// A rotation and a displacement, or one of their derivatives, in numbers of type S: rows of the matrix, and d.
template <class S>
struct RigidPlacement {
    Vector3Of<S> row[3];
    Vector3Of<S> displacement;

    Vector3Of<S> turned(const Vector3Of<S>& v) const {
        return {dot<S>(row[0], v), dot<S>(row[1], v), dot<S>(row[2], v)};
    }
    Vector3Of<S> turned_back(const Vector3Of<S>& v) const {
        Vector3Of<S> out{S(0.0), S(0.0), S(0.0)};
        for (int i = 0; i < 3; ++i) out += row[i] * v[i];
        return out;
    }
    Vector3Of<S> moved(const Vector3Of<S>& v) const { return turned(v) + displacement; }
};

/// A motion of space as a rigid body, a function of time; none by default.
class RigidMotion {
public:
    RigidMotion() = default;
    /// From a recorded function of t with twelve results: the rotation matrix row by row, then the displacement [m].
    /// Throws InvalidInput unless the matrix is a rotation at a number of times.
    explicit RigidMotion(Function function);
    /// A displacement d(t) alone, from any callable over the number type: [](const auto& t) { return Vector3Of<...>; }
    template <class F>
    requires Takes<F, Expression>
    static RigidMotion translation(F f) {
        return RigidMotion(Function::record(1, [&](const std::vector<Expression>& t) {
            const Vector3Of<Expression> d = recording::vector(f, t[0]);
            return std::vector<Expression>{1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, d[0], d[1], d[2]};
        }));
    }
    template <class F>
    requires(!Takes<F, Expression>) static RigidMotion translation(F) {
        static_assert(recording::fits<F>,
                      "the function of a translation is called as f(t), with a number: take it as const auto&");
        return {};
    }
    /// A turn by angle(t) [rad] about an axis through a point, by Rodrigues' formula.
    template <class F>
    requires Takes<F, Expression>
    static RigidMotion rotation(F angle, const Vector3& axis, const Vector3& point = Vector3::Zero()) {
        require(axis.norm() > 0.0, "motion", "length of the axis", axis.norm(), "an axis has a direction");
        const curves::WideVector e = curves::wide_unit(axis);
        return RigidMotion(Function::record(1, [&](const std::vector<Expression>& t) {
            const Expression phi = recording::number(angle, t[0]), s = sin(phi), c = cos(phi), rest = 1.0 - c;
            const DoubleDouble cross_matrix[3][3] = {{0.0, -e[2], e[1]}, {e[2], 0.0, -e[0]}, {-e[1], e[0], 0.0}};
            const auto constant = [](const DoubleDouble& x) { return x.lo == 0.0 ? Expression(x.hi) : Expression(x); };
            std::vector<Expression> out;
            for (int i = 0; i < 3; ++i)
                for (int j = 0; j < 3; ++j)
                    out.push_back((i == j ? c : Expression(0.0)) + rest * (constant(e[i]) * constant(e[j])) +
                                  s * constant(cross_matrix[i][j]));
            for (std::size_t i = 0; i < 3; ++i) {
                Expression d = point[static_cast<Eigen::Index>(i)];
                for (std::size_t j = 0; j < 3; ++j) d -= out[3 * i + j] * point[static_cast<Eigen::Index>(j)];
                out.push_back(d);
            }
            return out;
        }));
    }
    template <class F>
    requires(!Takes<F, Expression>) static RigidMotion rotation(F, const Vector3&, const Vector3& = Vector3::Zero()) {
        static_assert(recording::fits<F>,
                      "the function of a rotation is called as angle(t), with a number: take it as const auto&");
        return {};
    }

    bool present() const { return static_cast<bool>(function_); }
    const Function& function() const { return function_; }
    /// With the numbers of the user's as they are now; none if it moves nothing.
    RigidMotion frozen() const;

    template <class S>
    RigidPlacement<S> at(const S& t) const {
        return value<S>(function_, t);
    }
    template <class S>
    RigidPlacement<S> rate(const S& t) const {
        return value<S>(rate_, t);
    }
    template <class S>
    RigidPlacement<S> second(const S& t) const {
        return value<S>(second_, t);
    }

    bool operator==(const RigidMotion& other) const { return function_ == other.function_; }

private:
    template <class S>
    static RigidPlacement<S> value(const Function& f, const S& t) {
        const std::vector<S> y = f(std::span<const S>(&t, 1));
        return {{{y[0], y[1], y[2]}, {y[3], y[4], y[5]}, {y[6], y[7], y[8]}}, {y[9], y[10], y[11]}};
    }

    Function function_, rate_, second_;
};

}  // namespace rbdyn::inline RBDYN_FORM
