// Scenes whose motion is known in closed form: every body by itself, under nothing but constant forces, and
//
//   free, or on a ball joint with no moment about it: the free rotation (closed_form/free_rotation.hpp);
//   on a ball joint, symmetric, heavy: Lagrange's top (closed_form/lagrange_top.hpp);
//   on a hinge: uniformly accelerated, a compound pendulum or a torsion pendulum (7.60);
//   on a slide, and the centre of mass of a free body: uniformly accelerated.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "rbdyn/closed_form/closed_form.hpp"
#include "rbdyn/closed_form/free_rotation.hpp"
#include "rbdyn/closed_form/lagrange_top.hpp"
#include "rbdyn/closed_form/linear_oscillator.hpp"
#include "rbdyn/closed_form/pendulum.hpp"
#include "rbdyn/model/points.hpp"

namespace rbdyn {

/// The coordinates of one body at a time since the start, in the order of its law.
class BodyForm {
public:
    virtual ~BodyForm() = default;
    virtual void state(Instant since, double* q, double* v) const = 0;
    virtual double error(double since) const = 0;
    /// How its attitude comes back.
    virtual std::optional<Recurrence> recurrence() const { return std::nullopt; }
    virtual std::string name() const = 0;
};

namespace closed_forms {

/// x0 + v0 t + a t^2 / 2, in numbers of 32 digits.
class Accelerated {
public:
    Accelerated(const Vector3Of<DoubleDouble>& x, const Vector3Of<DoubleDouble>& v, const Vector3Of<DoubleDouble>& a)
        : x_(x), v_(v), a_(a) {}
    void state(Instant since, double* x, double* v, int count = 3) const {
        const DoubleDouble t(since);
        for (int i = 0; i < count; ++i) {
            x[i] = double(x_[i] + t * (v_[i] + t * a_[i] * DoubleDouble(0.5)));
            v[i] = double(v_[i] + t * a_[i]);
        }
    }

private:
    Vector3Of<DoubleDouble> x_, v_, a_;
};

/// A body that turns freely about its centre of mass, or about the point a ball joint holds.
class FreeForm : public BodyForm {
public:
    [[gnu::cold]] FreeForm(const Scene::Body& b, const RigidLaw& law, const Vector3Of<DoubleDouble>& acceleration)
        : law_(law), rotation_(about(b, law), b.attitude.exact(), b.angular_velocity) {
        const PrincipalAxesOf<DoubleDouble> p = about(b, law);
        Vector3Of<DoubleDouble> k = product(p.axes.transpose(), b.angular_velocity);
        for (int i = 0; i < 3; ++i) k[i] = p.moments[i] * k[i];
        momentum_ = rounded(product(rotation_matrix(b.attitude.exact()), product(p.axes, k)));
        if (law.kind != RigidLaw::Kind::free) return;
        const Matrix3Of<DoubleDouble> r = rotation_matrix(b.attitude.exact());
        const Vector3Of<DoubleDouble>& com = b.rigid()->exact().com;
        center_.emplace(widened(b.position) + product(r, com),
                        widened(b.velocity) + product(r, b.angular_velocity.cross(com)), acceleration);
    }
    void state(Instant since, double* q, double* v) const override {
        if (center_) {
            center_->state(since, q, v);
            q += 3;
            v += 3;
        }
        const FreeRotation::State s = rotation_.at(since);
        law_.set_attitude(s.attitude, s.angular_velocity, since, q, v);
    }
    double error(double since) const override { return rotation_.error(since); }
    /// About the angular momentum, after a period of omega in the body.
    std::optional<Recurrence> recurrence() const override {
        if (rotation_.regime() == FreeRotation::Regime::permanent)
            return Recurrence{momentum_, 1.0 / rotation_.precession_rate()};
        // a body of revolution keeps its axis at one angle from K: any time is a period
        if (law_.follows_axis && std::abs(law_.frame(2, 2)) == 1.0)
            return Recurrence{momentum_, 1.0 / rotation_.at(0.0).angular_velocity.norm()};
        return Recurrence{momentum_, rotation_.period()};
    }
    std::string name() const override { return "free rotation"; }

private:
    static PrincipalAxesOf<DoubleDouble> about(const Scene::Body& b, const RigidLaw& law) {
        return law.kind == RigidLaw::Kind::free ? b.rigid()->principal_exact() : b.rigid()->principal_exact(law.origin);
    }
    const RigidLaw law_;
    std::optional<Accelerated> center_;
    FreeRotation rotation_;
    Vector3 momentum_;  // world axes
};

/// A heavy symmetric body on a ball joint on its axis.
class TopForm : public BodyForm {
public:
    [[gnu::cold]] TopForm(const Scene::Body& b, const RigidLaw& law, const Vector3Of<DoubleDouble>& acceleration)
        : law_(law), up_(-rounded(acceleration)), top_(made(b, law, acceleration)) {}
    void state(Instant since, double* q, double* v) const override {
        const LagrangeTop::State s = top_.at(since);
        // the top's axes are those of the law at the start, and turn with the body
        law_.set_attitude(s.attitude * conjugate(law_.frame_attitude), law_.frame * s.angular_velocity, since, q, v);
    }
    double error(double since) const override { return top_.error(since); }
    /// About the vertical, after a nutation; of axes in the body only if the third is the top's. One whose weight turns
    /// nothing precesses about its angular momentum, and any time is a period.
    std::optional<Recurrence> recurrence() const override {
        if (std::abs(law_.frame(2, 2)) != 1.0) return std::nullopt;
        if (top_.nutation_period() > 0.0) return Recurrence{up_, top_.nutation_period()};
        const LagrangeTop::State s = top_.at({});
        Vector3 momentum = s.angular_velocity;
        for (int i = 0; i < 3; ++i) momentum[i] *= law_.exact.moments[i].hi;
        return Recurrence{to_world<double>(s.attitude, momentum), 1.0 / s.angular_velocity.norm()};
    }
    std::string name() const override { return "Lagrange's top"; }

private:
    [[gnu::cold]] static LagrangeTop made(const Scene::Body& b, const RigidLaw& law, const Vector3Of<DoubleDouble>& a) {
        const RigidLaw::Exact& exact = law.exact;
        const DoubleDouble g = sqrt(dot<DoubleDouble>(a, a));
        const Vector3Of<DoubleDouble> omega = product(exact.frame.transpose(), b.angular_velocity);
        return {exact.moments[0],
                exact.moments[2],
                b.rigid()->exact().mass * g * exact.center[2],
                Vector3(-rounded(a)),
                b.attitude.exact() * exact.frame_attitude,
                {omega[0], omega[1], omega[2]}};
    }
    const RigidLaw law_;
    Vector3 up_;
    LagrangeTop top_;
};

/// A body on a hinge: a compound pendulum, or one with a torsion spring and no other moment.
class PendulumForm : public BodyForm {
public:
    PendulumForm(const DoubleDouble& square, const DoubleDouble& lowest, double angle, double rate)
        : lowest_(lowest), pendulum_(square, DoubleDouble(angle) - lowest, rate), start_{angle, rate} {}
    void state(Instant since, double* q, double* v) const override {
        if (since.hi == 0.0 && since.lo == 0.0) {
            *q = start_.angle;
            *v = start_.rate;
            return;
        }
        const Pendulum::State s = pendulum_.at(since);
        *q = double(DoubleDouble(s.angle) + lowest_);
        *v = s.rate;
    }
    double error(double since) const override {
        // an angle of many turns is rounded as a whole
        const double angle = pendulum_.at({since, 0.0}).angle;
        return pendulum_.error(since) + 0.5 * std::numeric_limits<double>::epsilon() * std::abs(angle);
    }
    std::string name() const override { return "compound pendulum"; }

private:
    DoubleDouble lowest_;
    Pendulum pendulum_;
    Pendulum::State start_;
};
class OscillatorForm : public BodyForm {
public:
    OscillatorForm(const LinearOscillator::Coefficients& c, double rest, double angle, double rate)
        : rest_(rest), oscillator_(c, DoubleDouble(angle) - rest, rate), start_{angle, rate} {}
    void state(Instant since, double* q, double* v) const override {
        const bool at_start = since.hi == 0.0 && since.lo == 0.0;
        const LinearOscillator::State s = at_start ? start_ : oscillator_.at(since);
        *q = at_start ? s.position : s.position + rest_;
        *v = s.velocity;
    }
    double error(double since) const override {
        const double angle = oscillator_.at({since, 0.0}).position + rest_;
        return oscillator_.error(since) + 0.5 * std::numeric_limits<double>::epsilon() * std::abs(angle);
    }
    std::string name() const override { return "torsion pendulum"; }

private:
    double rest_;
    LinearOscillator oscillator_;
    LinearOscillator::State start_;
};

/// A particle, or a body on a slide.
class SlidingForm : public BodyForm {
public:
    SlidingForm(Accelerated motion, int count) : motion_(std::move(motion)), count_(count) {}
    void state(Instant since, double* q, double* v) const override { motion_.state(since, q, v, count_); }
    double error(double) const override { return 2.0 * std::numeric_limits<double>::epsilon(); }
    std::string name() const override { return "uniform acceleration"; }

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

    void state(Instant since, std::span<double> x) const override {
        if (map_.has_all()) return whole(since, x);
        std::vector<double> all(static_cast<std::size_t>(map_.variables()));
        whole(since, all);
        map_.gather(all, x);
    }
    double error(double since, double /*wanted*/) const override {
        double worst = 0.0;
        for (const Part& p : parts_) worst = std::max(worst, p.form->error(since));
        return worst;
    }
    std::optional<Recurrence> recurrence(int body) const override {
        return parts_[static_cast<std::size_t>(body)].form->recurrence();
    }
    std::string name() const override {
        std::string names;
        for (const Part& p : parts_)
            if (names.find(p.form->name()) == std::string::npos) names += (names.empty() ? "" : ", ") + p.form->name();
        return names;
    }

private:
    /// All variables.
    void whole(Instant since, std::span<double> x) const {
        for (const Part& p : parts_) p.form->state(since, x.data() + p.first, x.data() + p.first_rate);
    }

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
inline std::optional<Vector3> only_constant_force(const Scene& scene, int index) {
    Vector3 sum = Vector3::Zero();
    for (const Scene::AppliedLoad& load : scene.loads()) {
        if (load.body != index || !is_present(load.load)) continue;
        if (std::holds_alternative<TorsionSpring>(load.load)) continue;
        const Force* force = std::get_if<Force>(&load.load);
        const Scene::Body& b = scene.bodies()[static_cast<std::size_t>(index)];
        const bool at_center = !load.at || b.rigid() == nullptr || *load.at == b.rigid()->com();
        if (force == nullptr || !force->is_constant() || force->frame() != Frame::world || !at_center)
            return std::nullopt;
        sum += force->constant();
    }
    return sum;
}

/// Of a body on a hinge, under constant acceleration `a` or torsion springs, not both. Angles are measured in the law's
/// frame: e1 towards the centre of mass, e3 the axis.
[[gnu::cold]] inline std::unique_ptr<const BodyForm> hinge_form(const Scene& scene, const Scene::Body& b,
                                                                const RigidLaw& law, int index,
                                                                const Vector3Of<DoubleDouble>& a) {
    LinearOscillator::Coefficients c;
    double rest = 0.0;
    int springs = 0;
    for (const Scene::AppliedLoad& load : scene.loads()) {
        const TorsionSpring* spring = std::get_if<TorsionSpring>(&load.load);
        if (load.body != index || spring == nullptr || !spring->present()) continue;
        // the rest of one with no stiffness is anywhere
        if (++springs > 1) return nullptr;
        rest = spring->stiffness.is_zero() ? 0.0 : spring->rest_angle.now();
        c.stiffness = spring->stiffness.now();
        c.damping = spring->damping.now();
    }
    const Revolute& hinge = std::get<Revolute>(b.joint);
    const Vector3Of<DoubleDouble> d = b.rigid()->exact().com - widened(hinge.point), e = widened(hinge.axis);
    const DoubleDouble ee = dot<DoubleDouble>(e, e);
    const Matrix3Of<DoubleDouble> about = b.rigid()->inertia_exact(hinge.point);
    const DoubleDouble moment = dot<DoubleDouble>(e, product(about, e)) / ee;
    c.stiffness /= moment;
    c.damping /= moment;
    // M3 = m e . (R d x a): with d and a taken across the axis, m |d| |a| sin(angle from d to a)
    const Vector3Of<DoubleDouble> turned = cross<DoubleDouble>(d, a), across = cross<DoubleDouble>(d, e),
                                  pull = cross<DoubleDouble>(a, e);
    const DoubleDouble arm = sqrt(dot<DoubleDouble>(across, across) / ee),
                       field = sqrt(dot<DoubleDouble>(pull, pull) / ee);
    const DoubleDouble weight = DoubleDouble(b.mass()) * arm * field;
    const bool is_heavy = std::abs(law.center[0]) > 0.0 && weight.hi > 0.0;
    if (!is_heavy) return made<closed_forms::OscillatorForm>(c, rest, b.parameter, b.speed);
    if (springs > 0) return nullptr;
    // lowest where R d lies along a
    const DoubleDouble sine = dot<DoubleDouble>(turned, e) / sqrt(ee), cosine = dot<DoubleDouble>(across, pull) / ee;
    DoubleDouble lowest = std::atan2(sine.hi, cosine.hi);
    // one step of Newton's: the angle to 32 digits
    const auto [s, co] = sine_cosine(lowest);
    lowest += (sine * co - cosine * s) / (cosine * co + sine * s);
    return made<closed_forms::PendulumForm>(weight / moment, lowest, b.parameter, b.speed);
}

/// The closed form of one body; none if it has none here.
[[gnu::cold]] inline std::unique_ptr<const BodyForm> closed_form_of(const Scene& scene, const PointLaws& laws,
                                                                    int index) {
    using closed_forms::Accelerated;
    const Scene::Body& b = scene.bodies()[static_cast<std::size_t>(index)];
    const std::optional<Vector3> force = only_constant_force(scene, index);
    if (b.rail() != nullptr || !force) return nullptr;
    Vector3Of<DoubleDouble> a;
    for (int i = 0; i < 3; ++i) a[i] = DoubleDouble(scene.gravity()[i]) + DoubleDouble((*force)[i]) / b.mass();
    if (b.rigid() == nullptr)
        return made<closed_forms::SlidingForm>(Accelerated(widened(b.position), widened(b.velocity), a), 3);
    const RigidLaw& law = *laws.body(index).rigid;
    const bool is_weightless = a[0].hi == 0.0 && a[1].hi == 0.0 && a[2].hi == 0.0;
    switch (law.kind) {
        case RigidLaw::Kind::free: return made<closed_forms::FreeForm>(b, law, a);
        case RigidLaw::Kind::spherical:
            if (is_weightless || law.center.isZero(0.0)) return made<closed_forms::FreeForm>(b, law, a);
            return law.follows_axis ? made<closed_forms::TopForm>(b, law, a) : nullptr;
        case RigidLaw::Kind::revolute: return hinge_form(scene, b, law, index, a);
        case RigidLaw::Kind::prismatic: {
            const Vector3Of<DoubleDouble> e = widened(std::get<Prismatic>(b.joint).axis);
            Vector3Of<DoubleDouble> x, v, along;
            x[0] = b.parameter;
            v[0] = b.speed;
            along[0] = dot<DoubleDouble>(e, a) / sqrt(dot<DoubleDouble>(e, e));
            return made<closed_forms::SlidingForm>(Accelerated(x, v, along), 1);
        }
    }
    return nullptr;
}

/// The closed form of a scene, and why there is none otherwise.
[[gnu::cold]] inline std::pair<std::shared_ptr<const ClosedMotion>, std::string> closed_motion(const Scene& scene,
                                                                                               const PointLaws& laws) {
    for (const Scene::Connection& c : scene.connections())
        if (is_present(c.coupling)) return {nullptr, "bodies joined by springs have none here"};
    for (const Scene::Watch& w : scene.watches())
        if (w.options.action.kind == WatchAction::Kind::change)
            return {nullptr, "\"" + w.name + "\" changes the state on the way"};
    std::vector<ClosedMotion::Part> parts;
    for (int i = 0; i < static_cast<int>(scene.bodies().size()); ++i) {
        const PointLaws::Body& b = laws.body(i);
        auto form = closed_form_of(scene, laws, i);
        if (!form) return {nullptr, "the motion of " + b.name + " has none here"};
        parts.push_back({b.first, b.first_rate, std::move(form)});
    }
    return {std::make_shared<const ClosedMotion>(laws.map(), std::move(parts)), ""};
}

}  // namespace planning

}  // namespace rbdyn
