// Loads: forces and torques on one body.
#pragma once

#include <initializer_list>
#include <memory>
#include <span>
#include <string>
#include <type_traits>
#include <variant>
#include <vector>

#include "rbdyn/basics/error.hpp"
#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/expression/callback.hpp"
#include "rbdyn/expression/elementary.hpp"
#include "rbdyn/expression/function.hpp"
#include "rbdyn/expression/functor.hpp"
#include "rbdyn/expression/given.hpp"
#include "rbdyn/expression/node.hpp"
#include "rbdyn/expression/numbers.hpp"
#include "rbdyn/expression/recorder.hpp"
#include "rbdyn/scene/joint_loads.hpp"
#include "rbdyn/scene/torque.hpp"

namespace rbdyn::inline RBDYN_FORM {

/// A force [N], in world axes or in those of the body: constant, or a function (t, position, velocity) of the point it
/// acts at, world axes both, recorded or called back.
class Force {
public:
    Force(const Vector3& constant, Frame frame = Frame::world);
    /// Of three numbers.
    Force(std::initializer_list<double> constant, Frame frame = Frame::world);
    /// From a recorded function of (t, x, y, z, vx, vy, vz) with three results.
    explicit Force(Function function, std::string name = "function", Frame frame = Frame::world);
    /// From a function that is called back, of (t, x, y, z, vx, vy, vz) with three results.
    explicit Force(std::shared_ptr<const Callback> callback, Frame frame = Frame::world);
    /// [](const auto& t, const auto& position, const auto& velocity) { return Vector3Of<...>{...}; }
    template <class F>
    requires Takes<F, Expression, Vector3Of<Expression>, Vector3Of<Expression>> Force(F f, Frame frame = Frame::world)
        : Force(Function::record(7,
                                 [&](const std::vector<Expression>& x) {
                                     const Vector3Of<Expression> r =
                                         recording::vector(f, x[0], Vector3Of<Expression>{x[1], x[2], x[3]},
                                                           Vector3Of<Expression>{x[4], x[5], x[6]});
                                     return std::vector<Expression>{r[0], r[1], r[2]};
                                 }),
                "function", frame) {}
    template <class F>
    requires(!Takes<F, Expression, Vector3Of<Expression>, Vector3Of<Expression>> &&
             MeantAsFunctor<F, Force, Function, std::shared_ptr<const Callback>>) explicit Force(F,
                                                                                                 Frame = Frame::world) {
        static_assert(recording::fits<F>,
                      "the function of a Force is called as f(t, position, velocity), a number and two vectors: take "
                      "each as const auto&");
    }

    bool is_constant() const { return is_constant_; }
    /// Whether numbers of the user's are all that it depends on.
    bool is_of_numbers() const { return is_constant_ && function_; }
    Frame frame() const { return frame_; }
    const Vector3& constant() const { return constant_; }
    /// The same; what is made of it while equations are recorded holds for this value only.
    const Vector3& settled() const;
    const Function& function() const { return function_; }
    const std::shared_ptr<const Callback>& callback() const { return callback_; }
    const std::string& name() const { return name_; }
    bool depends_on_time() const { return callback_ || (function_ && function_.depends_on(0)); }
    /// Depends on the body's velocity.
    bool depends_on_velocity() const;
    /// Whether there is any.
    bool present() const { return !is_constant() || !constant_.isZero(0.0); }
    /// With the numbers of the user's as they are now; constant if nothing in it varies with them.
    Force frozen() const;

    template <class S>
    Vector3Of<S> operator()(const S& t, const Vector3Of<S>& r, const Vector3Of<S>& v) const {
        if (is_constant_ && !(function_ && std::is_same_v<S, Expression>)) return Vector3Of<S>(constant_);
        const S x[7] = {t, r[0], r[1], r[2], v[0], v[1], v[2]};
        if (function_) {
            const std::vector<S> f = function_(std::span<const S>(x, 7));
            return {f[0], f[1], f[2]};
        }
        if constexpr (std::is_same_v<S, Expression>) {
            for (const Expression& e : x)
                if (!e.is_constant()) {
                    const std::vector<Expression> f = e.recorder()->call(callback_, std::span<const Expression>(x, 7));
                    return {f[0], f[1], f[2]};
                }
            throw Error("a function is called back with numbers that vary");
        } else {
            double in[7], out[3];
            for (int i = 0; i < 7; ++i) in[i] = static_cast<double>(x[i]);
            (*callback_)(in, out);
            return {S(out[0]), S(out[1]), S(out[2])};
        }
    }

    bool operator==(const Force& other) const;

private:
    static void require_shape(int inputs, int outputs);

    bool is_constant_ = true;
    Vector3 constant_ = Vector3::Zero();
    Function function_;
    std::shared_ptr<const Callback> callback_;
    std::string name_;
    Frame frame_ = Frame::world;
};

/// A force by its potential U(position) [J], in world axes: F = +grad U (the chapter's sign, eq. 7.2).
class Potential {
public:
    /// From a recorded function of (x, y, z) with one result.
    explicit Potential(Function function, std::string name = "function");
    /// [](const auto& position) { return ...; }
    template <class F>
    requires Takes<F, Vector3Of<Expression>> Potential(F f)
        : Potential(Function::record(3, [&](const std::vector<Expression>& x) {
              return std::vector<Expression>{recording::number(f, Vector3Of<Expression>{x[0], x[1], x[2]})};
          })) {}
    template <class F>
    requires(!Takes<F, Vector3Of<Expression>> && MeantAsFunctor<F, Potential, Function>) explicit Potential(F) {
        static_assert(recording::fits<F>,
                      "the function of a Potential is called as f(position), with a vector: take it as const auto&");
    }

    const Function& function() const { return function_; }
    const std::string& name() const { return name_; }
    /// Whether it exerts any force; what depends on numbers of the user's does until they are frozen().
    bool present() const { return present_; }
    Potential frozen() const;

    /// U [J].
    template <class S>
    S value(const Vector3Of<S>& r) const {
        return function_(std::span<const S>(r.data(), 3))[0];
    }
    /// grad U [N].
    template <class S>
    Vector3Of<S> operator()(const S& /*t*/, const Vector3Of<S>& r, const Vector3Of<S>& /*v*/) const {
        const std::span<const S> x(r.data(), 3);
        return {slope_[0](x)[0], slope_[1](x)[0], slope_[2](x)[0]};
    }

    bool operator==(const Potential& other) const { return function_ == other.function_; }

private:
    Function function_, slope_[3];
    std::string name_;
    bool present_ = true;
};

/// A force across the velocity: strength v x field, that of a uniform field on a charge. It does no work.
struct Lorentz {
    Given strength = 0.0;
    Vector3 field = Vector3::Zero();  // world axes; strength times field is in kg/s

    void validate() const;
    bool present() const { return !strength.is_zero() && !field.isZero(0.0); }
    Lorentz frozen() const { return {strength.frozen(), field}; }
    template <class S>
    Vector3Of<S> operator()(const S& /*t*/, const Vector3Of<S>& /*r*/, const Vector3Of<S>& v) const {
        const S q = strength.in<S>();
        return cross<S>(v, Vector3Of<S>(q * S(field[0]), q * S(field[1]), q * S(field[2])));
    }
    bool operator==(const Lorentz&) const = default;
};

/// Resistance of a medium at rest: -(linear + quadratic |v|) v. linear [kg/s], quadratic [kg/m].
struct Drag {
    Given linear = 0.0;
    Given quadratic = 0.0;

    bool present() const { return !linear.is_zero() || !quadratic.is_zero(); }
    Drag frozen() const;
    void validate() const;
    bool operator==(const Drag&) const = default;
};

/// The factor of -v that several resist with; `times_speed(c)` is c |v|.
template <class S, class Times>
S resistance(std::span<const Drag> drags, const Times& times_speed) {
    S factor(0.0), quadratic(0.0);
    bool is_quadratic = false;
    for (const Drag& drag : drags) {
        factor += drag.linear.in<S>();
        quadratic += drag.quadratic.in<S>();
        is_quadratic = is_quadratic || !drag.quadratic.is_zero();
    }
    if (is_quadratic) factor += times_speed(quadratic);
    return factor;
}
/// The force of one on what moves with v; `name`: of its body.
template <class S>
Vector3Of<S> drag_force(const Drag& drag, const Vector3Of<S>& v, const std::string& name) {
    const auto times_speed = [&](const S& c) { return S(c * length(v, "speed of " + name)); };
    return -(v * resistance<S>({&drag, 1}, times_speed));
}

/// A spring about a hinge: its torque about the axis is -(stiffness (angle - rest_angle) + damping rate). stiffness
/// [N m/rad], rest_angle [rad], damping [N m s].
struct TorsionSpring {
    Given stiffness = 0.0;
    Given rest_angle = 0.0;
    Given damping = 0.0;

    bool present() const { return !stiffness.is_zero() || !damping.is_zero(); }
    /// The torque that it resists with.
    template <class S>
    S resistance(const S& angle, const S& rate) const {
        return stiffness.in<S>() * (angle - rest_angle.in<S>()) + damping.in<S>() * rate;
    }
    TorsionSpring frozen() const;
    void validate() const;
    bool operator==(const TorsionSpring&) const = default;
};

using Load = std::variant<Force, Potential, Lorentz, Drag, Torque, TorsionSpring, JointTorque, JointForce>;

/// Whether a load does anything.
bool is_present(const Load& load);

/// A load that a function gives, as a subject of a sentence.
std::string title_of(const Load& load);

/// A load with the numbers of the user's as they are now.
Load frozen(const Load& load);
/// The numbers of the user's that a load depends on.
void give(const Load& load, GivenNumbers& numbers);

/// The force of a load on a particle at r that moves with v; zero for a drag, whose law depends on how the particle
/// moves (drag_force).
template <class S>
Vector3Of<S> force_of(const Load& load, const S& t, const Vector3Of<S>& r, const Vector3Of<S>& v) {
    if (const Force* force = std::get_if<Force>(&load)) return (*force)(t, r, v);
    if (const Potential* potential = std::get_if<Potential>(&load)) return (*potential)(t, r, v);
    if (const Lorentz* lorentz = std::get_if<Lorentz>(&load)) return (*lorentz)(t, r, v);
    return {S(0.0), S(0.0), S(0.0)};
}

}  // namespace rbdyn::inline RBDYN_FORM
