// Loads: forces and torques on one body.
#pragma once

#include <cmath>
#include <initializer_list>
#include <memory>
#include <string>
#include <type_traits>
#include <utility>
#include <variant>

#include "rbdyn/expression/given.hpp"
#include "rbdyn/scene/torque.hpp"

namespace rbdyn {

/// A force [N], in world axes or in those of the body: constant, or a function (t, position, velocity) of the point it
/// acts at, world axes both, recorded or called back.
class Force {
public:
    Force(const Vector3& constant, Frame frame = Frame::world) : constant_(constant), frame_(frame) {
        for (int i = 0; i < 3; ++i)
            require(std::isfinite(constant[i]), "Force", "component " + std::to_string(i), constant[i],
                    "a force is finite; give it in N");
    }
    /// From a recorded function of (t, x, y, z, vx, vy, vz) with three results.
    explicit Force(Function function, std::string name = "function", Frame frame = Frame::world)
        : is_constant_(false), function_(std::move(function)), name_(std::move(name)), frame_(frame) {
        require_shape(function_.inputs(), function_.outputs());
    }
    /// From a function that is called back, of (t, x, y, z, vx, vy, vz) with three results.
    explicit Force(std::shared_ptr<const Callback> callback, Frame frame = Frame::world)
        : is_constant_(false), callback_(std::move(callback)), name_(callback_->name), frame_(frame) {
        require_shape(callback_->inputs, callback_->outputs);
    }
    /// [](const auto& t, const auto& position, const auto& velocity) { return Vector3Of<...>{...}; }
    template <class F>
    requires std::is_invocable_v < F, const Expression&, const Vector3Of<Expression>
    &, const Vector3Of<Expression>& > Force(F f, Frame frame = Frame::world)
        : Force(Function::record(7,
                                 [&](const std::vector<Expression>& x) {
                                     const Vector3Of<Expression> r = f(x[0], Vector3Of<Expression>{x[1], x[2], x[3]},
                                                                       Vector3Of<Expression>{x[4], x[5], x[6]});
                                     return std::vector<Expression>{r[0], r[1], r[2]};
                                 }),
                "function", frame) {}

    bool is_constant() const { return is_constant_; }
    /// Whether numbers of the user's are all that it depends on.
    bool is_of_numbers() const { return is_constant_ && function_; }
    Frame frame() const { return frame_; }
    const Vector3& constant() const { return constant_; }
    /// The same; what is made of it while equations are recorded holds for this value only.
    const Vector3& settled() const {
        if (function_) function_.settle();
        return constant_;
    }
    const Function& function() const { return function_; }
    const std::shared_ptr<const Callback>& callback() const { return callback_; }
    const std::string& name() const { return name_; }
    bool depends_on_time() const { return callback_ || (function_ && function_.depends_on(0)); }
    /// Depends on the body's velocity.
    bool depends_on_velocity() const {
        return callback_ ||
               (function_ && (function_.depends_on(4) || function_.depends_on(5) || function_.depends_on(6)));
    }
    /// Whether there is any.
    bool present() const { return !is_constant() || !constant_.isZero(0.0); }
    /// With the numbers of the user's as they are now; constant if nothing in it varies with them.
    Force frozen() const {
        Force result = *this;
        if (!function_) return result;
        result.function_ = function_.frozen();
        if (const auto same = result.function_.constants()) {
            result.is_constant_ = true;
            result.constant_ = {(*same)[0], (*same)[1], (*same)[2]};
            // the formula remains: equations that are recorded hold for other numbers, too
            if (function_.parameters().empty() || !result.present()) result.function_ = {};
        }
        return result;
    }

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

    bool operator==(const Force& other) const {
        return constant_ == other.constant_ && function_ == other.function_ && callback_ == other.callback_ &&
               frame_ == other.frame_;
    }

private:
    static void require_shape(int inputs, int outputs) {
        if (inputs != 7 || outputs != 3)
            throw InvalidInput("Force: the function has " + std::to_string(outputs) +
                               " results; a force has three components, in N");
    }

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
    explicit Potential(Function function, std::string name = "function")
        : function_(std::move(function)), name_(std::move(name)) {
        if (function_.inputs() != 3 || function_.outputs() != 1)
            throw InvalidInput("Potential: the function has " + std::to_string(function_.outputs()) +
                               " results; a potential is one number, in J");
        for (int i = 0; i < 3; ++i) slope_[i] = function_.derivative(i);
    }
    /// [](const auto& position) { return ...; }
    template <class F>
    requires std::is_invocable_v < F, const Vector3Of<Expression>
    & > Potential(F f)
        : Potential(Function::record(3, [&](const std::vector<Expression>& x) {
              return std::vector<Expression>{f(Vector3Of<Expression>{x[0], x[1], x[2]})};
          })) {}

    const Function& function() const { return function_; }
    const std::string& name() const { return name_; }
    /// Whether it exerts any force; what depends on numbers of the user's does until they are frozen().
    bool present() const { return present_; }
    Potential frozen() const {
        Potential result = *this;
        result.function_ = function_.frozen();
        result.present_ = false;
        for (Function& f : result.slope_) {
            f = f.frozen();
            const auto same = f.constants();
            result.present_ = result.present_ || !same || same->front() != 0.0;
        }
        return result;
    }

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

    void validate() const {
        require(std::isfinite(strength.now()), "Lorentz", "strength", strength.now(), "it is finite");
        for (int i = 0; i < 3; ++i)
            require(std::isfinite(field[i]), "Lorentz", "component " + std::to_string(i) + " of field", field[i],
                    "it is finite");
    }
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
    Drag frozen() const {
        const Drag result{linear.frozen(), quadratic.frozen()};
        result.validate();
        return result;
    }
    void validate() const {
        for (auto [name, value] : {std::pair{"linear", linear.now()}, std::pair{"quadratic", quadratic.now()}})
            require(std::isfinite(value) && value >= 0.0, "Drag", name, value,
                    "a resistance is zero or positive and finite; a driving force is a Force");
    }
    bool operator==(const Drag&) const = default;
};

/// A spring about a hinge: its torque about the axis is -(stiffness (angle - rest_angle) + damping rate). stiffness
/// [N m/rad], rest_angle [rad], damping [N m s].
struct TorsionSpring {
    Given stiffness = 0.0;
    Given rest_angle = 0.0;
    Given damping = 0.0;

    bool present() const { return !stiffness.is_zero() || !damping.is_zero(); }
    TorsionSpring frozen() const {
        const TorsionSpring result{stiffness.frozen(), rest_angle.frozen(), damping.frozen()};
        result.validate();
        return result;
    }
    void validate() const {
        for (auto [name, value] : {std::pair{"stiffness", stiffness.now()}, std::pair{"damping", damping.now()}})
            require(std::isfinite(value) && value >= 0.0, "TorsionSpring", name, value,
                    "it is zero or positive and finite");
        require(std::isfinite(rest_angle.now()), "TorsionSpring", "rest_angle", rest_angle.now(),
                "an angle is finite, in rad");
    }
    bool operator==(const TorsionSpring&) const = default;
};

using Load = std::variant<Force, Potential, Lorentz, Drag, Torque, TorsionSpring>;

/// Whether a load does anything.
inline bool is_present(const Load& load) {
    return std::visit([](const auto& l) { return l.present(); }, load);
}

/// A load with the numbers of the user's as they are now.
inline Load frozen(const Load& load) {
    return std::visit([](const auto& l) -> Load { return l.frozen(); }, load);
}
/// The numbers of the user's that a load depends on.
inline void give(const Load& load, GivenNumbers& numbers) {
    const auto give_all = [&](std::initializer_list<const Given*> all) {
        for (const Given* number : all) number->give(numbers);
    };
    if (const auto* force = std::get_if<Force>(&load)) force->function().give(numbers);
    if (const auto* torque = std::get_if<Torque>(&load)) torque->function().give(numbers);
    if (const auto* potential = std::get_if<Potential>(&load)) potential->function().give(numbers);
    if (const auto* lorentz = std::get_if<Lorentz>(&load)) give_all({&lorentz->strength});
    if (const auto* drag = std::get_if<Drag>(&load)) give_all({&drag->linear, &drag->quadratic});
    if (const auto* spring = std::get_if<TorsionSpring>(&load))
        give_all({&spring->stiffness, &spring->rest_angle, &spring->damping});
}

/// The force of a load on a particle at r that moves with v; zero for a drag, whose law depends on how the particle
/// moves (model/point_laws.hpp).
template <class S>
Vector3Of<S> force_of(const Load& load, const S& t, const Vector3Of<S>& r, const Vector3Of<S>& v) {
    if (const Force* force = std::get_if<Force>(&load)) return (*force)(t, r, v);
    if (const Potential* potential = std::get_if<Potential>(&load)) return (*potential)(t, r, v);
    if (const Lorentz* lorentz = std::get_if<Lorentz>(&load)) return (*lorentz)(t, r, v);
    return {S(0.0), S(0.0), S(0.0)};
}

}  // namespace rbdyn
