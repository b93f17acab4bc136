// Momenta, energies, external forces and the cardinal equations, of systems and of parts of them.
#include <gtest/gtest.h>

#include <iostream>

#include "refusal.hpp"
#include "scenes.hpp"
#include "support.hpp"

namespace rbdyn::test::test_theorems {
namespace {

using nlohmann::json;

const auto pole_of_all = [](const auto& t) {
    using T = std::decay_t<decltype(t)>;
    return Vector3Of<T>{sin(t), cos(2.0 * t), 0.3 * t};
};

/// The cases k_*: particles with internal forces, a drag, a force that grows, a moving pole.
struct Case {
    json file;
    Scene scene;
    std::vector<BodyHandle> bodies;

    explicit Case(const std::string& name) : file(reference(name)) {
        const json& p = file["parameters"];
        const auto number = [&](const char* key) { return p.contains(key) ? parameter(file, key) : 0.0; };
        scene.set_gravity({0.0, 0.0, -number("g")});
        const json &r = p["positions0"]["value"], &v = p["velocities0"]["value"];
        for (std::size_t i = 0; i < r.size(); ++i) {
            const double mass = parameter(file, ("m" + std::to_string(i + 1)).c_str());
            bodies.push_back(scene.add(Particle{mass}, {vector3(r[i]), vector3(v[i])}));
            scene.apply(Drag{.linear = number("drag_c")}, bodies.back());
        }
        const double ramp = number("ramp_on_point_1_x");
        if (ramp != 0.0)
            scene.apply(Force([ramp](const auto& t, const auto&, const auto&) {
                            using T = std::decay_t<decltype(t)>;
                            return Vector3Of<T>{ramp * t, T(0.0), T(0.0)};
                        }),
                        bodies[0]);
        const double k = number("k"), length = number("L"), twist = number("twist_noncentral");
        for (std::size_t j = 0; j < bodies.size(); ++j)
            for (std::size_t i = 0; i < j; ++i) {
                if (p["internal_law"] == "gravity")
                    scene.connect(Gravitation{number("G")}, bodies[i], bodies[j]);
                else if (twist == 0.0)
                    scene.connect(Spring{.stiffness = k, .rest_length = length}, bodies[i], bodies[j]);
                else
                    scene.connect(
                        PairForce([=](const auto&, const auto& ra, const auto& rb, const auto&, const auto&) {
                            using T = std::decay_t<decltype(ra[0])>;
                            const Vector3Of<T> d = rb - ra;
                            const T distance = rbdyn::length(d, "distance");
                            const T pull = k * (1.0 - length / distance);
                            return Vector3Of<T>{pull * d[0] - twist * d[1], pull * d[1] + twist * d[0], pull * d[2]};
                        }),
                        bodies[i], bodies[j]);
            }
    }
    Pole pole() const {
        const json& c = file["parameters"]["pole_Omega(t)=a+b t+c t^2"]["value"];
        const Vector3 p = vector3(c[0]), q = vector3(c[1]), r = vector3(c[2]);
        return Pole([=](const auto& t) {
            using T = std::decay_t<decltype(t)>;
            return Vector3Of<T>{p[0] + t * (q[0] + t * r[0]), p[1] + t * (q[1] + t * r[1]),
                                p[2] + t * (q[2] + t * r[2])};
        });
    }
};

TEST(Theorems, are_as_the_reference_digits_say) {
    for (const char* name : {"k_two_body_kepler", "k_four_springs_isolated", "k_three_gravity_in_uniform_g",
                             "k_three_noncentral_counterexample"})
        for (const double error : {1e-6, 1e-9, 1e-12}) {
            const Case made(name);
            const json& samples = made.file["values"]["samples"];
            const double until = static_cast<double>(digits(samples.back()["t"]));
            const Trajectory run = simulate(made.scene, {.until = until, .error = error});
            const Pole pole = made.pole();
            double extent = 0.0, speed = 0.0;
            for (const BodyHandle b : made.bodies) {
                const Scales own = scales(run, b);
                extent = std::max(extent, own.extent + run[b].position(until).norm());
                speed = std::max(speed, own.speed);
            }
            // of quantities that are products of places and velocities
            const double scale = std::max(1.0, extent) * std::max({1.0, speed, speed * speed}),
                         near = 50.0 * error * scale;
            double worst = 0.0;
            for (const json& s : samples) {
                const double t = static_cast<double>(digits(s["t"]));
                const std::string what = std::string(name) + " at " + text(error) + ", t = " + text(t);
                EXPECT_LE(off(run.center_of_mass(t), s["G"]), near) << what;
                EXPECT_LE(off(run.center_of_mass_velocity(t), s["v_G"]), near) << what;
                EXPECT_LE(off(run.momentum(t), s["momentum_Q"]), near) << what;
                EXPECT_LE(off(run.external_force(t), s["R_external"]), near) << what;
                EXPECT_LE(off(run.angular_momentum(t, pole), s["K_Omega"]), near) << what;
                EXPECT_LE(off(run.angular_momentum(t, Pole(Vector3(vector3(s["G"])))), s["K_G"]), near) << what;
                EXPECT_LE(off(run.angular_momentum(t), s["K_origin"]), near) << what;
                EXPECT_LE(off(run.external_moment(t, pole), s["M_Omega_external"]), near) << what;
                EXPECT_NEAR(run.kinetic_energy(t), static_cast<double>(digits(s["T"])), near) << what;
                EXPECT_NEAR(run.relative_kinetic_energy(t), static_cast<double>(digits(s["T_centre_of_mass_frame"])),
                            near)
                    << what;
                EXPECT_NEAR(run.power(t),
                            static_cast<double>(digits(s["power_internal"]) + digits(s["power_external"])), 20.0 * near)
                    << what;
                worst = std::max({worst, off(run.center_of_mass(t), s["G"]), off(run.momentum(t), s["momentum_Q"]),
                                  off(run.angular_momentum(t, pole), s["K_Omega"]),
                                  std::abs(run.kinetic_energy(t) - static_cast<double>(digits(s["T"])))});
                // the second of them lacks the moment of what is not central
                const auto [first, second] = run.cardinal_residuals(t, pole);
                EXPECT_LE(first.norm(), 1e-13) << what;
                EXPECT_LE(off(-second, s["M_internal"]), 20.0 * near + 1e-12) << what;
                if (std::string(name) != "k_three_noncentral_counterexample") {
                    EXPECT_LE(second.norm(), 1e-12) << what;
                    EXPECT_NEAR(run.potential(t), static_cast<double>(digits(s["U_internal"]) + digits(s["U_gravity"])),
                                near)
                        << what;
                }
            }
            if (setting("RBDYN_TEST_TABLE", 0) != 0)
                std::cout << name << "  asked " << error << "  estimate " << *run.error() << "  true " << worst / scale
                          << '\n';
            const auto drift = run.drift();
            const bool is_central = std::string(name) != "k_three_noncentral_counterexample";
            EXPECT_TRUE(drift.contains("momentum x")) << name;
            EXPECT_EQ(drift.contains("energy"), is_central) << name;
            EXPECT_EQ(drift.contains("angular momentum") || drift.contains("angular momentum z"), is_central) << name;
            for (const auto& [integral, value] : drift) EXPECT_LE(value, 10.0 * error) << name << ": " << integral;
        }
}

/// Sizes of the terms of both cardinal equations, with every force by itself.
std::pair<double, double> sizes_of_terms(const Trajectory& run, double t, const Vector3& pole,
                                         const Vector3& velocity) {
    double force = 0.0, moment = 0.0;
    for (int i = 0; i < static_cast<int>(run.scene().bodies().size()); ++i) {
        const BodyHandle b{i};
        const Scene::Body& body = run.scene().bodies()[static_cast<std::size_t>(i)];
        const PointReport r = run[b].report(t);
        const double arm = (r.position - pole).norm() + pole.norm() + r.position.norm() + 1.0;
        double own = r.force.norm() + r.reaction.norm() + body.mass() * r.acceleration.norm();
        for (std::size_t k = 0; k < run.scene().connections().size(); ++k) {
            const auto& c = run.scene().connections()[k];
            if (body_of(c.a) == i || body_of(c.b) == i) own += run[CouplingHandle{static_cast<int>(k)}].force(t).norm();
        }
        force += own;
        moment += arm * own + velocity.norm() * body.mass() * r.velocity.norm();
        if (body.rigid() == nullptr) continue;
        const RigidReport rigid = run[b].rigid(t);
        moment += rigid.reaction_torque.norm() + rigid.torque_effort + rigid.moment.norm() +
                  rigid.spin_momentum.norm() * (1.0 + rigid.angular_velocity.norm());
    }
    return {force, moment};
}

TEST(Theorems, cardinal_equations_hold_to_rounding_with_a_moving_pole_for_all_and_for_parts) {
    Random random(3);
    for (int round = 0; round < 40; ++round) {
        const Scene scene = random_system(random);
        const Attempt made = attempt(scene, {.until = 1.0, .rtol = 1e-9});
        const Trajectory& run = made.run;
        const int count = static_cast<int>(scene.bodies().size());
        for (const double share : {0.0, 0.37, 0.9}) {
            const double t = share * run.end();
            const Vector3 place(std::sin(t), std::cos(2.0 * t), 0.3 * t),
                velocity(std::cos(t), -2.0 * std::sin(2.0 * t), 0.3);
            const auto [force, moment] = sizes_of_terms(run, t, place, velocity);
            std::vector<Trajectory::Bodies> parts{{}, {BodyHandle{0}}, {BodyHandle{count - 1}, BodyHandle{0}}};
            for (const auto& part : parts) {
                const auto [first, second] = run.cardinal_residuals(t, Pole(pole_of_all), part);
                EXPECT_LE(first.norm(), 100.0 * epsilon * force) << "round " << round;
                EXPECT_LE(second.norm(), 100.0 * epsilon * moment) << "round " << round;
            }
            // about a body and a point of one
            const auto [first, second] = run.cardinal_residuals(t, BodyHandle{0});
            EXPECT_LE(second.norm(),
                      100.0 * epsilon * (moment + force * (10.0 + run[BodyHandle{0}].velocity(t).norm())))
                << "round " << round;
        }
    }
}

TEST(Theorems, sums_of_parts_are_those_written_out_and_external_forces_of_parts_add_up) {
    Random random(11);
    for (int round = 0; round < 20; ++round) {
        const Scene scene = random_system(random);
        const Attempt made = attempt(scene, {.until = 1.0, .rtol = 1e-9});
        const Trajectory& run = made.run;
        const double t = 0.6 * run.end();
        const int count = static_cast<int>(scene.bodies().size());
        Vector3 q = Vector3::Zero(), force = Vector3::Zero();
        double energy = 0.0, power = 0.0, mass = 0.0, size = 0.0;
        for (int i = 0; i < count; ++i) {
            const BodyHandle b{i};
            const double m = scene.bodies()[static_cast<std::size_t>(i)].mass();
            const Vector3 v = run[b].center_of_mass_velocity(t);
            mass += m;
            q += m * v;
            energy += 0.5 * m * v.squaredNorm();
            if (scene.bodies()[static_cast<std::size_t>(i)].rigid() != nullptr) energy += run[b].rigid(t).spin_energy;
            power += run.power(t, {b});
            force += run.external_force(t, {b});
            size += run.external_force(t, {b}).norm() + run[b].force(t).norm();
        }
        EXPECT_LE((run.momentum(t) - q).norm(), 16.0 * epsilon * (1.0 + q.norm() + mass));
        EXPECT_NEAR(run.kinetic_energy(t), energy, 64.0 * epsilon * energy);
        EXPECT_NEAR(run.power(t), power, 64.0 * epsilon * (std::abs(power) + size * 10.0));
        // what bodies exert on each other cancels
        EXPECT_LE((run.external_force(t) - force).norm(), 64.0 * epsilon * size);
        // Koenig, and the change of the pole
        const Vector3 v = run.center_of_mass_velocity(t), g = run.center_of_mass(t);
        EXPECT_NEAR(run.relative_kinetic_energy(t) + 0.5 * mass * v.squaredNorm(), energy, 64.0 * epsilon * energy);
        EXPECT_LE((run.angular_momentum(t, Vector3(0, 0, 0)) - run.angular_momentum(t, g) - g.cross(mass * v)).norm(),
                  256.0 * epsilon * (1.0 + mass * g.norm() * v.norm() + run.angular_momentum(t, g).norm()));
    }
}

TEST(Theorems, energy_and_work_of_couplings_agree) {
    Scene scene;
    const auto a = scene.add(Particle{1.0}, {.velocity = {0.0, 0.7, 0.0}}),
               b = scene.add(Particle{2.0}, {.position = {1.5, 0.0, 0.25}}),
               c = scene.add(Particle{0.5}, {.position = {0.0, 1.0, 1.0}, .velocity = {0.2, 0.0, 0.0}});
    const auto spring = scene.connect(Spring{.stiffness = 3.0, .rest_length = 1.0, .damping = 0.3}, a, b);
    const auto attraction = scene.connect(Gravitation{1.25}, b, c);
    const auto push = scene.connect(Central([](const auto& r) { return 0.5 / r - 0.25 * r; }), a, c);
    const auto tie = scene.connect(Central([](const auto& r) { return -r * r; }), c, Vector3(0.0, 0.0, 2.0));
    const auto whirl =
        scene.connect(PairForce([](const auto&, const auto& ra, const auto& rb, const auto&, const auto&) {
                          using T = std::decay_t<decltype(ra[0])>;
                          return Vector3Of<T>{0.1 * (rb[1] - ra[1]), 0.1 * (ra[0] - rb[0]), T(0.0)};
                      }),
                      a, b);
    const Trajectory run = simulate(scene, {.until = 3.0, .error = 1e-11});
    // what each does from a time to another, by its potential or its power, makes up the kinetic energy
    for (const auto& [t0, t1] : {std::pair{0.0, 3.0}, std::pair{0.4, 1.1}, std::pair{2.0, 1.0}}) {
        double work = 0.0;
        for (const CouplingHandle handle : {spring, attraction, push, tie, whirl}) work += run.work(t0, t1, handle);
        EXPECT_NEAR(work, run.kinetic_energy(t1) - run.kinetic_energy(t0), 1e-9);
    }
    // a central force's U by hand: Int f dr from the distance of the start
    const auto u = [](double r) { return 0.5 * std::log(r) - 0.125 * r * r; };
    const double t = 2.2, r0 = std::sqrt(2.0), r = (run[a].position(t) - run[c].position(t)).norm();
    Scene alone = scene.without(spring, attraction, tie, whirl);
    EXPECT_EQ(alone.connections()[0].coupling, Coupling(Spring{}));
    const Trajectory one = simulate(alone, {.until = 3.0, .error = 1e-11});
    const double l = (one[a].position(t) - one[c].position(t)).norm();
    EXPECT_NEAR(one.potential(t), u(l) - u(r0), 1e-14);
    EXPECT_LE(one.drift().at("energy"), 1e-11);
    EXPECT_GT(std::abs(r - r0), 0.01);
    // and that of a part: what is within it and what ties it to the world
    EXPECT_NEAR(run.potential(t, {c}),
                -(std::pow((run[c].position(t) - Vector3(0, 0, 2)).norm(), 3) - std::pow(std::sqrt(2.0), 3)) / 3.0,
                1e-12);
}

TEST(Theorems, poles_that_are_none_are_refused) {
    Scene scene;
    const auto a = scene.add(Particle{1.0});
    const Trajectory run = simulate(scene, {.until = 1.0});
    EXPECT_NE(refusal([&] { run.angular_momentum(0.5, BodyHandle{7}); }).find("body of the pole is 7"),
              std::string::npos);
    EXPECT_NE(refusal([&] { run.momentum(0.5, {BodyHandle{-1}}); }).find("body is -1"), std::string::npos);
    EXPECT_NE(refusal([&] { (void)Pole(Vector3(0, std::nan(""), 0)); }).find("component 1 of pole"), std::string::npos);
    EXPECT_EQ(run.angular_momentum(0.5, a), Vector3(0, 0, 0));
}

}  // namespace
}  // namespace rbdyn::test::test_theorems
