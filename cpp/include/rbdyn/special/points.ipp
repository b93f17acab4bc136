// Definitions of rbdyn/special/points.hpp.
#pragma once

#include "rbdyn/special/points.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "rbdyn/basics/direction.hpp"
#include "rbdyn/basics/error.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/curve/curve.hpp"
#include "rbdyn/curve/point.hpp"
#include "rbdyn/curve/regular_stretch.hpp"
#include "rbdyn/expression/evaluate.hpp"
#include "rbdyn/expression/numbers.hpp"
#include "rbdyn/expression/program.hpp"
#include "rbdyn/expression/rounding_sizes.hpp"
#include "rbdyn/expression/time_function.hpp"
#include "rbdyn/model/acting.hpp"
#include "rbdyn/model/equations.hpp"
#include "rbdyn/model/equations_writer.hpp"
#include "rbdyn/model/hybrid.hpp"
#include "rbdyn/model/leading_sign.hpp"
#include "rbdyn/model/rail_landing.hpp"
#include "rbdyn/model/recorded_model.hpp"
#include "rbdyn/model/rigid_state.hpp"
#include "rbdyn/model/state_map.hpp"
#include "rbdyn/model/within.hpp"
#include "rbdyn/rotation/euler_angles.hpp"
#include "rbdyn/rotation/euler_path.hpp"
#include "rbdyn/rotation/quaternion.hpp"
#include "rbdyn/scene/couplings.hpp"
#include "rbdyn/scene/handles.hpp"
#include "rbdyn/scene/joints.hpp"
#include "rbdyn/scene/loads.hpp"
#include "rbdyn/scene/scene.hpp"
#include "rbdyn/scene/watch.hpp"
#include "rbdyn/series/piece.hpp"
#include "rbdyn/special/point_equations.hpp"
#include "rbdyn/special/point_laws.hpp"
#include "rbdyn/special/point_observables.hpp"
#include "rbdyn/special/point_state.hpp"
#include "rbdyn/special/points_now.hpp"
#include "rbdyn/special/rigid_change.hpp"
#include "rbdyn/special/rigid_law.hpp"
#include "rbdyn/special/rigid_loads.hpp"
#include "rbdyn/special/what_stays.hpp"
#include "rbdyn/special/words.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE PointsModel::PointsModel(const Scene& scene, const Placement& view, bool leaves_out,
                                      const GivenNumbers& numbers)
    : SceneModel(numbers), watches_(scene.watches()) {
    if (std::any_of(watches_.begin(), watches_.end(),
                    [](const Scene::Watch& w) { return !w.function.is_recorded() || w.options.action.change; }))
        asked_ = std::make_shared<const Scene>(scene);
    const auto laws = std::make_shared<PointLaws>(scene, view);
    laws_ = laws;
    if (!leaves_out) return;
    auto [stays, why_none] = staying_in(*laws);
    why_all_ = std::move(why_none);
    laws->leave_out(stays);
    if (laws->map().size() > 0) return;
    // where something may happen all the same there have to be time steps, and so a state
    if (record_points(laws_, watches_, undecided().slip, {})->still) return;
    why_all_ = nothing_moves;
    laws->leave_out(std::vector<bool>(stays.size(), false));
}

RBDYN_INLINE Staying PointsModel::staying_in(const PointLaws& laws) const {
    for (const Scene::Watch& w : watches_)
        if (w.options.action.kind == WatchAction::Kind::change)
            return {std::vector<bool>(at(laws.variables()), false),
                    "the action of \"" + w.name + "\" may change any of them"};
    return what_stays(laws);
}

RBDYN_INLINE PointsModel::PointsModel(const PointsModel& planned, const Scene& scene, const GivenNumbers& numbers,
                                      std::shared_ptr<PointLaws> elsewhere)
    : SceneModel(planned, numbers, elsewhere != nullptr),
      watches_(scene.watches()),
      asked_(planned.asked_),
      why_all_(planned.why_all_) {
    if (elsewhere != nullptr) {
        laws_ = std::move(elsewhere);
        return;
    }
    const auto laws = std::make_shared<PointLaws>(planned.laws());
    laws->take_functions(scene);
    laws_ = laws;
}

RBDYN_INLINE std::string PointsModel::coordinates(int body) const { return planning::coordinates_of(*laws_, body); }

RBDYN_INLINE std::vector<Omission> PointsModel::left_out(int body) const {
    std::vector<Omission> omissions;
    if (why_all_.empty()) planning::leave_out_body(*laws_, body, omissions);
    return omissions;
}

RBDYN_INLINE std::vector<std::string> PointsModel::guards() const { return planning::guards_of(*this); }

RBDYN_INLINE bool PointsModel::guards_depend_on_start() const {
    return std::ranges::any_of(laws_->bodies(), [](const PointLaws::Body& b) { return b.one_side.has_value(); });
}

RBDYN_INLINE int PointsModel::variables() const { return laws_->map().size(); }

RBDYN_INLINE bool PointsModel::holds_what_touches(int subject) const {
    const auto& b = laws_->body(subject);
    // what differs by rounding is meant to be equal
    return b.mu_static - b.mu_dynamic > 64.0 * std::numeric_limits<double>::epsilon() * b.mu_static;
}

RBDYN_INLINE const Equations& PointsModel::equations(const std::vector<signed char>& slip, double t) const {
    const std::vector<double> x = start(t);
    Mode mode;
    mode.slip = slip;
    return structure(mode, t, x, {})->equations;
}

RBDYN_INLINE std::vector<double> PointsModel::start(double t) const {
    std::vector<double> x(at(variables()));
    laws_->map().gather(laws_->start(t), x);
    return x;
}

RBDYN_INLINE std::vector<double> PointsModel::start_rest() const {
    const std::vector<double> rest = laws_->start_rest();
    if (rest.empty()) return rest;
    std::vector<double> x(at(variables()));
    laws_->map().gather(rest, x);
    return x;
}

RBDYN_INLINE std::optional<Acting> PointsModel::acting(const Mode& mode, double t, std::span<const double> x) const {
    return acting_in(mode, bodies(), static_cast<int>(laws_->couplings().size()), t, x);
}

RBDYN_INLINE PointReport PointsModel::report(const Mode& mode, int body, double t, std::span<const double> x) const {
    const Within state(mode, t, x, Within::unseen);
    const std::optional<Acting> now = acting(mode, t, x);
    return laws_->report(body, PointsNow(*laws_, mode.slip, state.t, state.x, now ? &*now : nullptr));
}

RBDYN_INLINE RigidReport PointsModel::rigid_report(const Mode& mode, int body, double t,
                                                   std::span<const double> x) const {
    const Within state(mode, t, x, Within::unseen);
    const std::optional<Acting> now = acting(mode, t, x);
    return laws_->rigid_report(body, PointsNow(*laws_, mode.slip, state.t, state.x, now ? &*now : nullptr));
}

RBDYN_INLINE std::vector<double> PointsModel::with_unit_attitudes(std::span<const double> x) const {
    std::vector<double> result(x.begin(), x.end());
    for (const PointLaws::Body& b : laws_->bodies()) {
        if (!b.rigid || !b.rigid->turns_freely()) continue;
        const int first = b.first + b.rigid->first_of_attitude();
        double square = 0.0;
        for (int k = 0; k < 4; ++k) square += std::pow(laws_->map().value(first + k, x), 2);
        for (int k = 0; k < 4; ++k)
            if (laws_->map().is_simulated(first + k)) variable(result, first + k) /= std::sqrt(square);
    }
    return result;
}

RBDYN_INLINE SystemReport PointsModel::system_report(const Mode& mode, double t, std::span<const double> x,
                                                     Asked asked) const {
    const std::vector<double> exact = with_unit_attitudes(x);
    const Within state(mode, t, exact, Within::unseen);
    const std::optional<Acting> acts = asked == Asked::forces ? acting(mode, t, exact) : std::nullopt;
    const PointsNow now(*laws_, mode.slip, state.t, state.x, acts ? &*acts : nullptr);
    SystemReport result;
    result.bodies.reserve(at(bodies()));
    for (int i = 0; i < bodies(); ++i) result.bodies.push_back(now.body(i, asked));
    const auto place = [&](const PointLaws::CouplingEnd& e) {
        return laws_->in_world<double>(PointLaws::motion_of<double>(e, now.states).first);
    };
    const int count = static_cast<int>(laws_->couplings().size());
    result.couplings.reserve(at(count));
    for (int k = 0; k < count; ++k) {
        const PointLaws::Connected& c = laws_->couplings()[at(k)];
        CouplingReport& r = result.couplings.emplace_back();
        r.a = c.a.body;
        r.b = c.b.body;
        r.place_a = place(c.a);
        r.place_b = place(c.b);
        if (asked == Asked::forces) r.force = laws_->view().axes * now.coupling_force(k);
    }
    return result;
}

RBDYN_INLINE Vector3 PointsModel::coupling_force(const Mode& mode, int coupling, double t,
                                                 std::span<const double> x) const {
    const Within state(mode, t, x, Within::unseen);
    const std::optional<Acting> now = acting(mode, t, x);
    return laws_->view().axes *
           PointsNow(*laws_, mode.slip, state.t, state.x, now ? &*now : nullptr).coupling_force(coupling);
}

RBDYN_INLINE double PointsModel::power(const Mode& mode, const Scene::AppliedLoad& load, int index, double t,
                                       std::span<const double> x) const {
    if (laws_->is_function(load, index))
        if (const std::optional<Acting> now = acting(mode, t, x)) return now->power(index);
    const Within state(mode, t, x, Within::unseen);
    return laws_->power(load, mode.slip, state.t, state.x);
}

RBDYN_INLINE double PointsModel::watched(const Mode& mode, int watch, double t, std::span<const double> x) const {
    if (mode.equations != nullptr)
        for (const Guard& guard : mode.equations->guards) {
            if (guard.watch != watch || guard.output < 0 || !guard.is_itself) continue;
            Evaluator<double> values(mode.equations->program);
            values.set_parameters(mode.parameters);
            values(t, x);
            return values.output(guard.output);
        }
    return called(watches_[at(watch)], mode, t, x);
}

RBDYN_INLINE double PointsModel::called(const Scene::Watch& watch, const Mode& mode, double t,
                                        std::span<const double> x) const {
    Observe observe = observing(mode, t, x);
    return watch.function(asked_ ? asked_->checked(std::move(observe), "watch " + watch.name) : std::move(observe));
}

RBDYN_INLINE Turning PointsModel::turning(int body, double, std::span<const double> x) const {
    const PointLaws::Body& b = laws_->body(body);
    const PointLaws::Variables own = laws_->variables_of(b, x);
    const RigidState<double> s = b.rigid->state(own.q, own.v);
    return {b.rigid->attitude(s), b.rigid->to_body(s, s.omega)};
}

RBDYN_INLINE std::vector<double> PointsModel::winding(double, std::span<const double> x) const {
    std::vector<double> all;
    for (int i = 0; i < bodies(); ++i) {
        if (!has_angles(i)) continue;
        const EulerAngles a = euler_path::begin(turning(i, 0.0, x), laws_->body(i).start_angles);
        all.insert(all.end(), {a.theta, a.psi, a.phi});
    }
    return all;
}

RBDYN_INLINE void PointsModel::wind(const Piece& piece, double length, std::vector<double>& all) const {
    auto next = all.begin();
    for (int i = 0; i < bodies(); ++i) {
        if (!has_angles(i)) continue;
        const EulerAngles a = wound(i, piece, {next[0], next[1], next[2]}, length);
        for (const double angle : {a.theta, a.psi, a.phi}) *next++ = angle;
    }
}

RBDYN_INLINE int PointsModel::place_of_angles(int body) const {
    int place = 0;
    for (int i = 0; i < body; ++i) place += has_angles(i);
    return has_angles(body) ? place : -1;
}

RBDYN_INLINE EulerAngles PointsModel::wound(int body, const Piece& piece, const EulerAngles& before, double tau) const {
    std::vector<double> x(at(variables()));
    const auto motion = [&](double time) {
        piece.state(std::clamp(time / piece.unit, 0.0, tau), x);
        return turning(body, time, x);
    };
    const Turning first = motion(0.0);
    const double time = tau * piece.unit;
    const EulerStep last =
        euler_path::follow({0.0, first, continue_from(before, first.attitude)}, time, motion, [](const EulerStep&) {});
    return continue_from(last.angles, motion(time).attitude);
}

RBDYN_INLINE int PointsModel::freedom() const {
    int sum = 0;
    for (const PointLaws::Body& b : laws_->bodies()) sum += b.curve ? 1 : b.velocities();
    return sum;
}

RBDYN_INLINE std::shared_ptr<const SceneModel> PointsModel::with_numbers(const Scene& scene,
                                                                         const GivenNumbers& numbers) const {
    return std::make_shared<const PointsModel>(*this, scene, numbers);
}

RBDYN_INLINE std::shared_ptr<const SceneModel> PointsModel::started_elsewhere(const Scene& scene,
                                                                              const GivenNumbers& numbers) const {
    if (why_all_ == nothing_moves) return nullptr;
    const auto laws = std::make_shared<PointLaws>(*laws_);
    laws->take_functions(scene);
    laws->take_starts(scene);
    // what the equations have of a start: what stays, and the plane of a rail that only pushes
    for (int i = 0; i < bodies(); ++i)
        if (!(laws->body(i).binormal == laws_->body(i).binormal)) return nullptr;
    const StateMap& before = laws_->map();
    const std::vector<DoubleDouble> start = laws->exact_start();
    for (int i = 0; i < before.variables(); ++i) {
        const DoubleDouble was = before.exact_start(i), is = start[at(i)];
        const double rest = std::isfinite(is.lo) ? is.lo : 0.0;
        if (!before.is_simulated(i) && !(same_bits(was.hi, is.hi) && was.lo == rest)) return nullptr;
    }
    const Staying now = staying_in(*laws);
    if (now.unknown != why_all_) return nullptr;
    for (int i = 0; i < before.variables(); ++i)
        if (now.variables[at(i)] == before.is_simulated(i)) return nullptr;
    laws->leave_out(now.variables);
    return std::make_shared<const PointsModel>(*this, scene, numbers, laws);
}

RBDYN_INLINE JointReport PointsModel::joint(const Mode& mode, int body, double t, std::span<const double> x) const {
    const RigidReport r = rigid_report(mode, body, t, x);
    return {{r.coordinate}, {r.rate}};
}

RBDYN_INLINE Matrix3 PointsModel::rail_turn(int body, double t, std::span<const double>) const {
    return laws_->rail_turn(body, t);
}

RBDYN_INLINE Vector3 PointsModel::center(const Mode& mode, int body, double t, std::span<const double> x) const {
    return laws_->view().origin + laws_->view().axes * laws_->states(t, x, mode.slip)[at(body)].r;
}

RBDYN_INLINE Vector3 PointsModel::position(const Mode& mode, int body, double t, std::span<const double> x) const {
    const PointLaws::Body& b = laws_->body(body);
    if (!b.rigid) return center(mode, body, t, x);
    const PointLaws::Variables own = laws_->variables_of(b, x);
    const RigidState<double> s = b.rigid->state(own.q, own.v);
    return s.position(b.rigid->origin_in_frame(s));
}

RBDYN_INLINE Observe PointsModel::observing(const Mode& mode, double t, std::span<const double> x) const {
    const auto state = std::make_shared<const Within>(mode, t, x, Within::unseen);
    const auto acts = std::make_shared<const std::optional<Acting>>(acting(mode, t, x));
    const auto now =
        std::make_shared<const PointsNow>(*laws_, mode.slip, state->t, state->x, *acts ? &**acts : nullptr);
    return [state, acts, now](const Observable& o) { return rbdyn::observed(*now, o); };
}

RBDYN_INLINE Mode PointsModel::undecided() const {
    Mode mode;
    mode.slip.assign(laws_->bodies().size(), 1);
    return mode;
}

RBDYN_INLINE Mode PointsModel::begin(double t, std::span<double> x) const {
    Mode mode = undecided();
    // what starts on the edge of a case is looked at from the side it leaves to
    choose(mode, t, x, {});
    for (int i = 0; i < bodies(); ++i) {
        const PointLaws::Body& b = laws_->body(i);
        if (!b.rough) continue;
        // the slip as the user gave it, so that a bead carried by its rail starts stuck
        mode.slip[at(i)] = slip_of(mode, i, b.start_speed, t, x);
    }
    mode.equations = nullptr;
    choose(mode, t, x, {});
    // what its rail would have to pull flies from the start, and what moves off its end
    for (int i = 0; i < bodies(); ++i) {
        let_go(mode, i, t, x);
        leave_end(mode, i, t, x);
    }
    return mode;
}

RBDYN_INLINE Mode PointsModel::next(const Mode& mode, std::span<const int> fired, double t, std::span<double> x,
                                    std::vector<Happening>& happenings) const {
    if (const int i = at_corner(mode, fired, x); i >= 0) {
        happenings.push_back({EventKind::singular, i, Direction::either, {}});
        return mode;
    }
    Mode after = mode;
    std::vector<int> flipped;
    bool is_new = false;
    // changes of the user's own come first
    for (int index : fired) {
        const Guard& guard = mode.equations->guards[at(index)];
        if (guard.kind != EventKind::watch) continue;
        happenings.push_back({EventKind::watch, -1, guard.direction, guard.name});
        change(after, watches_[at(guard.watch)], t, x);
        is_new = true;
        ++after.jumps;
    }
    for (int index : fired) {
        const Guard& guard = mode.equations->guards[at(index)];
        const int i = guard.subject;
        const double sign = guard.sign_parameter >= 0 ? mode.parameters[at(guard.sign_parameter)] : 1.0;
        const Direction direction = sign > 0.0 ? Direction::falling : Direction::rising;
        switch (guard.kind) {
            case EventKind::watch: break;
            case EventKind::reverse: {
                const signed char before = mode.slip[at(i)];
                after.slip[at(i)] = settle(after, i, t, x);
                if (after.slip[at(i)] == sticks)
                    happenings.push_back({EventKind::stick, i, direction, {}});
                else if (after.slip[at(i)] != before)
                    happenings.push_back({EventKind::reverse, i, direction, {}});
                break;
            }
            case EventKind::slip: {
                carry(mode, i, t, x);
                const signed char s = escape(mode, i, t, x, holding(mode, i, t, x));
                after.slip[at(i)] = s;
                happenings.push_back({EventKind::slip, i, s > 0 ? Direction::rising : Direction::falling, {}});
                break;
            }
            case EventKind::detach:
            case EventKind::rail_end:
                release(after, i, t, x);
                happenings.push_back({guard.kind, i, direction, {}});
                break;
            case EventKind::land: {
                const double impulse = land(after, i, t, x);
                ++after.jumps;
                happenings.push_back({EventKind::land, i, Direction::falling, {}, impulse});
                break;
            }
            default: {
                flipped.push_back(index);
                // a variable that switches is zero, exactly
                if (mode.equations->is_variable(guard)) x[at(mode.equations->program.output(guard.output))] = 0.0;
                if (guard.kind == EventKind::switching && guard.name.empty()) break;
                // where the reaction of a rail that only pushes vanishes the bead detaches, and that is said
                if (guard.kind == EventKind::normal_zero && laws_->body(i).side != RailSide::both) break;
                Happening h{guard.kind, i, guard.step > 0 ? Direction::rising : direction,
                            guard.kind == EventKind::switching ? guard.name : std::string()};
                // several distinctions of one function at one place are one event
                if (std::none_of(happenings.begin(), happenings.end(), [&](const Happening& other) {
                        return other.kind == h.kind && other.subject == h.subject && other.name == h.name;
                    }))
                    happenings.push_back(std::move(h));
                break;
            }
        }
    }
    choose(after, t, x, flipped, is_new);
    if (!flipped.empty() && follow_drives(mode, after, t, x, happenings)) {
        after.equations = mode.equations;
        after.parameters = mode.parameters;
        choose(after, t, x, flipped, is_new);
    }
    if (same_motion(mode, after, flipped))
        std::erase_if(happenings, [](const Happening& h) { return h.kind == EventKind::switching; });
    for (int index : fired) {
        const Guard& guard = mode.equations->guards[at(index)];
        if (guard.kind == EventKind::land && let_go(after, guard.subject, t, x))
            happenings.push_back({EventKind::detach, guard.subject, Direction::falling, {}});
    }
    return after;
}

RBDYN_INLINE Slope PointsModel::slope(const Mode& mode, double t, std::span<const double> x, std::span<double> slope,
                                      std::span<double> bend) const {
    const StateMap& map = laws_->map();
    std::vector<double> all(at(map.variables())), second(all.size(), 0.0);
    Slope result{.is_known = true};
    const PointsNow now(*laws_, mode.slip, t, x);
    for (int i = 0; i < bodies(); ++i) {
        const PointLaws::Body& b = laws_->body(i);
        double *q_rate = all.data() + b.first, *v_rate = all.data() + b.first_rate;
        laws_->slope(i, now, {q_rate, at(b.positions())}, {v_rate, at(b.velocities())});
        // coordinates in space bend as their velocities do; attitudes have coordinates of another kind
        const int attitude = b.rigid ? b.rigid->first_of_attitude() : -1;
        std::copy_n(v_rate, attitude < 0 ? b.positions() : attitude, second.begin() + b.first);
        double square = 0.0;
        for (int k = attitude; attitude >= 0 && k < b.positions(); ++k) square += q_rate[k] * q_rate[k];
        if (square > 0.0) result.pace = std::min(result.pace, 1.0 / std::sqrt(square));
    }
    for (double s : all)
        if (!std::isfinite(s)) return {};
    map.gather(all, slope);
    map.gather(second, bend);
    for (int i = 0; i < laws_->positions(); ++i) result.positions += map.is_simulated(i) ? 1 : 0;
    return result;
}

RBDYN_INLINE void PointsModel::observe(const Mode& mode, double t, std::span<const double> x,
                                       std::vector<Observed>& out) const {
    out.clear();
    const Within state(mode, t, x, Within::unseen);
    const std::optional<Acting> acts = acting(mode, t, x);
    const PointsNow now(*laws_, mode.slip, state.t, state.x, acts ? &*acts : nullptr);
    for (int i = 0; i < bodies(); ++i) {
        if (laws_->body(i).rigid) {
            observe_rigid(i, now, out);
            continue;
        }
        const PointReport r = laws_->report(i, now);
        double effort = r.effort;
        for (const int k : laws_->body(i).couplings) {
            const PointLaws::Connected& c = laws_->couplings()[at(k)];
            // what is left of the large terms of a spring is rounding, where it has hardly moved
            if (std::holds_alternative<Spring>(c.coupling))
                effort += effort_of(c.coupling, laws_->ends<double>(c, state.t, now.states), 0.0);
        }
        out.push_back({r.position, true, 0.0, r.position.norm(), Alike::place});
        out.push_back({r.velocity, false, std::abs(r.rail_speed), r.velocity.norm(), Alike::velocity,
                       effort / laws_->body(i).mass});
        if (on_rail(i)) out.push_back({r.reaction, false, 0.0, r.effort, Alike::force});
    }
}

RBDYN_INLINE double PointsModel::guard_value(const Guard& guard, const Mode& mode, double t,
                                             std::span<const double> x) const {
    return called(watches_[at(guard.watch)], mode, t, x);
}

RBDYN_INLINE std::string PointsModel::grown(const Mode& before, double t0, std::span<const double> x0, const Mode& mode,
                                            double t, std::span<const double> x) const {
    const PointsNow first_of_all(*laws_, before.slip, t0, x0), at_last(*laws_, mode.slip, t, x);
    const auto &was = first_of_all.states, &is = at_last.states;
    // no motion that goes on comes to this
    constexpr double beyond = 1e8;
    const auto size = [&](const Load& load, double time, const PointState<double>& p) {
        return force_of<double>(load, time, laws_->in_world<double>(p.r), laws_->view().axes * p.v).norm();
    };
    for (int i = 0; i < bodies(); ++i)
        for (const Load& load : laws_->body(i).functions) {
            const double first = size(load, t0, was[at(i)]), last = size(load, t, is[at(i)]);
            if (last > beyond * first && first > 0.0)
                return title_of(load) + " on " + laws_->body(i).name + ", which has grown from " + text(first) +
                       " to " + text(last) + " N";
        }
    for (int k = 0; k < static_cast<int>(laws_->couplings().size()); ++k) {
        if (!laws_->couplings()[at(k)].present()) continue;
        const double first = first_of_all.coupling_force(k).norm(), last = at_last.coupling_force(k).norm();
        if (last > beyond * first && first > 0.0)
            return title(k) + ", which has grown from " + text(first) + " to " + text(last) + " N: they meet";
    }
    return {};
}

RBDYN_INLINE std::string PointsModel::not_finite(const Mode& mode, double t, std::span<const double> x) const {
    for (const double value : x)
        if (!std::isfinite(value)) return "the state itself";
    const PointsNow now(*laws_, mode.slip, t, x);
    for (int i = 0; i < bodies(); ++i) {
        const PointLaws::Body& b = laws_->body(i);
        const PointState<double>& p = now.states[at(i)];
        if (!is_finite(p.r) || !is_finite(p.v))
            return "the curve or the motion of the rail of " + b.name +
                   (b.curve ? " at u = " + text(laws_->map().value(b.first, x)) : "");
        const Vector3 r = laws_->in_world<double>(p.r), v = laws_->view().axes * p.v;
        for (const auto& load : b.functions) {
            const Vector3 f = force_of<double>(load, t, r, v);
            if (is_finite(f)) continue;
            return title_of(load) + " on " + b.name + ", which is [" + text(f[0]) + ", " + text(f[1]) + ", " +
                   text(f[2]) + "]";
        }
        if (b.rigid) {
            for (const RigidLoad& load : b.loads) {
                Wrench<double> w;
                add_load(w, *b.rigid, *p.rigid, load, t, b.name);
                if (!is_finite(w.force) || !is_finite(w.moment)) return "a load on " + b.name;
            }
            for (const int k : b.couplings)
                if (const Vector3 f = now.coupling_force(k); !is_finite(f)) return title(k) + ", which is not finite";
            continue;
        }
        if (b.rough && !std::isfinite(b.drive(t))) return "the drive of the rail of " + b.name;
        if (b.curve && mode.slip[at(i)] != flies) {
            const double u = laws_->map().value(b.first, x);
            if (std::string what = singular_at(*b.curve, u); !what.empty())
                return "the rail of " + b.name + " at u = " + text(u) + ", where " + what;
        }
        for (const int k : b.couplings)
            if (const Vector3 f = now.coupling_force(k); !is_finite(f)) return title(k) + ", which is not finite";
        if (!is_finite(laws_->report(i, now).acceleration)) return "the acceleration of " + b.name;
    }
    for (int k = 0; k < static_cast<int>(laws_->couplings().size()); ++k) {
        const PointLaws::Connected& c = laws_->couplings()[at(k)];
        if (!c.present()) continue;
        if (const std::string why = without_direction(c.coupling, laws_->ends<double>(c, t, now.states)); !why.empty())
            return title(k) + ", " + why;
    }
    return {};
}

RBDYN_INLINE int PointsModel::at_corner(const Mode& mode, std::span<const int> fired, std::span<const double> x) const {
    const bool has_changed = std::any_of(fired.begin(), fired.end(), [&](int index) {
        return mode.equations->guards[at(index)].kind == EventKind::switching;
    });
    for (int i = 0; has_changed && i < bodies(); ++i) {
        const PointLaws::Body& b = laws_->body(i);
        if (!b.curve || mode.slip[at(i)] == flies || !laws_->map().is_simulated(b.first)) continue;
        if (b.curve->jumps_at(laws_->map().value(b.first, x))) return i;
    }
    return -1;
}

RBDYN_INLINE std::string PointsModel::title(int coupling) const {
    const PointLaws::Connected& c = laws_->couplings()[at(coupling)];
    const auto name = [&](const PointLaws::CouplingEnd& e) {
        return e.body >= 0 ? laws_->body(e.body).name : "a point of the world";
    };
    const OwnFunction* own = own_function(c.coupling);
    return "the " + std::string(rbdyn::kind_of(c.coupling)) + (own != nullptr ? " \"" + own->name() + "\"" : "") +
           " of " + name(c.a) + " and " + name(c.b);
}

RBDYN_INLINE void PointsModel::observe_rigid(int i, const PointsNow& now, std::vector<Observed>& out) const {
    const RigidLaw& law = *laws_->body(i).rigid;
    const RigidReport r = laws_->rigid_report(i, now);
    const PointState<double>& p = now.states[at(i)];
    if (law.kind == RigidLaw::Kind::free || law.kind == RigidLaw::Kind::prismatic) {
        out.push_back({p.r, true, 0.0, p.r.norm(), Alike::place});
        out.push_back({p.v, false, 0.0, p.v.norm(), Alike::velocity, r.force_effort / laws_->body(i).mass});
    }
    if (law.kind != RigidLaw::Kind::prismatic) {
        // axes of unit length: together they show the angle between two attitudes
        const Matrix3 axes = rotation_matrix(r.attitude);
        for (int k = 0; k < 3; ++k) out.push_back({column(axes, k), false, 1.0, 1.0});
        out.push_back({r.angular_velocity, false, 0.0, r.angular_velocity.norm(), Alike::turning});
    }
    if (law.kind == RigidLaw::Kind::free) return;
    out.push_back({r.reaction, false, 0.0, r.force_effort, Alike::force});
    if (law.kind != RigidLaw::Kind::spherical)
        out.push_back({r.reaction_torque, false, 0.0, r.torque_effort, Alike::torque});
}

RBDYN_INLINE signed char PointsModel::slip_of(const Mode& mode, int i, double speed, double t,
                                              std::span<double> x) const {
    const Drive drive = drive_of(mode, i, t, x);
    const double slip = speed - drive.speed;
    if (std::abs(slip) > 4.0 * epsilon * std::max(std::abs(speed), drive.size)) return slip > 0.0 ? 1 : -1;
    return settle(mode, i, t, x);
}

RBDYN_INLINE PointsModel::Drive PointsModel::drive_of(const Mode& mode, int i, double t,
                                                      std::span<const double> x) const {
    if (mode.equations == nullptr || mode.equations->drives < 0) {
        const double speed = laws_->body(i).drive(t);
        return {speed, std::abs(speed)};
    }
    RoundingSizes values(mode.equations->program);
    values.set_parameters(mode.parameters);
    values(t, x);
    return {values.output(mode.equations->drives + i), values.size(mode.equations->drives + i)};
}

RBDYN_INLINE bool PointsModel::follow_drives(const Mode& before, Mode& after, double t, std::span<double> x,
                                             std::vector<Happening>& happenings) const {
    bool has_changed = false;
    for (int i = 0; i < bodies(); ++i) {
        const PointLaws::Body& b = laws_->body(i);
        if (!b.rough || b.drive.is_constant() || before.slip[at(i)] == flies || after.slip[at(i)] == flies) continue;
        const Drive last = drive_of(before, i, t, x), next = drive_of(after, i, t, x);
        const double was = last.speed, is = next.speed;
        // what differs by the rounding of the time has a corner, no jump
        if (std::abs(is - was) <= 1e-10 * std::max(std::abs(is), std::abs(was))) continue;
        if (std::abs(is - was) <= 16.0 * epsilon * (last.size + next.size)) continue;
        const CurvePoint<double> c = laws_->curve_point(b, variable(x, b.first));
        const double speed = std::sqrt(c.speed_squared) * variable(x, b.first_rate);
        const signed char slip = slip_of(after, i, before.slip[at(i)] == sticks ? was : speed, t, x);
        if (slip == after.slip[at(i)]) continue;
        const EventKind kind = slip == sticks                ? EventKind::stick
                               : after.slip[at(i)] == sticks ? EventKind::slip
                                                             : EventKind::reverse;
        // a surface that speeds up leaves the bead behind
        happenings.push_back({kind, i, is > was ? Direction::falling : Direction::rising, {}});
        after.slip[at(i)] = slip;
        has_changed = true;
    }
    return has_changed;
}

RBDYN_INLINE void PointsModel::carry(const Mode& mode, int i, double t, std::span<double> x) const {
    const PointLaws::Body& b = laws_->body(i);
    const CurvePoint<double> c = laws_->curve_point(b, variable(x, b.first));
    variable(x, b.first_rate) = drive_of(mode, i, t, x).speed / std::sqrt(c.speed_squared);
}

RBDYN_INLINE Holding PointsModel::holding(const Mode& mode, int i, double t, std::span<const double> x) const {
    const Within state(mode, t, x);
    Holding h = laws_->holding(i, state.t, state.x, mode.slip);
    const double later = state.t + 16.0 * epsilon * std::abs(state.t);
    if (later == state.t) return h;
    const Holding then = laws_->holding(i, later, state.x, mode.slip);
    h.rounding += std::abs(then.tangential - h.tangential) + std::abs(then.across - h.across);
    return h;
}

RBDYN_INLINE signed char PointsModel::escape(const Mode& stuck, int i, double t, std::span<const double> x,
                                             const Holding& h) const {
    const bool is_zero = std::abs(h.tangential) <= h.rounding && stuck.equations->pulls >= 0;
    const double pull = is_zero ? leading_sign(stuck, t, x, stuck.equations->pulls + i) : h.tangential;
    return static_cast<signed char>(pull < 0.0 ? 1 : -1);
}

RBDYN_INLINE signed char PointsModel::settle(const Mode& mode, int i, double t, std::span<double> x) const {
    const PointLaws::Body& b = laws_->body(i);
    carry(mode, i, t, x);
    const Holding h = holding(mode, i, t, x);
    const double limit = b.mu_static * h.across, needed = std::abs(h.tangential),
                 near = 8.0 * epsilon * limit + h.rounding;
    if (needed > limit + near) return h.tangential < 0.0 ? 1 : -1;
    if (needed < limit - near) return sticks;
    // on the edge of the cone within rounding, that of the time included, or with neither load nor reaction: it holds
    // unless the next moment asks for more
    Mode stuck = mode;
    stuck.slip[at(i)] = sticks;
    choose(stuck, t, x, {});
    for (const Guard& guard : stuck.equations->guards)
        if (guard.kind == EventKind::slip && guard.subject == i)
            return leading_sign(stuck, t, x, guard.output) < 0 ? escape(stuck, i, t, x, h) : sticks;
    return sticks;
}

RBDYN_INLINE void PointsModel::release(Mode& mode, int i, double t, std::span<double> x) const {
    const PointLaws::Body& b = laws_->body(i);
    const PointState<double> p = laws_->states(t, x, mode.slip)[at(i)];
    for (int k = 0; k < 3; ++k) {
        variable(x, b.first_of_space() + k) = p.r[k];
        variable(x, b.first_of_velocity() + k) = p.v[k];
    }
    variable(x, b.first_rate) = 0.0;
    mode.slip[at(i)] = flies;
}

RBDYN_INLINE double PointsModel::land(Mode& mode, int i, double t, std::span<double> x) const {
    const PointLaws::Body& b = laws_->body(i);
    const int space = b.first_of_space(), velocity = b.first_of_velocity();
    const Vector3 r{variable(x, space), variable(x, space + 1), variable(x, space + 2)},
        v{variable(x, velocity), variable(x, velocity + 1), variable(x, velocity + 2)};
    variable(x, b.first) = laws_->landing(i)->place(r, variable(x, b.first));
    const CurvePoint<double> c = laws_->curve_point(b, variable(x, b.first));
    // along the normal: what rounding leaves along the rail is none
    const double along = dot<double>(c.first, v), rounding = 16.0 * epsilon * std::sqrt(c.speed_squared) * v.norm();
    double w = std::abs(along) > rounding ? along / c.speed_squared : 0.0;
    if (b.rough && b.mu_dynamic > 0.0) {
        // Coulomb's law of the impulses: against the slip after it, up to mu of that across the rail
        const double pace = std::sqrt(c.speed_squared), carried = drive_of(mode, i, t, x).speed,
                     slip = w * pace - carried, most = b.mu_dynamic * (v - c.first * w).norm();
        w = (std::abs(slip) <= most ? carried : w * pace - std::copysign(most, slip)) / pace;
    }
    variable(x, b.first_rate) = w;
    for (int k = 0; k < 3; ++k) variable(x, velocity + k) = 0.0;
    mode.slip[at(i)] = 1;
    if (b.rough) mode.slip[at(i)] = slip_of(mode, i, w * std::sqrt(c.speed_squared), t, x);
    return b.mass * (v - c.first * w).norm();
}

RBDYN_INLINE bool PointsModel::let_go(Mode& mode, int i, double t, std::span<double> x) const {
    if (laws_->body(i).side == RailSide::both || mode.slip[at(i)] == flies) return false;
    for (const Guard& guard : mode.equations->guards) {
        if (guard.kind != EventKind::detach || guard.subject != i) continue;
        Evaluator<double> values(mode.equations->program);
        values.set_parameters(mode.parameters);
        values(t, x);
        const double g = values.output(guard.output);
        const bool is_zero = std::abs(g) <= 8.0 * epsilon * values.magnitude(guard.output);
        if (is_zero ? leading_sign(mode, t, x, guard.output) >= 0 : g > 0.0) return false;
        release(mode, i, t, x);
        choose(mode, t, x, {});
        return true;
    }
    return false;
}

RBDYN_INLINE void PointsModel::leave_end(Mode& mode, int i, double t, std::span<double> x) const {
    if (!on_rail(i) || mode.slip[at(i)] == flies) return;
    for (const Guard& guard : mode.equations->guards) {
        if (guard.kind != EventKind::rail_end || guard.subject != i) continue;
        Evaluator<double> values(mode.equations->program);
        values.set_parameters(mode.parameters);
        values(t, x);
        if (std::abs(values.output(guard.output)) > 8.0 * epsilon * values.magnitude(guard.output) ||
            leading_sign(mode, t, x, guard.output) >= 0)
            continue;
        if (guard.role == GuardRole::stop)
            throw InvalidInput(laws_->body(i).name + ": parameter is " +
                               text(laws_->map().value(laws_->body(i).first, x)) +
                               ", an end of its rail, which it leaves at once; start it within the rail or moving "
                               "inward, or let it fly on with ends \"release\"");
        release(mode, i, t, x);
        return choose(mode, t, x, {});
    }
}

RBDYN_INLINE void PointsModel::change(Mode& mode, const Scene::Watch& watch, double t, std::span<double> x) const {
    const std::string user = "watch " + watch.name;
    for (const StateChange& c :
         watch.options.action.change(asked_->checked(observing(mode, t, x), user + ", its action"))) {
        const int i = c.body.index;
        require(i >= 0 && i < bodies(), user, "body", i, "its action changes bodies of this scene");
        const PointLaws::Body& b = laws_->body(i);
        if (b.rigid) {
            change_rigid(c, b, laws_->rigid_report(i, mode.slip, t, x), user, x);
            continue;
        }
        for (const std::string& word : c.words())
            if (word != "position" && word != "velocity" && word != "parameter" && word != "speed")
                throw InvalidInput(user + ": its action changes " + word + " of " + b.name +
                                   ", a particle; give position and velocity, three numbers each, or on a rail "
                                   "parameter and speed");
        const bool is_free = !b.curve || mode.slip[at(i)] == flies;
        if (is_free ? c.parameter || c.speed : c.position || c.velocity)
            throw InvalidInput(
                user + ": its action changes " +
                (is_free ? "parameter or speed of " + b.name + ", which is free; give position, velocity"
                         : "position or velocity of " + b.name + ", which is on a rail; give parameter, speed"));
        const auto set = [&](int index, double value) {
            require(std::isfinite(value), user, "a number its action gives", value, "a state is finite");
            x[at(index)] = value;
        };
        for (int k = 0; k < 3 && is_free; ++k) {
            if (c.position)
                set(b.first_of_space() + k, (laws_->view().axes.transpose() * (*c.position - laws_->view().origin))[k]);
            if (c.velocity) set(b.first_of_velocity() + k, (laws_->view().axes.transpose() * *c.velocity)[k]);
        }
        if (is_free) continue;
        const double before = std::sqrt(laws_->curve_point(b, x[at(b.first)]).speed_squared) * x[at(b.first_rate)];
        if (c.parameter) {
            const Domain domain = b.curve->domain();
            require(b.curve->closed() || (*c.parameter >= domain.begin && *c.parameter <= domain.end) ||
                        !std::isfinite(*c.parameter),
                    user, "parameter of " + b.name + " its action gives", *c.parameter,
                    "it lies in the domain of its curve, " + text(domain.begin) + " to " + text(domain.end));
            set(b.first, *c.parameter);
            b.curve->require_regular(*c.parameter);
        }
        const double speed = c.speed.value_or(before);
        set(b.first_rate, speed / std::sqrt(laws_->curve_point(b, x[at(b.first)]).speed_squared));
        if (b.rough) mode.slip[at(i)] = slip_of(mode, i, speed, t, x);
    }
}

RBDYN_INLINE std::vector<signed char> PointsModel::kind_of(const Mode& mode) const {
    std::vector<signed char> kind = mode.slip;
    for (int i = 0; i < bodies(); ++i)
        if (kind[at(i)] != flies && !(kind[at(i)] == sticks && laws_->body(i).rough)) kind[at(i)] = 1;
    return kind;
}

RBDYN_INLINE std::unique_ptr<Structure> PointsModel::record(const Mode& mode, const RecordedFor& state) const {
    return record_points(laws_, watches_, mode.slip, state);
}

RBDYN_INLINE std::unique_ptr<Structure> PointsModel::adapted(const Structure& recorded) const {
    const Equations& e = recorded.equations;
    const auto locator = [&](const Guard& guard) -> std::shared_ptr<const Locator> {
        if (guard.locator == nullptr) return nullptr;
        if (guard.kind == EventKind::land) return laws_->landing(guard.subject);
        if (guard.kind == EventKind::singular) return laws_->singularity(guard.subject);
        return laws_->singular_landing(guard.subject);
    };
    std::vector<VariableGroup> groups = groups_of(*laws_);
    const bool is_same = groups == e.groups && std::all_of(e.guards.begin(), e.guards.end(),
                                                           [&](const Guard& g) { return g.locator == locator(g); });
    if (is_same) return nullptr;
    auto result = std::make_unique<Structure>(recorded);
    result->equations.groups = std::move(groups);
    for (Guard& guard : result->equations.guards) guard.locator = locator(guard);
    return result;
}

RBDYN_INLINE void PointsModel::own_parameters(Mode& mode, std::span<const double> x) const {
    if (!laws_->takes_numbers()) return;
    for (int i = 0; i < bodies(); ++i) {
        mode.parameters[at(i)] = mode.slip[at(i)];
        mode.parameters[at(bodies() + i)] = laws_->map().value(laws_->body(i).fixed_variable(), x);
    }
}

}  // namespace rbdyn::inline RBDYN_FORM
