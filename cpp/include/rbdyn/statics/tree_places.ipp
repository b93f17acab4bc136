// Definitions of rbdyn/statics/tree_forces.hpp: places, coordinates and steps.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <variant>
#include <vector>

#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/error.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/mechanics/assemble.hpp"
#include "rbdyn/mechanics/closure.hpp"
#include "rbdyn/rotation/attitude.hpp"
#include "rbdyn/rotation/quaternion.hpp"
#include "rbdyn/scene/joints.hpp"
#include "rbdyn/statics/tree_forces.hpp"

namespace rbdyn::inline RBDYN_FORM::statics {

RBDYN_INLINE int coordinates_of(const Scene::Body& b) {
    if (std::holds_alternative<Free>(b.joint)) return b.rigid() != nullptr ? 7 : 3;
    if (std::holds_alternative<Spherical>(b.joint)) return 4;
    if (std::holds_alternative<Universal>(b.joint) || std::holds_alternative<Cylindrical>(b.joint)) return 2;
    if (std::holds_alternative<Planar>(b.joint)) return 3;
    if (std::holds_alternative<Fixed>(b.joint)) return 0;
    if (const Revolute* hinge = std::get_if<Revolute>(&b.joint)) return hinge->motion ? 0 : 1;
    if (const Prismatic* slide = std::get_if<Prismatic>(&b.joint)) return slide->motion ? 0 : 1;
    return 1;
}

RBDYN_INLINE std::vector<double> TreeForces::place(const std::vector<double>& coordinates) const {
    std::vector<Scene::Body> bodies = acting_.scene().bodies();
    const double* c = coordinates.data();
    for (Scene::Body& b : bodies) {
        if (std::holds_alternative<Free>(b.joint)) {
            b.position = {c[0], c[1], c[2]};
            c += 3;
        }
        const bool turns = (std::holds_alternative<Free>(b.joint) && b.rigid() != nullptr) ||
                           std::holds_alternative<Spherical>(b.joint);
        if (turns) {
            b.attitude = Attitude(Quaternion{c[0], c[1], c[2], c[3]});
            c += 4;
        } else if (const int count = coordinates_of(b); count == 1) {
            b.parameter = *c++;
            b.parameter_rest = 0.0;
        } else if (!std::holds_alternative<Free>(b.joint)) {
            for (int k = 0; k < count; ++k) b.coordinates[at(k)] = *c++;
        }
    }
    Wide x = tree().start(0.0, bodies);
    x.resize(at(tree().positions()));
    const Wide on = closed(x);
    if (on.empty())
        throw InvalidInput(
            "near: the constraints of this scene cannot be closed from the coordinates given; give some "
            "that are closer to satisfying them");
    std::vector<double> q = mechanics::closing::nearest(on);
    q.resize(at(tree().positions()));
    return q;
}

RBDYN_INLINE std::vector<double> TreeForces::coordinates(const std::vector<double>& q) const {
    Wide x(q.begin(), q.end());
    x.resize(at(tree().variables()), 0.0);
    const auto all = moving(x);
    std::vector<double> c;
    const auto add = [&](double value) { c.push_back(value + 0.0); };  // not -0
    for (int i = 0; i < bodies(); ++i) {
        Scene::Body b = acting_.scene().bodies()[at(i)];
        mechanics::assembling::put(tree(), i, all, x, b);
        if (std::holds_alternative<Free>(b.joint))
            for (const double place : b.position) add(place);
        if (tree().node(i).joint.attitude() >= 0) {
            tell(b.attitude.quaternion(), c);
        } else if (const int count = coordinates_of(b); count == 1) {
            add(b.parameter);
        } else if (!std::holds_alternative<Free>(b.joint)) {
            for (int k = 0; k < count; ++k) add(b.coordinates[at(k)]);
        }
    }
    return c;
}

RBDYN_INLINE Quaternion TreeForces::attitude(const std::vector<double>& q, int body) const {
    const double* p = &q[at(tree().node(body).q + tree().node(body).joint.attitude())];
    return {p[0], p[1], p[2], p[3]};
}

RBDYN_INLINE Vector3 TreeForces::center(const std::vector<double>& q, int body) const {
    const double* p = &q[at(tree().node(body).q)];
    return {p[0], p[1], p[2]};
}

RBDYN_INLINE std::vector<double> TreeForces::turned(std::vector<double> q, int body, const Vector3& axis,
                                                    const Vector3& point, double angle) const {
    const Quaternion by = turn(axis, angle), p = normalized(by * attitude(q, body));
    double* own = &q[at(tree().node(body).q)];
    if (const int moves = displacements(body); moves > 0) {
        const Vector3 g = point + to_world<double>(by, Vector3(center(q, body) - point));
        std::copy_n(g.data(), 3, own);
        own += moves;
    }
    write(own, p);
    return q;
}

RBDYN_INLINE std::vector<double> TreeForces::moved(std::vector<double> q, const std::vector<double>& step) const {
    const std::vector<double> nowhere(q.size(), std::numeric_limits<double>::quiet_NaN());
    const Wide from = wide(q);
    if (from.empty()) return nowhere;
    const Wide v = velocities(rows(moving(from)), Wide(step.begin(), step.end()));
    for (int i = 0; i < bodies(); ++i) {
        const mechanics::Node& n = tree().node(i);
        double* own = q.data() + n.q;
        const int turns = n.joint.attitude(), moves = turns >= 0 ? turns : n.joint.velocities();
        for (int k = 0; k < moves; ++k) own[k] += static_cast<double>(v[at(n.v + k)]);
        if (const mechanics::RailLaw* rail = n.joint.rail())
            *own = std::clamp(*own, rail->curve->domain().begin, rail->curve->domain().end);
        if (turns < 0) continue;
        Vector3 by;
        for (int k = 0; k < 3; ++k) by[k] = static_cast<double>(v[at(n.v + turns + k)]);
        const double angle = by.norm();
        if (angle == 0.0) continue;
        const Quaternion p = normalized(turn(Vector3(by / angle), angle) * attitude(q, i));
        own += turns;
        write(own, p);
    }
    if (rows_.empty()) return q;
    const Wide on = wide(q);
    if (on.empty()) return nowhere;
    q = mechanics::closing::nearest(on);
    q.resize(at(tree().positions()));
    return q;
}

RBDYN_INLINE std::vector<double> TreeForces::nearest(const Wide& place) const {
    std::vector<double> q = mechanics::closing::nearest(place);
    q.resize(at(tree().positions()));
    return q;
}

RBDYN_INLINE TreeForces::Wide TreeForces::stepped(const Wide& place, const std::vector<double>& step) const {
    const Wide v = velocities(rows(moving(place)), Wide(step.begin(), step.end()));
    Wide there(place.begin(), place.begin() + tree().positions());
    mechanics::closing::move<DoubleDouble>(tree(), 0.0, mechanics::closing::nearest(v), there);
    for (const mechanics::Node& n : tree().nodes())
        if (const mechanics::RailLaw* rail = n.joint.rail()) {
            const Domain d = rail->curve->domain();
            there[at(n.q)] = std::clamp<DoubleDouble>(there[at(n.q)], d.begin, d.end);
        }
    for (int i = 0; i < 2; ++i) mechanics::closing::normalize<DoubleDouble>(tree(), there);
    return closed(std::move(there));
}

RBDYN_INLINE double TreeForces::largest_turn(const std::vector<double>& step) const {
    double most = 0.0;
    const std::vector<double> v = in_all(step);
    for (const mechanics::Node& n : tree().nodes()) {
        const double* own = v.data() + n.v;
        if (const mechanics::RailLaw* rail = n.joint.rail()) {
            // once round a closed rail
            if (const double period = rail->curve->period(); period > 0.0)
                most = std::max(most, 2.0 * std::numbers::pi / period * std::abs(own[0]));
        } else if (const int turns = n.joint.attitude(); turns >= 0) {
            most = std::max(most, std::hypot(own[turns], own[turns + 1], own[turns + 2]));
        } else if (n.joint.as<mechanics::UniversalLaw>() != nullptr) {
            most = std::max({most, std::abs(own[0]), std::abs(own[1])});
        } else if (const int k = mechanics::turning_velocity(n.joint); k >= 0) {
            most = std::max(most, std::abs(own[k]));
        }
    }
    return most;
}

RBDYN_INLINE double TreeForces::largest_move(const std::vector<double>& step) const {
    std::vector<Vector3> moves(at(bodies()), Vector3::Zero());
    for (int i = 0; i < freedoms(); ++i)
        if (step[at(i)] != 0.0)
            for (const Carried& c : carried(i)) moves[at(c.body)] += step[at(i)] * rounded(c.twist.move);
    double most = 0.0;
    for (const Vector3& move : moves) most = std::max(most, move.norm());
    return most;
}

RBDYN_INLINE double TreeForces::unit_of(const mechanics::Node& n, int velocity) const {
    if (const mechanics::RailLaw* rail = n.joint.rail()) {
        const double speed = rail->curve->first(start_[at(n.q)]).norm();
        return speed > 0.0 ? extent_ / speed : 1.0;
    }
    if (const int turns = n.joint.attitude(); turns >= 0) return velocity < turns ? extent_ : 1.0;
    const bool turns =
        n.joint.as<mechanics::UniversalLaw>() != nullptr || velocity == mechanics::turning_velocity(n.joint);
    return turns ? 1.0 : extent_;
}

RBDYN_INLINE std::vector<double> TreeForces::units() const {
    std::vector<double> result;
    for (const int k : leading_)
        for (const mechanics::Node& n : tree().nodes())
            if (k >= n.v && k < n.v + n.joint.velocities()) result.push_back(unit_of(n, k - n.v));
    return result;
}

RBDYN_INLINE std::vector<double> TreeForces::units_of_positions() const {
    std::vector<double> result;
    // an attitude has one position more than velocities, the last one
    for (const mechanics::Node& n : tree().nodes())
        for (int k = 0; k < n.joint.positions(); ++k)
            result.push_back(unit_of(n, std::min(k, n.joint.velocities() - 1)));
    for (const mechanics::Foot& foot : tree().feet()) result.push_back(foot.part());
    return result;
}

RBDYN_INLINE std::vector<TreeForces::Round> TreeForces::rounds() const {
    std::vector<Round> result;
    constexpr double turn = 2.0 * std::numbers::pi;
    for (const mechanics::Node& n : tree().nodes()) {
        if (const mechanics::RailLaw* rail = n.joint.rail()) {
            if (const double period = rail->curve->period(); period > 0.0) result.push_back({n.q, period});
        } else if (n.joint.attitude() >= 0) {
            continue;
        } else if (n.joint.as<mechanics::UniversalLaw>() != nullptr) {
            result.push_back({n.q, turn});
            result.push_back({n.q + 1, turn});
        } else if (const int k = mechanics::turning_velocity(n.joint); k >= 0) {
            result.push_back({n.q + k, turn});
        }
    }
    return result;
}

RBDYN_INLINE double TreeForces::distance(const std::vector<double>& to, const std::vector<double>& from) const {
    double sum = 0.0;
    for (int i = 0; i < bodies(); ++i) {
        const mechanics::Node& n = tree().node(i);
        const int turns = n.joint.attitude(), moves = turns >= 0 ? turns : n.joint.positions();
        for (int k = 0; k < moves; ++k) {
            const double way = to[at(n.q + k)] - from[at(n.q + k)];
            sum += way * way;
        }
        if (turns < 0) continue;
        const Quaternion p = attitude(to, i) * conjugate(attitude(from, i));
        const double angle = 2.0 * std::atan2(Vector3(p.x, p.y, p.z).norm(), std::abs(p.w));
        sum += angle * angle;
    }
    return std::sqrt(sum);
}

RBDYN_INLINE std::vector<double> TreeForces::difference(const std::vector<double>& to,
                                                        const std::vector<double>& from) const {
    std::vector<double> v(at(tree().velocities()), 0.0);
    for (int i = 0; i < bodies(); ++i) {
        const mechanics::Node& n = tree().node(i);
        const int turns = n.joint.attitude(), moves = turns >= 0 ? turns : n.joint.velocities();
        for (int k = 0; k < moves; ++k) v[at(n.v + k)] = to[at(n.q + k)] - from[at(n.q + k)];
        if (turns < 0) continue;
        Quaternion p = attitude(to, i) * conjugate(attitude(from, i));
        if (p.w < 0.0) p = {-p.w, -p.x, -p.y, -p.z};
        for (int k = 0; k < 3; ++k) v[at(n.v + turns + k)] = 2.0 * Vector3(p.x, p.y, p.z)[k];
    }
    std::vector<double> d;
    for (const int k : leading_) d.push_back(v[at(k)]);
    return d;
}

}  // namespace rbdyn::inline RBDYN_FORM::statics
