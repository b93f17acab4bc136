// Definitions of rbdyn/special/closed_motion.hpp.
#pragma once

#include "rbdyn/special/closed_motion.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/double_double_functions.hpp"
#include "rbdyn/basics/double_double_vector.hpp"
#include "rbdyn/basics/instant.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/body/mass_properties.hpp"
#include "rbdyn/body/principal_axes.hpp"
#include "rbdyn/body/rigid_body.hpp"
#include "rbdyn/closed_form/free_rotation.hpp"
#include "rbdyn/closed_form/lagrange_top.hpp"
#include "rbdyn/closed_form/linear_oscillator.hpp"
#include "rbdyn/closed_form/pendulum.hpp"
#include "rbdyn/expression/given.hpp"
#include "rbdyn/model/state_map.hpp"
#include "rbdyn/rotation/attitude.hpp"
#include "rbdyn/rotation/euler_turns.hpp"
#include "rbdyn/rotation/quaternion.hpp"
#include "rbdyn/scene/couplings.hpp"
#include "rbdyn/scene/joints.hpp"
#include "rbdyn/scene/loads.hpp"
#include "rbdyn/scene/scene.hpp"
#include "rbdyn/scene/torque.hpp"
#include "rbdyn/scene/watch.hpp"
#include "rbdyn/special/point_laws.hpp"
#include "rbdyn/special/rigid_law.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE std::optional<Recurrence> BodyForm::recurrence() const { return std::nullopt; }

}  // namespace rbdyn::inline RBDYN_FORM

namespace rbdyn::inline RBDYN_FORM::closed_forms {

RBDYN_INLINE Accelerated::Accelerated(const Vector3Of<DoubleDouble>& x, const Vector3Of<DoubleDouble>& v,
                                      const Vector3Of<DoubleDouble>& a)
    : x_(x), v_(v), a_(a) {}

RBDYN_INLINE void Accelerated::state(Instant since, double* x, double* v, int count) const {
    const DoubleDouble t(since);
    for (int i = 0; i < count; ++i) {
        x[i] = double(x_[i] + t * (v_[i] + t * a_[i] * DoubleDouble(0.5)));
        v[i] = double(v_[i] + t * a_[i]);
    }
}

RBDYN_INLINE FreeForm::FreeForm(const Scene::Body& b, const RigidLaw& law, const Vector3Of<DoubleDouble>& acceleration)
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

RBDYN_INLINE void FreeForm::state(Instant since, double* q, double* v) const {
    if (center_) {
        center_->state(since, q, v);
        q += 3;
        v += 3;
    }
    const FreeRotation::State s = rotation_.at(since);
    law_.set_attitude(s.attitude, s.angular_velocity, since, q, v);
}

RBDYN_INLINE double FreeForm::error(double since) const { return rotation_.error(since); }

RBDYN_INLINE std::optional<Recurrence> FreeForm::recurrence() const {
    if (rotation_.regime() == FreeRotation::Regime::permanent)
        return Recurrence{momentum_, 1.0 / rotation_.precession_rate()};
    // a body of revolution keeps its axis at one angle from K: any time is a period
    if (law_.follows_axis && std::abs(law_.frame(2, 2)) == 1.0)
        return Recurrence{momentum_, 1.0 / rotation_.at(0.0).angular_velocity.norm()};
    return Recurrence{momentum_, rotation_.period()};
}

RBDYN_INLINE std::string FreeForm::name() const { return "free rotation"; }

RBDYN_INLINE PrincipalAxesOf<DoubleDouble> FreeForm::about(const Scene::Body& b, const RigidLaw& law) {
    return law.kind == RigidLaw::Kind::free ? b.rigid()->principal_exact() : b.rigid()->principal_exact(law.origin);
}

RBDYN_INLINE TopForm::TopForm(const Scene::Body& b, const RigidLaw& law, const Vector3Of<DoubleDouble>& acceleration)
    : law_(law), up_(-rounded(acceleration)), top_(made(b, law, acceleration)) {}

RBDYN_INLINE void TopForm::state(Instant since, double* q, double* v) const {
    const LagrangeTop::State s = top_.at(since);
    // the top's axes are those of the law at the start, and turn with the body
    law_.set_attitude(s.attitude * conjugate(law_.frame_attitude), law_.frame * s.angular_velocity, since, q, v);
}

RBDYN_INLINE double TopForm::error(double since) const { return top_.error(since); }

RBDYN_INLINE std::optional<Recurrence> TopForm::recurrence() const {
    if (std::abs(law_.frame(2, 2)) != 1.0) return std::nullopt;
    if (top_.nutation_period() > 0.0) return Recurrence{up_, top_.nutation_period()};
    const LagrangeTop::State s = top_.at({});
    Vector3 momentum = s.angular_velocity;
    for (int i = 0; i < 3; ++i) momentum[i] *= law_.exact.moments[i].hi;
    return Recurrence{to_world<double>(s.attitude, momentum), 1.0 / s.angular_velocity.norm()};
}

RBDYN_INLINE std::string TopForm::name() const { return "Lagrange's top"; }

RBDYN_INLINE LagrangeTop TopForm::made(const Scene::Body& b, const RigidLaw& law, const Vector3Of<DoubleDouble>& a) {
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

RBDYN_INLINE PendulumForm::PendulumForm(const DoubleDouble& square, const DoubleDouble& lowest, double angle,
                                        double rate)
    : lowest_(lowest), pendulum_(square, DoubleDouble(angle) - lowest, rate), start_{angle, rate} {}

RBDYN_INLINE void PendulumForm::state(Instant since, double* q, double* v) const {
    if (since.hi == 0.0 && since.lo == 0.0) {
        *q = start_.angle;
        *v = start_.rate;
        return;
    }
    const Pendulum::State s = pendulum_.at(since);
    *q = double(DoubleDouble(s.angle) + lowest_);
    *v = s.rate;
}

RBDYN_INLINE double PendulumForm::error(double since) const {
    // an angle of many turns is rounded as a whole
    const double angle = pendulum_.at({since, 0.0}).angle;
    return pendulum_.error(since) + 0.5 * std::numeric_limits<double>::epsilon() * std::abs(angle);
}

RBDYN_INLINE std::string PendulumForm::name() const { return "compound pendulum"; }

RBDYN_INLINE OscillatorForm::OscillatorForm(const LinearOscillator::Coefficients& c, double rest, double angle,
                                            double rate)
    : rest_(rest), oscillator_(c, DoubleDouble(angle) - rest, rate), start_{angle, rate} {}

RBDYN_INLINE void OscillatorForm::state(Instant since, double* q, double* v) const {
    const bool at_start = since.hi == 0.0 && since.lo == 0.0;
    const LinearOscillator::State s = at_start ? start_ : oscillator_.at(since);
    *q = at_start ? s.position : s.position + rest_;
    *v = s.velocity;
}

RBDYN_INLINE double OscillatorForm::error(double since) const {
    const double angle = oscillator_.at({since, 0.0}).position + rest_;
    return oscillator_.error(since) + 0.5 * std::numeric_limits<double>::epsilon() * std::abs(angle);
}

RBDYN_INLINE std::string OscillatorForm::name() const { return "torsion pendulum"; }

RBDYN_INLINE void SlidingForm::state(Instant since, double* q, double* v) const { motion_.state(since, q, v, count_); }

RBDYN_INLINE double SlidingForm::error(double) const { return 2.0 * std::numeric_limits<double>::epsilon(); }

RBDYN_INLINE std::string SlidingForm::name() const { return "uniform acceleration"; }

}  // namespace rbdyn::inline RBDYN_FORM::closed_forms

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE void ClosedMotion::state(Instant since, std::span<double> x) const {
    if (map_.has_all()) return whole(since, x);
    std::vector<double> all(static_cast<std::size_t>(map_.variables()));
    whole(since, all);
    map_.gather(all, x);
}

RBDYN_INLINE double ClosedMotion::error(double since, double /*wanted*/) const {
    double worst = 0.0;
    for (const Part& p : parts_) worst = std::max(worst, p.form->error(since));
    return worst;
}

RBDYN_INLINE std::optional<Recurrence> ClosedMotion::recurrence(int body) const {
    return parts_[static_cast<std::size_t>(body)].form->recurrence();
}

RBDYN_INLINE std::string ClosedMotion::name() const {
    std::string names;
    for (const Part& p : parts_)
        if (names.find(p.form->name()) == std::string::npos) names += (names.empty() ? "" : ", ") + p.form->name();
    return names;
}

RBDYN_INLINE void ClosedMotion::whole(Instant since, std::span<double> x) const {
    for (const Part& p : parts_) p.form->state(since, x.data() + p.first, x.data() + p.first_rate);
}

}  // namespace rbdyn::inline RBDYN_FORM

namespace rbdyn::inline RBDYN_FORM::planning {

RBDYN_INLINE std::optional<Vector3> only_constant_force(const Scene& scene, int index) {
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

RBDYN_INLINE std::unique_ptr<const BodyForm> hinge_form(const Scene& scene, const Scene::Body& b, const RigidLaw& law,
                                                        int index, const Vector3Of<DoubleDouble>& a) {
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

RBDYN_INLINE std::unique_ptr<const BodyForm> closed_form_of(const Scene& scene, const PointLaws& laws, int index) {
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

RBDYN_INLINE std::pair<std::shared_ptr<const ClosedMotion>, std::string> closed_motion(const Scene& scene,
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

}  // namespace rbdyn::inline RBDYN_FORM::planning
