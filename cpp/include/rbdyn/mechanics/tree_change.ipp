// Definitions of rbdyn/mechanics/tree_model.hpp: what a motion begins with, and what actions of watched functions make
// of a state.
//
// A state is taken in the words of the joints, each relative to its parent, changed there, and put back: what no word
// changes keeps its bits, but for a ball joint on what has been changed, whose attitude is one in the world. What
// follows is decided anew, as at a start; unlike there, what contacts and joints do then is told.
#pragma once

#include <algorithm>
#include <cmath>
#include <iterator>
#include <span>
#include <string>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "rbdyn/basics/double_double_functions.hpp"
#include "rbdyn/basics/error.hpp"
#include "rbdyn/mechanics/assemble.hpp"
#include "rbdyn/mechanics/closure.hpp"
#include "rbdyn/mechanics/contact_state.hpp"
#include "rbdyn/mechanics/driven.hpp"
#include "rbdyn/mechanics/redundant.hpp"
#include "rbdyn/mechanics/tree_model.hpp"
#include "rbdyn/scene/starts.hpp"
#include "rbdyn/scene/watch.hpp"

namespace rbdyn::inline RBDYN_FORM {

namespace tree_changes {

/// Puts what a change gives into a start in a joint's words, and says which positions and velocities of the joint that
/// is, counted from its first ones.
struct Put {
    const StateChange& change;
    std::vector<std::string> own = {};
    std::vector<int> positions = {}, velocities = {};

    template <class T, class U>
    bool take(const char* word, const std::optional<T>& given, U& into, std::vector<int>& list,
              std::initializer_list<int> of) {
        own.emplace_back(word);
        if (!given) return false;
        into = *given;
        list.insert(list.end(), of);
        return true;
    }
    /// Of what turns freely; its quaternion begins at `first`.
    template <class S>
    void turn(S& start, int first) {
        const std::initializer_list<int> none = {};
        const auto turns = [&](std::vector<int>& list, int count) {
            for (int k = 0; k < count; ++k) list.push_back(first + k);
        };
        // body axes turn with the attitude
        if (take("attitude", change.attitude, start.attitude, positions, none)) {
            turns(positions, 4);
            turns(velocities, 3);
        }
        if (change.angular_velocity || change.angular_velocity_world) {
            start.angular_velocity.reset();
            start.angular_velocity_world.reset();
            turns(velocities, 3);
        }
        take("angular_velocity", change.angular_velocity, start.angular_velocity, velocities, none);
        take("angular_velocity_world", change.angular_velocity_world, start.angular_velocity_world, velocities, none);
    }

    void operator()(FreeStart& s) {
        take("position", change.position, s.position, positions, {0, 1, 2});
        take("velocity", change.velocity, s.velocity, velocities, {0, 1, 2});
    }
    void operator()(BodyStart& s) {
        take("position", change.position, s.position, positions, {0, 1, 2});
        take("velocity", change.velocity, s.velocity, velocities, {0, 1, 2});
        turn(s, 3);
    }
    void operator()(RailStart& s) {
        // the same speed is another rate of the parameter elsewhere
        if (take("parameter", change.parameter, s.parameter, positions, {0})) velocities.push_back(0);
        take("speed", change.speed, s.speed, velocities, {0});
    }
    void operator()(SphericalStart& s) { turn(s, 0); }
    void operator()(RevoluteStart& s) {
        take("angle", change.angle, s.angle, positions, {0});
        take("rate", change.rate, s.rate, velocities, {0});
    }
    void operator()(PrismaticStart& s) {
        take("displacement", change.displacement, s.displacement, positions, {0});
        take("rate", change.rate, s.rate, velocities, {0});
    }
    void operator()(UniversalStart& s) {
        take("angles", change.angles, s.angles, positions, {0, 1});
        take("rates", change.rates, s.rates, velocities, {0, 1});
    }
    void operator()(CylindricalStart& s) {
        take("angle", change.angle, s.angle, positions, {0});
        take("rate", change.rate, s.rate, velocities, {0});
        take("displacement", change.displacement, s.displacement, positions, {1});
        take("displacement_rate", change.displacement_rate, s.displacement_rate, velocities, {1});
    }
    void operator()(PlanarStart& s) {
        take("position (2)", change.position_in_plane, s.position, positions, {0, 1});
        take("velocity (2)", change.velocity_in_plane, s.velocity, velocities, {0, 1});
        take("angle", change.angle, s.angle, positions, {2});
        take("rate", change.rate, s.rate, velocities, {2});
    }
    void operator()(FixedStart&) {}
    void operator()(Started&) {}
};

}  // namespace tree_changes

RBDYN_INLINE bool TreeModel::change(const Mode& mode, const Scene::Watch& watch, double t, std::span<double> x) const {
    const std::string user = "watch " + watch.name;
    const std::vector<StateChange> changes =
        watch.options.action.change(scene_.checked(observing(mode, t, x), user + ", its action"));
    if (changes.empty()) return false;
    const std::vector<DoubleDouble> now(x.begin(), x.end());
    const auto all = mechanics::closing::moving<DoubleDouble>(*tree_, t, now);
    std::vector<Scene::Body> starts = scene_.bodies();
    for (int i = 0; i < bodies(); ++i) {
        // what nothing joins to its parent is in the world
        if (std::holds_alternative<Free>(starts[at(i)].joint)) starts[at(i)].parent = -1;
        mechanics::assembling::put(*tree_, i, all, now, starts[at(i)]);
    }
    std::vector<bool> is_taken(x.size(), false), moves(at(bodies()), false), speeds(at(bodies()), false);
    for (const StateChange& c : changes) {
        const int i = c.body.index;
        require(i >= 0 && i < bodies(), user, "body", i, "its action changes bodies of this scene");
        const mechanics::Node& n = tree_->node(i);
        Scene::Body& b = starts[at(i)];
        if (n.joint.as<mechanics::DrivenLaw>() != nullptr)
            throw InvalidInput(user + ": its action changes " + n.name +
                               ", whose joint is driven: its motion says where it is and how fast; change others");
        if (is_flying(mode, i))
            throw InvalidInput(user + ": its action changes " + n.name +
                               ", which has left its rail; beside bodies that are joined it is changed on it");
        Start words = starts::words(b.joint, b.rigid() != nullptr, b);
        tree_changes::Put put{c};
        std::visit([&](auto& start) { put(start); }, words);
        c.require_words(put.own, user, n.name);
        Started& kept = b;
        kept = std::visit(
            [&]<class J, class S>(const J& joint, const S& given) -> Started {
                if constexpr (requires { starts::on(joint, given, n.name); })
                    return starts::on(joint, given, user + ", " + n.name);
                else
                    return b;
            },
            b.joint, words);
        if (const mechanics::RailLaw* rail = n.joint.rail(); rail != nullptr && c.parameter)
            rail->curve->require_regular(*c.parameter);
        moves[at(i)] = moves[at(i)] || !put.positions.empty();
        speeds[at(i)] = speeds[at(i)] || !put.velocities.empty();
        for (const int k : put.positions) is_taken[at(n.q + k)] = true;
        for (const int k : put.velocities) is_taken[at(tree_->positions() + n.v + k)] = true;
        // the centre of mass moves where the body turns about its origin
        const bool turns =
            n.joint.as<mechanics::FreeBodyLaw>() != nullptr && !rounded(n.joint.held().point).isZero(0.0);
        for (int k = 0; k < 3 && turns; ++k) {
            if (c.attitude) is_taken[at(n.q + k)] = true;
            if (c.attitude || c.angular_velocity || c.angular_velocity_world)
                is_taken[at(tree_->positions() + n.v + k)] = true;
        }
    }
    for (int i = 0; i < bodies(); ++i) {
        const mechanics::Node& n = tree_->node(i);
        if (n.parent < 0) continue;
        // what turns by itself is in the world, and keeps how it lies to its parent
        const int first = n.joint.attitude();
        for (int k = 0; first >= 0 && k < 4 && moves[at(n.parent)]; ++k) is_taken[at(n.q + first + k)] = true;
        for (int k = 0; first >= 0 && k < 3 && (moves[at(n.parent)] || speeds[at(n.parent)]); ++k)
            is_taken[at(tree_->positions() + n.v + first + k)] = true;
        moves[at(i)] = moves[at(i)] || moves[at(n.parent)];
        speeds[at(i)] = speeds[at(i)] || speeds[at(n.parent)];
    }
    const std::vector<DoubleDouble> changed = tree_->start(t, starts);
    const std::vector<double> before(x.begin(), x.end());
    for (std::size_t k = 0; k < x.size(); ++k)
        if (is_taken[k]) x[k] = static_cast<double>(changed[k]);
    const bool has_moved = !std::equal(x.begin(), x.begin() + tree_->positions(), before.begin());
    for (const mechanics::Foot& f : tree_->feet()) {
        // rounds of a closed curve are counted on
        const double period = f.curve.period(), there = static_cast<double>(changed[at(f.q)]);
        const double rounds = period > 0.0 ? std::round((x[at(f.q)] - there) / period) : 0.0;
        if (has_moved) x[at(f.q)] = there + rounds * period;
    }
    if (!conditions_->all().empty()) {
        const auto positions = static_cast<std::ptrdiff_t>(tree_->positions());
        const std::vector<double> on = mechanics::closing::nearest(
            onto_constraints(t, std::vector<DoubleDouble>(x.begin(), x.end()), "the action of " + user));
        // where nothing has moved they are satisfied
        std::copy(on.begin() + (has_moved ? 0 : positions), on.end(), x.begin() + (has_moved ? 0 : positions));
    }
    const auto there = moving(t, x);
    const auto gaps = conditions_->gaps<double>(*tree_, there);
    for (int k = 0; k < contacts(); ++k) {
        if (conditions_->contacts()[at(k)].is_gone) continue;
        const double gap = gaps[at(conditions_->normal_row(k))];
        // and no place is known better than by how far it goes in the rounding of the time
        const double late = 4.0 * epsilon * (std::abs(t) + ahead()) * speed_of(k, there);
        require(gap >= -nearest_touch(mode, k) * size_of(k, there) - late,
                user + ", " + conditions_->contacts()[at(k)].name, "gap its action leaves", gap,
                "what touches is not inside what it touches; move it less far");
    }
    return true;
}

RBDYN_INLINE Mode TreeModel::decided_anew(const Mode& before, std::span<const double> was, double t,
                                          std::span<double> x, std::vector<Happening>& happenings) const {
    Mode mode = undecided();
    const Mode as_it_was = mode;
    const bool begins = was.empty();
    if (contacts() == 0) {
        if (!loose_.empty()) {
            // what flies goes on to
            if (!begins)
                std::copy(before.slip.begin() + first_loose(), before.slip.end(), mode.slip.begin() + first_loose());
            settle_loose(as_it_was, mode, t, x, begins ? nullptr : &happenings);
        } else {
            if (has_choice_) renew_rows(mode, t, x);
            joints_.empty() ? choose(mode, t, x, {}) : settle_joints(as_it_was, mode, t, x, {});
        }
        if (!begins && mode.impossible.empty()) tell_joints(before, mode, happenings);
        return mode;
    }
    const auto all = moving(t, x);
    const auto gaps = conditions_->gaps<double>(*tree_, all);
    const auto rows = conditions_->rows<double>(*tree_, all);
    // plans ask what equations there are also where no motion begins
    const auto ends_at_once = [&](const std::string& why) {
        choose(mode, t, x, {});
        mode.impossible = why;
        return mode;
    };
    const PhaseRounding phases = phase_rounding(t, x);
    const auto noise_of = [&](int k, const auto& motion) { return 1e-12 * speed_of(k, motion) + phases.normal[at(k)]; };
    std::vector<int> closed;
    for (int k = 0; k < contacts(); ++k) {
        if (conditions_->contacts()[at(k)].is_gone) continue;
        const auto row = at(conditions_->normal_row(k));
        const double gap = gaps[row], near = nearest_touch(before, k) * size_of(k, all),
                     late = 4.0 * epsilon * (std::abs(t) + ahead()) * speed_of(k, all);
        require(
            gap >= -near - late, conditions_->contacts()[at(k)].name, "gap", gap,
            "what touches is not inside what it touches as the scene starts; move it out, or turn the normal of the "
            "surface");
        if (gap > near + late) continue;
        if (const std::string why = lies_flat({k}, all, no_tilt); !why.empty()) return ends_at_once(why);
        if (mechanics::Conditions::rate(rows[row], all) <= noise_of(k, all)) closed.push_back(k);
    }
    // what is at rest on its surface, or rolls on it, but for rounding does not strike it: it is set to be so exactly
    const auto touching = [&](int k) { return conditions_->contacts()[at(k)].touching<double>(*tree_, all); };
    const auto is_along = [&](int k) {
        return std::abs(mechanics::Conditions::rate(rows[at(conditions_->normal_row(k))], all)) <= noise_of(k, all);
    };
    const auto is_stuck = [&](int k) {
        return is_rough(k) && touching(k).slip().norm() <= 1e-12 * speed_of(k, all) + phases.slip[at(k)];
    };
    const bool strikes = !std::all_of(closed.begin(), closed.end(), is_along);
    if (begins && !strikes)
        for (const int k : closed) require_no_slip(k, touching(k).slip().norm(), is_stuck(k));
    std::vector<double> impulses;
    Strokes strokes;
    const Kept kept = begins ? Kept{} : kept_closed(before, t, was, x);
    const auto is_in = [](const std::vector<int>& list, int k) {
        return std::find(list.begin(), list.end(), k) != list.end();
    };
    // what comes towards its surface strikes it before the motion begins
    if (!closed.empty()) {
        if (strikes || !conditions_->is_rough() || !joints_.empty())
            impulses = strike(as_it_was, t, x, closed, strokes);
        else
            std::copy_if(closed.begin(), closed.end(), std::back_inserter(strokes.stuck), is_stuck);
        if (!strokes.impossible.empty()) return ends_at_once(strokes.impossible);
        std::vector<int> at_rest;
        const auto then = moving(t, x);
        const auto later = conditions_->rows<double>(*tree_, then);
        for (const int k : closed) {
            const auto row = at(conditions_->normal_row(k));
            // what rests on its surface, and goes on to, has rounding of a speed
            const double rounding =
                is_in(kept.along, k) ? 8.0 * std::abs(mechanics::Conditions::rate(rows[row], all)) : 0.0;
            if (mechanics::Conditions::rate(later[row], then) <= noise_of(k, then) + rounding) at_rest.push_back(k);
        }
        // what never slips does not as the motion begins, whatever turns then
        std::vector<int> never;
        for (const int k : at_rest)
            if (conditions_->contacts()[at(k)].never_slips() && !is_in(strokes.stuck, k)) never.push_back(k);
        if (!never.empty()) stop(t, x, never, never);
        Fired fired;
        fired.stuck = strokes.stuck;
        fired.stuck.insert(fired.stuck.end(), never.begin(), never.end());
        for (const int k : at_rest)
            if (is_in(kept.held, k)) fired.stuck.push_back(k);
        settle(as_it_was, mode, t, x, at_rest, fired);
    } else if (!joints_.empty()) {
        settle(as_it_was, mode, t, x, {}, {});
    } else {
        choose(mode, t, x, {});
    }
    if (!mode.impossible.empty()) return mode;
    std::vector<double> rest(x.size(), 0.0);
    hold(mode, t, x, rest);
    quiet(mode, t, x, rest);
    come_to_stand(mode, t, x);
    if (!begins) {
        tell_anew(before, mode, impulses, strokes, all, moving(t, x), happenings);
        tell_rest(before, was, mode, t, x, happenings);
        put_in_order(happenings);
    }
    return mode;
}

RBDYN_INLINE void TreeModel::require_no_slip(int contact, double slip, bool is_stuck) const {
    const mechanics::ContactLaw& c = conditions_->contacts()[at(contact)];
    if (is_stuck || !is_rough(contact) || !c.never_slips()) return;
    require(false, c.name, "slip as the scene starts [m/s]", slip,
            "where no friction lets it slide it rolls or stands as the scene starts (v + omega x r is that of what it "
            "touches): give velocities that do, or a coefficient that it slides with, as in Coulomb(math.inf, 0.2)");
}

RBDYN_INLINE double TreeModel::ahead() const {
    double most = 0.0;
    for (const mechanics::Node& n : tree_->nodes()) {
        if (const mechanics::DrivenLaw* law = mechanics::driven(n)) most = std::max(most, law->ahead);
        if (const mechanics::RailLaw* rail = mechanics::moved(n)) most = std::max(most, rail->ahead);
    }
    return most;
}

RBDYN_INLINE TreeModel::PhaseRounding TreeModel::phase_rounding(double t, std::span<const double> x) const {
    const std::vector<double> none(at(contacts()), 0.0);
    PhaseRounding result{none, none};
    const double late = 4.0 * epsilon * (std::abs(t) + ahead());
    if (!(t + late > t) || !is_driven()) return result;
    const auto now = moving(t, x), then = moving(t + late, x);
    for (int k = 0; k < contacts(); ++k) {
        const mechanics::ContactLaw& law = conditions_->contacts()[at(k)];
        if (law.is_gone) continue;
        const auto here = law.touching<double>(*tree_, now), there = law.touching<double>(*tree_, then);
        const auto rate = [](const auto& touching, const auto& all) {
            return mechanics::Conditions::rate(touching.row(touching.normal, touching.normal_rate), all);
        };
        result.normal[at(k)] = std::abs(rate(there, then) - rate(here, now));
        if (is_rough(k)) result.slip[at(k)] = (there.slip() - here.slip()).norm();
    }
    return result;
}

RBDYN_INLINE double TreeModel::nearest_touch(const Mode& mode, int contact) const {
    // what has touched so far is held so to the rounding of its motion
    return mode.slip[at(contact)] != flies ? 1e-9 : 1e-12;
}

RBDYN_INLINE TreeModel::Kept TreeModel::kept_closed(const Mode& mode, double t, std::span<const double> was,
                                                    std::span<const double> x) const {
    Kept kept;
    const auto before = moving(t, was), now = moving(t, x);
    for (int k = 0; k < contacts(); ++k) {
        const signed char state = mode.slip[at(k)];
        if (state == flies) continue;
        const mechanics::ContactLaw& c = conditions_->contacts()[at(k)];
        const auto then = c.touching<double>(*tree_, before), here = c.touching<double>(*tree_, now);
        const double rounding = 1e-12 * std::max(speed_of(k, before), speed_of(k, now));
        if (std::abs(here.normal.dot(here.velocity) - then.normal.dot(then.velocity)) > rounding) continue;
        kept.along.push_back(k);
        if (mechanics::contact_state::is_held(state) && (here.velocity - then.velocity).norm() <= rounding)
            kept.held.push_back(k);
    }
    return kept;
}

RBDYN_INLINE void TreeModel::tell_anew(const Mode& mode, const Mode& after, const std::vector<double>& impulses,
                                       const Strokes& strokes, const std::vector<mechanics::Moving<double>>& before,
                                       const std::vector<mechanics::Moving<double>>& now,
                                       std::vector<Happening>& happenings) const {
    for (int k = 0; k < contacts(); ++k) {
        const bool was = mode.slip[at(k)] != flies, is = after.slip[at(k)] != flies;
        const double impulse = impulses.empty() ? 0.0 : impulses[at(k)];
        if (was == is && (is || impulse <= 0.0)) continue;
        Happening h{was ? EventKind::detach : is ? EventKind::land : EventKind::impact, -1, Direction::falling, {}};
        h.contact = k;
        h.impulse = impulse;
        h.push = strokes.pushed.empty()
                     ? Vector3(conditions_->contacts()[at(k)].touching<double>(*tree_, before).normal * impulse)
                     : strokes.pushed[at(k)];
        happenings.push_back(std::move(h));
    }
    if (conditions_->is_rough()) tell_friction(mode, after, {}, before, now, happenings);
    tell_joints(mode, after, happenings);
}

}  // namespace rbdyn::inline RBDYN_FORM
