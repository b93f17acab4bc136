// What steps must not lose of a rigid body's motion: one application brings a state that is a little off back to its
// first integrals, to second order in how far it is off, whichever of its numbers is.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <functional>
#include <numbers>
#include <variant>
#include <vector>

#include "rbdyn/special/ball_law.hpp"
#include "rbdyn/special/hinge_law.hpp"
#include "rbdyn/special/projection.hpp"
#include "support.hpp"

namespace rbdyn::test::test_projection {
namespace {

using Real = long double;
using Wide = Eigen::Matrix<Real, 3, 1>;
using State = std::vector<double>;

constexpr Real arm = 0.25L, mass = 2.0L;
const Vector3 moments(0.5, 0.75, 1.0);

/// The value of a variable, with its digits beyond doubles.
Real value(const State& x, const State& low, std::size_t i) {
    return static_cast<Real>(x[i]) + static_cast<Real>(low[i]);
}

/// A vector of the body in the world, or back.
Wide turned(const State& x, const State& low, const Wide& v, Real sign) {
    const Real w = value(x, low, 0);
    const Wide r = sign * Wide(value(x, low, 1), value(x, low, 2), value(x, low, 3));
    const Real square = w * w + r.squaredNorm();
    return v + (2.0L / square) * r.cross(r.cross(v) + w * v);
}

/// First integrals of a body held at a point, from what the words mean.
struct Integrals {
    Real energy, vertical;
    Wide momentum;  // in the world
};
/// `moment`: principal moments about the point; G on the third axis.
Integrals integrals(const State& x, const State& low, std::size_t first_rate, const Wide& moment, Real weight) {
    const Wide omega(value(x, low, first_rate), value(x, low, first_rate + 1), value(x, low, first_rate + 2));
    const Wide k = moment.cwiseProduct(omega), axis = turned(x, low, Wide(0, 0, 1), 1.0L);
    const Wide in_world = turned(x, low, k, 1.0L);
    return {0.5L * omega.dot(k) + weight * arm * axis[2], in_world[2], in_world};
}

/// Of the only body of a scene.
template <class Law, class Joint>
Law law_of(const Scene& scene) {
    return Law(scene, 0, std::get<Joint>(scene.bodies()[0].joint));
}
BallLaw ball_law_of(const Scene& scene) { return law_of<BallLaw, Spherical>(scene); }

/// Far from any special place.
const State anywhere{0.4, -0.2, 0.8, 0.4};

TEST(Projections, bring_a_heavy_body_back_to_its_energy_and_its_momentum_about_the_vertical) {
    for (const bool is_symmetric : {false, true}) {
        Scene scene(down);
        const Vector3 about_point = is_symmetric ? Vector3(0.75, 0.75, 1.0) : moments;
        // about G, by Steiner's theorem
        const auto shift = static_cast<double>(mass * arm * arm);
        scene.add(RigidBody(2.0, Inertia{about_point[0] - shift, about_point[1] - shift, about_point[2]}),
                  Spherical{.point = {0.0, 0.0, -0.25}}, SphericalStart{});
        const BallLaw law = ball_law_of(scene);
        ASSERT_EQ(law.follows_axis, is_symmetric);
        const std::size_t rates = is_symmetric ? 5 : 4;
        State x = anywhere;
        if (is_symmetric) x.push_back(0.5);
        x.insert(x.end(), {0.75, -1.25, 2.5});
        const State none(x.size(), 0.0);
        const RigidProjection held(law, 0, static_cast<int>(rates), x, none);
        const Wide moment = about_point.cast<Real>();
        const Integrals wanted = integrals(x, none, rates, moment, mass * gravity);
        constexpr double off = 0x1p-26;
        for (std::size_t i = 0; i < x.size(); ++i) {
            if (is_symmetric && (i == 4 || i == 7)) continue;  // the spin is what it is, and its rate is held exactly
            State y = x, low = none;
            y[i] += off;
            const Integrals before = integrals(y, low, rates, moment, mass * gravity);
            const Real amiss = std::abs(before.energy - wanted.energy) + std::abs(before.vertical - wanted.vertical);
            held.apply(y, low, 0.0, 0.0);
            const Integrals after = integrals(y, low, rates, moment, mass * gravity);
            EXPECT_LE(std::abs(after.energy - wanted.energy), 1e3L * off * off) << is_symmetric << ' ' << i;
            EXPECT_LE(std::abs(after.vertical - wanted.vertical), 1e3L * off * off) << is_symmetric << ' ' << i;
            Real norm = 0.0L;
            for (std::size_t k = 0; k < 4; ++k) norm += value(y, low, k) * value(y, low, k);
            EXPECT_LE(std::abs(norm - 1.0L), 1e3L * off * off);
            if (i >= 4) {
                EXPECT_GT(amiss, 1e-3L * off) << i;
            }
        }
    }
}

TEST(Projections, bring_a_free_body_back_to_its_energy_and_its_angular_momentum) {
    Scene scene;
    scene.add(RigidBody(2.0, Inertia{moments[0], moments[1], moments[2]}), Spherical{}, SphericalStart{});
    const BallLaw law = ball_law_of(scene);
    State x = anywhere;
    x.insert(x.end(), {0.75, -1.25, 2.5});
    const State none(x.size(), 0.0);
    const RigidProjection held(law, 0, 4, x, none);
    const Wide moment = moments.cast<Real>();
    const Integrals wanted = integrals(x, none, 4, moment, 0.0L);
    constexpr double off = 0x1p-26;
    for (std::size_t i = 0; i < x.size(); ++i) {
        State y = x, low = none;
        y[i] += off;
        held.apply(y, low, 0.0, 0.0);
        const Integrals after = integrals(y, low, 4, moment, 0.0L);
        EXPECT_LE(std::abs(after.energy - wanted.energy), 1e3L * off * off) << i;
        EXPECT_LE((after.momentum - wanted.momentum).norm(), 1e3L * off * off) << i;
    }
}

TEST(Projections, bring_a_pendulum_back_to_its_energy_wherever_it_is) {
    Scene scene(down);
    scene.add(RigidBody(2.0, Inertia{0.5, 0.25, 0.25}, {.com = {0.0, 0.0, -0.5}}), Revolute{.axis = {1, 0, 0}},
              RevoluteStart{});
    const HingeLaw law = law_of<HingeLaw, Revolute>(scene);
    const auto moment = static_cast<Real>(law.exact.moments[2].hi);
    EXPECT_NEAR(static_cast<double>(moment), 0.5 + 2.0 * 0.25, 4 * epsilon);
    // both halves of the circle, its lowest place with all the energy in the rate, and its highest
    for (const double angle : {0.0, 0.75, 1.5, 2.5, 3.0, -2.0})
        for (const double rate : {1.5, -0.25}) {
            const State x{angle, rate}, none(2, 0.0);
            const HingeProjection held(law, 0, 1, x, none);
            // m g 1/2 (1 - cos), without cancellation: only differences matter, of less than a turn
            const auto energy = [&](const State& y, const State& low) {
                const Real s = std::sin(0.5L * value(y, low, 0)), w = value(y, low, 1);
                return 0.5L * moment * w * w + 2.0L * mass * gravity * 0.5L * s * s;
            };
            const Real wanted = energy(x, none);
            constexpr double off = 0x1p-26;
            for (std::size_t i = 0; i < 2; ++i) {
                State y = x, low = none;
                y[i] += off;
                held.apply(y, low, 0.0, 0.0);
                EXPECT_LE(std::abs(energy(y, low) - wanted), 1e3L * off * off) << angle << ' ' << rate << ' ' << i;
            }
        }
}

// of 5/3, the ratio of two moments, doubles lack 1e-16: a free body would turn so much too slowly
TEST(Projections, make_up_for_what_rounded_coefficients_leave_out_of_a_step) {
    Scene scene;
    scene.add(RigidBody(2.0, Inertia{0.75, 0.75, 1.25}), Spherical{}, SphericalStart{});
    const BallLaw law = ball_law_of(scene);
    ASSERT_TRUE(law.follows_axis);
    State x = anywhere;
    x.insert(x.end(), {0.5, 0.75, -1.25, 2.5});
    const State none(x.size(), 0.0);
    const RigidProjection held(law, 0, 5, x, none);
    State y = x, low = none;
    constexpr double step = 0x1p10;
    held.apply(y, low, step, 0.0);
    const Real rest = 5.0L / 3.0L - static_cast<Real>(static_cast<double>(5.0L / 3.0L));
    // omega goes round the axis by so much more
    const Real turn = rest * static_cast<Real>(x[7]) * static_cast<Real>(step);
    const Real one = (static_cast<Real>(y[5]) - x[5]) + low[5], two = (static_cast<Real>(y[6]) - x[6]) + low[6];
    const Real angle = (x[5] * two - x[6] * one) / (x[5] * x[5] + x[6] * x[6]);
    EXPECT_NEAR(static_cast<double>(angle / turn), 1.0, 0.01);
}

TEST(Projections, keep_a_spin_within_two_turns) {
    Scene scene;
    scene.add(RigidBody(2.0, Inertia{0.75, 0.75, 1.25}), Spherical{}, SphericalStart{});
    const BallLaw law = ball_law_of(scene);
    for (const double spin : {7.5, 9.0, -9.0, 12.5}) {
        State x = anywhere;
        x.insert(x.end(), {spin, 0.75, -1.25, 2.5});
        State low(x.size(), 0.0);
        RigidProjection(law, 0, 5, x, low).apply(x, low, 0.0, 0.0);
        EXPECT_LE(std::abs(x[4]), 8.0) << spin;
        // by whole turns of the body and of the quaternion that halves them
        const Real turns = (value(x, low, 4) - static_cast<Real>(spin)) / (4.0L * std::numbers::pi_v<Real>);
        EXPECT_NEAR(static_cast<double>(turns), std::round(static_cast<double>(turns)), 1e-18) << spin;
    }
}

}  // namespace
}  // namespace rbdyn::test::test_projection
