// Definitions of rbdyn/special/turning_law.hpp.
#pragma once

#include "rbdyn/special/turning_law.hpp"

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/double_double_vector.hpp"
#include "rbdyn/basics/error.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/body/principal_axes.hpp"
#include "rbdyn/model/equations.hpp"
#include "rbdyn/model/omission.hpp"
#include "rbdyn/model/state_map.hpp"
#include "rbdyn/rotation/quaternion.hpp"
#include "rbdyn/scene/couplings.hpp"
#include "rbdyn/scene/handles.hpp"
#include "rbdyn/scene/loads.hpp"
#include "rbdyn/scene/scene.hpp"
#include "rbdyn/scene/torque.hpp"
#include "rbdyn/special/projection.hpp"
#include "rbdyn/special/words.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE TurningLaw::TurningLaw(const Scene& scene, int place, const Vector3& at, const Vector3& origin,
                                    const Vector3Of<DoubleDouble>& exact_origin, const Matrix3Of<DoubleDouble>& about_o)
    : RigidLaw(scene, place, at, origin, exact_origin) {
    choose_principal_frame(scene, principal_axes(about_o));
    take_frame(scene);
}

RBDYN_INLINE void TurningLaw::choose_principal_frame(const Scene& scene, const PrincipalAxesOf<DoubleDouble>& p) {
    int axis = -1;
    for (int i = 0; i < 3; ++i)
        if (p.moments[(i + 1) % 3] == p.moments[(i + 2) % 3]) axis = i;
    const bool is_ball = p.moments[0] == p.moments[1] && p.moments[1] == p.moments[2];
    const int first_axis = axis < 0 ? 0 : (axis + 1) % 3;
    Vector3Of<DoubleDouble>& m = exact.moments;
    for (int i = 0; i < 3; ++i) {
        const int k = (first_axis + i) % 3;
        exact.frame.col(i) = p.axes.col(k);
        m[i] = p.moments[k];
    }
    // a ball turns about any of its axes: that through G
    const Vector3Of<DoubleDouble> arm = to_center(scene);
    if (is_ball && !rounded(arm).isZero(0.0)) exact.frame = axis_frame(arm, arm);
    follows_axis = axis >= 0 && acts_on_axis(scene, exact.frame.col(2));
    for (int i = 0; i < 3; ++i) coupling[i] = follows_axis ? m[2] / m[0] : (m[(i + 1) % 3] - m[(i + 2) % 3]) / m[i];
}

RBDYN_INLINE bool TurningLaw::acts_on_axis(const Scene& scene, const Vector3Of<DoubleDouble>& e) const {
    const auto arm_is_on_axis = [&](const Vector3Of<DoubleDouble>& d) {
        return rounded(d - scaled(e, e.dot(d))).norm() <= off_axis * rounded(d).norm();
    };
    const auto is_on_axis = [&](const Vector3& point) { return arm_is_on_axis(widened(point) - exact.origin); };
    if (!arm_is_on_axis(to_center(scene))) return false;
    for (const Scene::AppliedLoad& load : scene.loads()) {
        if (load.body != index || !is_present(load.load)) continue;
        const Force* force = std::get_if<Force>(&load.load);
        if (std::holds_alternative<Torque>(load.load) || (force != nullptr && force->frame() == Frame::body) ||
            (load.at && !is_on_axis(*load.at)))
            return false;
    }
    for (const Scene::Connection& c : scene.connections()) {
        if (!is_present(c.coupling)) continue;
        for (const End* end : {&c.a, &c.b})
            if (const BodyPoint* point = std::get_if<BodyPoint>(end);
                point != nullptr && point->body == index && !is_on_axis(point->point))
                return false;
    }
    return true;
}

RBDYN_INLINE void TurningLaw::start_turned(const Scene::Body& b, DoubleDouble* q, DoubleDouble* v) const {
    const QuaternionOf<DoubleDouble> p = b.attitude.exact() * exact.frame_attitude;
    const Vector3Of<DoubleDouble> omega = product(exact.frame.transpose(), b.angular_velocity);
    for (const DoubleDouble& c : {p.w, p.x, p.y, p.z}) *q++ = c;
    if (follows_axis) *q = 0.0;
    for (int i = 0; i < 3; ++i) v[i] = omega[i];
}

RBDYN_INLINE std::vector<VariableGroup> TurningLaw::groups(bool of_positions) const {
    std::vector<VariableGroup> result;
    const int turn = first_turn();
    if (turn > 0) result.push_back({0, 3, of_positions, 0.0, of_positions ? Alike::place : Alike::velocity});
    result.push_back({turn, of_positions ? 4 : 3, false, 0.0, of_positions ? Alike::nothing : Alike::turning});
    if (of_positions && follows_axis) result.push_back({turn + 4, 1, false});
    return result;
}

RBDYN_INLINE std::unique_ptr<const Projection> TurningLaw::projection(std::span<const double> x,
                                                                      std::span<const double> low) const {
    return std::make_unique<RigidProjection>(*this, first, first_rate, x, low);
}

RBDYN_INLINE std::vector<std::string> TurningLaw::words() const {
    return {"attitude", "angular_velocity", "angular_velocity_world"};
}

RBDYN_INLINE std::string TurningLaw::whole_attitude() const {
    return follows_axis ? "quaternion of the frame that follows its axis, spin about it"
                        : "quaternion of its principal axes";
}

RBDYN_INLINE planning::Named TurningLaw::part_of_attitude(const StateMap& map) const {
    return {map, first + first_turn(), planning::attitudes, positions() - first_turn()};
}

RBDYN_INLINE void TurningLaw::leave_out_turns(const StateMap& map, const char* about,
                                              std::vector<Omission>& omissions) const {
    const planning::Named attitude = part_of_attitude(map), turn(map, first_rate + first_turn(), planning::turns);
    if (attitude.in.empty() && turn.in.empty()) {
        omissions.push_back({"rotation of " + name,
                             std::string("no spin, and no moment about its ") + about + "; either brings it in"});
        return;
    }
    std::vector<std::string> still = attitude.out;
    for (std::size_t k = 0; k < turn.out.size(); ++k) {
        if (turn.values[k] == 0.0) {
            still.push_back(turn.out[k]);
            continue;
        }
        const bool is_spin = follows_axis && turn.out[k] == planning::turns[2];
        omissions.push_back({turn.out[k] + " of " + name,
                             "stays at " + text(turn.values[k]) +
                                 (is_spin ? ": nothing turns it about its axis of symmetry; a moment does"
                                          : ": a permanent rotation; a moment or another spin brings it in")});
    }
    if (!still.empty())
        omissions.push_back({planning::listed(still) + " of " + name,
                             std::string(still.size() > 1 ? "stay as they start" : "stays as it starts") +
                                 "; a moment or a spin about another axis brings " +
                                 (still.size() > 1 ? "them in" : "it in")});
}

}  // namespace rbdyn::inline RBDYN_FORM
