// Forces between two bodies that follow from where both are: gravitation, central forces, and any of the user's own.
//
// Notation: d = r_a - r_b, r = |d|. All act on the first end, with the opposite on the second, so that momentum is kept
// (7.32); those along d keep angular momentum too (7.39).
#pragma once

#include <concepts>
#include <memory>
#include <span>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/expression/callback.hpp"
#include "rbdyn/expression/function.hpp"
#include "rbdyn/expression/functor.hpp"
#include "rbdyn/expression/given.hpp"
#include "rbdyn/expression/node.hpp"
#include "rbdyn/expression/numbers.hpp"
#include "rbdyn/expression/own_function.hpp"

namespace rbdyn::inline RBDYN_FORM {

/// Attraction of two bodies: constant m_a m_b / r^2 between their centres of mass. constant [m^3/(kg s^2)]. A point of
/// the world has no mass; it takes Central.
struct Gravitation {
    Given constant = 0.0;

    bool present() const { return !constant.is_zero(); }
    bool operator==(const Gravitation&) const = default;
    Gravitation frozen() const;
    void give(GivenNumbers& numbers) const { constant.give(numbers); }
    void validate() const;

    /// -constant m_a m_b d / r^3; `masses`: m_a m_b. Where the bodies meet it is not finite.
    template <class S>
    Vector3Of<S> operator()(const Vector3Of<S>& d, const S& masses) const {
        using std::pow;
        // in one operation: no square root whose zeros are looked for
        return d * -(constant.in<S>() * masses * pow(dot<S>(d, d), -1.5));
    }
    /// constant m_a m_b / r: U, with F = +grad U (the chapter's sign) [J].
    double potential(double length, double masses) const { return constant.now() * masses / length; }
};

/// A force along the line of the ends, f(distance) [N]; positive pushes apart.
class Central {
public:
    Central() = default;
    /// From a recorded function of the distance with one result.
    explicit Central(Function function, std::string name = "function");
    /// From a function that is called back.
    explicit Central(std::shared_ptr<const Callback> callback);
    /// [](const auto& distance) { return ...; }
    template <class F>
    requires(Takes<F, Expression> && !std::is_same_v<std::decay_t<F>, Function> &&
             !std::is_same_v<std::decay_t<F>, Central>) explicit Central(F f)
        : Central(Function::record(1, [&](const std::vector<Expression>& x) {
              return std::vector<Expression>{recording::number(f, x[0])};
          })) {}
    template <class F>
    requires(!Takes<F, Expression> &&
             MeantAsFunctor<F, Central, Function, std::shared_ptr<const Callback>>) explicit Central(F) {
        static_assert(recording::fits<F>,
                      "the function of a Central is called as f(distance), with a number: take it as const auto&");
    }

    const OwnFunction& law() const { return law_; }
    bool present() const { return present_; }
    bool operator==(const Central& other) const { return law_ == other.law_; }
    /// With the numbers of the user's as they are now.
    Central frozen() const;
    void give(GivenNumbers& numbers) const { law_.give(numbers); }
    void validate() const {}

    /// f(distance) [N].
    template <class S>
    S magnitude(const S& distance) const {
        return law_(std::span<const S>(&distance, 1))[0];
    }
    /// On the first end. Along a straight way through the second end the direction is a sign, as of a spring.
    Vector3Of<Expression> operator()(const Vector3Of<Expression>& d) const;
    Vector3 operator()(const Vector3& d, const Vector3& v, double size = 0.0) const;
    /// U(r) - U(from) = Int f dr [J], by quadrature.
    double gain(double from, double to) const;

private:
    OwnFunction law_;
    bool present_ = false;
};

/// Any force between two bodies: f(t, r_a, r_b, v_a, v_b) [N] on the first, its opposite on the second; world axes. It
/// need not be along their line, and then keeps momentum but not angular momentum.
class PairForce {
public:
    static constexpr int inputs = 13;

    PairForce() = default;
    /// From a recorded function of (t, r_a, r_b, v_a, v_b), 13 numbers, with three results.
    explicit PairForce(Function function, std::string name = "function");
    /// From a function that is called back with these numbers.
    explicit PairForce(std::shared_ptr<const Callback> callback);
    /// [](const auto& t, const auto& ra, const auto& rb, const auto& va, const auto& vb) { return vector; }
    template <class F>
    requires Takes<F, Expression, Vector3Of<Expression>, Vector3Of<Expression>, Vector3Of<Expression>,
                   Vector3Of<Expression>>
    explicit PairForce(F f)
        : PairForce(Function::record(inputs, [&](const std::vector<Expression>& x) {
              const auto vector = [&](std::size_t i) { return Vector3Of<Expression>{x[i], x[i + 1], x[i + 2]}; };
              const Vector3Of<Expression> r = recording::vector(f, x[0], vector(1), vector(4), vector(7), vector(10));
              return std::vector<Expression>{r[0], r[1], r[2]};
          })) {}
    template <class F>
    requires(!Takes<F, Expression, Vector3Of<Expression>, Vector3Of<Expression>, Vector3Of<Expression>,
                    Vector3Of<Expression>> &&
             MeantAsFunctor<F, PairForce, Function, std::shared_ptr<const Callback>>) explicit PairForce(F) {
        static_assert(recording::fits<F>,
                      "the function of a PairForce is called as f(t, r_a, r_b, v_a, v_b), a number and four vectors: "
                      "take each as const auto&");
    }

    const OwnFunction& law() const { return law_; }
    bool present() const { return present_; }
    bool depends_on_time() const { return law_.may_depend_on(0); }
    bool depends_on_velocity() const;
    bool operator==(const PairForce& other) const { return law_ == other.law_; }
    /// With the numbers of the user's as they are now.
    PairForce frozen() const;
    void give(GivenNumbers& numbers) const { law_.give(numbers); }
    void validate() const {}

    /// On the first end.
    template <class S>
    Vector3Of<S> operator()(const S& t, const Vector3Of<S>& ra, const Vector3Of<S>& rb, const Vector3Of<S>& va,
                            const Vector3Of<S>& vb) const {
        const S x[inputs] = {t, ra[0], ra[1], ra[2], rb[0], rb[1], rb[2], va[0], va[1], va[2], vb[0], vb[1], vb[2]};
        const std::vector<S> f = law_(std::span<const S>(x, inputs));
        return {f[0], f[1], f[2]};
    }

private:
    OwnFunction law_;
    bool present_ = false;
};

}  // namespace rbdyn::inline RBDYN_FORM
