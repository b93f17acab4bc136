// Definitions of rbdyn/statics/rest_forces.hpp.
#pragma once

#include "rbdyn/statics/rest_forces.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/double_double_vector.hpp"
#include "rbdyn/basics/error.hpp"
#include "rbdyn/curve/one_side.hpp"
#include "rbdyn/expression/expression.hpp"
#include "rbdyn/mechanics/closure.hpp"
#include "rbdyn/mechanics/six.hpp"
#include "rbdyn/scene/couplings.hpp"
#include "rbdyn/scene/handles.hpp"
#include "rbdyn/scene/joint_loads.hpp"
#include "rbdyn/scene/joints.hpp"
#include "rbdyn/scene/loads.hpp"
#include "rbdyn/scene/torque.hpp"

namespace rbdyn::inline RBDYN_FORM::statics {

RBDYN_INLINE RestForces::RestForces(const Scene& scene)
    : scene_(scene), tree_(scene, {}, mechanics::Beads::stay), exerted_(scene, tree_) {
    const auto all = mechanics::closing::moving<DoubleDouble>(tree_, 0.0, tree_.start(0.0));
    Vector3 low = Vector3::Constant(std::numeric_limits<double>::infinity()), high = -low;
    const auto take = [&](const Vector3& p) {
        low = lesser(low, p);
        high = greater(high, p);
    };
    for (int i = 0; i < tree_.size(); ++i) {
        const mechanics::Moving<DoubleDouble>& m = all[at(i)];
        take(rounded(m.place));
        take(rounded(m.place + m.to_world(tree_.node(i).center)));
        const Scene::Body& body = scene.bodies()[at(i)];
        const Rail* rail = body.rail();
        if (rail == nullptr || rail->side() == RailSide::both) continue;
        mechanics::LooseRail loose{i, body.parent, rail->curve()};
        loose.side = curves::one_side(rail->curve(), body.parameter, rail->up(), body.name);
        if (rail->side() == RailSide::minus) loose.side->sign = -loose.side->sign;
        one_sided_.push_back(std::move(loose));
    }
    for (const Scene::Connection& c : scene.connections())
        for (const End* end : {&c.a, &c.b}) take(rounded(tree_.point<DoubleDouble>(tree_.anchor(*end), all).place));
    for (const Scene::Held& c : scene.constraints())
        for (const End* end : {&c.a, &c.b})
            if (body_of(*end) >= 0 || std::holds_alternative<Vector3>(*end))
                take(rounded(tree_.point<DoubleDouble>(tree_.anchor(*end), all).place));
    size_ = (high - low).norm();
}

RBDYN_INLINE RestForces::Recorded RestForces::recorded(const std::vector<S>& q) const {
    const std::vector<S> still(at(tree_.velocities()), S(0.0));
    Recorded result;
    result.all = tree_.moving<S>(S(0.0), q.data(), still.data());
    mechanics::Acts acts = exerted_.all(tree_, S(0.0), result.all, q.data(), still.data());
    result.wrenches = acts.wrenches;
    result.along = acts.joints;
    for (int i = tree_.size() - 1; i >= 0; --i) {
        const mechanics::Node& n = tree_.node(i);
        const mechanics::Moving<S>& m = result.all[at(i)];
        Wrench<S> w = acts.wrenches[at(i)];
        for (int k = 0; k < n.joint.velocities(); ++k) result.along[at(n.v + k)] += mechanics::power(m.joint[at(k)], w);
        if (n.parent < 0) continue;
        // what turns freely does not turn with its parent
        if (n.joint.attitude() >= 0) w.moment = mechanics::none<S>();
        mechanics::add<S>(acts.wrenches[at(n.parent)],
                          mechanics::about<S>(w, Vector3Of<S>(m.place - result.all[at(n.parent)].place)), S(1.0));
    }
    return result;
}

RBDYN_INLINE RestForces::Efforts RestForces::efforts(const std::vector<double>& q) const {
    std::vector<double> x = q;
    x.resize(at(tree_.variables()), 0.0);
    Efforts result{std::vector<Efforts::OnBody>(at(tree_.size())), std::vector<double>(at(tree_.velocities()), 0.0),
                   mechanics::closing::moving<double>(tree_, 0.0, x)};
    const auto add = [&](int body, double size, const Vector3& arm) {
        result.bodies[at(body)].size += size;
        result.bodies[at(body)].moment += size * arm.norm();
    };
    const Vector3 still = Vector3::Zero();
    // constant forces on a particle are one with its weight
    std::vector<Vector3Of<DoubleDouble>> constant;
    for (const mechanics::Node& n : tree_.nodes()) constant.push_back(scaled(widened(scene_.gravity()), n.mass));
    for (const Scene::AppliedLoad& load : scene_.loads()) {
        const mechanics::Node& n = tree_.node(load.body);
        if (!is_present(load.load)) continue;
        const auto along = [&](int k, const JointLoad& own) {
            result.joints[at(n.v + k)] += std::abs(own(0.0, x[at(n.q + k)], 0.0));
        };
        if (const TorsionSpring* spring = std::get_if<TorsionSpring>(&load.load)) {
            const int k = mechanics::turning_velocity(n.joint);
            result.joints[at(n.v + k)] += spring->stiffness * (std::abs(x[at(n.q + k)]) + std::abs(spring->rest_angle));
        } else if (const JointTorque* torque = std::get_if<JointTorque>(&load.load)) {
            along(mechanics::turning_velocity(n.joint), *torque);
        } else if (const JointForce* force = std::get_if<JointForce>(&load.load)) {
            along(mechanics::sliding_velocity(n.joint), *force);
        } else if (const Torque* twist = std::get_if<Torque>(&load.load)) {
            const AxesOf<double>& axes = result.all[at(load.body)].axes;
            RotationOf<double> r{};
            const Vector3* e[3] = {&axes.e1, &axes.e2, &axes.e3};
            for (std::size_t i = 0; i < 3; ++i)
                for (std::size_t k = 0; k < 3; ++k) r[i][k] = (*e[k])[static_cast<Eigen::Index>(i)];
            result.bodies[at(load.body)].moment += (*twist)(0.0, r, still).norm();
        } else if (const Force* own = std::get_if<Force>(&load.load);
                   own != nullptr && own->is_constant() && n.is_point) {
            constant[at(load.body)] += widened(own->settled());
        } else {
            const auto p = tree_.point<double>(
                tree_.anchor(load.at ? End(BodyPoint{load.body, *load.at}) : End(BodyHandle{load.body})), result.all);
            const Vector3 f = force_of<double>(load.load, 0.0, p.place, still);
            // high powers far away, whose squares overflow
            add(load.body, f.stableNorm(), p.arm);
            result.bodies[at(load.body)].force += f;
        }
    }
    for (int i = 0; i < tree_.size(); ++i) {
        const Vector3 f = rounded(constant[at(i)]);
        add(i, f.norm(), rounded(tree_.node(i).center));
        result.bodies[at(i)].force += f;
    }
    for (const Scene::Connection& c : scene_.connections()) {
        if (!is_present(c.coupling)) continue;
        const mechanics::Anchor a = tree_.anchor(c.a), b = tree_.anchor(c.b);
        const auto pa = tree_.point<double>(a, result.all), pb = tree_.point<double>(b, result.all);
        const double masses =
            a.body >= 0 && b.body >= 0 ? static_cast<double>(tree_.node(a.body).mass * tree_.node(b.body).mass) : 0.0;
        const PairState<double> pair{0.0, pa.place, pb.place, still, still, masses};
        const Vector3 f = force_of<double>(c.coupling, pair);
        const double force = std::holds_alternative<Spring>(c.coupling) ? 0.0 : f.norm();
        const double size = force + effort_of(c.coupling, pair, force);
        if (a.body >= 0) add(a.body, size, pa.arm);
        if (b.body >= 0 && b.body != a.body) add(b.body, size, pb.arm);
        if (a.body >= 0) result.bodies[at(a.body)].force += f;
        if (b.body >= 0) result.bodies[at(b.body)].force -= f;
    }
    return result;
}

RBDYN_INLINE std::string RestForces::not_finite(const std::vector<double>& q) const {
    std::vector<double> x = q;
    x.resize(at(tree_.variables()), 0.0);
    const auto all = mechanics::closing::moving<double>(tree_, 0.0, x);
    for (int i = 0; i < tree_.size(); ++i)
        if (!is_finite(all[at(i)].place)) return "the place of " + tree_.node(i).name;
    const Vector3 still = Vector3::Zero();
    for (const Scene::AppliedLoad& load : scene_.loads()) {
        const mechanics::Node& n = tree_.node(load.body);
        if (!n.is_point || !is_present(load.load)) continue;
        const Vector3 f = force_of<double>(load.load, 0.0, all[at(load.body)].place, still);
        if (!is_finite(f))
            return title_of(load.load) + " on " + n.name + ", which is [" + text(f[0]) + ", " + text(f[1]) + ", " +
                   text(f[2]) + "]";
    }
    return "";
}

}  // namespace rbdyn::inline RBDYN_FORM::statics
