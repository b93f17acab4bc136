// Definitions of rbdyn/special/particle_law.hpp.
#pragma once

#include "rbdyn/special/particle_law.hpp"

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/double_double_vector.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/expression/expression.hpp"
#include "rbdyn/model/equations.hpp"
#include "rbdyn/model/state_map.hpp"
#include "rbdyn/scene/scene.hpp"
#include "rbdyn/scene/watch.hpp"
#include "rbdyn/special/body_form.hpp"
#include "rbdyn/special/laws_now.hpp"
#include "rbdyn/special/words.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE std::unique_ptr<SingleLaw> ParticleLaw::copy() const { return std::make_unique<ParticleLaw>(*this); }

RBDYN_INLINE void ParticleLaw::take_start(const Scene::Body& b) {
    start_position_ = b.position;
    start_velocity_ = b.velocity;
}

RBDYN_INLINE std::vector<VariableGroup> ParticleLaw::groups(bool of_positions) const {
    return {{0, 3, of_positions, 0.0, of_positions ? Alike::place : Alike::velocity}};
}

RBDYN_INLINE void ParticleLaw::start(double /*t*/, DoubleDouble* q, DoubleDouble* v) const {
    const Vector3Of<DoubleDouble> r = view_.seen_point(start_position_), u = view_.seen_exactly(start_velocity_);
    for (int i = 0; i < 3; ++i) {
        q[i] = r[i];
        v[i] = u[i];
    }
}

RBDYN_INLINE void ParticleLaw::add_state(SingleStates<double>& states, double /*t*/, const double* q, const double* v,
                                         signed char /*phase*/) const {
    states.add<SingleState<double>>(Vector3(q[0], q[1], q[2]), Vector3(v[0], v[1], v[2]));
}

RBDYN_INLINE void ParticleLaw::add_state(SingleStates<S>& states, const S& /*t*/, const S* q, const S* v,
                                         signed char /*phase*/) const {
    states.add<SingleState<S>>(Vector3Of<S>(q[0], q[1], q[2]), Vector3Of<S>(v[0], v[1], v[2]));
}

RBDYN_INLINE void ParticleLaw::lay_down(RecordedBody& present, const CouplingForces<S>& coupled, S* q_rate,
                                        S* v_rate) const {
    present.force = forces_in_space<S>(coupled.time(), *present.state);
    add_couplings<S>(present.force, coupled);
    lay_down_in_space(present, q_rate, v_rate);
}

RBDYN_INLINE PointReport ParticleLaw::report(const LawsNow& now) const {
    const SingleState<double>& p = now.state(index);
    Applied f;
    if (now.acting != nullptr) {
        f = applied_in_mode(now);
    } else {
        f.own = f.all = forces_in_space<double>(now.t, p);
        add_couplings<double>(f.all, now.couplings);
    }
    PointReport r = report_in_space(f, p);
    r.speed = p.v.norm();
    return r;
}

RBDYN_INLINE void ParticleLaw::slope(const LawsNow& now, std::span<double> dq, std::span<double> dv) const {
    slope_in_space(now, dq.data(), dv.data());
}

RBDYN_INLINE std::optional<double> ParticleLaw::change(const StateChange& c, const LawsNow& /*now*/,
                                                       const std::string& user, std::span<double> x) const {
    require_words(c, user, name);
    put_in_space(c, user, x.data() + first, x.data() + first_rate);
    return std::nullopt;
}

RBDYN_INLINE std::unique_ptr<const BodyForm> ParticleLaw::closed_form(const Scene& scene,
                                                                      const Vector3Of<DoubleDouble>& a) const {
    const Scene::Body& b = scene.bodies()[static_cast<std::size_t>(index)];
    return closed_forms::made<closed_forms::SlidingForm>(
        closed_forms::Accelerated(widened(b.position), widened(b.velocity), a), 3);
}

RBDYN_INLINE std::string ParticleLaw::coordinates(const StateMap& map) const {
    return planning::listed(planning::Named(map, first, planning::places).in) + " in the world";
}

RBDYN_INLINE void ParticleLaw::leave_out(const StateMap& map, std::vector<Omission>& omissions) const {
    planning::leave_out_places(*this, map, omissions);
}

RBDYN_INLINE std::string ParticleLaw::not_finite(const LawsNow& now) const {
    if (std::string what = load_not_finite(now); !what.empty()) return what;
    return acceleration_not_finite(now);
}

}  // namespace rbdyn::inline RBDYN_FORM
