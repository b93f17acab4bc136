// Definitions of rbdyn/special/single_laws.hpp.
#pragma once

#include "rbdyn/special/single_laws.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/model/state_map.hpp"
#include "rbdyn/scene/couplings.hpp"
#include "rbdyn/scene/handles.hpp"
#include "rbdyn/scene/joints.hpp"
#include "rbdyn/scene/scene.hpp"
#include "rbdyn/special/ball_law.hpp"
#include "rbdyn/special/bead_law.hpp"
#include "rbdyn/special/free_law.hpp"
#include "rbdyn/special/hinge_law.hpp"
#include "rbdyn/special/particle_law.hpp"
#include "rbdyn/special/rigid_law.hpp"
#include "rbdyn/special/slide_law.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE SingleLaws::SingleLaws(const Scene& scene, const Placement& view) : view_{view} {
    for (int i = 0; i < static_cast<int>(scene.bodies().size()); ++i) {
        bodies_.push_back(law_of(scene, i));
        bodies_.back()->first = positions_;
        positions_ += bodies_.back()->positions();
    }
    variables_ = positions_;
    for (const auto& b : bodies_) {
        b->first_rate = variables_;
        variables_ += b->velocities();
    }
    take_starts(scene);
    for (const Scene::Connection& c : scene.connections()) couplings_.push_back({c.coupling, end(c.a), end(c.b)});
    take_functions(scene);
    leave_out(std::vector<bool>(at(variables_), false));
}

RBDYN_INLINE SingleLaws::SingleLaws(const SingleLaws& other)
    : view_(other.view_),
      beads_(other.beads_),
      couplings_(other.couplings_),
      map_(other.map_),
      positions_(other.positions_),
      variables_(other.variables_),
      loads_(other.loads_) {
    for (const auto& b : other.bodies_) bodies_.push_back(b->copy());
}

RBDYN_INLINE std::unique_ptr<SingleLaw> SingleLaws::law_of(const Scene& scene, int i) {
    const Scene::Body& b = scene.bodies()[at(i)];
    if (b.rail() != nullptr) {
        beads_.push_back(i);
        return std::make_unique<BeadLaw>(b, i, view_);
    }
    if (b.rigid() == nullptr) return std::make_unique<ParticleLaw>(b, i, view_);
    if (const Spherical* ball = std::get_if<Spherical>(&b.joint)) return std::make_unique<BallLaw>(scene, i, *ball);
    if (const Revolute* hinge = std::get_if<Revolute>(&b.joint)) return std::make_unique<HingeLaw>(scene, i, *hinge);
    if (const Prismatic* slide = std::get_if<Prismatic>(&b.joint)) return std::make_unique<SlideLaw>(scene, i, *slide);
    return std::make_unique<FreeLaw>(scene, i);
}

RBDYN_INLINE const BeadLaw& SingleLaws::bead(int i) const { return static_cast<const BeadLaw&>(body(i)); }

RBDYN_INLINE const RigidLaw& SingleLaws::rigid(int i) const { return static_cast<const RigidLaw&>(body(i)); }

RBDYN_INLINE void SingleLaws::take_starts(const Scene& scene) {
    for (const auto& b : bodies_) b->take_start(scene.bodies()[at(b->index)]);
}

RBDYN_INLINE void SingleLaws::take_functions(const Scene& scene) {
    loads_ = static_cast<int>(scene.loads().size());
    std::vector<std::vector<int>> own(bodies_.size());
    for (int k = 0; k < loads_; ++k) own[at(scene.loads()[at(k)].body)].push_back(k);
    for (const auto& b : bodies_) b->take_loads(scene, own[at(b->index)]);
    take_couplings(scene);
}

RBDYN_INLINE void SingleLaws::take_couplings(const Scene& scene) {
    for (const auto& b : bodies_) b->couplings.clear();
    for (std::size_t k = 0; k < couplings_.size(); ++k) {
        Connected& c = couplings_[k];
        c.coupling = scene.connections()[k].coupling;
        if (c.a.body >= 0 && c.b.body >= 0)
            c.masses = DoubleDouble(body(c.a.body).mass) * DoubleDouble(body(c.b.body).mass);
        if (!c.present()) continue;
        if (c.a.body >= 0) bodies_[at(c.a.body)]->couplings.push_back(static_cast<int>(k));
        if (c.b.body >= 0 && c.b.body != c.a.body) bodies_[at(c.b.body)]->couplings.push_back(static_cast<int>(k));
    }
}

RBDYN_INLINE void SingleLaws::leave_out(const std::vector<bool>& stays) {
    const std::vector<double> rest = start_rest();
    map_ = StateMap(start(), stays, rest);
    for (const auto& b : bodies_) b->take_map(map_);
}

RBDYN_INLINE SingleLaws::Variables SingleLaws::variables_of(const SingleLaw& b, std::span<const double> x) const {
    Variables own;
    for (int k = 0; k < b.positions(); ++k) own.q[k] = map_.value(b.first + k, x);
    for (int k = 0; k < b.velocities(); ++k) own.v[k] = map_.value(b.first_rate + k, x);
    return own;
}

RBDYN_INLINE std::vector<DoubleDouble> SingleLaws::exact_start(double t) const {
    std::vector<DoubleDouble> x(at(variables_), 0.0);
    for (const auto& b : bodies_) b->start(t, x.data() + b->first, x.data() + b->first_rate);
    return x;
}

RBDYN_INLINE std::vector<double> SingleLaws::start(double t) const {
    std::vector<double> x;
    for (const DoubleDouble& d : exact_start(t)) x.push_back(d.hi);
    return x;
}

RBDYN_INLINE std::vector<double> SingleLaws::start_rest(double t) const {
    std::vector<double> rest;
    for (const DoubleDouble& d : exact_start(t)) rest.push_back(std::isfinite(d.lo) ? d.lo : 0.0);
    const bool is_exact = std::all_of(rest.begin(), rest.end(), [](double r) { return r == 0.0; });
    return is_exact ? std::vector<double>() : rest;
}

RBDYN_INLINE SingleStates<double> SingleLaws::states(double t, std::span<const double> x,
                                                     std::span<const signed char> slip) const {
    SingleStates<double> result;
    result.reserve(bodies_.size());
    for (const auto& b : bodies_) {
        const Variables own = variables_of(*b, x);
        b->add_state(result, t, own.q, own.v, slip[at(b->index)]);
    }
    return result;
}

RBDYN_INLINE bool SingleLaws::takes_numbers() const {
    return std::any_of(bodies_.begin(), bodies_.end(), [&](const auto& b) { return b->takes_numbers(map_); });
}

RBDYN_INLINE std::string SingleLaws::title(int coupling_index) const {
    const Connected& c = coupling(coupling_index);
    const auto name = [&](const CouplingEnd& e) { return e.body >= 0 ? body(e.body).name : "a point of the world"; };
    const OwnFunction* own = own_function(c.coupling);
    return "the " + std::string(kind_of(c.coupling)) + (own != nullptr ? " \"" + own->name() + "\"" : "") + " of " +
           name(c.a) + " and " + name(c.b);
}

RBDYN_INLINE SingleLaws::CouplingEnd SingleLaws::end(const End& e) const {
    if (const Vector3* point = std::get_if<Vector3>(&e)) return {-1, view_.seen_point(*point)};
    const BodyPoint* point = std::get_if<BodyPoint>(&e);
    const int index = body_of(e);
    return {index, body(index).point(point != nullptr ? std::optional<Vector3>(point->point) : std::nullopt)};
}

}  // namespace rbdyn::inline RBDYN_FORM
