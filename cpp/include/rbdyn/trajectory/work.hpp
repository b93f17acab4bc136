// Work done along a run.
//
// The work of all forces on bodies, reactions included, is what their kinetic energy gains (Thm 7.9), that of a load or
// spring with a potential what that gains: at any span and whatever else was kept, for two states say it. What state
// jumps make of them (a landing, an action that changes the state) is no work of forces that act in time and does not
// count. Other work is the integral of the power, by Gauss's rule on the pieces of the motion; of a closed form without
// pieces, on stretches of its own pace.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <vector>

#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/error.hpp"
#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/instant.hpp"
#include "rbdyn/basics/interruption.hpp"
#include "rbdyn/closed_form/closed_form.hpp"
#include "rbdyn/event/record.hpp"
#include "rbdyn/trajectory/run_data.hpp"

namespace rbdyn::inline RBDYN_FORM {

namespace working {

[[noreturn]] void refuse_missing(double t0, double t1);

/// Whether the pieces of a record hold all of a span of time.
bool covers(const Record& record, double t0, double t1);

/// The integral of f over a span of time, t0 < t1, of the motion of one part. Throws InvalidInput where the record does
/// not hold it.
template <class F>
double integral(const Record& record, double t0, double t1, F&& f) {
    // Gauss's rule of ten points: exact for polynomials of degree 19
    static constexpr double place[5] = {0.1488743389816312, 0.4333953941292472, 0.6794095682990244, 0.8650633666889845,
                                        0.9739065285171717};
    static constexpr double weight[5] = {0.2955242247147529, 0.2692667193099963, 0.2190863625159820, 0.1494513491505806,
                                         0.0666713443086881};
    // more stretches than this take minutes
    constexpr double most = 3e7;
    DoubleDouble sum = 0.0;
    const auto add = [&](double begin, double finish) {
        const double lo = std::max(t0, begin), hi = std::min(t1, finish);
        if (!(hi > lo)) return;
        Interruption::point();
        const double centre = 0.5 * (lo + hi), half = 0.5 * (hi - lo);
        double part = 0.0;
        for (int i = 0; i < 5; ++i) part += weight[i] * (f(centre - half * place[i]) + f(centre + half * place[i]));
        sum += half * part;
    };
    if (covers(record, t0, t1)) {
        for (const auto& e : record.entries()) add(e.start.hi, (e.start + e.length * e.unit).hi);
        return double(sum);
    }
    if (!record.closed || !std::isfinite(record.closed->pace())) refuse_missing(t0, t1);
    // twice the pace is a phase of 4 rad of a power
    const double count = std::max(std::ceil(0.5 * (t1 - t0) / record.closed->pace()), 16.0);
    if (!(count <= most))
        throw InvalidInput("Trajectory: work from " + text(t0) + " to " + text(t1) + " s takes " + text(10.0 * count) +
                           " values of the power; ask for it in stretches, or for that of all forces");
    for (double i = 0.0; i < count; i += 1.0) add(t0 + (t1 - t0) * (i / count), t0 + (t1 - t0) * ((i + 1.0) / count));
    return double(sum);
}

/// The times strictly within a span at which the state of a run of one part jumps.
std::vector<double> jumps(const RunData& run, double t0, double t1);

/// What value(t, side) gains over a span, t0 < t1, of a run of one part, but for what jumps of the state make of it.
/// Throws InvalidInput where the record does not hold it.
template <class Value>
double gain(const RunData& run, double t0, double t1, Value&& value) {
    for (const double t : {t0, t1}) (void)entry_at(run.record, t, Side::after);
    DoubleDouble sum = DoubleDouble(value(t1, Side::before)) - DoubleDouble(value(t0, Side::after));
    for (const double t : jumps(run, t0, t1)) {
        // both sides, each on a piece of its own
        std::optional<std::size_t> before, after;
        try {
            before = entry_at(run.record, t, Side::before);
            after = entry_at(run.record, t, Side::after);
        } catch (const InvalidInput&) {
            refuse_missing(t0, t1);
        }
        if (before == after) refuse_missing(t0, t1);
        sum -= DoubleDouble(value(t, Side::after)) - DoubleDouble(value(t, Side::before));
    }
    return double(sum);
}

}  // namespace working

}  // namespace rbdyn::inline RBDYN_FORM
