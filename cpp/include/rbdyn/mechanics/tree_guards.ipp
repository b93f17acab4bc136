// Definitions of rbdyn/mechanics/tree_writer.hpp: the guards of contacts, of ends of curves, and of watched functions.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "rbdyn/expression/expression.hpp"
#include "rbdyn/mechanics/tree_writer.hpp"
#include "rbdyn/model/hybrid.hpp"
#include "rbdyn/model/watch_role.hpp"

namespace rbdyn::inline RBDYN_FORM::mechanics {

RBDYN_INLINE void TreeWriter::touch(EquationsWriter& write) const {
    const recording::WideFolding all_digits;
    // where loads are shared anew all that bear them do something else
    const bool is_shared = std::ranges::any_of(states_, contact_state::is_given);
    // what acts on a body all the time
    const auto weight = [&](int body) {
        if (body < 0) return std::numeric_limits<double>::max();
        double square = 0.0;
        for (const S& one : acting(12 * body))
            if (one.is_constant()) square += one.value() * one.value();
        return std::sqrt(square);
    };
    for (std::size_t k = 0; k < states_.size(); ++k) {
        const ContactLaw& c = conditions_.contacts()[k];
        const int contact = static_cast<int>(k);
        // beyond where all of a rim is as low series go on with the end of it that was: that ends what touches, and a
        // piece of a flight
        if (const S& flat = touching_[k].flat; !flat.is_constant() && !c.is_gone) {
            const S leans = flat - S(nearest::least_tilt * nearest::least_tilt);
            const auto same = [&] { return leans; };
            if (states_[k] == flies)
                select(leans, same, same, "");
            else
                write.guard({.kind = EventKind::singular, .contact = contact, .name = "tilt of " + c.name}, leans);
        }
        if (states_[k] == flies && !c.is_gone)
            write.guard({.kind = EventKind::land, .contact = contact, .name = "gap of " + c.name},
                        c.sign<Expression>(tree_, moving_, touching_[k]));
        if (contact_state::slides(states_[k]) || contact_state::is_held(states_[k]) ||
            (contact_state::is_given(states_[k]) && c.is_rough())) {
            guard_friction(write, contact);
            continue;
        }
        // a force that is none, as between bodies that fall together, is one of rounding beside what acts on either
        const S nothing(4.0 * std::numeric_limits<double>::epsilon() * std::min(weight(c.a.body), weight(c.b.body)));
        if (states_[k] == contact_state::rests)
            write.decide({.kind = EventKind::detach, .contact = contact, .name = "force of " + c.name, .renews = true},
                         friction_[k].force[0] + nothing);
        for (std::size_t r = 0; r < rows_.size(); ++r)
            if (rows_[r] == conditions_.normal_row(contact))
                write.decide(
                    {.kind = EventKind::detach, .contact = contact, .name = "force of " + c.name, .renews = is_shared},
                    values_[first_multiplier() + r] + nothing);
    }
    for (std::size_t e = 0; e < resistance_states_.size(); ++e) guard_resistance(write, e);
}

RBDYN_INLINE void TreeWriter::guard_friction(EquationsWriter& write, int contact) const {
    const ContactLaw& c = conditions_.contacts()[at(contact)];
    const Touching<S>& t = touching_[at(contact)];
    const Friction& f = friction_[at(contact)];
    const signed char state = states_[at(contact)];
    const std::size_t first = place(contact);
    const Vector3Of<S> force = vector_at(first);
    // what shares its load shares it anew where it comes to an edge, and with it all that bear it
    const bool is_held = contact_state::is_held(state), is_shared = is_held || contact_state::is_given(state),
               is_renewed = is_shared || std::ranges::any_of(states_, contact_state::is_given);
    const Guard leaves{
        .kind = EventKind::detach, .contact = contact, .name = "force of " + c.name, .renews = is_renewed},
        turns{.kind = EventKind::switching,
              .contact = contact,
              .name = "direction of the slip of " + c.name,
              .renews = true};
    const S normal = dot<S>(t.normal, force);
    if (is_held) {
        // the world's axes have it whole: no square root, and no direction where nothing acts along the surface
        write.decide(leaves, normal);
        if (!std::isfinite(static_cast<double>(c.mu_static))) return;
        const S limit = c.mu_static.in<S>() * normal;
        const Vector3Of<S> along = force - t.normal * normal;
        write.decide({.kind = EventKind::slip, .contact = contact, .name = "friction of " + c.name, .renews = true},
                     limit * limit - dot<S>(along, along));
        return;
    }
    // N is a quotient: what slides alone leaves where its numerator ends, and there is no N where its denominator does
    const auto slides = [](signed char s) { return contact_state::slides(s); };
    const bool is_alone = std::count_if(states_.begin(), states_.end(), slides) == 1;
    write.decide(leaves, is_alone && !is_shared && joints_.empty() ? values_[first + 3] : normal);
    if (!contact_state::is_given(state))
        write.guard({.kind = EventKind::singular, .contact = contact, .name = "friction of " + c.name},
                    grip().value_or(values_[first + 4]));
    const Vector3Of<S> slip = t.slip();
    Guard stops{.kind = EventKind::stick, .contact = contact, .name = "slip of " + c.name};
    if (contact_state::follows_slip(state)) {
        // a near miss of rest has its own least speed
        stops.renews = true;
        write.guard(stops, f.speed - f.least);
        // a direction is not followed past a speed of zero: there the series of |u| goes on with another sign
        write.guard(turns, dot<S>(unit_along(f.axis, t.normal), slip) - S(0.875) * f.speed);
        return;
    }
    // what starts has no speed yet, and no acceleration if it starts at the edge of its cone, but for rounding
    const bool begins = contact_state::is_start(state) || contact_state::is_curved(state);
    write.guard(stops, begins ? f.speed + f.least : f.speed);
    const bool curves = contact_state::is_curved(state), starts = contact_state::is_start(state),
               is_brief = state == contact_state::brief;
    if (is_brief || starts) write.guard(turns, S(2.0) * f.least - f.speed);
    if (starts) return;
    const S across = dot<S>(cross<S>(t.normal, f.along), slip);
    // a direction that curves was made for what acts as it begins
    const S most = curves ? f.least + f.speed * S(1e-6) : is_brief ? S(2.0) * f.least : f.least;
    write.guard(turns, most - across);
    write.guard(turns, most + across);
    if (curves) write.guard(turns, f.left);
}

RBDYN_INLINE std::optional<Expression> TreeWriter::grip() const {
    S grip(1.0);
    bool slides = false, rubs = false;
    for (std::size_t k = 0; k < states_.size(); ++k) {
        if (!contact_state::slides(states_[k])) continue;
        slides = true;
        grip *= values_[place(static_cast<int>(k)) + 4];
    }
    for (std::size_t i = 0; i < joints_.size(); ++i) {
        if (!joint_state::resists(joint_states_[i]) || joint_state::has(joint_states_[i], joint_state::unloaded))
            continue;
        rubs = true;
        grip *= values_[first_of_joints() + per_joint * i + 4];
    }
    return slides && rubs ? std::make_optional(grip) : std::nullopt;
}

RBDYN_INLINE void TreeWriter::guard_ends(EquationsWriter& write) const {
    const auto guard = [&](const Curve& curve, int body, const std::string& name, const S& u, bool releases = false) {
        const Domain d = curve.domain();
        if (curve.closed()) return;
        const GuardRole role = releases ? GuardRole::mode : GuardRole::stop;
        const Guard end{.kind = EventKind::rail_end, .role = role, .subject = body, .name = name};
        if (std::isfinite(d.begin)) write.guard(end, u - S(d.begin));
        if (std::isfinite(d.end)) write.guard(end, S(d.end) - u);
    };
    for (int i = 0; i < tree_.size(); ++i) {
        const JointLaw& joint = tree_.node(i).joint;
        if (joint.rail() == nullptr || joint.flies()) continue;
        const auto* loose = joint.as<LooseRailLaw>();
        guard(*joint.rail()->curve, i, "", q_[at(tree_.node(i).q)], loose != nullptr && loose->releases);
    }
    for (const Foot& f : tree_.feet()) {
        guard(f.curve, f.held.body, f.name, q_[at(f.q)]);
        if (f.curve.always_regular()) continue;
        // where r' vanishes, or grows beyond all bounds, it varies within a small part of the curve; further on the
        // point leaves the curve along its tangent, which no row tells of
        const CurvePoint<S> c = f.curve.own<S>(q_[at(f.q)]);
        const double part = 1e-7 * f.part();
        const S clear = c.speed_squared - dot<S>(c.second, c.second) * (part * part);
        write.guard({.kind = EventKind::singular, .role = GuardRole::stop, .subject = f.held.body, .name = f.name},
                    clear);
    }
}

RBDYN_INLINE void TreeWriter::watch(EquationsWriter& write, const std::vector<Scene::Watch>& watches) const {
    for (std::size_t k = 0; k < watches.size(); ++k) {
        const Scene::Watch& w = watches[k];
        Guard g{.kind = EventKind::watch,
                .role = role_of(w.options.action.kind),
                .direction = w.options.direction,
                .name = w.name,
                .watch = static_cast<int>(k)};
        if (!w.function.is_recorded()) {
            write.outside(std::move(g));
            continue;
        }
        std::vector<S> x;
        for (const Observable& o : w.function.arguments()) x.push_back(observed(o));
        write.watch(g, w.function.function(), x);
    }
}

}  // namespace rbdyn::inline RBDYN_FORM::mechanics
