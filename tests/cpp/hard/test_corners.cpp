// Rails whose functions distinguish cases: where r' jumps the run ends, where only r'' does it goes on, and the curve
// is the function everywhere.
#include <gtest/gtest.h>

#include "rbdyn/integrate.hpp"
#include "support.hpp"

namespace rbdyn::test::test_corners {
namespace {

using Point = Vector3Of<Expression>;

struct Case {
    const char* what;
    Curve curve;
    double corner, start, speed;  // sent from start to the corner
    Vector3 (*r)(double);
};

/// A bead sent along a curve; the motion up to where it breaks off, and the words it does so with.
struct Sent {
    Scene scene{down};
    BodyHandle bead;
    Sent(const Curve& curve, double start, double speed, std::optional<Coulomb> friction = {})
        : bead(scene.add(Particle{0.5}, Rail(curve, friction), {.parameter = start, .speed = speed})) {}
    std::pair<std::string, Trajectory> run(const std::string& engine, double until, double error = 1e-9) const {
        try {
            return {"", simulate(scene, {.until = until, .error = error, .engine = engine})};
        } catch (const IntegrationError& e) {
            return {e.what(), e.run};
        }
    }
};

template <class F>
Curve of(F f, Domain domain = {}) {
    return Curve([=](const auto& u) { return f(Expression(u)); }, domain);
}

std::vector<Case> corners() {
    return {
        {"a V", of([](const Expression& u) {
             return Point{u, 0.0, abs(u)};
         }),
         0.0, -0.5, 8.0, [](double u) { return Vector3(u, 0.0, std::abs(u)); }},
        {"a V as a norm", of([](const Expression& u) {
             return Point{u, 0.0, length({u, 0.0, 0.0})};
         }),
         0.0, 0.5, -8.0, [](double u) { return Vector3(u, 0.0, std::abs(u)); }},
        {"a V as a choice",
         of(
             [](const Expression& u) {
                 return Point{u, 0.0, where(u > 0.0, u, -u)};
             },
             {-1, 1}),
         0.0, -0.5, 8.0, [](double u) { return Vector3(u, 0.0, std::abs(u)); }},
        {"a V as a root", of([](const Expression& u) {
             return Point{u, 0.0, sqrt((u - 0.2) * (u - 0.2))};
         }),
         0.2, 0.75, -8.0, [](double u) { return Vector3(u, 0.0, std::abs(u - 0.2)); }},
        {"a ramp from a level", of([](const Expression& u) {
             return Point{u, 0.0, max(u, Expression(0.3))};
         }),
         0.3, 0.75, -8.0, [](double u) { return Vector3(u, 0.0, std::max(u, 0.3)); }},
        {"a level before a ramp",
         of(
             [](const Expression& u) {
                 return Point{u, 0.0, max(u, Expression(0.3))};
             },
             {-1, 1}),
         0.3, -0.5, 8.0, [](double u) { return Vector3(u, 0.0, std::max(u, 0.3)); }},
        {"a turn aside in a bend", of([](const Expression& u) {
             return Point{u, max(u - 0.5, Expression(0.0)), u * u};
         }),
         0.5, 0.0, 6.0, [](double u) { return Vector3(u, std::max(u - 0.5, 0.0), u * u); }},
        {"a slight turn in a bend", of([](const Expression& u) {
             return Point{u, 1e-4 * max(u - 0.5, Expression(0.0)), u * u};
         }),
         0.5, 1.0, -2.0, [](double u) { return Vector3(u, 1e-4 * std::max(u - 0.5, 0.0), u * u); }},
        {"a parameter that goes on twice as fast", of([](const Expression& u) {
             return Point{max(u, 2.0 * u), 0.0, 0.0};
         }),
         0.0, -0.5, 2.0, [](double u) { return Vector3(std::max(u, 2.0 * u), 0.0, 0.0); }},
        {"a step", of([](const Expression& u) {
             return Point{u, 0.0, 0.1 * floor(u)};
         }),
         1.0, 0.5, 2.0, [](double u) { return Vector3(u, 0.0, 0.1 * std::floor(u)); }},
        {"a hat much narrower than a step of the motion", of([](const Expression& u) {
             return Point{u, 0.0, max(Expression(0.0), 1e-3 - abs(u - 0.123))};
         }),
         0.122, -0.5, 2.0, [](double u) { return Vector3(u, 0.0, std::max(0.0, 1e-3 - std::abs(u - 0.123))); }},
    };
}

TEST(Corners, of_a_rail_end_the_run_whatever_the_other_components_do) {
    for (const Case& c : corners())
        for (const std::string& engine : simulating::engines()) {
            SCOPED_TRACE(std::string(c.what) + " " + engine);
            const Sent sent(c.curve, c.start, c.speed);
            const auto [words, run] = sent.run(engine, 2.0, engine.starts_with("cvode") ? 1e-6 : 1e-9);
            EXPECT_NE(words.find("not finite"), std::string::npos) << words;
            EXPECT_NE(words.find("its tangent jumps"), std::string::npos) << words;
            // it came there
            EXPECT_NEAR(run[sent.bead].parameter(run.end()), c.corner, 1e-9);
            const double tolerance = engine.starts_with("cvode") ? 1e-5 : 1e-8;
            for (int k = 0; k <= 16; ++k) {
                const double t = run.end() * k / 16.0;
                EXPECT_NEAR(run.energy(t), run.energy(0.0), tolerance);
                // at the corner itself a step has either height
                if (k == 16) continue;
                EXPECT_LE((run[sent.bead].position(t) - c.r(run[sent.bead].parameter(t))).norm(), 1e-15);
            }
        }
}

TEST(Corners, end_the_run_of_a_rough_bead_too) {
    for (const Case& c : corners()) {
        const Sent sent(c.curve, c.start, c.speed, Coulomb{0.0625});
        const auto [words, run] = sent.run("taylor", 2.0);
        EXPECT_NE(words.find("its tangent jumps"), std::string::npos) << c.what << words;
        EXPECT_NEAR(run[sent.bead].parameter(run.end()), c.corner, 1e-9) << c.what;
    }
}

TEST(Corners, are_no_places_to_start_from) {
    for (const Case& c : corners()) {
        EXPECT_THROW(Sent(c.curve, c.corner, 0.0), InvalidInput) << c.what;
        EXPECT_NO_THROW(Sent(c.curve, c.corner + 1e-6, 0.0)) << c.what;
        EXPECT_NO_THROW(Sent(c.curve, c.corner - 1e-6, 0.0)) << c.what;
    }
}

TEST(Corners, that_a_bead_does_not_reach_are_no_hindrance) {
    // up a slope of 45 degrees and back: s = v t - g t^2 / (2 sqrt 2)
    const Sent sent(of([](const Expression& u) { return Point{u, 0.0, max(u, Expression(0.3))}; }), 0.5, 2.0);
    const double until = 0.5, s = 2.0 * until - 0.5 * gravity * std::sqrt(0.5) * until * until;
    const auto [words, run] = sent.run("taylor", until, 1e-12);
    EXPECT_EQ(words, "");
    EXPECT_NEAR(run[sent.bead].parameter(until), 0.5 + s * std::sqrt(0.5), 1e-13);
}

TEST(CurvatureJumps, of_a_function_keep_the_energy) {
    const std::vector<Case> cases{
        {"two parabolas", of([](const Expression& u) {
             return Point{u, 0.0, u * abs(u)};
         }),
         0.0, 0.5, -1.0, [](double u) { return Vector3(u, 0.0, u * std::abs(u)); }},
        {"bends in two planes", of([](const Expression& u) {
             const Expression p = max(u, Expression(0.0)), q = min(u, Expression(0.0));
             return Point{u, p * p, q * q};
         }),
         0.0, -0.5, 4.0,
         [](double u) {
             const double p = std::max(u, 0.0), q = std::min(u, 0.0);
             return Vector3(u, p * p, q * q);
         }},
        {"a level and an arc", of([](const Expression& u) {
             return Point{where(u < 0.0, u, sin(u)), 0.0, where(u < 0.0, 0.0 * u, 1.0 - cos(u))};
         }),
         0.0, 1.0, -1.0,
         [](double u) { return u < 0.0 ? Vector3(u, 0.0, 0.0) : Vector3(std::sin(u), 0.0, 1.0 - std::cos(u)); }},
    };
    for (const Case& c : cases)
        for (const char* engine : {"taylor", "dop853"}) {
            SCOPED_TRACE(std::string(c.what) + " " + engine);
            const Sent sent(c.curve, c.start, c.speed);
            const auto [words, run] = sent.run(engine, 1.0, 1e-10);
            EXPECT_EQ(words, "");
            const double u = run[sent.bead].parameter(1.0);
            EXPECT_LT((u - c.corner) * (c.start - c.corner), 0.0) << "it passes the place";
            EXPECT_NEAR(run.energy(1.0), run.energy(0.0), 1e-9);
            EXPECT_LE((run[sent.bead].position(1.0) - c.r(u)).norm(), 4.0 * epsilon * (1.0 + u * u));
        }
}

}  // namespace
}  // namespace rbdyn::test::test_corners
