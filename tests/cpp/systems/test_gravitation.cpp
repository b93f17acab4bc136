// Particles under their gravitation against reference digits, and what becomes of two that meet.
#include <gtest/gtest.h>

#include <chrono>

#include "scenes.hpp"
#include "support.hpp"

namespace rbdyn::test::test_gravitation {
namespace {

using nlohmann::json;

/// Positions and velocities at all samples until a time: within what is told, and what doubles can hold of a state that
/// is carried on; a closed form does without that.
void hold_to(const std::string& name, double error, double until, const std::string& engine = "taylor") {
    const json file = reference(name);
    const Attracted made(file);
    const json& samples = file["values"]["samples"];
    // growth of a disturbance, in units of the last place of the largest coordinate
    const json growth = *file["conditioning"].begin();
    std::vector<double> times;
    for (const json& s : samples)
        if (digits(s["t"]) <= until) times.push_back(static_cast<double>(digits(s["t"])));
    const Attempt run = attempt(made.scene, {.until = times.back(), .error = error, .engine = engine});
    ASSERT_EQ(run.outcome, simulating::Outcome::good) << name << " at " << error << ": " << run.message;
    ASSERT_TRUE(run.run.error());
    EXPECT_LE(*run.run.error(), error) << name;
    std::vector<Scales> own;
    for (const BodyHandle b : made.bodies) own.push_back(scales(run.run, b));
    for (std::size_t k = 0; k < times.size(); ++k) {
        const double held = engine == "closed form" ? 0.0 : 64.0 * epsilon * static_cast<double>(digits(growth[k]));
        for (std::size_t i = 0; i < made.bodies.size(); ++i) {
            const std::string what =
                name + " at " + text(error) + ", body " + std::to_string(i + 1) + ", t = " + text(times[k]);
            const double size = std::max(own[i].extent, vector3(samples[k]["position"][i]).norm());
            EXPECT_LE(off(run.run[made.bodies[i]].position(times[k]), samples[k]["position"][i]),
                      *run.run.error() * own[i].extent + held * size)
                << what;
            EXPECT_LE(off(run.run[made.bodies[i]].velocity(times[k]), samples[k]["velocity"][i]),
                      *run.run.error() * own[i].speed + held * own[i].speed)
                << what;
        }
    }
    // far from the origin the distance of two, 1 m at the start, is a difference of what is rounded
    const double digits_lost = engine == "closed form" ? std::max(own[0].extent, 1.0) : 1.0;
    const auto drift = run.run.drift();
    for (const char* integral : {"energy", "momentum x", "momentum y", "momentum z", "angular momentum"}) {
        ASSERT_TRUE(drift.contains(integral)) << name << ": " << integral;
        EXPECT_LE(drift.at(integral), 10.0 * *run.run.error() + 64.0 * epsilon * digits_lost)
            << name << " at " << error << ": " << integral;
    }
}

TEST(Gravitation, moves_the_pleiades_and_the_figure_of_eight_as_the_reference_digits_say) {
    for (const double error : {1e-6, 1e-9, 1e-12}) {
        hold_to("o_pleiades", error, 3.0);
        hold_to("o_figure_eight", error, 100.0);
    }
}

TEST(Gravitation, moves_keplers_ellipses_as_the_reference_digits_say) {
    for (const double error : {1e-6, 1e-9, 1e-12}) hold_to("o_kepler_e01", error, 64.0);
    for (const double error : {1e-6, 1e-9}) hold_to("o_kepler_e09", error, 1800.0);
    hold_to("o_kepler_e01", 1e-6, 700.0);
    hold_to("o_kepler_e0999", 1e-6, 2e5);
    // a thousand turns, passages of the pericentre among them, to the last digits
    for (const char* name : {"o_kepler_e01", "o_kepler_e09", "o_kepler_e0999"})
        hold_to(name, 1e-12, 1e10, "closed form");
}

/// Two particles that start at rest fall together in pi sqrt(r^3 / (8 G M)).
TEST(Gravitation, that_makes_two_bodies_meet_ends_the_run_by_its_name_and_at_its_time) {
    const double constant = 1.5, first = 1.0, second = 2.0;
    for (const bool is_skew : {false, true})
        for (const char* engine : {"taylor", "dop853"}) {
            Scene scene;
            const Vector3 apart = is_skew ? Vector3(2.0, -0.3, 0.6) : Vector3(2.0, 0.0, 0.0);
            const Vector3 drifting = is_skew ? Vector3(0.1, 0.2, 0.0) : Vector3(0, 0, 0);
            const auto a = scene.add(Particle{first}, {.velocity = drifting}, "sun");
            const auto b = scene.add(Particle{second}, {.position = apart, .velocity = drifting}, "planet");
            scene.connect(Gravitation{constant}, a, b);
            const double time =
                std::numbers::pi * std::sqrt(std::pow(apart.norm(), 3) / (8.0 * constant * (first + second)));
            const auto before = std::chrono::steady_clock::now();
            const Attempt made = attempt(scene, {.until = 100.0, .error = 1e-9, .engine = engine});
            EXPECT_LT(std::chrono::duration<double>(std::chrono::steady_clock::now() - before).count(), 10.0);
            EXPECT_EQ(made.outcome, simulating::Outcome::broken) << engine;
            EXPECT_EQ(made.run.status(), Status::not_finite) << engine;
            EXPECT_NEAR(made.run.end(), time, 1e-8 * time) << engine;
            for (const char* part : {"gravitation", "sun", "planet", "they meet"})
                EXPECT_NE(made.message.find(part), std::string::npos) << made.message;
        }
}

}  // namespace
}  // namespace rbdyn::test::test_gravitation
