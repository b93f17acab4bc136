// The motion of one body in closed form, under nothing but constant forces:
//
//   free, or on a ball joint with no moment about it: the free rotation (closed_form/free_rotation.hpp);
//   on a ball joint, symmetric, heavy: Lagrange's top (closed_form/lagrange_top.hpp);
//   on a hinge: uniformly accelerated, a compound pendulum or a torsion pendulum (7.60);
//   on a slide, a particle, and the centre of mass of a free body: uniformly accelerated.
#pragma once

#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/instant.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/body/principal_axes.hpp"
#include "rbdyn/closed_form/free_rotation.hpp"
#include "rbdyn/closed_form/lagrange_top.hpp"
#include "rbdyn/closed_form/linear_oscillator.hpp"
#include "rbdyn/closed_form/pendulum.hpp"
#include "rbdyn/rotation/euler_turns.hpp"
#include "rbdyn/rotation/quaternion.hpp"
#include "rbdyn/scene/scene.hpp"

namespace rbdyn::inline RBDYN_FORM {

/// The coordinates of one body at a time since the start, in the order of its law.
class BodyForm {
public:
    virtual ~BodyForm() = default;
    virtual void state(Instant since, double* q, double* v) const = 0;
    virtual double error(double since) const = 0;
    /// How its attitude comes back.
    virtual std::optional<Recurrence> recurrence() const;
    virtual std::string name() const = 0;
};

namespace closed_forms {

/// x0 + v0 t + a t^2 / 2, in numbers of 32 digits.
class Accelerated {
public:
    Accelerated(const Vector3Of<DoubleDouble>& x, const Vector3Of<DoubleDouble>& v, const Vector3Of<DoubleDouble>& a);
    void state(Instant since, double* x, double* v, int count = 3) const;

private:
    Vector3Of<DoubleDouble> x_, v_, a_;
};

/// The frame that a body's attitude is written in, and its coordinates of an attitude.
struct TurningFrame {
    Matrix3 axes;         // columns, in body axes (spin zero)
    Quaternion attitude;  // in the body
    bool follows_axis;    // it does not turn about e3

    /// The coordinates of an attitude and an angular velocity, both of the body's axes, a time after the start.
    void set(const Quaternion& of_body, const Vector3& omega, Instant since, double* q, double* v) const;
    /// Whether its axis is one of the body's axes too, e3.
    bool is_on_axis() const { return std::abs(axes(2, 2)) == 1.0; }
};

/// A body that turns freely about its centre of mass, or about the point a ball joint holds.
class FreeForm : public BodyForm {
public:
    /// `center`: how its centre of mass moves, of one that is free.
    [[gnu::cold]] FreeForm(const Scene::Body& b, const TurningFrame& frame,
                           const PrincipalAxesOf<DoubleDouble>& principal, const std::optional<Accelerated>& center);
    void state(Instant since, double* q, double* v) const override;
    double error(double since) const override;
    /// About the angular momentum, after a period of omega in the body.
    std::optional<Recurrence> recurrence() const override;
    std::string name() const override;

private:
    TurningFrame frame_;
    std::optional<Accelerated> center_;
    FreeRotation rotation_;
    Vector3 momentum_;  // world axes
};

/// A heavy symmetric body on a ball joint on its axis.
class TopForm : public BodyForm {
public:
    TopForm(const TurningFrame& frame, const Vector3& moments, const Vector3& up, LagrangeTop top)
        : frame_(frame), moments_(moments), up_(up), top_(std::move(top)) {}
    void state(Instant since, double* q, double* v) const override;
    double error(double since) const override;
    /// About the vertical, after a nutation; of axes in the body only if the third is the top's. One whose weight turns
    /// nothing precesses about its angular momentum, and any time is a period.
    std::optional<Recurrence> recurrence() const override;
    std::string name() const override;

private:
    TurningFrame frame_;
    Vector3 moments_, up_;
    LagrangeTop top_;
};

/// A body on a hinge: a compound pendulum, or one with a torsion spring and no other moment.
class PendulumForm : public BodyForm {
public:
    PendulumForm(const DoubleDouble& square, const DoubleDouble& lowest, double angle, double rate);
    void state(Instant since, double* q, double* v) const override;
    double error(double since) const override;
    std::string name() const override;

private:
    DoubleDouble lowest_;
    Pendulum pendulum_;
    Pendulum::State start_;
};
class OscillatorForm : public BodyForm {
public:
    OscillatorForm(const LinearOscillator::Coefficients& c, double rest, double angle, double rate);
    void state(Instant since, double* q, double* v) const override;
    double error(double since) const override;
    std::string name() const override;

private:
    double rest_;
    LinearOscillator oscillator_;
    LinearOscillator::State start_;
};

/// A particle, or a body on a slide.
class SlidingForm : public BodyForm {
public:
    SlidingForm(Accelerated motion, int count) : motion_(std::move(motion)), count_(count) {}
    void state(Instant since, double* q, double* v) const override;
    double error(double) const override;
    std::string name() const override;

private:
    Accelerated motion_;
    int count_;
};

/// Held as what all forms are from the start: a pointer for each would be much to compile.
template <class Form, class... Given>
std::unique_ptr<const BodyForm> made(Given&&... given) {
    return std::unique_ptr<const BodyForm>(new Form(std::forward<Given>(given)...));
}

}  // namespace closed_forms

}  // namespace rbdyn::inline RBDYN_FORM
