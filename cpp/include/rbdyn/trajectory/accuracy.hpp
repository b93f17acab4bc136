// The estimate of the global error: a run held against a more accurate one, event by event.
//
// Measured against the motion's own scales: positions to the extent of that body's motion, velocities and reactions
// to their largest magnitude, times of events to the time since the start. Between events both runs are compared at
// the same times, where both are in the same mode; at events their times are. Where the sequences of events differ,
// the result is certain up to the first difference.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "rbdyn/event/record.hpp"
#include "rbdyn/model/points.hpp"

namespace rbdyn {

/// How far a run is from a more accurate one.
struct Comparison {
    double error = 0.0;        // largest relative difference
    double certain_until = 0;  // s, up to where it is at most what was asked
    bool same_events = true;
};

class AccuracyCheck {
public:
    AccuracyCheck(const PointsModel& model, double wanted) : model_(model), wanted_(wanted) {}

    Comparison operator()(const Record& run, const Record& better) {
        Comparison result;
        result.certain_until = run.end.hi;
        differences_.clear();
        scales_.assign(static_cast<std::size_t>(model_.bodies()), {});
        const double start = run.start;
        const double span = std::max(run.end.hi - start, std::numeric_limits<double>::min());

        // times of events
        double uncertain = std::numeric_limits<double>::infinity();
        const std::size_t common = std::min(run.events.size(), better.events.size());
        std::size_t k = 0;
        for (; k < common; ++k) {
            const Event &a = run.events[k], &b = better.events[k];
            if (a.kind != b.kind || a.subject != b.subject) break;
            const double error = std::abs(a.instant - b.instant) /
                                 std::max(b.instant - Instant{start, 0.0}, std::numeric_limits<double>::min());
            differences_.push_back({a.time, error, -1, 0});
        }
        const auto first_left = [&](const Record& r) { return k < r.events.size() ? r.events[k].time : uncertain; };
        const double odd = std::min(first_left(run), first_left(better));
        // one event more or less within the error of the end is no difference
        if (odd < run.end.hi - wanted_ * span) {
            result.same_events = false;
            uncertain = odd;
        }

        compare_motion(run, better, uncertain);
        for (const Difference& d : differences_) {
            const double error = d.body < 0 ? d.value : relative(d);
            result.error = std::max(result.error, error);
            if (error > wanted_) uncertain = std::min(uncertain, d.time);
        }
        // rounding: what two runs share is not seen by comparing them
        const double steps = static_cast<double>(std::max<std::size_t>(run.entries().size(), 1));
        result.error = std::max(result.error, std::numeric_limits<double>::epsilon() * std::sqrt(steps));
        if (!result.same_events) result.error = std::numeric_limits<double>::infinity();
        result.certain_until = std::min(result.certain_until, uncertain);
        return result;
    }

private:
    struct Difference {
        double time, value;
        int body, kind;  // 0 position, 1 velocity, 2 reaction
    };
    struct Scale {
        Vector3 low = Vector3::Constant(std::numeric_limits<double>::infinity());
        Vector3 high = Vector3::Constant(-std::numeric_limits<double>::infinity());
        double velocity = 0.0, reaction = 0.0;
    };

    double relative(const Difference& d) const {
        const Scale& s = scales_[static_cast<std::size_t>(d.body)];
        const double scale = d.kind == 0 ? (s.high - s.low).norm() : d.kind == 1 ? s.velocity : s.reaction;
        return scale > 0.0 ? d.value / scale : 0.0;
    }

    void compare_motion(const Record& run, const Record& better, double until) {
        std::vector<double> x(static_cast<std::size_t>(run.variables)), y(x.size());
        std::size_t j = 0;  // piece of the better run
        for (std::size_t i = 0; i < run.entries().size(); ++i) {
            const auto& entry = run.entries()[i];
            const Piece piece = run.piece(i);
            for (double fraction : {0.5, 1.0}) {
                const double tau = fraction * entry.length;
                const Instant at = piece.at(tau);
                if (at.hi >= until) return;
                while (j + 1 < better.entries().size() && at - better.entries()[j + 1].start > 0.0) ++j;
                const auto& other = better.entries()[j];
                // just before an event one run may be past it already: its time tells
                if (!same_mode(run.mode(i), better.mode(j))) continue;
                const Piece fine = better.piece(j);
                const double place = (at - fine.start) / fine.unit;
                if (place > other.length * (1.0 + 1e-9)) continue;
                piece.state(tau, x);
                fine.state(std::clamp(place, 0.0, other.length), y);
                for (int body = 0; body < model_.bodies(); ++body) {
                    const PointReport a = model_.report(run.mode(i), body, at.hi, x);
                    const PointReport b = model_.report(better.mode(j), body, at.hi, y);
                    Scale& s = scales_[static_cast<std::size_t>(body)];
                    s.low = s.low.cwiseMin(b.position);
                    s.high = s.high.cwiseMax(b.position);
                    s.velocity = std::max(s.velocity, b.velocity.norm());
                    s.reaction = std::max(s.reaction, b.reaction.norm());
                    differences_.push_back({at.hi, (a.position - b.position).norm(), body, 0});
                    differences_.push_back({at.hi, (a.velocity - b.velocity).norm(), body, 1});
                    if (s.reaction > 0.0) differences_.push_back({at.hi, (a.reaction - b.reaction).norm(), body, 2});
                }
            }
        }
    }

    static bool same_mode(const Mode& a, const Mode& b) { return a.slip == b.slip; }

    const PointsModel& model_;
    double wanted_;
    std::vector<Difference> differences_;
    std::vector<Scale> scales_;
};

}  // namespace rbdyn
