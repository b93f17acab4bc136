// Definitions of rbdyn/special/hinge_law.hpp.
#pragma once

#include "rbdyn/special/hinge_law.hpp"

#include <cmath>
#include <cstddef>
#include <memory>
#include <span>
#include <variant>
#include <vector>

#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/double_double_functions.hpp"
#include "rbdyn/basics/double_double_vector.hpp"
#include "rbdyn/basics/error.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/body/mass_properties.hpp"
#include "rbdyn/body/rigid_body.hpp"
#include "rbdyn/closed_form/linear_oscillator.hpp"
#include "rbdyn/model/equations.hpp"
#include "rbdyn/scene/joints.hpp"
#include "rbdyn/scene/loads.hpp"
#include "rbdyn/scene/scene.hpp"
#include "rbdyn/special/body_form.hpp"
#include "rbdyn/special/projection.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE HingeLaw::HingeLaw(const Scene& scene, int place, const Revolute& joint)
    : RigidLawOf(scene, place, joint.axis, joint.at, joint.point) {
    const Matrix3Of<DoubleDouble> about_o = inertia_about(body_of(scene, place).exact(), exact.origin);
    const Vector3Of<DoubleDouble>& e3 = exact.frame.col(2);
    exact.moments[2] = dot<DoubleDouble>(e3, product(about_o, e3));
    moments = rounded(exact.moments);
    const double all = (about_o(0, 0) + about_o(1, 1) + about_o(2, 2)).hi;
    require(moments[2] > 1e-15 * all, name, "moment of inertia about its axis", moments[2],
            "a body turns about a hinge by its moment about it and that of what it carries; this one has none: give it "
            "some, or move the axis");
}

RBDYN_INLINE std::vector<VariableGroup> HingeLaw::groups(bool of_positions) const {
    return {{0, 1, false, 0.0, of_positions ? Alike::nothing : Alike::turning}};
}

RBDYN_INLINE void HingeLaw::observe(const LawsNow& now, std::vector<Observed>& out) const {
    const RigidReport r = rigid_report(now);
    // how far it has turned, measured by how far it does: axes are known to rounding beside a radian
    out.push_back({Vector3(r.coordinate, 0.0, 0.0), true, 0.0, std::abs(r.coordinate)});
    observe_axes(r, out);
    observe_force(r, out);
    observe_torque(r, out);
}

RBDYN_INLINE std::unique_ptr<const Projection> HingeLaw::projection(std::span<const double> x,
                                                                    std::span<const double> low) const {
    return std::make_unique<HingeProjection>(*this, first, first_rate, x, low);
}

RBDYN_INLINE std::unique_ptr<const BodyForm> HingeLaw::closed_form(const Scene& scene,
                                                                   const Vector3Of<DoubleDouble>& a) const {
    const Scene::Body& b = scene.bodies()[static_cast<std::size_t>(index)];
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
    const bool is_heavy = std::abs(center[0]) > 0.0 && weight.hi > 0.0;
    if (!is_heavy) return closed_forms::made<closed_forms::OscillatorForm>(c, rest, b.parameter, b.speed);
    if (springs > 0) return nullptr;
    // lowest where R d lies along a
    const DoubleDouble sine = dot<DoubleDouble>(turned, e) / sqrt(ee), cosine = dot<DoubleDouble>(across, pull) / ee;
    DoubleDouble lowest = std::atan2(sine.hi, cosine.hi);
    // one step of Newton's: the angle to 32 digits
    const auto [s, co] = sine_cosine(lowest);
    lowest += (sine * co - cosine * s) / (cosine * co + sine * s);
    return closed_forms::made<closed_forms::PendulumForm>(weight / moment, lowest, b.parameter, b.speed);
}

}  // namespace rbdyn::inline RBDYN_FORM
