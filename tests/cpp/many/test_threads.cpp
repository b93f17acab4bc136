// One scene, one plan and one run that several threads use at the same time: the results are those of one thread alone.
// ./run sanitize threads looks at these under the thread sanitizer.
#include <gtest/gtest.h>

#include <atomic>
#include <thread>

#include "support.hpp"

namespace rbdyn::test::test_threads {
namespace {

constexpr int many = 4;

template <class F>
void at_once(const F& f) {
    std::vector<std::thread> threads;
    for (int k = 0; k < many; ++k) threads.emplace_back([&f, k] { f(k); });
    for (std::thread& thread : threads) thread.join();
}

Scene rough_hoop() {
    Scene scene({0, 0, -9.81});
    const Circle circle{.radius = 0.5, .start = {0, 0, -1}, .toward = {1, 0, 0}};
    scene.add(Particle{0.5}, Rail(circle, Coulomb{.mu_static = 0.4, .mu_dynamic = 0.1}),
              {.parameter = 0.0, .speed = 7.0});
    return scene;
}

Scene top() {
    Scene scene({0, 0, -9.81});
    scene.add(RigidBody(0.5, Vector3(0.002, 0.0019, 0.001)), Spherical{.point = {0.001, 0, -0.05}},
              {.attitude = EulerAngles{0.3, 0.0, 0.0}, .angular_velocity = Vector3(0, 0, 60)});
    return scene;
}

// the plan is made by whichever comes first, and kept in the scene that all of them share
TEST(Threads, that_run_one_scene_at_once_have_the_run_made_alone) {
    for (const bool is_rigid : {false, true}) {
        const Scene scene = is_rigid ? top() : rough_hoop(), alone = is_rigid ? top() : rough_hoop();
        const SimulateOptions options{.until = is_rigid ? 0.2 : 2.0, .error = 1e-9};
        const Trajectory wanted = simulate(alone, options);
        const BodyHandle body{0};
        std::vector<Vector3> places(many);
        std::vector<std::size_t> events(many);
        at_once([&](int k) {
            const Trajectory run = simulate(scene, options);
            places[static_cast<std::size_t>(k)] = run[body].position(options.until);
            events[static_cast<std::size_t>(k)] = run.events().size();
        });
        for (int k = 0; k < many; ++k) {
            EXPECT_EQ(places[static_cast<std::size_t>(k)], wanted[body].position(options.until));
            EXPECT_EQ(events[static_cast<std::size_t>(k)], wanted.events().size());
        }
    }
}

// angles are counted as they are asked for, and what is counted is kept in the run
TEST(Threads, that_ask_one_run_at_once_hear_what_one_hears) {
    const Trajectory run = simulate(top(), {.until = 0.5, .error = 1e-9}), alone = simulate(top(), {.until = 0.5});
    const BodyHandle body{0};
    std::vector<double> psi(many), energies(many);
    at_once([&](int k) {
        const auto place = static_cast<std::size_t>(k);
        for (int i = 0; i <= 20; ++i) psi[place] = run[body].euler_angles(0.5 * ((i * (k + 3)) % 21) / 20.0).psi;
        psi[place] = run[body].euler_angles(0.5).psi;
        energies[place] = run.energy(0.25);
    });
    for (int k = 0; k < many; ++k) {
        EXPECT_EQ(psi[static_cast<std::size_t>(k)], run[body].euler_angles(0.5).psi);
        EXPECT_EQ(energies[static_cast<std::size_t>(k)], run.energy(0.25));
    }
    EXPECT_NEAR(psi[0], alone[body].euler_angles(0.5).psi, 1e-8);
}

TEST(Threads, stop_a_run_that_another_thread_watches) {
    std::atomic<bool> stops{false};
    std::atomic<double> reached{0.0};
    const Scene scene = top();
    Status status = Status::reached_end;
    std::thread run([&] {
        const Monitor monitor = [&](double t) {
            reached = t;
            return !stops;
        };
        status = attempt(scene, {.until = 1e6, .rtol = 1e-9, .keep = {.what = Keep::What::end}, .monitor = monitor})
                     .run.status();
    });
    while (!(reached > 0.01)) std::this_thread::yield();
    stops = true;
    run.join();
    EXPECT_EQ(status, Status::stopped_by_user);
}

}  // namespace
}  // namespace rbdyn::test::test_threads
