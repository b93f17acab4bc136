// Definitions of rbdyn/special/special_model.hpp: what beads do, stick, slip or fly.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "rbdyn/basics/direction.hpp"
#include "rbdyn/basics/error.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/curve/curve.hpp"
#include "rbdyn/curve/point.hpp"
#include "rbdyn/expression/evaluate.hpp"
#include "rbdyn/expression/rounding_sizes.hpp"
#include "rbdyn/expression/time_function.hpp"
#include "rbdyn/model/equations.hpp"
#include "rbdyn/model/hybrid.hpp"
#include "rbdyn/model/leading_sign.hpp"
#include "rbdyn/model/rail_landing.hpp"
#include "rbdyn/model/within.hpp"
#include "rbdyn/special/bead_law.hpp"
#include "rbdyn/special/single_laws.hpp"
#include "rbdyn/special/special_model.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE int SpecialModel::at_corner(const Mode& mode, std::span<const int> fired,
                                         std::span<const double> x) const {
    const bool has_changed = std::any_of(fired.begin(), fired.end(), [&](int index) {
        return mode.equations->guards[at(index)].kind == EventKind::switching;
    });
    if (!has_changed) return -1;
    for (const int i : laws_->beads()) {
        const BeadLaw& b = laws_->bead(i);
        if (mode.slip[at(i)] == flies || !map().is_simulated(b.first)) continue;
        if (b.curve().jumps_at(map().value(b.first, x))) return i;
    }
    return -1;
}

RBDYN_INLINE signed char SpecialModel::slip_of(const Mode& mode, int i, double speed, double t,
                                               std::span<double> x) const {
    const Drive drive = drive_of(mode, i, t, x);
    const double slip = speed - drive.speed;
    if (std::abs(slip) > 4.0 * epsilon * std::max(std::abs(speed), drive.size)) return slip > 0.0 ? 1 : -1;
    return settle(mode, i, t, x);
}

RBDYN_INLINE SpecialModel::Drive SpecialModel::drive_of(const Mode& mode, int i, double t,
                                                        std::span<const double> x) const {
    if (mode.equations == nullptr || mode.equations->drives < 0) {
        const double speed = laws_->bead(i).drive()(t);
        return {speed, std::abs(speed)};
    }
    RoundingSizes values(mode.equations->program);
    values.set_parameters(mode.parameters);
    values(t, x);
    return {values.output(mode.equations->drives + i), values.size(mode.equations->drives + i)};
}

RBDYN_INLINE bool SpecialModel::follow_drives(const Mode& before, Mode& after, double t, std::span<double> x,
                                              std::vector<Happening>& happenings) const {
    bool has_changed = false;
    for (const int i : laws_->beads()) {
        const BeadLaw& b = laws_->bead(i);
        if (!b.rough() || b.drive().is_constant() || before.slip[at(i)] == flies || after.slip[at(i)] == flies)
            continue;
        const Drive last = drive_of(before, i, t, x), next = drive_of(after, i, t, x);
        const double was = last.speed, is = next.speed;
        // what differs by the rounding of the time has a corner, no jump
        if (std::abs(is - was) <= 1e-10 * std::max(std::abs(is), std::abs(was))) continue;
        if (std::abs(is - was) <= 16.0 * epsilon * (last.size + next.size)) continue;
        const CurvePoint<double> c = b.curve_point(variable(x, b.first));
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

RBDYN_INLINE void SpecialModel::carry(const Mode& mode, int i, double t, std::span<double> x) const {
    const BeadLaw& b = laws_->bead(i);
    const CurvePoint<double> c = b.curve_point(variable(x, b.first));
    variable(x, b.first_rate) = drive_of(mode, i, t, x).speed / std::sqrt(c.speed_squared);
}

RBDYN_INLINE Holding SpecialModel::holding(const Mode& mode, int i, double t, std::span<const double> x) const {
    const Within state(mode, t, x);
    const BeadLaw& b = laws_->bead(i);
    Holding h = b.holding(*laws_, state.t, state.x, mode.slip);
    const double later = state.t + 16.0 * epsilon * std::abs(state.t);
    if (later == state.t) return h;
    const Holding then = b.holding(*laws_, later, state.x, mode.slip);
    h.rounding += std::abs(then.tangential - h.tangential) + std::abs(then.across - h.across);
    return h;
}

RBDYN_INLINE signed char SpecialModel::escape(const Mode& stuck, int i, double t, std::span<const double> x,
                                              const Holding& h) const {
    const bool is_zero = std::abs(h.tangential) <= h.rounding && stuck.equations->pulls >= 0;
    const double pull = is_zero ? leading_sign(stuck, t, x, stuck.equations->pulls + i) : h.tangential;
    return static_cast<signed char>(pull < 0.0 ? 1 : -1);
}

RBDYN_INLINE signed char SpecialModel::settle(const Mode& mode, int i, double t, std::span<double> x) const {
    const BeadLaw& b = laws_->bead(i);
    carry(mode, i, t, x);
    const Holding h = holding(mode, i, t, x);
    const double limit = b.mu_static() * h.across, needed = std::abs(h.tangential),
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

RBDYN_INLINE void SpecialModel::release(Mode& mode, int i, double t, std::span<double> x) const {
    const BeadLaw& b = laws_->bead(i);
    const SingleStates<double> all = laws_->states(t, x, mode.slip);
    const SingleState<double>& p = all[at(i)];
    for (int k = 0; k < 3; ++k) {
        variable(x, b.first_of_space() + k) = p.r[k];
        variable(x, b.first_of_velocity() + k) = p.v[k];
    }
    variable(x, b.first_rate) = 0.0;
    mode.slip[at(i)] = flies;
}

RBDYN_INLINE double SpecialModel::land(Mode& mode, int i, double t, std::span<double> x) const {
    const BeadLaw& b = laws_->bead(i);
    const int space = b.first_of_space(), velocity = b.first_of_velocity();
    const Vector3 r{variable(x, space), variable(x, space + 1), variable(x, space + 2)},
        v{variable(x, velocity), variable(x, velocity + 1), variable(x, velocity + 2)};
    variable(x, b.first) = b.landing()->place(r, variable(x, b.first));
    const CurvePoint<double> c = b.curve_point(variable(x, b.first));
    // along the normal: what rounding leaves along the rail is none
    const double along = dot<double>(c.first, v), rounding = 16.0 * epsilon * std::sqrt(c.speed_squared) * v.norm();
    double w = std::abs(along) > rounding ? along / c.speed_squared : 0.0;
    if (b.rough() && b.mu_dynamic() > 0.0) {
        // Coulomb's law of the impulses: against the slip after it, up to mu of that across the rail
        const double pace = std::sqrt(c.speed_squared), carried = drive_of(mode, i, t, x).speed,
                     slip = w * pace - carried, most = b.mu_dynamic() * (v - c.first * w).norm();
        w = (std::abs(slip) <= most ? carried : w * pace - std::copysign(most, slip)) / pace;
    }
    variable(x, b.first_rate) = w;
    for (int k = 0; k < 3; ++k) variable(x, velocity + k) = 0.0;
    mode.slip[at(i)] = 1;
    if (b.rough()) mode.slip[at(i)] = slip_of(mode, i, w * std::sqrt(c.speed_squared), t, x);
    return b.mass * (v - c.first * w).norm();
}

RBDYN_INLINE bool SpecialModel::let_go(Mode& mode, int i, double t, std::span<double> x) const {
    if (!laws_->bead(i).only_pushes() || mode.slip[at(i)] == flies) return false;
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

RBDYN_INLINE void SpecialModel::leave_end(Mode& mode, int i, double t, std::span<double> x) const {
    if (mode.slip[at(i)] == flies) return;
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

}  // namespace rbdyn::inline RBDYN_FORM
