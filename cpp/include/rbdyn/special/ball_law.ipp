// Definitions of rbdyn/special/ball_law.hpp.
#pragma once

#include "rbdyn/special/ball_law.hpp"

#include <cmath>
#include <cstddef>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/double_double_vector.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/body/mass_properties.hpp"
#include "rbdyn/body/rigid_body.hpp"
#include "rbdyn/model/omission.hpp"
#include "rbdyn/scene/joints.hpp"
#include "rbdyn/scene/scene.hpp"
#include "rbdyn/special/body_form.hpp"
#include "rbdyn/special/words.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE BallLaw::BallLaw(const Scene& scene, int place, const Spherical& joint)
    : RigidLawOf(scene, place, joint.at, joint.point, widened(joint.point),
                 inertia_about(body_of(scene, place).exact(), widened(joint.point))) {}

RBDYN_INLINE void BallLaw::observe(const LawsNow& now, std::vector<Observed>& out) const {
    const RigidReport r = rigid_report(now);
    // how far its centre goes, measured by that; where it hardly moves the rounding of its place is not told
    const Vector3& at = now.state(index).r;
    Observed moved{at, true};
    moved.from = at.norm();
    moved.none = 8.0 * std::numeric_limits<double>::epsilon() * moved.from;
    out.push_back(moved);
    observe_axes(r, out, std::sqrt(inertia.trace() / mass));
    observe_force(r, out);
}

RBDYN_INLINE std::optional<planning::LoneBody> BallLaw::alone() const {
    planning::LoneBody result = *RigidLaw::alone();
    result.on_ball_joint = true;
    // its centre of mass off the axis of its equal moments A = B, C = A/2 and G in their plane
    const double near = 1e-12;
    result.is_kovalevskaya = std::abs(moments[0] - moments[1]) <= near * moments[0] &&
                             std::abs(moments[0] - 2.0 * moments[2]) <= near * moments[0] &&
                             std::abs(center[2]) <= near * center.norm() && !center.isZero(0.0);
    return result;
}

RBDYN_INLINE std::unique_ptr<const BodyForm> BallLaw::closed_form(const Scene& scene,
                                                                  const Vector3Of<DoubleDouble>& a) const {
    const Scene::Body& b = scene.bodies()[static_cast<std::size_t>(index)];
    const bool is_weightless = a[0].hi == 0.0 && a[1].hi == 0.0 && a[2].hi == 0.0;
    if (is_weightless || center.isZero(0.0))
        return closed_forms::made<closed_forms::FreeForm>(b, turning_frame(), b.rigid()->principal_exact(origin_),
                                                          std::nullopt);
    if (!follows_axis) return nullptr;
    const DoubleDouble g = sqrt(dot<DoubleDouble>(a, a));
    const Vector3Of<DoubleDouble> omega = product(exact.frame.transpose(), b.angular_velocity);
    return closed_forms::made<closed_forms::TopForm>(
        turning_frame(), moments, Vector3(-rounded(a)),
        LagrangeTop(exact.moments[0], exact.moments[2], exact.mass * g * exact.center[2], Vector3(-rounded(a)),
                    b.attitude.exact() * exact.frame_attitude, {omega[0], omega[1], omega[2]}));
}

RBDYN_INLINE std::string BallLaw::coordinates(const StateMap& map) const {
    const planning::Named attitude = part_of_attitude(map);
    return attitude.out.empty() ? whole_attitude() : planning::listed(attitude.in) + " of its attitude";
}

RBDYN_INLINE void BallLaw::leave_out(const StateMap& map, std::vector<Omission>& omissions) const {
    leave_out_turns(map, "joint", omissions);
}

}  // namespace rbdyn::inline RBDYN_FORM
