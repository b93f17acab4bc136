// Definitions of rbdyn/special/rigid_change.hpp.
#pragma once

#include "rbdyn/special/rigid_change.hpp"

#include <algorithm>
#include <cmath>
#include <span>
#include <string>
#include <vector>

#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/double_double_functions.hpp"
#include "rbdyn/basics/error.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/rotation/attitude.hpp"
#include "rbdyn/scene/joints.hpp"
#include "rbdyn/scene/scene.hpp"
#include "rbdyn/scene/watch.hpp"
#include "rbdyn/special/point_laws.hpp"
#include "rbdyn/special/rigid_law.hpp"
#include "rbdyn/special/rigid_loads.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE void change_rigid(const StateChange& c, const PointLaws::Body& body, const RigidReport& now,
                               const std::string& user, std::span<double> x) {
    const RigidLaw& law = *body.rigid;
    const bool is_free = law.kind == RigidLaw::Kind::free, turns = law.turns_freely(),
               is_hinged = law.kind == RigidLaw::Kind::revolute, slides = law.kind == RigidLaw::Kind::prismatic;
    std::vector<std::string> own;
    if (is_free) own = {"position", "velocity"};
    if (turns) own.insert(own.end(), {"attitude", "angular_velocity", "angular_velocity_world"});
    if (is_hinged) own = {"angle", "rate"};
    if (slides) own = {"displacement", "rate"};
    c.require_words(own, user, body.name);
    Scene::Body changed;
    changed.position = c.position.value_or(now.position);
    changed.velocity = c.velocity.value_or(now.velocity);
    changed.attitude = c.attitude.value_or(now.attitude);
    changed.angular_velocity = joints::angular_velocity(c, changed.attitude, user, now.angular_velocity);
    changed.parameter = is_hinged ? c.angle.value_or(now.coordinate) : c.displacement.value_or(now.coordinate);
    changed.speed = c.rate.value_or(now.rate);
    DoubleDouble q[8], v[6];
    law.start(changed, q, v);
    const auto put = [&](const DoubleDouble& value) {
        require(std::isfinite(value.hi), user, "a number its action gives", value.hi, "a state is finite");
        return value.hi;
    };
    std::transform(q, q + law.positions(), x.begin() + body.first, put);
    std::transform(v, v + law.velocities(), x.begin() + body.first_rate, put);
}

}  // namespace rbdyn::inline RBDYN_FORM
