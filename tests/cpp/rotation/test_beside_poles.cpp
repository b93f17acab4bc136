// Euler angles beside theta = 0 and pi: against regular precessions, whose angles are known by hand, and by the number
// of times that the motion is asked for.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>

#include "rbdyn/trajectory/euler_track.hpp"

namespace rbdyn::test::test_beside_poles {

constexpr double pi = std::numbers::pi;
constexpr double tilts[] = {1e-3, 1e-5, 1e-8, 1e-9, 3e-11, 1e-12};

/// A way without end fails.
void count(long long& asked) {
    if (++asked > 1000000) throw std::runtime_error("the motion is asked for too often");
}

/// A body whose third axis goes round K, at an angle beta from it, while K lies at an angle alpha from the world's
/// third axis: Rx(alpha) Rz(precession t) Rx(beta) Rz(spin t). It counts how often it is asked.
struct Precession {
    double alpha, beta, precession, spin;
    mutable long long asked = 0;

    Turning operator()(double t) const {
        count(asked);
        // by two turns a quaternion keeps its sign
        const EulerAngles within{beta, std::fmod(precession * t, 4.0 * pi), std::fmod(spin * t, 4.0 * pi)};
        return {turn({1, 0, 0}, alpha) * quaternion(within), angular_velocity(within, Vector3(0.0, precession, spin))};
    }
    Recurrence recurrence() const {
        return {{0.0, -std::sin(alpha), std::cos(alpha)}, 1.0 / (*this)(0.0).angular_velocity.norm()};
    }
    EulerAngles start() const { return {alpha + beta, 0.0, 0.0}; }
    /// After whole turns about K the axis is where it was: psi has gained a turn for each if the pole is within the
    /// circle of the axis, and phi one if it is not.
    EulerAngles after(double turns) const {
        const double t = 2.0 * pi * turns / precession;
        const bool is_upright = alpha < 0.5 * pi;
        const bool is_round = beta > (is_upright ? alpha : pi - alpha);
        const double psi = is_round ? (is_upright ? 1.0 : -1.0) * 2.0 * pi * turns : 0.0;
        return {alpha + beta, psi, spin * t + (is_round ? 0.0 : 2.0 * pi * turns)};
    }
    /// Components of the quaternion are good to a few 1e-16, times to one.
    double tolerance(double turns) const {
        const double off = std::abs(std::sin(alpha + beta));
        return 1e-15 / off + 1e-15 * (std::abs(spin / precession) + 1.0) * 2.0 * pi * turns;
    }
};

void expect_same(const EulerAngles& a, const EulerAngles& truth, double tolerance, const std::string& what) {
    EXPECT_NEAR(a.theta, truth.theta, 1e-14) << what;
    EXPECT_NEAR(a.psi, truth.psi, tolerance) << what;
    EXPECT_NEAR(a.phi, truth.phi, 2.0 * tolerance) << what;
}

TEST(BesidePoles, a_spin_about_an_axis_at_rest_moves_phi_alone_and_asks_for_no_shorter_steps) {
    for (const double tilt : tilts)
        for (const double theta : {tilt, -tilt, pi - tilt})
            for (const double spin : {4.96, -0.01}) {
                long long asked = 0;
                const auto motion = [&](double t) -> Turning {
                    count(asked);
                    return {quaternion({theta, 0.3, 0.2 + spin * t}), Vector3(0, 0, spin)};
                };
                EulerTrack track;
                const double end = 200.0 / std::abs(spin);
                for (const double t : {0.0, end, 0.37 * end}) {
                    const EulerAngles a = track.at(0, t, motion(t).attitude, 0.0, EulerAngles{theta, 0.3, 0.2}, motion);
                    expect_same(a, {theta, 0.3, 0.2 + spin * t}, 1e-15 / tilt + 1e-13, std::to_string(theta));
                }
                EXPECT_LE(asked, 8 * 200) << theta;
            }
}

TEST(BesidePoles, an_axis_that_goes_round_beside_a_pole_is_followed_in_a_few_steps_a_turn) {
    for (const double tilt : tilts)
        for (const double ratio : {0.0, 0.3, 0.9, 1.5, 40.0})
            for (const bool is_upright : {true, false})
                for (const double precession : {3.0, 0.2}) {
                    const Precession motion{is_upright ? tilt : pi - tilt, ratio * tilt, precession, 2.0};
                    EulerTrack track;
                    const double turns = 6.0, t = 2.0 * pi * turns / precession;
                    const EulerAngles a = track.at(0, t, motion(t).attitude, 0.0, motion.start(), motion);
                    expect_same(a, motion.after(turns), motion.tolerance(turns),
                                std::to_string(tilt) + " " + std::to_string(ratio));
                    EXPECT_LE(motion.asked, 20 * (precession + 2.0) * t + 200) << tilt << " " << ratio;
                }
}

TEST(BesidePoles, turns_of_what_comes_back_are_known_without_going_through_them) {
    for (const double tilt : tilts)
        for (const double ratio : {0.0, 0.3, 0.9, 1.5, 40.0})
            for (const bool is_upright : {true, false}) {
                const Precession motion{is_upright ? tilt : pi - tilt, ratio * tilt, 3.0, 2.0};
                EulerTrack track;
                for (const double turns : {1e7, 50.0, 1e6}) {
                    const double t = 2.0 * pi * turns / motion.precession;
                    const EulerAngles a =
                        track.at(0, t, motion(t).attitude, 0.0, motion.start(), motion, motion.recurrence());
                    expect_same(a, motion.after(turns), motion.tolerance(turns) * (1.0 + ratio * 1e-15 / tilt * t),
                                std::to_string(tilt) + " " + std::to_string(ratio));
                }
                EXPECT_LE(motion.asked, 3000) << tilt << " " << ratio << " " << is_upright;
            }
}

TEST(BesidePoles, a_motion_that_ends_before_it_comes_back_is_followed) {
    const Precession motion{1e-5, 1.5e-5, 3.0, 2.0};
    const double turns = 20.0, end = 2.0 * pi * turns / motion.precession;
    const auto till_end = [&](double t) {
        if (t > end) throw InvalidInput("after the end");
        return motion(t);
    };
    Recurrence late = motion.recurrence();
    late.period = 2.0 * end;
    EulerTrack track;
    const EulerAngles a = track.at(0, end, motion(end).attitude, 0.0, motion.start(), till_end, late);
    expect_same(a, motion.after(turns), motion.tolerance(turns), "");
}

TEST(BesidePoles, a_swing_is_followed_past_the_pole_and_goes_through_it_when_it_is_nearer_than_told) {
    // the axis goes along a great circle that misses the pole; past it psi has turned by nearly pi, through it by none
    for (const double miss : {1e-3, 1e-6, 1e-9, 4e-10, 2e-11, 1e-13, 0.0}) {
        long long asked = 0;
        const auto motion = [&](double t) -> Turning {
            count(asked);
            return {turn({0, 1, 0}, miss) * turn({1, 0, 0}, t - 0.5), Vector3(1, 0, 0)};
        };
        EulerTrack track;
        const EulerAngles start = euler_angles(motion(0.0).attitude);
        const EulerAngles a = track.at(0, 1.0, motion(1.0).attitude, 0.0, start, motion);
        const bool is_past = miss > 3e-10;
        EXPECT_NEAR(a.theta, is_past ? start.theta : -start.theta, 1e-14) << miss;
        EXPECT_NEAR(std::abs(a.psi - start.psi), is_past ? pi - 2.0 * std::atan(std::sin(miss) / std::tan(0.5)) : 0.0,
                    is_past ? 1e-13 : 2.0 * miss / std::tan(0.5) + 1e-13)
            << miss;
        EXPECT_NEAR(a.psi + a.phi, start.psi + start.phi, 2.0 * miss + 1e-14) << miss;
        EXPECT_LE(asked, 400) << miss;
    }
}

TEST(BesidePoles, an_attitude_that_trembles_with_rounding_costs_no_more_than_the_turns_of_the_body) {
    // theta = 0 but for noise in every component, and an angular velocity that says otherwise
    long long asked = 0;
    const auto motion = [&](double t) -> Turning {
        count(asked);
        const double noise = 1e-13 * std::sin(1e9 * t);
        return {quaternion({1e-13 + noise, 1e5 * noise, 2.0 * t}), Vector3(1e-3, 0, 2.0)};
    };
    EulerTrack track;
    const EulerAngles a = track.at(0, 50.0, motion(50.0).attitude, 0.0, EulerAngles{}, motion);
    EXPECT_NEAR(a.psi + a.phi, 100.0, 1e-6);
    EXPECT_LE(asked, 100 * 450);
}

}  // namespace rbdyn::test::test_beside_poles
