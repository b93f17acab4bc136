// Random rough scenes: every run ends as it should, in time, without NaN, and friction never makes energy.
//
// RBDYN_RANDOM_SCENES: how many (default 300); RBDYN_RANDOM_FIRST: number of the first, to run one again alone.
#include <gtest/gtest.h>

#include <ctime>
#include <iostream>
#include <sstream>

#include "support.hpp"

namespace rbdyn::test::test_random {
namespace {

struct RandomScene {
    Scene scene;
    SimulateOptions options;
    bool is_driven = false, has_one_coefficient = false;
    std::string text;  // every number, as it would be written in C++
};

std::string number(double x) { return rbdyn::text(x); }
std::string number(const Vector3& v) { return "{" + number(v[0]) + ", " + number(v[1]) + ", " + number(v[2]) + "}"; }

/// Half of all numbers are round: degenerate cases live there.
double some(Random& random, double lo, double hi) {
    const double x = random.uniform(lo, hi);
    return random.chance(0.5) ? std::round(8.0 * x) / 8.0 : x;
}
Vector3 some_vector(Random& random, double size) {
    Vector3 v(some(random, -size, size), some(random, -size, size), some(random, -size, size));
    if (random.chance(0.3)) v[random.whole(0, 2)] = 0.0;
    return v;
}

Curve some_curve(Random& random, std::ostream& text) {
    // upright axes, or any
    Vector3 start(0, 0, -1), toward(1, 0, 0);
    if (random.chance(0.3)) start = Vector3(1, 0, 0), toward = Vector3(0, random.chance(0.5) ? 1 : -1, 0);
    if (random.chance(0.4)) {
        start = random.direction();
        do toward = random.direction();
        while (start.cross(toward).norm() < 0.1);
    }
    const double radius = random.chance(0.5) ? 0.125 * random.whole(1, 16) : random.logarithmic(0.1, 10.0);
    switch (random.whole(0, 4)) {
        case 0: {
            Vector3 direction = random.chance(0.5) ? Vector3(1, 0, -0.125 * random.whole(0, 16)) : random.direction();
            text << "Line{.direction = " << number(direction) << "}";
            return Line{.direction = direction};
        }
        case 1:
            text << "Circle{.radius = " << number(radius) << ", .start = " << number(start)
                 << ", .toward = " << number(toward) << "}";
            return Circle{.radius = radius, .start = start, .toward = toward};
        case 2: {
            const double pitch = (random.chance(0.5) ? 1.0 : -1.0) * random.logarithmic(0.1, 10.0);
            text << "Helix{.radius = " << number(radius) << ", .pitch = " << number(pitch)
                 << ", .start = " << number(start) << ", .toward = " << number(toward) << "}";
            return Helix{.radius = radius, .pitch = pitch, .start = start, .toward = toward};
        }
        default: break;
    }
    Polynomial p;
    const int degree = random.whole(2, 4);
    const bool is_plane = random.chance(0.4), is_bounded = random.chance(0.5);
    p.coefficients.push_back(Vector3::Zero());
    p.coefficients.push_back(Vector3(1, 0, random.chance(0.5) ? 0.0 : some(random, -1, 1)));
    for (int k = 2; k <= degree; ++k) {
        Vector3 c =
            random.chance(0.3) ? Vector3::Unit(random.whole(1, 2)).eval() : (some_vector(random, 1.0) / k).eval();
        c[0] = 0.0;
        if (is_plane) c[1] = 0.0;
        if (random.chance(0.15)) c.setZero();
        p.coefficients.push_back(c);
    }
    if (is_bounded) p.domain = {-2.0, 2.0};
    text << "Polynomial{.coefficients = {";
    for (const Vector3& c : p.coefficients) text << number(c) << ", ";
    text << "}";
    if (is_bounded) text << ", .domain = {-2, 2}";
    text << "}";
    return p;
}

RandomScene some_scene(int index) {
    Random random(static_cast<std::uint64_t>(index) * 1000003u + 17u);
    RandomScene result;
    std::ostringstream text;
    text << "scene " << index << ": ";
    const Curve curve = some_curve(random, text);
    Vector3 field(0, 0, random.chance(0.5) ? -9.81 : -gravity);
    if (random.chance(0.1)) field.setZero();
    if (random.chance(0.2)) field = some_vector(random, 10.0);
    result.scene.set_gravity(field);
    text << "; gravity " << number(field);
    const double mass = random.chance(0.5) ? 1.0 : random.logarithmic(1e-3, 1e3);
    text << "; mass " << number(mass);
    Coulomb friction;
    if (!random.chance(0.1)) {
        const double dynamic = random.chance(0.1) ? 0.0 : std::abs(some(random, 0.0, 1.0));
        friction.mu_dynamic = dynamic;
        friction.mu_static = dynamic * (random.chance(0.3) ? 1.0 : random.uniform(1.0, 2.0));
        if (random.chance(0.1)) friction.mu_static += 0.5;
    }
    result.has_one_coefficient = friction.mu_static == friction.dynamic();
    text << "; Coulomb{" << number(friction.mu_static) << ", " << number(friction.dynamic()) << "}";
    RailOptions rail;
    double drive_at_start = 0.0;
    if (random.chance(0.3)) {
        result.is_driven = true;
        const double a = some(random, -2.0, 2.0);
        if (random.chance(0.5)) {
            rail.drive = a;
            drive_at_start = a;
            text << "; drive " << number(a);
        } else {
            const double b = random.uniform(0.5, 5.0);
            rail.drive = TimeFunction([a, b](const auto& t) { return a * sin(b * t); });
            text << "; drive " << number(a) << " sin(" << number(b) << " t)";
        }
    }
    const double u = some(random, -1.5, 1.5);
    double speed = random.chance(0.3) ? 0.0 : some(random, -5.0, 5.0);
    if (random.chance(0.1)) speed = drive_at_start;
    text << "; u " << number(u) << "; speed " << number(speed);
    const BodyHandle bead =
        result.scene.add(Particle{mass}, Rail(curve, friction, rail), {.parameter = u, .speed = speed});
    if (random.chance(0.3)) {
        Spring spring{.stiffness = mass * random.logarithmic(0.1, 100.0)};
        if (random.chance(0.5)) spring.rest_length = std::abs(some(random, 0.0, 1.0));
        if (random.chance(0.3)) spring.damping = mass * random.uniform(0.0, 2.0);
        const bool on_curve = random.chance(0.2);
        const Vector3 anchor = on_curve ? Vector3(Vector3::Zero()) : some_vector(random, 2.0);
        // where a bead passes the anchor of its spring, a rest length or a damper makes the force 0/0
        if (on_curve) spring.rest_length = spring.damping = 0.0;
        result.scene.connect(spring, bead, anchor);
        text << "; Spring{" << number(spring.stiffness) << ", " << number(spring.rest_length) << ", "
             << number(spring.damping) << "} to " << number(anchor);
    }
    if (random.chance(0.3)) {
        Drag drag;
        if (random.chance(0.7)) drag.linear = mass * random.uniform(0.0, 1.0);
        if (random.chance(0.7)) drag.quadratic = mass * random.uniform(0.0, 1.0);
        result.scene.apply(drag, bead);
        text << "; Drag{" << number(drag.linear) << ", " << number(drag.quadratic) << "}";
    }
    result.options.until = random.logarithmic(0.1, 20.0);
    result.options.error = random.logarithmic(1e-12, 1e-6);
    text << "; until " << number(result.options.until) << "; error " << number(result.options.error);
    result.text = text.str();
    return result;
}

/// Whether doubles cannot give what was asked for; anything else is a fault of the library.
bool is_explained(const RandomScene& random, const AccuracyError& e) {
    // with equal coefficients a bead breaks away without acceleration, and comes back to the speed of a steady rail
    // without acceleration: whether it touches is decided by rounding
    if (random.is_driven && random.has_one_coefficient) return true;
    // a bead that moves a millionth of its distance from the origin: its positions are rounded to that distance
    const BodyHandle bead{0};
    const double distance = e.run[bead].position(e.run.start()).norm(), extent = scales(e.run, bead, 200).extent;
    return extent > 1e-9 * distance && 16.0 * epsilon * distance > random.options.error * extent;
}

/// What is wrong with a run, in words; empty if nothing.
std::string fault(const RandomScene& random) {
    const auto began = std::clock();
    const auto seconds = [&] { return static_cast<double>(std::clock() - began) / CLOCKS_PER_SEC; };
    SimulateOptions options = random.options;
    options.monitor = [&](double) { return seconds() < 10.0; };
    std::ostringstream out;
    try {
        const Trajectory run = simulate(random.scene, options);
        if (seconds() > 1.0) out << "took " << seconds() << " s; ";
        const bool at_end_of_rail = run.status() == Status::stopped_by_event && !run.events().empty() &&
                                    run.events().back().kind == EventKind::rail_end;
        if (run.status() == Status::stopped_by_event ? !at_end_of_rail : run.status() != Status::reached_end)
            out << "status " << name_of(run.status()) << "; ";
        if (run.status() == Status::reached_end && run.end() != options.until) out << "ended at " << run.end() << "; ";
        if (!run.error() || !(*run.error() <= options.error)) out << "estimate above the error asked for; ";
        // times in order, the motion finite, energy never made by friction
        double last = options.start;
        for (const Event& e : run.events()) {
            if (!(e.time > options.start && e.time >= last && e.time <= run.end()))
                out << "event at " << e.time << "; ";
            last = e.time;
        }
        const BodyHandle bead{0};
        constexpr int times = 200;
        double scale = 0.0, before = std::numeric_limits<double>::infinity(), rise = 0.0;
        for (int k = 0; k <= times; ++k) {
            const double t = std::min(run.end(), run.start() + (run.end() - run.start()) * k / times);
            const PointReport r = run[bead].report(t);
            if (!r.position.allFinite() || !r.velocity.allFinite() || !r.acceleration.allFinite() ||
                !r.reaction.allFinite()) {
                out << "not finite at " << t << "; ";
                break;
            }
            const double energy = run.energy(t);
            scale = std::max(scale, run.kinetic_energy(t) + std::abs(run.potential(t)));
            rise = std::max(rise, energy - before);
            before = energy;
        }
        // each energy is wrong by twice the relative error of its state; rounding of its terms beside it
        if (!random.is_driven && rise > (4.0 * options.error + 1e-13) * scale)
            out << "energy rises by " << rise / scale << " of its scale; ";
    } catch (const AccuracyError& e) {
        if (!is_explained(random, e)) out << "AccuracyError: " << e.what();
    } catch (const IntegrationError& e) {
        out << "IntegrationError: " << e.what();
    } catch (const std::exception& e) {
        out << "exception: " << e.what();
    }
    return out.str();
}

/// How many random scenes fail with an engine; each is printed.
int failures(const std::string& engine, int first, int count) {
    int failures = 0;
    for (int i = first; i < first + count; ++i) {
        RandomScene scene = some_scene(i);
        scene.options.engine = engine;
        const std::string what = fault(scene);
        if (what.empty()) continue;
        ++failures;
        std::cout << "FAULT " << engine << " " << scene.text << "\n      " << what << std::endl;
    }
    return failures;
}

TEST(RandomScenes, a_bead_on_any_rough_rail_ends_its_run_as_asked) {
    const int count = setting("RBDYN_RANDOM_SCENES", 300), first = setting("RBDYN_RANDOM_FIRST", 0);
    const int failed = failures("taylor", first, count);
    RecordProperty("failures", failed);
    EXPECT_LE(failed, count / 1000) << "of " << count << " scenes; each is printed above";
}

TEST(RandomScenes, dop853_gives_the_same_motion_to_the_error_asked_for) {
    // the error of a run by another engine than Taylor series is its distance from one by these
    const int count = setting("RBDYN_RANDOM_SCENES", 300), first = setting("RBDYN_RANDOM_FIRST", 0);
    const int failed = failures("dop853", first, count);
    RecordProperty("failures", failed);
    EXPECT_LE(failed, count / 1000) << "of " << count << " scenes; each is printed above";
}

}  // namespace
}  // namespace rbdyn::test::test_random
