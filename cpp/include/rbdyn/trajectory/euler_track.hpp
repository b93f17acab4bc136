// Euler angles that are continuous in time, along the motions of a run.
//
// They start as the user gave them, or with the principal values. From then on each attitude takes the angles nearest
// to those a fraction of a turn earlier (continue_from in rotation/euler_angles.hpp). The steps are kept, so that a
// motion is walked through once.
#pragma once

#include <algorithm>
#include <cmath>
#include <map>
#include <mutex>
#include <optional>
#include <tuple>
#include <utility>
#include <vector>

#include "rbdyn/basics/error.hpp"
#include "rbdyn/rotation/euler_angles.hpp"

namespace rbdyn {

class EulerTrack {
public:
    /// The angles of a body at time t, where its attitude is `now`. `given`: at the start, if they are. `motion`:
    /// attitude and |omega| at a time; times that it does not have are passed over. Where it has no start the angles
    /// are those of the attitude alone.
    template <class Motion>
    EulerAngles at(int body, double t, const Quaternion& now, double start, const std::optional<EulerAngles>& given,
                   Motion&& motion) {
        const std::lock_guard lock(mutex_);
        std::vector<Step>& steps = steps_[body];
        if (steps.empty()) {
            try {
                const auto [attitude, speed] = motion(start);
                steps.push_back({start, speed, given ? continue_from(*given, attitude) : euler_angles(attitude)});
            } catch (const InvalidInput&) {
                return euler_angles(now);
            }
        }
        while (steps.back().time < t) {
            const Step last = steps.back();
            double step = std::min(turn / last.speed, t - last.time);
            try {
                auto [attitude, speed] = motion(last.time + step);
                // a body that turns faster there may have turned far in between
                while (speed * step > 2.0 * turn && last.time + 0.5 * step > last.time) {
                    step *= 0.5;
                    std::tie(attitude, speed) = motion(last.time + step);
                }
                if (last.time + step >= t) break;
                steps.push_back({last.time + step, speed, continue_from(last.angles, attitude)});
            } catch (const InvalidInput&) {
                break;
            }
        }
        const auto later =
            std::upper_bound(steps.begin(), steps.end(), t, [](double time, const Step& s) { return time < s.time; });
        return continue_from(later == steps.begin() ? steps.front().angles : std::prev(later)->angles, now);
    }

private:
    // radians from one step to the next; a quarter of a turn would be too much
    static constexpr double turn = 0.25;
    struct Step {
        double time, speed;
        EulerAngles angles;
    };
    std::mutex mutex_;
    std::map<int, std::vector<Step>> steps_;
};

}  // namespace rbdyn
