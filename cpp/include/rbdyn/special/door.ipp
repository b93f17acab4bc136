// Definitions of rbdyn/special/door.hpp.
#pragma once

#include "rbdyn/special/door.hpp"

#include <cstddef>
#include <memory>
#include <string>
#include <tuple>
#include <variant>

#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/double_double_functions.hpp"
#include "rbdyn/basics/double_double_vector.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/curve/axes.hpp"
#include "rbdyn/curve/curve.hpp"
#include "rbdyn/scene/couplings.hpp"
#include "rbdyn/scene/handles.hpp"
#include "rbdyn/scene/joint_loads.hpp"
#include "rbdyn/scene/joints.hpp"
#include "rbdyn/scene/loads.hpp"
#include "rbdyn/special/closed_motion.hpp"
#include "rbdyn/special/linear_motion.hpp"
#include "rbdyn/special/special_model.hpp"
#include "rbdyn/special/two_body_motion.hpp"

namespace rbdyn::inline RBDYN_FORM::planning {

RBDYN_INLINE Placement view_of(const Scene& scene) {
    if (scene.bodies().size() != 1 || scene.bodies()[0].rail() == nullptr) return {};
    const Curve& curve = scene.bodies()[0].rail()->curve();
    Placement view = curve.placement();
    if (!curve.straight()) return view;
    // a line: the y axis along what pulls across it
    Vector3 across = Vector3::Zero();
    const Vector3 x = column(view.axes, 0);
    const auto take = [&](const Vector3& v) {
        const Vector3 part = v - x * x.dot(v);
        if (across.isZero(0.0) && part.norm() > 1e-12 * v.norm()) across = part;
    };
    take(scene.gravity());
    for (const auto& load : scene.loads())
        if (const Force* force = std::get_if<Force>(&load.load); force != nullptr && force->is_constant())
            take(force->settled());
    for (const auto& c : scene.connections()) {
        if (!is_present(c.coupling)) continue;
        for (const End* e : {&c.a, &c.b})
            if (const Vector3* point = std::get_if<Vector3>(e)) take(*point - view.origin);
    }
    if (across.isZero(0.0)) return view;
    const curves::WideVector along = view.exact_axes().col(0), beside = curves::wide_unit(across);
    const curves::WideVector y = beside - along * dot<DoubleDouble>(along, beside);
    const curves::WideVector unit = y / sqrt(dot<DoubleDouble>(y, y));
    return placed(view.origin, curves::columns(along, unit, cross<DoubleDouble>(along, unit)));
}

RBDYN_INLINE std::shared_ptr<const SceneModel> special_model(const Scene& scene, const Placement& view,
                                                             const GivenNumbers& numbers) {
    return std::make_shared<const SpecialModel>(scene, view, true, numbers);
}

namespace doors {

/// What makes a scene one of bodies joined to bodies, whose equations are not looked at.
inline std::string why_joined(const Scene& scene) {
    if (!scene.contacts().empty()) return "contacts have none here";
    if (!scene.constraints().empty()) return "constraints have none here";
    for (const Scene::Body& b : scene.bodies()) {
        if (b.parent >= 0) return "bodies joined to bodies have none here";
        if (friction_in(b.joint)) return "friction in joints has none here";
        if (is_driven(b.joint)) return "joints that are driven have none here";
    }
    for (const Scene::AppliedLoad& l : scene.loads())
        if (std::holds_alternative<JointTorque>(l.load) || std::holds_alternative<JointForce>(l.load)) {
            const Scene::Body& b = scene.bodies()[static_cast<std::size_t>(l.body)];
            return "loads along joints have none here, be they linear; " +
                   std::string(std::holds_alternative<Prismatic>(b.joint) ? "a Force on " : "a Torque on ") + b.name +
                   " along its axis does the same and may have one";
        }
    return "joints other than hinges, slides, balls and rails have none here";
}

}  // namespace doors

RBDYN_INLINE FoundForm closed_form(const Scene& scene, const SceneModel& model, bool any_rigid) {
    FoundForm found;
    const SpecialModel* special = dynamic_cast<const SpecialModel*>(&model);
    if (special == nullptr) return {nullptr, doors::why_joined(scene)};
    if (any_rigid) std::tie(found.form, found.why_not) = closed_motion(scene, special->laws());
    if (found.form) return found;
    FoundForm linear = linear_motion(scene, *special);
    if (linear.form) return linear;
    FoundForm two = two_body_motion(scene, special->laws());
    if (two.form || !two.why_not.empty()) return two;
    return any_rigid ? found : linear;
}

}  // namespace rbdyn::inline RBDYN_FORM::planning
