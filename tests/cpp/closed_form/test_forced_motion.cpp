// Linear scenes that are forced in time, in closed form: against known solutions, and against series.
#include <gtest/gtest.h>

#include "rbdyn/closed_form/waves.hpp"

#include <cmath>
#include <complex>
#include <numbers>
#include <string>
#include <type_traits>
#include <vector>

#include "random.hpp"
#include "rbdyn/rbdyn.hpp"
#include "support.hpp"

namespace rbdyn::test::test_forced_motion {
namespace {

template <class F>
Vector3Of<std::decay_t<F>> along_x(const F& f) {
    return {f, F(0.0), F(0.0)};
}

struct Forced {
    Scene scene;
    BodyHandle mass;
};
/// A mass of 1 kg at x0 with v0 on a spring to the origin.
template <class F>
Forced forced(double stiffness, double damping, double x0, double v0, F f) {
    Forced made;
    made.mass = made.scene.add(Particle{1.0}, {.position = {x0, 0, 0}, .velocity = {v0, 0, 0}}, "mass");
    if (stiffness != 0.0) made.scene.connect(Spring{.stiffness = stiffness}, made.mass, Vector3(0, 0, 0));
    if (damping != 0.0) made.scene.apply(Drag{.linear = damping}, made.mass);
    made.scene.apply(Force([f](const auto& t, const auto&, const auto&) { return along_x(f(t)); }), made.mass);
    return made;
}

TEST(ForcedMotion, at_resonance_grows_as_it_is_known_to) {
    // x'' + 4 x = 3 cos 2t: x = x0 cos 2t + v0/2 sin 2t + 3/4 t sin 2t
    const Forced made = forced(4.0, 0.0, 0.5, -1.0, [](const auto& t) { return 3.0 * cos(2.0 * t); });
    const Trajectory run = simulate(made.scene, {.until = 1000.0, .error = 1e-13});
    EXPECT_EQ(run.engine(), "closed form");
    EXPECT_EQ(run.statistics().steps, 0);
    for (const double t : {0.1, 1.0, 33.3, 1000.0}) {
        const long double s = std::sin(2.0L * static_cast<long double>(t)),
                          c = std::cos(2.0L * static_cast<long double>(t));
        EXPECT_NEAR(run[made.mass].position(t)[0], static_cast<double>(0.5L * c - 0.5L * s + 0.75L * t * s),
                    4e-16 * std::max(1.0, t))
            << t;
    }
}

TEST(ForcedMotion, begins_when_the_run_does) {
    // x'' + x = t exp(-t/2) has the particular solution exp(-t/2) (0.8 t + 0.64)
    const auto f = [](const auto& t) { return t * exp(-0.5 * t); };
    const auto solution = [](double t) { return std::exp(-0.5 * t) * (0.8 * t + 0.64); };
    const auto rate = [](double t) { return std::exp(-0.5 * t) * (0.8 - 0.4 * t - 0.32); };
    for (const double start : {0.0, 2.0, -1.5, 7.25}) {
        const Forced made = forced(1.0, 0.0, solution(start), rate(start), f);
        const Trajectory run = simulate(made.scene, {.until = start + 6.0, .start = start, .error = 1e-12});
        EXPECT_EQ(run.engine(), "closed form");
        for (const double since : {0.5, 3.0, 6.0})
            EXPECT_NEAR(run[made.mass].position(start + since)[0], solution(start + since), 4e-15) << start;
        const Trajectory on = simulate(run, {.until = start + 9.0});
        EXPECT_NEAR(on[made.mass].position(start + 9.0)[0], solution(start + 9.0), 4e-15) << start;
    }
}

TEST(ForcedMotion, is_that_of_the_series) {
    Random random(20261103);
    for (int i = 0; i < 40; ++i) {
        const double g = random.uniform(-0.5, 0.2), w = random.uniform(0.2, 4.0), p = random.uniform(-2.0, 2.0),
                     c = random.uniform(-2.0, 2.0), q = random.uniform(-2.0, 2.0);
        const int power = random.whole(0, 1);
        const bool is_damped = random.chance(0.5), is_free = random.chance(0.2);
        Forced made = forced(is_free ? 0.0 : random.uniform(0.5, 9.0), is_damped ? random.uniform(0.05, 1.0) : 0.0,
                             random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0), [=](const auto& t) {
                                 auto f = c * sin(w * t + p) * cos(0.5 * t) * exp(g * t) + q;
                                 for (int k = 0; k < power; ++k) f = f * t;
                                 return f;
                             });
        if (random.chance(0.5)) {
            const auto second = made.scene.add(Particle{random.uniform(0.5, 3.0)}, {.position = {1, 0.5, 0}});
            made.scene.connect(Spring{.stiffness = random.uniform(0.5, 5.0)}, made.mass, second);
        }
        const double start = random.chance(0.5) ? random.uniform(-2.0, 5.0) : 0.0,
                     until = start + random.uniform(1.0, 12.0);
        const Attempt closed = attempt(made.scene, {.until = until, .start = start, .error = 1e-11});
        ASSERT_EQ(closed.outcome, simulating::Outcome::good) << i << ": " << closed.message;
        ASSERT_EQ(closed.run.engine(), "closed form") << i;
        const Attempt series =
            attempt(made.scene, {.until = until, .start = start, .error = 1e-11, .engine = "taylor"});
        ASSERT_EQ(series.outcome, simulating::Outcome::good) << i << ": " << series.message;
        const Scales s = scales(closed.run, made.mass);
        const double told = *closed.run.error() + *series.run.error();
        for (const double part : {0.3, 0.6, 1.0}) {
            const double t = start + part * (until - start);
            EXPECT_LE((closed.run[made.mass].position(t) - series.run[made.mass].position(t)).norm(), told * s.extent)
                << i;
            EXPECT_LE((closed.run[made.mass].velocity(t) - series.run[made.mass].velocity(t)).norm(), told * s.speed)
                << i;
        }
    }
}

/// n masses of 1 kg on a line, each joined to the next and the outer ones to walls by springs of 4 N/m.
struct ForcedChain {
    Scene scene;
    std::vector<BodyHandle> masses;
};
ForcedChain forced_chain(int n) {
    ForcedChain made;
    for (int i = 0; i < n; ++i) made.masses.push_back(made.scene.add(Particle{1.0}, {.position = {i + 1.0, 0, 0}}));
    for (int i = 0; i + 1 < n; ++i)
        made.scene.connect(Spring{.stiffness = 4.0}, made.masses[static_cast<std::size_t>(i)],
                           made.masses[static_cast<std::size_t>(i + 1)]);
    made.scene.connect(Spring{.stiffness = 4.0}, made.masses.front(), Vector3(0, 0, 0));
    made.scene.connect(Spring{.stiffness = 4.0}, made.masses.back(), Vector3(n + 1.0, 0, 0));
    return made;
}

TEST(ForcedMotion, of_a_long_chain_is_that_of_its_modes) {
    // x_j = j + sum over k of sqrt(2/(n+1)) sin(jk pi/(n+1)) y_k, y_k'' + p_k^2 y_k = f_k sin(w t), at rest
    constexpr int n = 30;
    constexpr long double pi = std::numbers::pi_v<long double>;
    const auto pace = [](int k) { return 4.0L * std::sin(k * pi / (2.0L * (n + 1))); };
    const auto shape = [](int j, int k) { return std::sqrt(2.0L / (n + 1)) * std::sin(j * k * pi / (n + 1)); };
    for (const double w : {0.7, 2.0, static_cast<double>(pace(3))}) {
        ForcedChain made = forced_chain(n);
        made.scene.apply(Force([w](const auto& t, const auto&, const auto&) { return along_x(0.5 * sin(w * t)); }),
                         made.masses[1]);
        const Trajectory run = simulate(made.scene, {.until = 200.0, .error = 1e-12});
        ASSERT_EQ(run.engine(), "closed form");
        for (const double t : {0.5, 20.0, 200.0})
            for (const int j : {1, 2, 17, 30}) {
                long double x = j;
                for (int k = 1; k <= n; ++k) {
                    const long double p = pace(k), off = w - p, force = 0.5L * shape(2, k);
                    // (sin wt - w/p sin pt)/(p^2 - w^2), without cancelling beside resonance
                    const long double beat = off == 0.0L ? t / 2.0L : std::sin(off * t / 2.0L) / off;
                    const long double y = (std::sin(p * t) / p - 2.0L * std::cos((w + p) * t / 2.0L) * beat) / (w + p);
                    x += shape(j, k) * force * y;
                }
                EXPECT_NEAR(run[made.masses[static_cast<std::size_t>(j - 1)]].position(t)[0], static_cast<double>(x),
                            2e-16 * j + 1e-16 * t)
                    << w << ' ' << t << ' ' << j;
            }
    }
}

TEST(ForcedMotion, of_many_masses_in_space_with_drag_is_that_of_the_series) {
    Random random(20261126);
    for (int i = 0; i < 6; ++i) {
        ForcedChain made = forced_chain(random.whole(9, 16));
        const double w = random.uniform(0.3, 3.0), g = random.uniform(-0.4, 0.1), c = random.uniform(0.01, 0.3);
        for (const BodyHandle& mass : made.masses) made.scene.apply(Drag{.linear = c}, mass);
        made.scene.apply(Force([w, g](const auto& t, const auto&, const auto&) {
                             using S = std::decay_t<decltype(t)>;
                             return Vector3Of<S>{cos(w * t), S(0.2) * t, exp(g * t) * sin(w * t)};
                         }),
                         made.masses[static_cast<std::size_t>(random.whole(0, 8))]);
        const double start = random.uniform(-3.0, 3.0), until = start + 15.0;
        const Trajectory closed = simulate(made.scene, {.until = until, .start = start, .error = 1e-11});
        ASSERT_EQ(closed.engine(), "closed form") << i;
        const Trajectory series =
            simulate(made.scene, {.until = until, .start = start, .error = 1e-11, .engine = "taylor"});
        for (const BodyHandle& mass : made.masses)
            for (const double t : {start + 4.0, until}) {
                const Scales s = scales(closed, mass);
                EXPECT_LE((closed[mass].position(t) - series[mass].position(t)).norm(), 2e-11 * s.extent) << i;
                EXPECT_LE((closed[mass].velocity(t) - series[mass].velocity(t)).norm(), 2e-11 * s.speed) << i;
            }
    }
}

TEST(ForcedMotion, is_as_certain_in_any_unit_of_time) {
    // x'' + 2 x = t^3 exp(g t) cos(w t): with l = g + i w the real part of exp(l t) (p0 + p1 t + p2 t^2 + p3 t^3),
    // where (l^2 + 2) p3 = 1, (l^2 + 2) p2 = -6 l p3, (l^2 + 2) p1 = -4 l p2 - 6 p3, (l^2 + 2) p0 = -2 l p1 - 2 p2
    using Complex = std::complex<long double>;
    const double until = 300.0;
    for (const double growth : {0.05, -0.3, 0.0})
        for (const double pace : {30.0, 0.4}) {
            const Complex l(growth, pace), d = l * l + 2.0L, p3 = 1.0L / d, p2 = -6.0L * l * p3 / d,
                                           p1 = (-4.0L * l * p2 - 6.0L * p3) / d, p0 = (-2.0L * l * p1 - 2.0L * p2) / d;
            const long double root = std::sqrt(2.0L), t = static_cast<long double>(until);
            const long double known = (std::exp(l * t) * (p0 + t * (p1 + t * (p2 + t * p3)))).real() +
                                      (1.0L - p0.real()) * std::cos(root * t) -
                                      (l * p0 + p1).real() / root * std::sin(root * t);
            double told = 0.0;
            for (const double unit : {0x1p-20, 1.0, 0x1p13, 1e7, 0x1p40}) {
                SCOPED_TRACE(std::to_string(growth) + " " + std::to_string(pace) + " " + std::to_string(unit));
                const double g = growth / unit, w = pace / unit, f = std::pow(unit, -5.0);
                const Forced made = forced(2.0 / (unit * unit), 0.0, 1.0, 0.0,
                                           [=](const auto& s) { return f * s * s * s * exp(g * s) * cos(w * s); });
                const Trajectory run = simulate(made.scene, {.until = until * unit, .error = 1e-10});
                EXPECT_EQ(run.engine(), "closed form");
                // numbers in units that are no power of two are rounded, and the phase with them
                EXPECT_NEAR(run[made.mass].position(until * unit)[0] / static_cast<double>(known), 1.0,
                            unit == 1e7 ? 1e-10 : 4e-15);
                EXPECT_LE(*run.error(), 1e-14);
                if (unit == 1.0) told = *run.error();
            }
            EXPECT_GT(told, 0.0);
        }
}

TEST(ForcedMotion, has_its_events) {
    // x'' = -9 sin 3t from rest at 1 with v = 3: x = 1 + sin 3t, which touches 0 and passes 1
    const Forced made = forced(0.0, 0.0, 1.0, 3.0, [](const auto& t) { return -9.0 * sin(3.0 * t); });
    Scene scene = made.scene;
    scene.watch("middle", [b = made.mass](const Now& now) { return now[b].position()[0] - 1.0; });
    const Trajectory run = simulate(scene, {.until = 100.0, .error = 1e-13});
    EXPECT_EQ(run.engine(), "closed form");
    ASSERT_EQ(run.events().size(), 95u);
    for (std::size_t k = 0; k < run.events().size(); ++k)
        EXPECT_NEAR(run.events()[k].time, std::numbers::pi * static_cast<double>(k + 1) / 3.0, 4e-14);
}

TEST(ForcedMotion, has_a_closed_form_under_waves_alone) {
    const auto reason = [](const Scene& scene) {
        for (const Omission& o : make_plan(scene).omissions)
            if (o.what == "closed form") return o.why;
        return make_plan(scene).engine;
    };
    EXPECT_EQ(reason(forced(1.0, 0.0, 0, 0, [](const auto& t) { return pow(t, 3) * sin(t) * sin(t); }).scene),
              "closed form");
    EXPECT_NE(
        reason(forced(1.0, 0.0, 0, 0, [](const auto& t) { return sin(t * t); }).scene).find("otherwise than sines"),
        std::string::npos);
    EXPECT_NE(reason(forced(1.0, 0.0, 0, 0, [](const auto& t) { return 1.0 / (1.0 + t); }).scene).find("otherwise"),
              std::string::npos);
    EXPECT_NE(reason(forced(0.0, 0.0, 0, 0, [](const auto& t) { return 1.0 + t * t; }).scene).find("polynomial"),
              std::string::npos);
}

}  // namespace
}  // namespace rbdyn::test::test_forced_motion
