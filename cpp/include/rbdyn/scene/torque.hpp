// A torque on a rigid body: constant, or a function of time, attitude and angular velocity.
#pragma once

#include <array>
#include <cstddef>
#include <initializer_list>
#include <memory>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

#include "rbdyn/basics/error.hpp"
#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/expression/callback.hpp"
#include "rbdyn/expression/function.hpp"
#include "rbdyn/expression/functor.hpp"
#include "rbdyn/expression/node.hpp"
#include "rbdyn/expression/recorder.hpp"

namespace rbdyn::inline RBDYN_FORM {

/// The axes a vector is given in: the world's, or those of the body it acts on.
enum class Frame { world, body };

/// A vector of three numbers. Throws InvalidInput for more or less. `object`: whose they are.
Vector3 components(std::initializer_list<double> numbers, const std::string& object);

/// A rotation matrix in numbers of any type: element of row i and column j is r[i][j].
template <class S>
using RotationOf = std::array<std::array<S, 3>, 3>;

/// A torque [N m] in body axes, or in those of the world: constant, or a function (t, rotation_matrix,
/// angular_velocity), recorded or called back. The matrix turns body axes into the world's; the angular velocity is in
/// the axes the torque is in.
class Torque {
public:
    Torque(const Vector3& constant, Frame frame = Frame::body);
    /// Of three numbers.
    Torque(std::initializer_list<double> constant, Frame frame = Frame::body);
    /// From a recorded function of t, the 9 elements of the matrix row by row, and the angular velocity, with three
    /// results.
    explicit Torque(Function function, std::string name = "function", Frame frame = Frame::body);
    /// From a function that is called back, of the same numbers.
    explicit Torque(std::shared_ptr<const Callback> callback, Frame frame = Frame::body);
    /// [](const auto& t, const auto& rotation_matrix, const auto& angular_velocity) { return Vector3Of<...>{...}; }
    template <class F>
    requires Takes<F, Expression, RotationOf<Expression>, Vector3Of<Expression>> Torque(F f, Frame frame = Frame::body)
        : Torque(Function::record(inputs,
                                  [&](const std::vector<Expression>& x) {
                                      RotationOf<Expression> r;
                                      for (std::size_t i = 0; i < 9; ++i) r[i / 3][i % 3] = x[1 + i];
                                      const Vector3Of<Expression> m =
                                          recording::vector(f, x[0], r, Vector3Of<Expression>{x[10], x[11], x[12]});
                                      return std::vector<Expression>{m[0], m[1], m[2]};
                                  }),
                 "function", frame) {}
    template <class F>
    requires(
        !Takes<F, Expression, RotationOf<Expression>, Vector3Of<Expression>> &&
        MeantAsFunctor<F, Torque, Function, std::shared_ptr<const Callback>>) explicit Torque(F, Frame = Frame::body) {
        static_assert(recording::fits<F>,
                      "the function of a Torque is called as f(t, rotation_matrix, angular_velocity), a number, three "
                      "rows and a vector: take each as const auto&");
    }

    bool is_constant() const { return is_constant_; }
    const Vector3& constant() const { return constant_; }
    const Function& function() const { return function_; }
    const std::shared_ptr<const Callback>& callback() const { return callback_; }
    const std::string& name() const { return name_; }
    Frame frame() const { return frame_; }
    /// Whether there is any.
    bool present() const { return !is_constant() || !constant_.isZero(0.0); }
    /// With the numbers of the user's as they are now; constant if nothing in it varies with them.
    Torque frozen() const;

    template <class S>
    Vector3Of<S> operator()(const S& t, const RotationOf<S>& r, const Vector3Of<S>& omega) const {
        if (is_constant_ && !(function_ && std::is_same_v<S, Expression>))
            return Vector3Of<S>(S(constant_[0]), S(constant_[1]), S(constant_[2]));
        const std::array<S, inputs> x{t,       r[0][0], r[0][1], r[0][2],  r[1][0],  r[1][1], r[1][2],
                                      r[2][0], r[2][1], r[2][2], omega[0], omega[1], omega[2]};
        if (function_) {
            const std::vector<S> m = function_(std::span<const S>(x));
            return {m[0], m[1], m[2]};
        }
        if constexpr (std::is_same_v<S, Expression>) {
            for (const Expression& e : x)
                if (!e.is_constant()) {
                    const std::vector<Expression> m = e.recorder()->call(callback_, std::span<const Expression>(x));
                    return {m[0], m[1], m[2]};
                }
            throw Error("a function is called back with numbers that vary");
        } else {
            double in[inputs], out[3];
            for (std::size_t i = 0; i < inputs; ++i) in[i] = static_cast<double>(x[i]);
            (*callback_)(in, out);
            return {S(out[0]), S(out[1]), S(out[2])};
        }
    }

    bool operator==(const Torque& other) const;

private:
    static constexpr std::size_t inputs = 13;

    static void require_shape(int given_inputs, int outputs);

    bool is_constant_ = true;
    Vector3 constant_ = Vector3::Zero();
    Function function_;
    std::shared_ptr<const Callback> callback_;
    std::string name_;
    Frame frame_ = Frame::body;
};

}  // namespace rbdyn::inline RBDYN_FORM
