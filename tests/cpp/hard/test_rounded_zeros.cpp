// Distinctions by functions of time whose zeros no double holds: sin(t) at pi is 1.2e-16, and says nothing of sides.
#include <gtest/gtest.h>

#include <functional>
#include <numbers>

#include "rbdyn/integrate.hpp"
#include "support.hpp"

namespace rbdyn::test::test_rounded_zeros {
namespace {

constexpr double pi = std::numbers::pi;

struct Form {
    const char* name;
    std::function<Expression(const Expression&)> of;
};

/// The sign as NumPy's functions record it: what stays at zero has the middle value.
Expression three_valued(const Expression& x) {
    const auto constant = [](double value) { return [value] { return Expression(value); }; };
    return (x > 0.0).choose(
        constant(1.0), [&] { return (x < 0.0).choose(constant(-1.0), constant(0.0), "sign"); }, "sign");
}
const std::vector<Form> signs{
    {"two cases", [](const Expression& x) { return where(x > 0.0, 1.0, -1.0); }},
    {"three cases", three_valued},
    {"three cases of a multiple", [](const Expression& x) { return three_valued(-3.0 * x) * -1.0; }},
    {"locked", [](const Expression& x) { return locked_sign(x); }},
    {"a sign within a case", [](const Expression& x) { return where(x > 0.0, 1.0, three_valued(x)); }},
    {"a locked sign within a case", [](const Expression& x) { return where(x > 0.0, 1.0, locked_sign(2.0 * x)); }},
    {"a quotient", [](const Expression& x) { return x / abs(x); }},
    {"a product over a length",
     [](const Expression& x) {
         return 2.0 * x / length(Vector3Of<Expression>{2.0 * x, 0.0, 0.0});
     }},
    {"of two signs half each",
     [](const Expression& x) { return 0.5 * three_valued(x) + 0.5 * where(3.0 * x > 0.0, 1.0, -1.0); }},
};
// all of them |x|, or x where it is positive
const std::vector<Form> corners{
    {"abs", [](const Expression& x) { return abs(x); }},
    {"sign times x", [](const Expression& x) { return three_valued(x) * x; }},
    {"a case", [](const Expression& x) { return where(x > 0.0, x, -x); }},
    {"the larger one", [](const Expression& x) { return max(x, -x); }},
    {"a length",
     [](const Expression& x) {
         return length(Vector3Of<Expression>{x, 0.0, 0.0});
     }},
};
const std::vector<Form> levels{
    {"max", [](const Expression& x) { return max(x, Expression(0.0)); }},
    {"a case with a level", [](const Expression& x) { return where(x > 0.0, x, Expression(0.0)); }},
    {"half of x and |x|", [](const Expression& x) { return 0.5 * (x + abs(x)); }},
};

std::vector<std::string> all_engines() {
    std::vector<std::string> engines = simulating::engines();
    engines.push_back("auto");
    return engines;
}
double tolerance(const std::string& engine) { return engine.starts_with("cvode") ? 1e-6 : 1e-9; }

/// sin(w t + p), and where it is zero.
struct Wave {
    double w, p;
    Expression operator()(const Expression& t) const { return sin(w * t + p); }
    double operator()(double t) const { return std::sin(w * t + p); }
    std::vector<double> zeros(double until) const {
        std::vector<double> result;
        for (int k = 1; (k * pi - p) / w < until; ++k)
            if (k * pi > p) result.push_back((k * pi - p) / w);
        return result;
    }
    /// The integral of |sin| from 0.
    double area(double t) const { return (area_of(w * t + p) - area_of(p)) / w; }

private:
    static double area_of(double u) {
        const double whole = std::floor(u / pi);
        return 2.0 * whole + 1.0 - std::cos(u - whole * pi);
    }
};
Wave any_wave(Random& random) { return {random.uniform(0.5, 2.5), random.uniform(0.1, 3.0)}; }

std::vector<double> times(const Trajectory& run, EventKind kind) {
    std::vector<double> result;
    for (const Event& e : run.events())
        if (e.kind == kind) result.push_back(e.time);
    return result;
}
void expect_near(const std::vector<double>& is, const std::vector<double>& wanted, double error,
                 const std::string& what) {
    ASSERT_EQ(is.size(), wanted.size()) << what;
    for (std::size_t i = 0; i < is.size(); ++i) EXPECT_NEAR(is[i], wanted[i], error) << what;
}

Scene on_belt(std::function<Expression(const Expression&)> drive, Coulomb friction, double speed, BodyHandle& body) {
    Scene scene(down);
    RailOptions options;
    options.drive = [drive = std::move(drive)](const Expression& t) { return drive(t); };
    body = scene.add(Particle{1.0}, Rail(along_x, friction, options), {.parameter = 0.0, .speed = speed});
    return scene;
}

/// Where a block is that starts at rest on a belt of speed +-a: it gains or loses mu g until it goes with the belt.
double carried(double a, double side, const std::vector<double>& zeros, double until, double mu) {
    double t = 0.0, x = 0.0, v = 0.0;
    for (std::size_t i = 0; i <= zeros.size(); ++i, side = -side) {
        const double end = i < zeros.size() ? zeros[i] : until, left = end - t, b = side * a;
        const double slips = std::min(left, std::abs(b - v) / (mu * gravity)),
                     gain = std::copysign(mu * gravity, b - v);
        x += v * slips + 0.5 * gain * slips * slips;
        v = slips < left ? b : v + gain * slips;
        x += b * (left - slips);
        t = end;
    }
    return x;
}

TEST(SignsOfTime, drive_a_belt_to_and_fro_however_they_are_written) {
    Random random(71);
    for (int i = 0; i < 6; ++i) {
        const Wave wave = i == 0 ? Wave{1.0, 0.0} : any_wave(random);
        const double a = i == 0 ? 2.0 : random.uniform(0.5, 3.0);
        const double right = carried(a, 1.0, wave.zeros(6.0), 6.0, 0.2);
        for (const Form& form : signs)
            for (const std::string& engine : all_engines()) {
                BodyHandle block;
                const Scene scene =
                    on_belt([&](const Expression& t) { return a * form.of(wave(t)); }, {0.3, 0.2}, 0.0, block);
                const Trajectory run = simulate(scene, {.until = 6.0, .error = tolerance(engine), .engine = engine});
                EXPECT_NEAR(run[block].position(6.0)[0], right, 10.0 * tolerance(engine))
                    << form.name << ' ' << engine << ' ' << kinds(run);
            }
    }
}

TEST(SignsOfTime, that_are_watched_jump_through_zero_each_time) {
    Random random(72);
    for (int i = 0; i < 12; ++i) {
        const Wave wave = i == 0 ? Wave{1.0, 0.0} : i == 1 ? Wave{1.0, 0.5 * pi} : any_wave(random);
        for (const Form& form : signs)
            for (const std::string& engine : all_engines()) {
                Scene scene;
                scene.add(Particle{1.0}, FreeStart{{0, 0, 0}, {1, 0, 0}});
                scene.watch("w", [&](const Now& now) { return form.of(wave(now.time())); });
                const Trajectory run = simulate(scene, {.until = 10.0, .error = tolerance(engine), .engine = engine});
                const std::string what = std::string(form.name) + ' ' + engine + ' ' + kinds(run);
                expect_near(times(run, EventKind::watch), wave.zeros(10.0), 1e-12, what);
            }
    }
}

TEST(SignsOfTime, push_once_each_way) {
    for (const Form& form : signs)
        for (const std::string& engine : all_engines()) {
            const Wave wave{1.3, 0.2};
            Scene scene;
            const BodyHandle body = scene.add(Particle{1.0}, FreeStart{{0, 0, 0}, {1, 0, 0}});
            scene.apply(Force([&](const auto& t, const auto&, const auto&) {
                            return Vector3Of<Expression>{form.of(wave(t)), 0.0, 0.0};
                        }),
                        body);
            const Trajectory run = simulate(scene, {.until = 10.0, .error = tolerance(engine), .engine = engine});
            double t = 0.0, x = 0.0, v = 1.0, side = 1.0;
            std::vector<double> ends = wave.zeros(10.0);
            ends.push_back(10.0);
            for (const double end : ends) {
                x += (v + 0.5 * side * (end - t)) * (end - t);
                v += side * (end - t);
                t = end;
                side = -side;
            }
            EXPECT_NEAR(run[body].position(10.0)[0], x, 10.0 * tolerance(engine)) << form.name << engine;
            // those of other names are listed beside
            std::vector<double> switches = times(run, EventKind::switching);
            switches.erase(std::unique(switches.begin(), switches.end()), switches.end());
            expect_near(switches, wave.zeros(10.0), 1e-12, std::string(form.name) + ' ' + engine + ' ' + kinds(run));
        }
}

TEST(CornersInTime, of_a_drive_throw_no_block_off_its_belt) {
    Random random(73);
    for (int i = 0; i < 6; ++i) {
        const Wave wave = i == 0 ? Wave{1.8, 0.0} : any_wave(random);
        // static friction holds it: a w < mu g
        const double a = random.uniform(0.3, 0.9) * 0.3 * gravity / wave.w;
        const auto try_all = [&](const std::vector<Form>& forms, const std::function<double(double)>& integral) {
            for (const Form& form : forms)
                for (const std::string& engine : all_engines()) {
                    BodyHandle block;
                    const Scene scene = on_belt([&](const Expression& t) { return a * form.of(wave(t)); }, {0.3, 0.1},
                                                a * std::sin(wave.p), block);
                    const Trajectory run =
                        simulate(scene, {.until = 10.0, .error = tolerance(engine), .engine = engine});
                    const std::string what = std::string(form.name) + ' ' + engine + ' ' + kinds(run);
                    EXPECT_NEAR(run[block].position(10.0)[0], a * integral(10.0), 10.0 * tolerance(engine)) << what;
                    EXPECT_EQ(times(run, EventKind::switching).size(), run.events().size()) << what;
                }
        };
        const auto all = [&](double t) { return wave.area(t); };
        const auto half = [&](double t) {
            return 0.5 * (wave.area(t) + (std::cos(wave.p) - std::cos(wave.w * t + wave.p)) / wave.w);
        };
        try_all(corners, all);
        try_all(levels, half);
    }
}

TEST(CornersInTime, and_levels_at_zero_that_are_watched_pass_nothing) {
    Random random(74);
    for (int i = 0; i < 8; ++i) {
        const Wave wave = i == 0 ? Wave{1.0, 0.3} : any_wave(random);
        for (const auto* forms : {&corners, &levels})
            for (const Form& form : *forms)
                for (const double side : {1.0, -1.0})
                    for (const std::string& engine : all_engines()) {
                        Scene scene;
                        scene.add(Particle{1.0}, FreeStart{{0, 0, 0}, {1, 0, 0}});
                        scene.watch("w", [&](const Now& now) { return side * form.of(wave(now.time())); });
                        const Trajectory run =
                            simulate(scene, {.until = 10.0, .error = tolerance(engine), .engine = engine});
                        EXPECT_EQ(times(run, EventKind::watch).size(), 0u)
                            << form.name << ' ' << engine << ' ' << kinds(run);
                    }
    }
}

TEST(Levels, at_zero_are_passed_where_they_are_left_to_the_other_side) {
    for (const std::string& engine : all_engines())
        for (const bool comes_back : {false, true}) {
            Scene scene;
            const BodyHandle body = scene.add(Particle{1.0}, FreeStart{{0, 0, 0}, {1, 0, 0}});
            scene.watch("w", [=](const Now& now) {
                const Expression x = now[body].position()[0], after = comes_back ? x - 2.0 : 2.0 - x;
                return max(1.0 - x, Expression(0.0)) + where(x > 2.0, after, 0.0);
            });
            const Trajectory run = simulate(scene, {.until = 4.0, .error = tolerance(engine), .engine = engine});
            expect_near(times(run, EventKind::watch), comes_back ? std::vector<double>{} : std::vector<double>{2.0},
                        10.0 * tolerance(engine), engine + ' ' + kinds(run));
        }
}

TEST(Levels, that_a_motion_comes_to_are_reached) {
    // a speed that dry friction, written as a sign, brings to zero: v = 1 - t / 2
    for (const std::string& engine : all_engines()) {
        Scene scene;
        const BodyHandle body = scene.add(Particle{1.0}, FreeStart{{0, 0, 0}, {1, 0, 0}});
        scene.apply(Force([&](const auto&, const auto&, const auto& v) {
                        return Vector3Of<Expression>{-0.5 * three_valued(v[0]), 0.0, 0.0};
                    }),
                    body);
        scene.watch("w", [=](const Now& now) { return now[body].velocity()[0]; },
                    {.action = WatchAction{WatchAction::Kind::stop}});
        const Trajectory run = simulate(scene, {.until = 4.0, .error = tolerance(engine), .engine = engine});
        expect_near(times(run, EventKind::watch), {2.0}, 10.0 * tolerance(engine), engine + ' ' + kinds(run));
    }
}

}  // namespace
}  // namespace rbdyn::test::test_rounded_zeros
