// Euler angles that are continuous in time, along the motions of a run.
//
// They start as the user gave them, or with the principal values, and go on without jumps (rotation/euler_path.hpp).
// The steps are kept, so that a motion is walked through once; one in closed form that repeats itself is not walked
// through at all (rotation/euler_turns.hpp).
#pragma once

#include <algorithm>
#include <map>
#include <mutex>
#include <optional>
#include <vector>

#include "rbdyn/basics/error.hpp"
#include "rbdyn/basics/form.hpp"
#include "rbdyn/rotation/euler_angles.hpp"
#include "rbdyn/rotation/euler_path.hpp"
#include "rbdyn/rotation/euler_turns.hpp"
#include "rbdyn/rotation/quaternion.hpp"

namespace rbdyn::inline RBDYN_FORM {

class EulerTrack {
public:
    /// The angles of a body at time t, where its attitude is `now`. `given`: at the start, if they are. `motion`: a
    /// Turning at a time; times that it does not have are passed over. Where it has no start the angles are those of
    /// the attitude alone. `recurrence`: of the motion, if it is known to repeat itself.
    template <class Motion>
    EulerAngles at(int body, double t, const Quaternion& now, double start, const std::optional<EulerAngles>& given,
                   Motion&& motion, const std::optional<Recurrence>& recurrence = std::nullopt) {
        const std::lock_guard lock(mutex_);
        Known& known = known_[body];
        std::vector<EulerStep>& steps = known.steps;
        if (steps.empty()) {
            try {
                const Turning first = motion(start);
                steps.push_back({start, first, euler_path::begin(first, given)});
            } catch (const InvalidInput&) {
                return euler_angles(now);
            }
        }
        const auto keep = [&](const EulerStep& s) { steps.push_back(s); };
        try {
            if (recurrence && (t - steps.back().time) * steps.back().speed > few) {
                // away from the start, which may be a pole; a period that is not over by t says nothing sooner, and the
                // run may end before it
                const double later =
                    std::max(start + 2.0 * euler_path::longest / steps.front().speed, steps.back().time);
                if (!known.is_tried && later + recurrence->period <= t) {
                    known.is_tried = true;
                    euler_path::follow(steps.back(), later, motion, keep);
                    known.turns = EulerTurns::of(*recurrence, steps.back(), motion);
                }
                if (known.turns) {
                    known.turns->reach(t, motion);
                    if (const auto angles = known.turns->at(t, now)) return *angles;
                }
            }
            if (t >= steps.back().time)
                return continue_from(euler_path::follow(steps.back(), t, motion, keep).angles, now);
            const auto later = std::upper_bound(steps.begin(), steps.end(), t,
                                                [](double time, const EulerStep& s) { return time < s.time; });
            if (later == steps.begin()) return continue_from(steps.front().angles, now);
            // between two steps beside a pole there may be more
            const auto forget = [](const EulerStep&) {};
            return continue_from(euler_path::follow(*std::prev(later), t, motion, forget).angles, now);
        } catch (const InvalidInput&) {
            // what was not kept says nothing of turns; theta stays on its side
            return euler_path::beside(steps.back().angles, now);
        }
    }

private:
    // radians that are walked sooner than a period
    static constexpr double few = 50.0;
    struct Known {
        std::vector<EulerStep> steps;
        std::optional<EulerTurns> turns;
        bool is_tried = false;
    };
    std::mutex mutex_;
    std::map<int, Known> known_;
};

}  // namespace rbdyn::inline RBDYN_FORM
