// Definitions of rbdyn/special/special_model.hpp.
#pragma once

#include "rbdyn/special/special_model.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "rbdyn/basics/error.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/expression/evaluate.hpp"
#include "rbdyn/expression/numbers.hpp"
#include "rbdyn/model/acting.hpp"
#include "rbdyn/model/equations.hpp"
#include "rbdyn/model/equations_writer.hpp"
#include "rbdyn/model/hybrid.hpp"
#include "rbdyn/model/observed.hpp"
#include "rbdyn/model/recorded_model.hpp"
#include "rbdyn/model/state_map.hpp"
#include "rbdyn/model/within.hpp"
#include "rbdyn/rotation/euler_angles.hpp"
#include "rbdyn/rotation/euler_path.hpp"
#include "rbdyn/scene/couplings.hpp"
#include "rbdyn/scene/scene.hpp"
#include "rbdyn/scene/watch.hpp"
#include "rbdyn/series/piece.hpp"
#include "rbdyn/special/bead_law.hpp"
#include "rbdyn/special/laws_now.hpp"
#include "rbdyn/special/rigid_law.hpp"
#include "rbdyn/special/single_law.hpp"
#include "rbdyn/special/single_laws.hpp"
#include "rbdyn/special/special_writer.hpp"
#include "rbdyn/special/what_stays.hpp"
#include "rbdyn/special/words.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE SpecialModel::SpecialModel(const Scene& scene, const Placement& view, bool leaves_out,
                                        const GivenNumbers& numbers)
    : SceneModel(numbers), watches_(scene.watches()) {
    if (std::any_of(watches_.begin(), watches_.end(),
                    [](const Scene::Watch& w) { return !w.function.is_recorded() || w.options.action.change; }))
        asked_ = std::make_shared<const Scene>(scene);
    const auto laws = std::make_shared<SingleLaws>(scene, view);
    laws_ = laws;
    if (!leaves_out) return;
    auto [stays, why_none] = staying_in(*laws);
    why_all_ = std::move(why_none);
    laws->leave_out(stays);
    if (laws->map().size() > 0) return;
    // where something may happen all the same there have to be time steps, and so a state
    if (record_special(laws_, watches_, undecided().slip, {})->still) return;
    why_all_ = nothing_moves;
    laws->leave_out(std::vector<bool>(stays.size(), false));
}

RBDYN_INLINE Staying SpecialModel::staying_in(const SingleLaws& laws) const {
    for (const Scene::Watch& w : watches_)
        if (w.options.action.kind == WatchAction::Kind::change)
            return {std::vector<bool>(at(laws.variables()), false),
                    "the action of \"" + w.name + "\" may change any of them"};
    return what_stays(laws);
}

RBDYN_INLINE SpecialModel::SpecialModel(const SpecialModel& planned, const Scene& scene, const GivenNumbers& numbers,
                                        std::shared_ptr<SingleLaws> elsewhere)
    : SceneModel(planned, numbers, elsewhere != nullptr),
      watches_(scene.watches()),
      asked_(planned.asked_),
      why_all_(planned.why_all_) {
    if (elsewhere != nullptr) {
        laws_ = std::move(elsewhere);
        return;
    }
    const auto laws = std::make_shared<SingleLaws>(planned.laws());
    laws->take_functions(scene);
    laws_ = laws;
}

RBDYN_INLINE SpecialModel::Moment::Moment(const SpecialModel& model, const Mode& mode, double t,
                                          std::span<const double> x, Asked asked)
    : state(mode, t, x, Within::unseen),
      acts(asked == Asked::forces ? model.acting(mode, t, x) : std::nullopt),
      now(model.laws(), mode.slip, state.t, state.x, acts ? &*acts : nullptr) {}

RBDYN_INLINE std::string SpecialModel::coordinates(int body) const {
    const SingleLaw& law = laws_->body(body);
    return law.moves(map()) ? law.coordinates(map()) : "none, it stays as it starts";
}

RBDYN_INLINE std::vector<Omission> SpecialModel::left_out(int body) const {
    if (!why_all_.empty()) return {};
    const SingleLaw& law = laws_->body(body);
    std::vector<Omission> omissions;
    if (law.moves(map()))
        law.leave_out(map(), omissions);
    else
        omissions.push_back(
            {"motion of " + law.name, std::string("it stays as it starts; ") + law.mover() + " brings it in"});
    return omissions;
}

RBDYN_INLINE std::vector<std::string> SpecialModel::guards() const { return planning::guards_of(*this); }

RBDYN_INLINE bool SpecialModel::guards_depend_on_start() const {
    return std::ranges::any_of(laws_->beads(), [&](int i) { return laws_->bead(i).only_pushes(); });
}

RBDYN_INLINE int SpecialModel::variables() const { return laws_->map().size(); }

RBDYN_INLINE bool SpecialModel::holds_what_touches(int subject) const {
    return laws_->body(subject).holds_what_touches();
}

RBDYN_INLINE const Equations& SpecialModel::equations(const std::vector<signed char>& slip, double t) const {
    const std::vector<double> x = start(t);
    Mode mode;
    mode.slip = slip;
    return structure(mode, t, x, {})->equations;
}

RBDYN_INLINE std::vector<double> SpecialModel::start(double t) const {
    std::vector<double> x(at(variables()));
    laws_->map().gather(laws_->start(t), x);
    return x;
}

RBDYN_INLINE std::vector<double> SpecialModel::start_rest() const {
    const std::vector<double> rest = laws_->start_rest();
    if (rest.empty()) return rest;
    std::vector<double> x(at(variables()));
    laws_->map().gather(rest, x);
    return x;
}

RBDYN_INLINE std::optional<Acting> SpecialModel::acting(const Mode& mode, double t, std::span<const double> x) const {
    return acting_in(mode, bodies(), static_cast<int>(laws_->couplings().size()), t, x);
}

RBDYN_INLINE PointReport SpecialModel::report(const Mode& mode, int body, double t, std::span<const double> x) const {
    return laws_->body(body).report(Moment(*this, mode, t, x).now);
}

RBDYN_INLINE RigidReport SpecialModel::rigid_report(const Mode& mode, int body, double t,
                                                    std::span<const double> x) const {
    return laws_->rigid(body).rigid_report(Moment(*this, mode, t, x).now);
}

RBDYN_INLINE std::vector<double> SpecialModel::with_unit_attitudes(std::span<const double> x) const {
    std::vector<double> result(x.begin(), x.end());
    for (int i = 0; i < bodies(); ++i) {
        if (!has_angles(i)) continue;
        const int first = laws_->body(i).first + laws_->body(i).first_of_attitude();
        double square = 0.0;
        for (int k = 0; k < 4; ++k) square += std::pow(laws_->map().value(first + k, x), 2);
        for (int k = 0; k < 4; ++k)
            if (laws_->map().is_simulated(first + k)) variable(result, first + k) /= std::sqrt(square);
    }
    return result;
}

RBDYN_INLINE SystemReport SpecialModel::system_report(const Mode& mode, double t, std::span<const double> x,
                                                      Asked asked) const {
    const std::vector<double> exact = with_unit_attitudes(x);
    const Moment moment(*this, mode, t, exact, asked);
    const LawsNow& now = moment.now;
    SystemReport result;
    result.bodies.reserve(at(bodies()));
    for (int i = 0; i < bodies(); ++i) result.bodies.push_back(now.body(i, asked));
    const auto place = [&](const SingleLaws::CouplingEnd& e) {
        return laws_->view().in_world<double>(SingleLaws::motion_of<double>(e, now.states).first);
    };
    const int count = static_cast<int>(laws_->couplings().size());
    result.couplings.reserve(at(count));
    for (int k = 0; k < count; ++k) {
        const SingleLaws::Connected& c = laws_->coupling(k);
        CouplingReport& r = result.couplings.emplace_back();
        r.a = c.a.body;
        r.b = c.b.body;
        r.place_a = place(c.a);
        r.place_b = place(c.b);
        if (asked == Asked::forces) r.force = laws_->view().axes * now.coupling_force(k);
    }
    return result;
}

RBDYN_INLINE Vector3 SpecialModel::coupling_force(const Mode& mode, int coupling, double t,
                                                  std::span<const double> x) const {
    return laws_->view().axes * Moment(*this, mode, t, x).now.coupling_force(coupling);
}

RBDYN_INLINE double SpecialModel::power(const Mode& mode, const Scene::AppliedLoad& load, int index, double t,
                                        std::span<const double> x) const {
    const SingleLaw& law = laws_->body(load.body);
    if (law.is_function(load, index))
        if (const std::optional<Acting> now = acting(mode, t, x)) return now->power(index);
    const Within state(mode, t, x, Within::unseen);
    return law.power(load, state.t, laws_->states(state.t, state.x, mode.slip)[at(load.body)]);
}

RBDYN_INLINE double SpecialModel::watched(const Mode& mode, int watch, double t, std::span<const double> x) const {
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

RBDYN_INLINE double SpecialModel::called(const Scene::Watch& watch, const Mode& mode, double t,
                                         std::span<const double> x) const {
    Observe observe = observing(mode, t, x);
    return watch.function(asked_ ? asked_->checked(std::move(observe), "watch " + watch.name) : std::move(observe));
}

RBDYN_INLINE Turning SpecialModel::turning(int body, double, std::span<const double> x) const {
    const SingleLaws::Variables own = laws_->variables_of(laws_->body(body), x);
    return laws_->rigid(body).turning(own.q, own.v);
}

RBDYN_INLINE std::vector<double> SpecialModel::winding(double, std::span<const double> x) const {
    std::vector<double> all;
    for (int i = 0; i < bodies(); ++i) {
        if (!has_angles(i)) continue;
        const EulerAngles a = euler_path::begin(turning(i, 0.0, x), laws_->rigid(i).start_angles());
        all.insert(all.end(), {a.theta, a.psi, a.phi});
    }
    return all;
}

RBDYN_INLINE void SpecialModel::wind(const Piece& piece, double length, std::vector<double>& all) const {
    auto next = all.begin();
    for (int i = 0; i < bodies(); ++i) {
        if (!has_angles(i)) continue;
        const EulerAngles a = wound(i, piece, {next[0], next[1], next[2]}, length);
        for (const double angle : {a.theta, a.psi, a.phi}) *next++ = angle;
    }
}

RBDYN_INLINE int SpecialModel::place_of_angles(int body) const {
    int place = 0;
    for (int i = 0; i < body; ++i) place += has_angles(i);
    return has_angles(body) ? place : -1;
}

RBDYN_INLINE EulerAngles SpecialModel::wound(int body, const Piece& piece, const EulerAngles& before,
                                             double tau) const {
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

RBDYN_INLINE int SpecialModel::freedom() const {
    int sum = 0;
    for (const auto& law : laws_->bodies()) sum += law->freedom();
    return sum;
}

RBDYN_INLINE std::shared_ptr<const SceneModel> SpecialModel::with_numbers(const Scene& scene,
                                                                          const GivenNumbers& numbers) const {
    return std::make_shared<const SpecialModel>(*this, scene, numbers);
}

RBDYN_INLINE std::shared_ptr<const SceneModel> SpecialModel::started_elsewhere(const Scene& scene,
                                                                               const GivenNumbers& numbers) const {
    if (why_all_ == nothing_moves) return nullptr;
    const auto laws = std::make_shared<SingleLaws>(*laws_);
    laws->take_functions(scene);
    laws->take_starts(scene);
    // what the equations have of a start: what stays, and the plane of a rail that only pushes
    for (const int i : laws->beads())
        if (!(laws->bead(i).binormal() == laws_->bead(i).binormal())) return nullptr;
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
    return std::make_shared<const SpecialModel>(*this, scene, numbers, laws);
}

RBDYN_INLINE JointReport SpecialModel::joint(const Mode& mode, int body, double t, std::span<const double> x) const {
    const RigidReport r = rigid_report(mode, body, t, x);
    return {{r.coordinate}, {r.rate}};
}

RBDYN_INLINE Matrix3 SpecialModel::rail_turn(int body, double t, std::span<const double>) const {
    return laws_->body(body).rail_turn(t);
}

RBDYN_INLINE Vector3 SpecialModel::center(const Mode& mode, int body, double t, std::span<const double> x) const {
    return laws_->view().origin + laws_->view().axes * laws_->states(t, x, mode.slip)[at(body)].r;
}

RBDYN_INLINE Vector3 SpecialModel::position(const Mode& mode, int body, double t, std::span<const double> x) const {
    const SingleLaw& law = laws_->body(body);
    const SingleLaws::Variables own = laws_->variables_of(law, x);
    SingleStates<double> state;
    law.add_state(state, t, own.q, own.v, mode.slip[at(body)]);
    return law.origin(state[0]);
}

RBDYN_INLINE Observe SpecialModel::observing(const Mode& mode, double t, std::span<const double> x) const {
    const auto moment = std::make_shared<const Moment>(*this, mode, t, x);
    return [moment](const Observable& o) { return moment->now.observed(o); };
}

RBDYN_INLINE Mode SpecialModel::undecided() const {
    Mode mode;
    mode.slip.assign(laws_->bodies().size(), 1);
    return mode;
}

RBDYN_INLINE Slope SpecialModel::slope(const Mode& mode, double t, std::span<const double> x, std::span<double> slope,
                                       std::span<double> bend) const {
    const StateMap& map = laws_->map();
    std::vector<double> all(at(map.variables())), second(all.size(), 0.0);
    Slope result{.is_known = true};
    const LawsNow now(*laws_, mode.slip, t, x);
    for (int i = 0; i < bodies(); ++i) {
        const SingleLaw& b = laws_->body(i);
        double *q_rate = all.data() + b.first, *v_rate = all.data() + b.first_rate;
        b.slope(now, {q_rate, at(b.positions())}, {v_rate, at(b.velocities())});
        // coordinates in space bend as their velocities do; attitudes have coordinates of another kind
        const int attitude = b.first_of_attitude();
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

RBDYN_INLINE void SpecialModel::observe(const Mode& mode, double t, std::span<const double> x,
                                        std::vector<Observed>& out) const {
    out.clear();
    const Moment moment(*this, mode, t, x);
    for (const auto& law : laws_->bodies()) {
        const std::size_t first = out.size();
        law->observe(moment.now, out);
        for (std::size_t k = first; k < out.size(); ++k) out[k].of = &law->name;
    }
}

RBDYN_INLINE double SpecialModel::guard_value(const Guard& guard, const Mode& mode, double t,
                                              std::span<const double> x) const {
    return called(watches_[at(guard.watch)], mode, t, x);
}

RBDYN_INLINE std::string SpecialModel::grown(const Mode& before, double t0, std::span<const double> x0,
                                             const Mode& mode, double t, std::span<const double> x) const {
    const LawsNow was(*laws_, before.slip, t0, x0), is(*laws_, mode.slip, t, x);
    // no motion that goes on comes to this
    constexpr double beyond = 1e8;
    for (const auto& law : laws_->bodies())
        if (std::string what = law->grown(was, is, beyond); !what.empty()) return what;
    for (int k = 0; k < static_cast<int>(laws_->couplings().size()); ++k) {
        if (!laws_->coupling(k).present()) continue;
        const double first = was.coupling_force(k).norm(), last = is.coupling_force(k).norm();
        if (last > beyond * first && first > 0.0)
            return laws_->title(k) + ", which has grown from " + text(first) + " to " + text(last) +
                   " N: they meet, or pass so near that doubles do not tell";
    }
    return {};
}

RBDYN_INLINE std::string SpecialModel::not_finite(const Mode& mode, double t, std::span<const double> x) const {
    for (const double value : x)
        if (!std::isfinite(value)) return "the state itself";
    const LawsNow now(*laws_, mode.slip, t, x);
    for (const auto& law : laws_->bodies())
        if (std::string what = law->not_finite(now); !what.empty()) return what;
    for (int k = 0; k < static_cast<int>(laws_->couplings().size()); ++k) {
        const SingleLaws::Connected& c = laws_->coupling(k);
        if (!c.present()) continue;
        if (const std::string why = without_direction(c.coupling, laws_->ends<double>(c, t, now.states)); !why.empty())
            return laws_->title(k) + ", " + why;
    }
    return {};
}

RBDYN_INLINE std::vector<signed char> SpecialModel::kind_of(const Mode& mode) const {
    std::vector<signed char> kind = mode.slip;
    for (const auto& law : laws_->bodies()) kind[at(law->index)] = law->kind(kind[at(law->index)]);
    return kind;
}

RBDYN_INLINE std::unique_ptr<Structure> SpecialModel::record(const Mode& mode, const RecordedFor& state) const {
    return record_special(laws_, watches_, mode.slip, state);
}

RBDYN_INLINE std::unique_ptr<Structure> SpecialModel::adapted(const Structure& recorded) const {
    const Equations& e = recorded.equations;
    const auto locator = [&](const Guard& guard) -> std::shared_ptr<const Locator> {
        return guard.locator == nullptr ? nullptr : laws_->bead(guard.subject).locator(guard.kind);
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

RBDYN_INLINE void SpecialModel::own_parameters(Mode& mode, std::span<const double> x) const {
    if (!laws_->takes_numbers()) return;
    for (int i = 0; i < bodies(); ++i) {
        mode.parameters[at(i)] = mode.slip[at(i)];
        mode.parameters[at(bodies() + i)] = laws_->map().value(laws_->body(i).fixed_variable(), x);
    }
}

}  // namespace rbdyn::inline RBDYN_FORM
