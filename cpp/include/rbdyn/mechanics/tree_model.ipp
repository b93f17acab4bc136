// Definitions of rbdyn/mechanics/tree_model.hpp.
#pragma once

#include "rbdyn/mechanics/tree_model.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <tuple>
#include <utility>
#include <variant>
#include <vector>

#include "rbdyn/basics/double_double_functions.hpp"
#include "rbdyn/basics/error.hpp"
#include "rbdyn/mechanics/closure.hpp"
#include "rbdyn/mechanics/level.hpp"
#include "rbdyn/mechanics/recorded_rows.hpp"
#include "rbdyn/mechanics/speed_rounding.hpp"
#include "rbdyn/mechanics/tree_writer.hpp"
#include "rbdyn/model/acting.hpp"
#include "rbdyn/model/observed.hpp"
#include "rbdyn/model/rail_singular.hpp"
#include "rbdyn/model/sliding.hpp"
#include "rbdyn/model/within.hpp"
#include "rbdyn/rotation/euler_path.hpp"
#include "rbdyn/scene/joints.hpp"

namespace rbdyn::inline RBDYN_FORM {

namespace tree_models {

/// What is left, by so much of its terms, of sums of forces or of velocities that are zero.
inline constexpr double rounding = 1e3 * std::numeric_limits<double>::epsilon();

/// A reaction without what it has along what a smooth joint lets go, where that is rounding: it transmits nothing
/// there. Of light bodies that are pressed hard that is far more than rounding of their own weight. `effort`: the sizes
/// of what the reaction is made of.
inline Wrench<double> across(const mechanics::JointTwists<double>& lets, Wrench<double> reaction,
                             const Wrench<double>& effort) {
    constexpr double nothing = 1e-9;
    std::array<Vector3, 6> moves, turns;
    std::size_t n_moves = 0, n_turns = 0;
    const auto take = [](Vector3 way, auto& ways, std::size_t& n, Vector3& part, double most) {
        for (std::size_t k = 0; k < n; ++k) way -= ways[k] * ways[k].dot(way);
        const double length = way.norm();
        if (!(length > 1e-6) || n == 3) return;
        ways[n] = way / length;
        const double along = ways[n].dot(part);
        if (std::abs(along) <= nothing * most) part -= ways[n] * along;
        ++n;
    };
    for (std::size_t k = 0; k < lets.size(); ++k) {
        const auto& one = lets[k];
        if (one.turn.isZero(0.0))
            take(one.move / safe_norm(one.move), moves, n_moves, reaction.force, effort.force.norm());
        else if (one.move.isZero(0.0))
            take(one.turn / safe_norm(one.turn), turns, n_turns, reaction.moment, effort.moment.norm());
    }
    return reaction;
}

}  // namespace tree_models
namespace mechanics {

/// A body and all that it carries, as if it were one, about the point P of that body.
struct Carried {
    double mass = 0.0, second = 0.0;  // the sum of m r^2
    Vector3 first = Vector3::Zero();  // that of m r, world axes

    void add(const Node& n, const Moving<double>& at) {
        const Vector3 center = at.to_world(rounded(n.center));
        const double m = static_cast<double>(n.mass);
        double turning = 0.0;
        for (int k = 0; k < 3 && !n.is_point; ++k) turning += static_cast<double>(n.body.inertia(k, k));
        add({m, 0.5 * turning, Vector3::Zero()}, center);
    }
    void add(const Carried& other, const Vector3& arm) {
        mass += other.mass;
        second += std::max(0.0, other.second + 2.0 * arm.dot(other.first) + other.mass * arm.squaredNorm());
        first += other.first + other.mass * arm;
    }
    /// No less than it has along a motion.
    double inertia(const Twist<double>& way) const {
        return 2.0 * (mass * way.move.squaredNorm() + second * way.turn.squaredNorm());
    }
};

}  // namespace mechanics

RBDYN_INLINE bool needs_tree(const Scene& scene) {
    if (!scene.constraints().empty() || !scene.contacts().empty()) return true;
    for (const Scene::AppliedLoad& l : scene.loads())
        if (std::holds_alternative<JointTorque>(l.load) || std::holds_alternative<JointForce>(l.load)) return true;
    const auto is_special = [](const Scene::Body& b) {
        if (b.parent >= 0 || friction_in(b.joint) || is_driven(b.joint)) return false;
        return std::holds_alternative<Revolute>(b.joint) || std::holds_alternative<Prismatic>(b.joint) ||
               std::holds_alternative<Free>(b.joint) || std::holds_alternative<Rail>(b.joint) ||
               std::holds_alternative<Spherical>(b.joint);
    };
    return !std::all_of(scene.bodies().begin(), scene.bodies().end(), is_special);
}

RBDYN_INLINE TreeModel::TreeModel(const Scene& scene, const GivenNumbers& numbers)
    : SceneModel(numbers),
      scene_(scene),
      tree_(std::make_shared<const mechanics::Tree>(scene)),
      exerted_(std::make_shared<const mechanics::Exerted>(scene, *tree_)),
      why_all_(!scene.contacts().empty()                        ? "what touches may move any way"
               : mechanics::rough_joints(scene, *tree_).empty() ? "bodies are joined to bodies"
                                                                : "bodies are joined, by joints with friction") {
    require_finite_drives(origin());
    const auto start = tree_->start(origin());
    const auto all =
        tree_->moving<DoubleDouble>(DoubleDouble(origin()), start.data(), start.data() + tree_->positions());
    joints_ = mechanics::rough_joints(scene, *tree_);
    auto conditions = std::make_shared<mechanics::Conditions>(scene, *tree_, all);
    std::vector<mechanics::Conditions::Rubbing> rubbing;
    for (const mechanics::RoughJoint& joint : joints_) rubbing.push_back({joint.body, joint.turns});
    conditions->take_joints(std::move(rubbing));
    conditions_ = std::move(conditions);
    const std::vector<double> x = mechanics::closing::nearest(start);
    const auto now = mechanics::closing::moving<double>(*tree_, origin(), x);
    const auto accelerate = mechanics::accelerate<double>(*tree_, now);
    // what carries others feels what these lack: they are looked at first; beside each what is carried, all in one
    std::vector<mechanics::Carried> carried(at(bodies()));
    for (int i = bodies() - 1; i >= 0; --i) {
        const mechanics::Node& n = tree_->node(i);
        mechanics::Carried& own = carried[at(i)];
        own.add(n, now[at(i)]);
        const int used = n.joint.rail() != nullptr ? 1 : n.joint.velocities();
        for (int k = 0; k < used; ++k)
            require(accelerate.mass(n.v + k) > 1e-28 * own.inertia(now[at(i)].joint[at(k)]), n.name,
                    "inertia along velocity " + std::to_string(k + 1) + " of " + std::to_string(n.joint.velocities()) +
                        " of its joint",
                    accelerate.mass(n.v + k),
                    "what a joint leaves free has inertia: of the body, or of those joined to it; hold it otherwise, "
                    "or give it a thickness");
        if (n.parent >= 0) carried[at(n.parent)].add(own, now[at(i)].place - now[at(n.parent)].place);
    }
    if (!conditions_->empty()) choose_rows();
    take_loose_rails();
    map_ = StateMap(TreeModel::start(origin()), std::vector<bool>(at(tree_->variables()), false));
}

RBDYN_INLINE std::vector<std::string> TreeModel::not_unique() const {
    std::vector<std::string> names = sharing_contacts();
    if (conditions_->all().empty()) return names;
    const auto loose = mechanics::dependences(
        *tree_, *conditions_, rows_, mechanics::closing::moving<double>(*tree_, origin(), TreeModel::start(origin())));
    for (const mechanics::Condition& c : conditions_->all()) {
        const auto is_in = [&](const std::vector<double>& one) {
            return std::any_of(one.begin() + c.first, one.begin() + c.first + c.rows(),
                               [](double part) { return std::abs(part) > 1e-9; });
        };
        // a row that is not used does what other rows do, or what joints do by themselves
        bool is_unused = false;
        for (int r = c.first; r < c.first + c.rows(); ++r)
            is_unused = is_unused || !std::binary_search(rows_.begin(), rows_.end(), r);
        if (is_unused || std::ranges::any_of(loose, is_in)) names.push_back(c.name);
    }
    return names;
}

RBDYN_INLINE std::shared_ptr<const SceneModel> TreeModel::with_numbers(const Scene& scene,
                                                                       const GivenNumbers& numbers) const {
    const auto model = std::make_shared<TreeModel>(scene, numbers);
    // what holds bodies together may depend on how they lie as they start
    if (model->rows_ == rows_ && model->has_choice_ == has_choice_ && model->conditions_->all() == conditions_->all())
        model->share(*this);
    return model;
}

RBDYN_INLINE std::shared_ptr<const SceneModel> TreeModel::started_elsewhere(const Scene& scene,
                                                                            const GivenNumbers& numbers) const {
    auto model = with_numbers(scene, numbers);
    return shares(*model) ? model : nullptr;
}

RBDYN_INLINE bool TreeModel::on_rail(int body) const { return tree_->node(body).joint.rail() != nullptr; }

RBDYN_INLINE std::vector<double> TreeModel::start(double t) const {
    return mechanics::closing::nearest(exact_start(t));
}

RBDYN_INLINE std::vector<double> TreeModel::start_rest() const {
    std::vector<double> rest;
    bool any = false;
    for (const DoubleDouble& value : exact_start(origin())) {
        rest.push_back(value.lo);
        any = any || value.lo != 0.0;
    }
    return any ? rest : std::vector<double>();
}

RBDYN_INLINE std::vector<mechanics::Moving<double>> TreeModel::moving(double t, std::span<const double> x) const {
    return tree_->moving<double>(t, x.data(), x.data() + tree_->positions());
}

RBDYN_INLINE mechanics::TreeState TreeModel::look(const Mode& mode, double t, std::span<const double> x) const {
    const Within state(mode, t, x, Within::unseen);
    std::optional<Acting> acting = acting_near_singular(mode, state.t, state.x);
    if (!acting) acting = acting_in(mode, 0, 0, state.t, state.x);
    if (!acting) return {*tree_in(mode), moving(mode, t, x)};
    const std::span<const double> values(acting->values);
    mechanics::TreeState result{*tree_in(mode),
                                *conditions_,
                                *exerted_,
                                rows_in(mode),
                                moving(mode, state.t, state.x),
                                values.subspan(at(variables()))};
    // what a hinge resists is known itself; of larger moments it would be what is left
    const auto said = values.last(mechanics::JointMemory::said * joints_.size());
    for (std::size_t i = 0; i < joints_.size(); ++i) {
        if (!joints_[i].turns) continue;
        const Vector3& axis = result.moving[at(joints_[i].body)].joint.front().turn;
        Vector3& moment = result.bodies[at(joints_[i].body)].reaction.moment;
        moment += axis * (said[mechanics::JointMemory::said * i] - axis.dot(moment));
    }
    return result;
}

RBDYN_INLINE std::vector<std::string> TreeModel::guards() const {
    std::vector<std::string> lines;
    std::set<std::string> known;
    std::vector<double> x = start(origin());
    const Mode first = begin(origin(), x);
    // where no motion begins nothing is guarded
    if (first.equations == nullptr) return lines;
    for (const Guard& guard : first.equations->guards) {
        const bool is_end = guard.kind == EventKind::rail_end && guard.subject >= 0;
        // what goes over from one formula to another without an event, and what ends a motion
        if (guard.name.empty() && !is_end) continue;
        const bool is_loop = guard.kind == EventKind::singular && guard.contact < 0;
        std::string line = (is_loop && guard.least < 0.0   ? "rank of " + guard.name + " (singular)"
                            : is_loop                      ? guard.name + ", where no motion goes on"
                            : guard.is_watched()           ? "\"" + guard.name + "\" (watch)"
                            : is_end && guard.name.empty() ? "end of the rail of " + name(guard.subject)
                                                           : guard.name + " through zero (switch)");
        if (known.insert(line).second) lines.push_back(std::move(line));
    }
    return lines;
}

RBDYN_INLINE Mode TreeModel::undecided() const {
    Mode mode;
    mode.slip.assign(at(contacts()), flies);
    mode.slip.resize(at(first_joint()), flies);
    mode.slip.resize(at(first_joint()) + joints_.size(), mechanics::joint_state::open);
    mode.slip.resize(at(first_loose()) + loose_.size(), 1);
    if (contacts() > 0) mode.slip.push_back(0);
    if (has_choice_) {
        mode.slip.resize(place_of_rows() + at(conditions_->constraint_rows()) + 2, 0);
        for (const int r : rows_) mode.slip[place_of_rows() + at(r)] = 1;
    }
    mode.memory.assign(place_of_joint(static_cast<int>(joints_.size())), 0.0);
    mode.memory[0] = -std::numeric_limits<double>::infinity();
    return mode;
}

RBDYN_INLINE Mode TreeModel::begin(double t, std::span<double> x) const {
    require_finite_drives(t);
    std::vector<Happening> silent;
    Mode mode = decided_anew(undecided(), {}, t, x, silent);
    if (mode.impossible.empty()) require_no_end(mode, t, x);
    return mode;
}

RBDYN_INLINE Mode TreeModel::next(const Mode& mode, std::span<const int> fired, double t, std::span<double> x,
                                  std::vector<Happening>& happenings) const {
    std::vector<double> rest(x.size(), 0.0);
    return next_with_rest(mode, fired, t, x, rest, {}, happenings);
}

RBDYN_INLINE Mode TreeModel::next_with_rest(const Mode& mode, std::span<const int> fired, double t, std::span<double> x,
                                            std::span<double> rest, std::span<const double> largest,
                                            std::vector<Happening>& happenings) const {
    if (std::ranges::any_of(fired, [&](int g) { return mode.equations->guards[at(g)].contact >= 0; }))
        make_attitudes_unit(x, rest);
    const std::vector<double> reached(x.begin(), x.end());
    // what is set is short of nothing
    const auto forget = [&] {
        for (std::size_t i = 0; i < x.size(); ++i)
            if (x[i] != reached[i]) rest[i] = 0.0;
    };
    std::vector<int> flipped;
    bool touches = false, rubs = false, has_changed = false, is_loose = false, is_dependent = false;
    int jumps = mode.jumps;
    std::vector<double> was;
    for (const int index : fired) {
        const Guard& guard = mode.equations->guards[at(index)];
        if (guard.contact >= 0) {
            touches = true;
            continue;
        }
        if (guard.joint >= 0) {
            rubs = true;
            continue;
        }
        if (loosens(guard)) {
            is_loose = true;
            continue;
        }
        if (guard.kind == EventKind::singular && guard.output >= 0) {
            is_dependent = true;
            continue;
        }
        if (guard.kind == EventKind::singular) {
            Mode after = mode;
            after.impossible = opened(t, x);
            return after;
        }
        if (guard.kind == EventKind::watch) {
            if (was.empty()) was.assign(x.begin(), x.end());
            happenings.push_back({EventKind::watch, -1, guard.direction, guard.name});
            has_changed = change(mode, scene_.watches()[at(guard.watch)], t, x) || has_changed;
            ++jumps;
            continue;
        }
        flip(mode, index, true, x, flipped, happenings);
    }
    if (has_changed) {
        // whatever else happens there is decided with it
        Mode anew = decided_anew(mode, was, t, x, happenings);
        if (anew.impossible.empty()) anew.impossible = jump_of_drives(mode, anew, t, x);
        anew.jumps = jumps;
        forget();
        return anew;
    }
    Mode after = mode;
    after.jumps = jumps;
    leave_standing(after);
    if (is_dependent) {
        renew_rows(after, t, x);
        close_rows(after, t, x);
    }
    if (touches || (rubs && contacts() > 0)) {
        forget();
        touch(mode, after, fired, t, x, rest, largest, happenings);
        if (after.impossible.empty()) after.impossible = jump_of_drives(mode, after, t, x);
        return after;
    }
    if (is_loose) {
        if (!flipped.empty()) choose(after, t, x, flipped);
        leave_or_land(mode, after, fired, t, x, happenings);
        forget();
        if (after.impossible.empty()) after.impossible = jump_of_drives(mode, after, t, x);
        return after;
    }
    if (rubs) {
        if (!flipped.empty()) choose(after, t, x, flipped);
        rub(mode, after, fired, t, x, happenings);
        forget();
        if (after.impossible.empty()) after.impossible = jump_of_drives(mode, after, t, x);
        return after;
    }
    choose(after, t, x, flipped);
    if (const bool jumps_off = surfaces_jump(mode, after, t, x); jumps_off || joints_slip(after, t, x)) {
        const Mode passed = jumps_off ? mode : after;
        if (contacts() > 0)
            touch(passed, after, {}, t, x, rest, largest, happenings);
        else
            rub(passed, after, {}, t, x, happenings);
        forget();
        if (!after.impossible.empty()) return after;
    }
    forget();
    after.impossible = jump_of_drives(mode, after, t, x);
    if (after.impossible.empty() && pulls(after, t, x)) {
        touch(mode, after, {}, t, x, rest, largest, happenings);
        return after;
    }
    come_to_stand(after, t, x);
    if (same_motion(mode, after, flipped))
        std::erase_if(happenings, [](const Happening& h) { return h.kind == EventKind::switching; });
    return after;
}

RBDYN_INLINE void TreeModel::observe(const Mode& mode, double t, std::span<const double> x,
                                     std::vector<Observed>& out) const {
    out.clear();
    const mechanics::TreeState state = look(mode, t, x);
    const SlipParts slips(*this, mode, state);
    const auto body_held = [&](int which) { return !held_.empty() && held_[at(tree_->velocities() + which)]; };
    double fastest = 0.0;
    for (int i = 0; i < 2 * tree_->size(); ++i)
        if (body_held(i)) fastest = mechanics::fastest(state.moving, size_);
    const auto turn_held = [&](int i) {
        return size_ > 0.0 && body_held(i) ? static_cast<float>(fastest / size_) : 0.0F;
    };
    const auto place_held = [&](int i, double scale) {
        return body_held(tree_->size() + i) ? static_cast<float>(scale) : 0.0F;
    };
    std::vector<bool> touches(at(bodies()), false);
    std::vector<double> spans(at(bodies()), 0.0);  // of places that contacts hold: from how far [m]
    for (int k = 0; k < contacts(); ++k)
        for (const int body : {conditions_->contacts()[at(k)].a.body, conditions_->contacts()[at(k)].b.body}) {
            if (body < 0) continue;
            touches[at(body)] = true;
            if (mode.slip[at(k)] != flies) spans[at(body)] = std::max(spans[at(body)], size_of(k, state.moving));
        }
    // how quickly a body, or one that carries it, could begin to turn by the forces on it [rad/s]
    std::vector<double> paces(at(bodies()), 0.0);
    const double late = contacts() > 0 ? 16.0 * epsilon * (std::abs(t) + ahead()) : 0.0;
    std::vector<std::size_t> firsts;  // of what is seen of each body
    for (int i = 0; i < bodies(); ++i) {
        firsts.push_back(out.size());
        const mechanics::TreeState::Body& b = state.bodies[at(i)];
        const mechanics::Moving<double>& m = state.moving[at(i)];
        const mechanics::Node& n = tree_->node(i);
        const double mass = static_cast<double>(n.mass);
        double turned = 0.0;                   // what moves it with that pace [N m]
        double known = tree_models::rounding;  // what of that is rounding
        out.push_back({b.center, true, 0.0, b.center.norm(), Alike::place, place_held(i, size_)});
        out.back().from = spans[at(i)];
        out.push_back({b.velocity, false, 0.0, b.velocity.norm(), Alike::velocity, place_held(i, fastest),
                       mass > 0.0 ? b.effort.force.norm() / mass : 0.0});
        if (!n.is_point) {
            // what forces of this size would make of it: far below that it is rounding
            const double moments = b.inertia(0, 0) + b.inertia(1, 1) + b.inertia(2, 2),
                         gyration = mass > 0.0 ? std::sqrt(moments / mass) : 0.0,
                         natural = gyration > 0.0 ? std::sqrt(b.effort.force.norm() / (mass * gyration)) : 0.0;
            for (const Vector3* axis : {&m.axes.e1, &m.axes.e2, &m.axes.e3}) {
                out.push_back({*axis, false, 1.0, 1.0});
                // at contacts rounding turns what does not turn
                if (contacts() == 0) out.back().gyration = gyration;
            }
            // and so it is beside what contacts at this speed would: where it strikes, and nothing pushes afterwards
            const bool is_none = gyration > 0.0 && touches[at(i)] &&
                                 m.omega.norm() * gyration <= tree_models::rounding * b.velocity.norm();
            out.push_back({is_none ? Vector3(Vector3::Zero()) : m.omega, false, 0.0,
                           std::max(is_none ? 0.0 : m.omega.norm(), natural), Alike::turning, turn_held(i)});
            paces[at(i)] = std::max(n.parent < 0 ? 0.0 : paces[at(n.parent)], natural);
            turned = moments * paces[at(i)] * paces[at(i)];
            // places are known to how far they go in the rounding of the time
            if (gyration > 0.0) known += late * b.velocity.norm() / gyration;
        }
        const bool is_free = n.joint.as<mechanics::FreePointLaw>() != nullptr ||
                             n.joint.as<mechanics::FreeBodyLaw>() != nullptr || is_flying(mode, i);
        if (is_free || mode.equations == nullptr) continue;
        // what shares its load with contacts is one of many
        const double counts = !joints_.empty() && shares_load(mode) ? 0.0 : 1.0;
        const bool is_smooth = std::none_of(joints_.begin(), joints_.end(),
                                            [&](const mechanics::RoughJoint& joint) { return joint.body == i; });
        const Wrench<double> reaction = is_smooth ? tree_models::across(m.joint, b.reaction, b.effort) : b.reaction;
        const auto held = [&](const Vector3& value, double whole, Alike alike) {
            out.push_back({value * counts, false, 0.0, whole, alike});
            out.back().part = slips.on(i);
        };
        held(reaction.force, b.effort.force.norm(), Alike::force);
        if (n.is_point || n.joint.as<mechanics::SphericalLaw>() != nullptr) continue;
        Vector3 moment = reaction.moment;
        // the moment that turns it with what carries it, which does not turn but by rounding
        if (contacts() > 0 && moment.norm() <= known * turned) moment = Vector3::Zero();
        const auto rubs = std::find_if(joints_.begin(), joints_.end(), [&](const mechanics::RoughJoint& joint) {
            return joint.turns && joint.body == i;
        });
        if (rubs != joints_.end()) {
            // the friction of a pin may be far less than the moments across it, and is known by itself
            const Vector3 resists = m.joint.front().turn * m.joint.front().turn.dot(moment);
            moment -= resists;
            const signed char does = mode.slip[at(first_joint()) + static_cast<std::size_t>(rubs - joints_.begin())];
            const double most =
                mechanics::joint_state::resists(does)
                    ? rubs->coefficient(mechanics::joint_state::is_sliding(does)) * rubs->radius * b.effort.force.norm()
                    : b.effort.moment.norm();
            held(resists, most, Alike::torque);
        }
        held(moment, b.effort.moment.norm(), Alike::torque);
    }
    for (std::size_t k = 0, i = 0; k < out.size(); ++k) {
        while (i + 1 < firsts.size() && firsts[i + 1] <= k) ++i;
        out[k].of = &tree_->node(static_cast<int>(i)).name;
    }
    // a force is a difference of what acts on what it joins
    const auto effort = [&](const mechanics::Anchor& a, const mechanics::Anchor& b) {
        Wrench<double> most;
        for (const int i : {a.body, b.body}) {
            if (i < 0) continue;
            const Wrench<double>& own = state.bodies[at(i)].effort;
            if (own.force.norm() > most.force.norm()) most.force = own.force;
            if (own.moment.norm() > most.moment.norm()) most.moment = own.moment;
        }
        return most;
    };
    for (int k = 0; k < contacts(); ++k) {
        ContactReport c = state.contacts[at(k)];
        // a direction that turns is that of the slip, whose velocities are judged themselves
        if (mode.slip[at(k)] == mechanics::contact_state::turning ||
            mode.slip[at(k)] == mechanics::contact_state::brief)
            c.force = c.normal * c.normal.dot(c.force);
        // what is not unique is one of many
        if (shares_load(mode)) c.force = Vector3::Zero();
        const mechanics::ContactLaw& law = conditions_->contacts()[at(k)];
        double most = std::max(c.force.norm(), effort(law.a, law.b).force.norm());
        for (const int i : {law.a.body, law.b.body})
            if (i >= 0)
                most =
                    std::max(most, static_cast<double>(tree_->node(i).mass) *
                                       mechanics::speed_rounding(speed_of(k, state.moving), size_of(k, state.moving)));
        out.push_back({c.force, false, 0.0, most, Alike::force});
        out.back().part = slips.of_contact(k);
        out.back().of = &law.name;
        out.back().is_of_joint = false;
    }
    for (std::size_t k = 0; k < state.constraints.size(); ++k) {
        const ConstraintReport& c = state.constraints[k];
        const mechanics::Condition& law = conditions_->all()[k];
        const Wrench<double> most = effort(law.a, law.b);
        // what shares a load that is not unique is one of many
        const double counts = shares_load(mode) ? 0.0 : 1.0;
        for (const auto& [value, whole, alike] : {std::tuple(c.force, most.force.norm(), Alike::force),
                                                  std::tuple(c.torque, most.moment.norm(), Alike::torque)}) {
            out.push_back({value * counts, false, 0.0, std::max(value.norm(), whole), alike});
            out.back().part = slips.between(law.a.body, law.b.body);
            out.back().of = &law.name;
            out.back().is_of_joint = false;
        }
    }
}

RBDYN_INLINE bool TreeModel::holds_what_touches(int subject) const {
    return std::any_of(joints_.begin(), joints_.end(), [&](const mechanics::RoughJoint& joint) {
        return joint.body == subject && joint.mu_static.now() > joint.mu_dynamic.now();
    });
}

RBDYN_INLINE double TreeModel::guard_value(const Guard& guard, const Mode& mode, double t,
                                           std::span<const double> x) const {
    return called(scene_.watches()[at(guard.watch)], mode, t, x);
}

RBDYN_INLINE std::unique_ptr<Structure> TreeModel::record(const Mode& mode, const RecordedFor& state) const {
    const std::vector<int> rows = rows_in(mode);
    const recording::WideFolding all_digits;
    Recorder r;
    r.follow(state.t, state.x, {}, state.decided.forced, state.decided.sides);
    const mechanics::Tree& in_mode = *tree_in(mode);
    mechanics::TreeWriter tree(r, in_mode, *conditions_, *exerted_, joints_, rows,
                               {mode.slip.begin(), mode.slip.begin() + first_loose()});
    if (is_uneven_) tree.make_up();
    const int n = variables();
    const bool stands_still = holds_all(rows) || is_standing(mode);
    auto result = written(
        r, n, state.decided.sliding, [&] { return tree.laws(); },
        [&](EquationsWriter& write, std::span<const Expression> values) {
            // what stands still has no accelerations, not of rounding either, nor has what keeps to a plane across it
            std::vector<Expression> kept;
            if (stands_still || contacts() > 0) {
                kept.assign(values.begin(), values.end());
                values = kept;
            }
            if (stands_still) {
                std::fill_n(kept.begin(), n, Expression(0.0));
                for (int i = 0; i < bodies(); ++i) std::fill_n(kept.begin() + n + 12 * i + 6, 6, Expression(0.0));
            } else if (contacts() > 0) {
                mechanics::keep_level(
                    in_mode, mechanics::levels(in_mode, *conditions_, mode.slip), [&](int k) { return tree.turns(k); },
                    kept);
            }
            tree.take(values);
            for (int i = 0; i < n; ++i) write.rate(i) = values[at(i)];
            tree.touch(write);
            tree.rub(write);
            tree.guard_drives(write);
            guard_loose(write, tree, mode);
            if (!stands_still) {
                tree.guard_ends(write);
                // where a curve has no tangent there is no law of motion along it
                const auto cusps = [&](const Curve& curve, int body, int q) {
                    if (curve.always_regular()) return;
                    const auto place = std::make_shared<const RailSingularity>(curve, state.x[at(q)], q, -1);
                    write.outside(
                        {.kind = EventKind::singular, .role = GuardRole::stop, .subject = body, .locator = place});
                };
                for (int i = 0; i < bodies(); ++i)
                    if (const mechanics::RailLaw* rail = in_mode.node(i).joint.rail();
                        rail != nullptr && !in_mode.node(i).joint.flies())
                        cusps(*rail->curve, i, tree_->node(i).q);
                for (const mechanics::Foot& f : tree_->feet()) cusps(f.curve, f.held.body, f.q);
            }
            guard_loops(write, tree, mode, state);
            tree.watch(write, scene_.watches());
            write.acting(values.subspan(at(n)));
            return groups_in(in_mode, !kept_rows(mode).empty());
        });
    if (!result) return result;
    result->equations.drives = tree.drives();
    result->equations.pulls = tree.surfaces();
    bool turns = false;
    for (int i = 0; i < bodies(); ++i) turns = turns || tree_->node(i).joint.attitude() >= 0;
    const std::vector<int> closed = closed_in(mode, moving(state.t, state.x));
    if ((turns || !kept_rows(mode).empty() || !closed.empty()) && !stands_still)
        result->equations.projection = [tree = tree_in(mode), conditions = conditions_, rows = kept_rows(mode), closed,
                                        size = least_size(mode, moving(state.t, state.x)),
                                        recorded = std::make_shared<const mechanics::LazyRows>()](
                                           std::span<const double>, std::span<const double>) {
            return std::make_unique<const mechanics::TreeProjection>(tree, conditions, rows, closed, size, recorded);
        };
    return result;
}

}  // namespace rbdyn::inline RBDYN_FORM
