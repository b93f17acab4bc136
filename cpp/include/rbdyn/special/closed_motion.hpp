// Scenes whose motion is known in closed form: every body by itself, under nothing but constant forces, and
//
//   free, or on a ball joint with no moment about it: the free rotation (closed_form/free_rotation.hpp);
//   on a ball joint, symmetric, heavy: Lagrange's top (closed_form/lagrange_top.hpp);
//   on a hinge: uniformly accelerated, a compound pendulum or a torsion pendulum (7.60);
//   on a slide, and the centre of mass of a free body: uniformly accelerated.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/instant.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/body/principal_axes.hpp"
#include "rbdyn/closed_form/closed_form.hpp"
#include "rbdyn/closed_form/free_rotation.hpp"
#include "rbdyn/closed_form/lagrange_top.hpp"
#include "rbdyn/closed_form/linear_oscillator.hpp"
#include "rbdyn/closed_form/pendulum.hpp"
#include "rbdyn/model/state_map.hpp"
#include "rbdyn/rotation/euler_turns.hpp"
#include "rbdyn/scene/scene.hpp"
#include "rbdyn/special/point_laws.hpp"
#include "rbdyn/special/rigid_law.hpp"

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

/// A body that turns freely about its centre of mass, or about the point a ball joint holds.
class FreeForm : public BodyForm {
public:
    [[gnu::cold]] FreeForm(const Scene::Body& b, const RigidLaw& law, const Vector3Of<DoubleDouble>& acceleration);
    void state(Instant since, double* q, double* v) const override;
    double error(double since) const override;
    /// About the angular momentum, after a period of omega in the body.
    std::optional<Recurrence> recurrence() const override;
    std::string name() const override;

private:
    static PrincipalAxesOf<DoubleDouble> about(const Scene::Body& b, const RigidLaw& law);
    const RigidLaw law_;
    std::optional<Accelerated> center_;
    FreeRotation rotation_;
    Vector3 momentum_;  // world axes
};

/// A heavy symmetric body on a ball joint on its axis.
class TopForm : public BodyForm {
public:
    [[gnu::cold]] TopForm(const Scene::Body& b, const RigidLaw& law, const Vector3Of<DoubleDouble>& acceleration);
    void state(Instant since, double* q, double* v) const override;
    double error(double since) const override;
    /// About the vertical, after a nutation; of axes in the body only if the third is the top's. One whose weight turns
    /// nothing precesses about its angular momentum, and any time is a period.
    std::optional<Recurrence> recurrence() const override;
    std::string name() const override;

private:
    [[gnu::cold]] static LagrangeTop made(const Scene::Body& b, const RigidLaw& law, const Vector3Of<DoubleDouble>& a);
    const RigidLaw law_;
    Vector3 up_;
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

}  // namespace closed_forms

/// All bodies of a scene.
class ClosedMotion : public ClosedForm {
public:
    struct Part {
        int first, first_rate;
        std::unique_ptr<const BodyForm> form;
    };
    ClosedMotion(StateMap map, std::vector<Part> parts) : map_(std::move(map)), parts_(std::move(parts)) {}

    void state(Instant since, std::span<double> x) const override;
    double error(double since, double /*wanted*/) const override;
    std::optional<Recurrence> recurrence(int body) const override;
    std::string name() const override;

private:
    /// All variables.
    void whole(Instant since, std::span<double> x) const;

    StateMap map_;
    std::vector<Part> parts_;
};

namespace planning {

/// Held as what all forms are from the start: a pointer for each would be much to compile.
template <class Form, class... Given>
std::unique_ptr<const BodyForm> made(Given&&... given) {
    return std::unique_ptr<const BodyForm>(new Form(std::forward<Given>(given)...));
}

/// The constant force on a body beside gravity, if nothing else acts on it but torsion springs and it acts at the
/// centre of mass.
std::optional<Vector3> only_constant_force(const Scene& scene, int index);

/// Of a body on a hinge, under constant acceleration `a` or torsion springs, not both. Angles are measured in the law's
/// frame: e1 towards the centre of mass, e3 the axis.
[[gnu::cold]] std::unique_ptr<const BodyForm> hinge_form(const Scene& scene, const Scene::Body& b, const RigidLaw& law,
                                                         int index, const Vector3Of<DoubleDouble>& a);

/// The closed form of one body; none if it has none here.
[[gnu::cold]] std::unique_ptr<const BodyForm> closed_form_of(const Scene& scene, const PointLaws& laws, int index);

/// The closed form of a scene, and why there is none otherwise.
[[gnu::cold]] std::pair<std::shared_ptr<const ClosedMotion>, std::string> closed_motion(const Scene& scene,
                                                                                        const PointLaws& laws);

}  // namespace planning

}  // namespace rbdyn::inline RBDYN_FORM
