// Definitions of rbdyn/effects.hpp.
#pragma once

#include "rbdyn/effects.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <exception>
#include <iomanip>
#include <limits>
#include <map>
#include <ostream>
#include <string>
#include <tuple>
#include <utility>

#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/error.hpp"
#include "rbdyn/basics/interruption.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/event/event.hpp"
#include "rbdyn/model/body_report.hpp"
#include "rbdyn/model/equations.hpp"
#include "rbdyn/plan/plan.hpp"
#include "rbdyn/rotation/attitude.hpp"
#include "rbdyn/rotation/quaternion.hpp"
#include "rbdyn/scene/handles.hpp"
#include "rbdyn/scene/scene.hpp"
#include "rbdyn/simulate.hpp"
#include "rbdyn/trajectory/body_motion.hpp"
#include "rbdyn/trajectory/run_data.hpp"
#include "rbdyn/trajectory/trajectory.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE const EffectRow& EffectTable::operator[](const std::string& effect) const {
    std::string known;
    for (const EffectRow& row : rows) {
        if (row.effect == effect) return row;
        known += (known.empty() ? "" : ", ") + row.effect;
    }
    throw InvalidInput("EffectTable: there is no row \"" + effect + "\"; the scene has " +
                       (known.empty() ? "none" : known));
}

}  // namespace rbdyn::inline RBDYN_FORM

namespace rbdyn::inline RBDYN_FORM::comparing {

/// What is compared of a body at a time.
struct Kinematics {
    Vector3 place, velocity, turning = Vector3::Zero();
    Quaternion attitude = {};

    Kinematics(const Trajectory& run, int body, const Attitude& held, double t);
};

/// The scales of a body's motion in one or more runs.
struct KinematicScales {
    Vector3 low = Vector3::Constant(std::numeric_limits<double>::infinity()), high = -low;
    double size = 0.0, speed = 0.0, turning = 0.0;

    void take(const Trajectory& run, int body, double end);
};

RBDYN_INLINE Kinematics::Kinematics(const Trajectory& run, int body, const Attitude& held, double t)
    : attitude(held.quaternion()) {
    const BodyMotion motion = run[BodyHandle{body}];
    const PointReport r = motion.report(t);
    place = r.position;
    velocity = r.velocity;
    if (run.scene().bodies()[static_cast<std::size_t>(body)].rigid() == nullptr) return;
    turning = motion.angular_velocity_world(t);
    attitude = motion.quaternion(t);
}

RBDYN_INLINE void KinematicScales::take(const Trajectory& run, int body, double end) {
    constexpr int times = 256;
    for (int i = 0; i <= times; ++i) {
        const Kinematics k(run, body, {}, i == times ? end : run.start() + (end - run.start()) * i / times);
        low = lesser(low, k.place);
        high = greater(high, k.place);
        size = std::max(size, k.place.norm());
        speed = std::max(speed, k.velocity.norm());
        turning = std::max(turning, k.turning.norm());
    }
}

RBDYN_INLINE double angle_between(const Quaternion& p, const Quaternion& q) {
    const Vector3 a{p.x, p.y, p.z}, b{q.x, q.y, q.z};
    const Vector3 axis = p.w * b - q.w * a - a.cross(b);
    return 2.0 * std::atan2(axis.norm(), std::abs(p.w * q.w + a.dot(b)));
}

RBDYN_INLINE double difference(const Trajectory& a, const Trajectory& b, const Scene& whole, double time) {
    // what moves by rounding alone does not move
    constexpr double nothing = 1e3 * std::numeric_limits<double>::epsilon();
    double result = 0.0;
    for (int i = 0; i < static_cast<int>(whole.bodies().size()); ++i) {
        const Attitude& held = whole.bodies()[static_cast<std::size_t>(i)].attitude;
        KinematicScales scales;
        for (const Trajectory* run : {&a, &b}) scales.take(*run, i, time);
        const Kinematics x(a, i, held, time), y(b, i, held, time);
        const double extent = (scales.high - scales.low).norm();
        if (extent > nothing * scales.size) result = std::max(result, (x.place - y.place).norm() / extent);
        if (scales.speed > 0.0) result = std::max(result, (x.velocity - y.velocity).norm() / scales.speed);
        if (scales.turning > 0.0) result = std::max(result, (x.turning - y.turning).norm() / scales.turning);
        result = std::max(result, angle_between(x.attitude, y.attitude));
    }
    return result;
}

RBDYN_INLINE std::map<std::tuple<EventKind, int, std::string>, int> counted(const Trajectory& run, double until) {
    std::map<std::tuple<EventKind, int, std::string>, int> result;
    for (const Event& e : run.events())
        if (e.time <= until) ++result[{e.kind, e.subject, e.name}];
    return result;
}

}  // namespace rbdyn::inline RBDYN_FORM::comparing

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE EffectTable effects(const Scene& scene, const SimulateOptions& options) {
    SimulateOptions kept = options;
    kept.keep = {};
    // the least of a few calls: the others waited for something
    const auto least = [&](const Scene& s, double seconds) {
        for (int i = 0; i < 4 && seconds < 0.01; ++i)
            seconds = std::min(seconds, attempt(s, kept).run.statistics().seconds);
        return seconds;
    };
    const Trajectory whole = simulate(scene, kept);
    EffectTable table{{},
                      least(scene, whole.statistics().seconds),
                      whole.statistics().steps,
                      static_cast<int>(whole.events().size())};
    if (whole.status() == Status::stopped_by_user) return table;
    for (const std::string& effect : whole.plan().effects) {
        EffectRow row{.effect = effect};
        try {
            const Scene rest = scene.without(effect);
            const Attempt less = attempt(rest, kept);
            if (less.thrown) std::rethrow_exception(less.thrown);
            row.note = less.message;
            if (less.run.status() == Status::stopped_by_user) break;
            row.seconds = least(rest, less.run.statistics().seconds);
            row.steps = less.run.statistics().steps;
            row.time = std::min({whole.end(), less.run.end(), less.run.certain_until()});
            if (row.time > whole.start()) {
                row.difference = comparing::difference(whole, less.run, scene, row.time);
                const auto with = comparing::counted(whole, row.time), bare = comparing::counted(less.run, row.time);
                const auto more = [](const auto& a, const auto& b) {
                    int count = 0;
                    for (const auto& [key, n] : a) count += std::max(0, n - (b.contains(key) ? b.at(key) : 0));
                    return count;
                };
                row.gained = more(with, bare);
                row.lost = more(bare, with);
            }
            if (row.note.empty() && row.time < whole.end())
                row.note =
                    "without it the run ends at " + text(row.time) + " s: " + std::string(name_of(less.run.status()));
        } catch (const std::exception& e) {
            if (Interruption::has_ended()) throw;
            row.note = e.what();
        }
        table.rows.push_back(std::move(row));
    }
    return table;
}

RBDYN_INLINE std::ostream& operator<<(std::ostream& out, const EffectTable& table) {
    const auto flags = out.flags();
    const auto digits = out.precision();
    // a number, or a dash where there is none
    const auto put = [&](int width, double value) -> std::ostream& {
        out << std::right << std::setw(width);
        return std::isnan(value) ? out << "-" : out << value;
    };
    out << std::left << std::setw(18) << "without" << std::right << std::setw(10) << "steps" << std::setw(12)
        << "time [ms]" << std::setw(12) << "difference" << std::setw(8) << "gained" << std::setw(8) << "lost" << '\n';
    EffectRow whole{.effect = "nothing", .seconds = table.seconds, .steps = table.steps};
    whole.note = std::to_string(table.events) + " events";
    const auto line = [&](const EffectRow& r) {
        out << std::left << std::setw(18) << r.effect << std::right << std::setw(10) << r.steps << std::fixed
            << std::setprecision(4);
        put(12, r.seconds * 1e3) << std::scientific << std::setprecision(1);
        put(12, r.difference) << std::setw(8) << r.gained << std::setw(8) << r.lost << (r.note.empty() ? "" : "  ")
                              << r.note << '\n';
    };
    line(whole);
    for (const EffectRow& r : table.rows) line(r);
    out.flags(flags);
    out.precision(digits);
    return out;
}

}  // namespace rbdyn::inline RBDYN_FORM
