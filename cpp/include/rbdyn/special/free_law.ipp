// Definitions of rbdyn/special/free_law.hpp.
#pragma once

#include "rbdyn/special/free_law.hpp"

#include <cmath>
#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/double_double_vector.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/body/rigid_body.hpp"
#include "rbdyn/model/omission.hpp"
#include "rbdyn/model/state_map.hpp"
#include "rbdyn/rotation/attitude.hpp"
#include "rbdyn/scene/scene.hpp"
#include "rbdyn/special/body_form.hpp"
#include "rbdyn/special/words.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE FreeLaw::FreeLaw(const Scene& scene, int place)
    : RigidLawOf(scene, place, Vector3(Vector3::Zero()), body_of(scene, place).com(), body_of(scene, place).exact().com,
                 body_of(scene, place).exact().inertia) {}

RBDYN_INLINE void FreeLaw::start_in(const Scene::Body& b, DoubleDouble* q, DoubleDouble* v) const {
    const Matrix3Of<DoubleDouble> r = rotation_matrix(b.attitude.exact());
    const Vector3Of<DoubleDouble> g = widened(b.position) + product(r, exact.origin),
                                  u = widened(b.velocity) + product(r, b.angular_velocity.cross(exact.origin));
    for (int i = 0; i < 3; ++i) {
        q[i] = g[i];
        v[i] = u[i];
    }
    start_turned(b, q + 3, v + 3);
}

RBDYN_INLINE void FreeLaw::observe(const LawsNow& now, std::vector<Observed>& out) const {
    const RigidReport r = rigid_report(now);
    observe_center(r, now, out);
    observe_axes(r, out, std::sqrt(inertia.trace() / mass));
}

RBDYN_INLINE std::unique_ptr<const BodyForm> FreeLaw::closed_form(const Scene& scene,
                                                                  const Vector3Of<DoubleDouble>& a) const {
    const Scene::Body& b = scene.bodies()[static_cast<std::size_t>(index)];
    const Matrix3Of<DoubleDouble> r = rotation_matrix(b.attitude.exact());
    const Vector3Of<DoubleDouble>& com = b.rigid()->exact().com;
    const closed_forms::Accelerated center_of_mass(widened(b.position) + product(r, com),
                                                   widened(b.velocity) + product(r, b.angular_velocity.cross(com)), a);
    return closed_forms::made<closed_forms::FreeForm>(b, turning_frame(), b.rigid()->principal_exact(), center_of_mass);
}

RBDYN_INLINE std::vector<std::string> FreeLaw::words() const {
    std::vector<std::string> own{"position", "velocity"};
    for (const std::string& word : TurningLaw::words()) own.push_back(word);
    return own;
}

RBDYN_INLINE std::string FreeLaw::coordinates(const StateMap& map) const {
    const planning::Named place(map, first, planning::places), attitude = part_of_attitude(map);
    if (place.out.empty() && attitude.out.empty()) return "centre of mass x, y, z; " + whole_attitude();
    std::vector<std::string> parts;
    if (!place.in.empty()) parts.push_back("centre of mass " + planning::listed(place.in));
    if (!attitude.in.empty()) parts.push_back(planning::listed(attitude.in) + " of its attitude");
    return planning::listed(parts, "; ");
}

RBDYN_INLINE void FreeLaw::leave_out(const StateMap& map, std::vector<Omission>& omissions) const {
    planning::leave_out_places(*this, map, omissions);
    leave_out_turns(map, "centre of mass", omissions);
}

}  // namespace rbdyn::inline RBDYN_FORM
