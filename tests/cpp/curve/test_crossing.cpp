// Where paths first cross plane curves: against closed forms, and against dense searches in long double.
#include "rbdyn/curve/crossing.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <numbers>
#include <optional>
#include <vector>

namespace rbdyn::curves::test_crossing {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
using Real = long double;

const Circle unit_circle{.radius = 1.0, .start = {1, 0, 0}, .toward = {0, 1, 0}};
const Line x_axis{.direction = {1, 0, 0}};

/// y = sum_k c_k x^k, by x; c_0 = 0, since the own origin is there.
Polynomial graph_of(const std::vector<double>& c) {
    Polynomial p;
    for (std::size_t k = 0; k < std::max<std::size_t>(c.size(), 2); ++k)
        p.coefficients.push_back({k == 1 ? 1.0 : 0.0, k < c.size() ? c[k] : 0.0, 0.0});
    return p;
}

struct Path {
    std::vector<double> x, y;
    double length = 1.0;

    Flight flight() const { return {x.data(), y.data(), static_cast<int>(x.size()) - 1, length}; }
    static Real value(const std::vector<double>& c, Real t) {
        Real sum = 0.0L;
        for (auto k = c.rbegin(); k != c.rend(); ++k) sum = sum * t + *k;
        return sum;
    }
    Real x_at(Real t) const { return value(x, t); }
    Real y_at(Real t) const { return value(y, t); }
};

std::optional<Landing> land(const Curve& curve, const Path& path, int side, double last = 0.0, bool just_left = false) {
    LandingFinder finder(curve, curve.closed() ? 2.0 * std::numbers::pi : 0.0);
    const auto found = finder.first_landing(path.flight(), side, last, just_left);
    EXPECT_TRUE(finder.complete());
    return found;
}

/// A function's first fall through zero in (from, to], from a dense search and halving.
std::optional<Real> first_fall(const std::function<Real(Real)>& gap, Real from, Real to, int steps) {
    Real before = from;
    Real at_before = gap(from);
    for (int k = 1; k <= steps; ++k) {
        const Real t = from + (to - from) * k / steps, at = gap(t);
        if (at_before > 0.0L && at <= 0.0L) {
            Real lo = before, hi = t;
            for (int i = 0; i < 70; ++i) {
                const Real middle = 0.5L * (lo + hi);
                (gap(middle) > 0.0L ? lo : hi) = middle;
            }
            return hi;
        }
        before = t;
        at_before = at;
    }
    return std::nullopt;
}

double uniform(std::uint64_t& state, double lo = 0.0, double hi = 1.0) {
    state = state * 6364136223846793005ULL + 1442695040888963407ULL;
    return lo + (hi - lo) * static_cast<double>(state >> 11) * 0x1p-53;
}

TEST(Crossing, a_stone_thrown_over_flat_ground_lands_where_the_parabola_says) {
    // y = 1 + 3 t - 5 t^2 is zero at t = (3 + sqrt 29)/10
    const Path path{{-2.0, 4.0, 0.0}, {1.0, 3.0, -5.0}, 2.0};
    const double t = (3.0 + std::sqrt(29.0)) / 10.0;
    const auto landing = land(x_axis, path, 1);
    ASSERT_TRUE(landing);
    EXPECT_NEAR(landing->tau, t, 4e-16);
    EXPECT_NEAR(landing->u, -2.0 + 4.0 * t, 2e-15);
    // from below the same path is on the wrong side until it comes through the ground, and never comes back
    EXPECT_FALSE(land(x_axis, path, -1));
    EXPECT_FALSE(land(x_axis, {path.x, path.y, 0.8}, 1));
}

TEST(Crossing, a_bead_that_falls_off_a_loop_lands_on_it_again) {
    // leaves at the angle a from the horizontal where v^2 = g sin a; gap ~ t^3, the other root of |P|^2 = 1 is
    // t = -4 v.g/g^2 = 4 v cos a/g
    const double g = 9.8125;
    for (const double a : {0.2, 0.7, 1.0, 1.4, 1.55}) {
        const double v = std::sqrt(g * std::sin(a)), t = 4.0 * v * std::cos(a) / g;
        const Path path{{std::cos(a), -v * std::sin(a), 0.0}, {std::sin(a), v * std::cos(a), -0.5 * g}, 2.0};
        const auto landing = land(unit_circle, path, 1, a, true);
        ASSERT_TRUE(landing) << a;
        // the rounding of the contact, against t^3
        EXPECT_NEAR(landing->tau, t, 1e-15 / std::min(1.0, t * t)) << a;
        const double u = std::atan2(static_cast<double>(path.y_at(t)), static_cast<double>(path.x_at(t)));
        EXPECT_NEAR(landing->u, u < 0.0 ? u + 2.0 * std::numbers::pi : u, 4e-15 / std::min(1.0, t * t)) << a;
        EXPECT_FALSE(land(unit_circle, {path.x, path.y, 0.999 * t}, 1, a, true));
    }
}

TEST(Crossing, a_bead_that_leaves_a_sphere_never_comes_back) {
    // released at the top, it leaves at cos a = 2/3 from the vertical
    const double g = 9.8125, c = 2.0 / 3.0, s = std::sqrt(1.0 - c * c), v = std::sqrt(g * c);
    const Path path{{s, v * c, 0.0}, {c, -v * s, -0.5 * g}, 10.0};
    EXPECT_FALSE(land(unit_circle, path, -1, std::atan2(c, s), true));
}

TEST(Crossing, a_jump_off_a_hill_clears_it_or_lands_in_the_valley_behind) {
    const double g = 9.8125;
    // faster than sqrt(g): the flight is flatter than y = -x^2/2
    for (const double v : {3.2, 4.0, 30.0})
        EXPECT_FALSE(land(graph_of({0.0, 0.0, -0.5}), {{0.0, v, 0.0}, {0.0, 0.0, -0.5 * g}, 5.0}, 1, 0.0, true)) << v;
    // the hill ends in a valley and a slope up behind it
    const std::vector<double> hill{0.0, 0.0, -0.5, 0.0, 0.03125};
    for (const double v : {3.2, 4.0, 6.0, 9.0}) {
        const Path path{{0.0, v, 0.0}, {0.0, 0.0, -0.5 * g}, 3.0};
        const auto expected =
            first_fall([&](Real t) { return path.y_at(t) - Path::value(hill, path.x_at(t)); }, 1e-3L, 3.0L, 100000);
        const auto landing = land(graph_of(hill), path, 1, 0.0, true);
        ASSERT_TRUE(landing && expected) << v;
        EXPECT_NEAR(landing->tau, static_cast<double>(*expected), 1e-15) << v;
        EXPECT_NEAR(landing->u, static_cast<double>(path.x_at(*expected)), 4e-15) << v;
    }
}

TEST(Crossing, the_contact_just_left_does_not_count_and_a_landing_soon_after_does) {
    // over y = F(x), x = 0.3 + t: gap = t^m (e - t), so that it lands at t = e
    const std::vector<double> ground{0.0, -0.7, 0.4, 0.25};
    for (const int m : {2, 3})
        for (const double e : {1e-6, 1e-5, 1e-3, 0.1, 0.9}) {
            std::vector<Real> y(6, 0.0L);
            // F(0.3 + t) in powers of t
            for (std::size_t k = ground.size(); k-- > 0;) {
                for (std::size_t i = 5; i > 0; --i) y[i] = y[i] * Real(0.3) + y[i - 1];
                y[0] = y[0] * Real(0.3) + ground[k];
            }
            y[static_cast<std::size_t>(m)] += e;
            y[static_cast<std::size_t>(m) + 1] -= 1.0L;
            const Path path{{0.3, 1.0, 0.0, 0.0, 0.0, 0.0}, {y.begin(), y.end()}, 1.0};
            const auto landing = land(graph_of(ground), path, 1, 0.3, true);
            ASSERT_TRUE(landing) << m << " " << e;
            // the second derivative is the curve's own, the third that of a polynomial of degree 20 through its points
            EXPECT_NEAR(landing->tau, e, m == 2 ? 4e-15 : 1e-12) << m << " " << e;
            EXPECT_NEAR(landing->u, 0.3 + landing->tau, 1e-15);
            EXPECT_FALSE(land(graph_of(ground), {path.x, path.y, e * 0.99}, 1, 0.3, true)) << m << " " << e;
        }
    // no second term that is not rounding: leaves for good, whichever way the rounding goes
    for (const double rounding : {1e-17, -1e-17, 1e-14, -1e-14})
        EXPECT_FALSE(
            land(graph_of({0.0, 0.0, 1.0}), {{0.0, 1.0, 0.0, 0.0}, {0.0, 0.0, 1.0 + rounding, 1.0}}, 1, 0.0, true));
    // a path that goes through at once does not leave
    const auto through = land(graph_of({0.0, 0.0, 1.0}), {{0.0, 1.0, 0.0}, {0.0, 0.0, 0.999}}, 1, 0.0, true);
    ASSERT_TRUE(through);
    EXPECT_EQ(through->tau, 0.0);
    EXPECT_EQ(through->u, 0.0);
}

TEST(Crossing, a_touch_is_no_landing_and_a_dip_of_a_millionth_of_a_millionth_is) {
    // least gap -dip at t = 0.4; over a line, a circle's outside and a polynomial
    for (const double dip : {1e-12, 1e-9, 1e-4}) {
        for (const double sign : {1.0, -1.0}) {
            const Path flat{{0.0, 1.0, 0.0}, {0.16 - sign * dip, -0.8, 1.0}};
            const Path over{{-0.4, 1.0, 0.0}, {1.0 - sign * dip, 0.0, 0.0}};
            const std::vector<double> wave{0.0, 0.0, 1.0, -0.3, -2.0, 0.7};
            // (t - 0.4)^2 above the wave along x = t - 0.4, in powers of t
            std::vector<Real> y(6, 0.0L);
            for (std::size_t k = wave.size(); k-- > 0;) {
                for (std::size_t i = 5; i > 0; --i) y[i] = -Real(0.4) * y[i] + y[i - 1];
                y[0] = -Real(0.4) * y[0] + wave[k] + (k == 2 ? 1.0L : 0.0L);
            }
            y[0] -= sign * dip;
            const Path waving{{-0.4, 1.0, 0.0, 0.0, 0.0, 0.0}, {y.begin(), y.end()}};
            const auto a = land(x_axis, flat, 1), b = land(unit_circle, over, -1), c = land(graph_of(wave), waving, 1);
            ASSERT_EQ(a.has_value(), sign > 0.0) << dip;
            ASSERT_EQ(b.has_value(), sign > 0.0) << dip;
            ASSERT_EQ(c.has_value(), sign > 0.0) << dip;
            if (sign < 0.0) continue;
            // known as well as the gap is, 1e-16, against its slope, twice the distance to the least gap
            const double half = std::sqrt(dip), doubt = 2e-16 / half;
            EXPECT_NEAR(a->tau, 0.4 - half, doubt);
            EXPECT_NEAR(b->tau, 0.4 - std::sqrt(dip * (2.0 - dip)), 2.0 * doubt);
            EXPECT_NEAR(c->tau, 0.4 - half, 2.0 * doubt);
        }
    }
}

TEST(Crossing, of_several_crossings_in_a_step_the_first_counts) {
    // through the circle from outside and out again; allowed outside: in; allowed inside: out
    const Path through{{-3.0, 6.0}, {0.6, 0.0}};
    const auto in = land(unit_circle, through, -1), out = land(unit_circle, through, 1);
    ASSERT_TRUE(in && out);
    EXPECT_NEAR(in->tau, 2.2 / 6.0, 2e-16);
    EXPECT_NEAR(out->tau, 3.8 / 6.0, 2e-16);
    EXPECT_NEAR(in->u, std::numbers::pi - std::asin(0.6), 1e-15);
    EXPECT_NEAR(out->u, std::asin(0.6), 1e-15);
    // a wave of nine crossings over a line
    std::vector<Real> wave{1.0L};
    for (int k = 1; k <= 9; ++k) {
        wave.insert(wave.begin(), 0.0L);
        for (std::size_t i = 0; i + 1 < wave.size(); ++i) wave[i] -= Real(0.1) * k * wave[i + 1];
    }
    Path nine{{}, {wave.begin(), wave.end()}};
    nine.x.assign(nine.y.size(), 0.0);
    nine.x[1] = 1.0;
    const auto rising = land(x_axis, nine, -1), falling = land(x_axis, nine, 1);
    ASSERT_TRUE(rising && falling);
    EXPECT_NEAR(rising->tau, 0.1, 1e-11);
    EXPECT_NEAR(falling->tau, 0.2, 1e-11);
}

TEST(Crossing, a_crossing_at_the_end_of_a_step_is_met_once) {
    // y = 1 - t^2 to t = 1, and what follows it
    const Path first{{0.0, 1.0, 0.0}, {1.0, 0.0, -1.0}, 1.0}, rest{{1.0, 1.0, 0.0}, {0.0, -2.0, -1.0}, 1.0};
    const auto landing = land(x_axis, first, 1);
    ASSERT_TRUE(landing);
    EXPECT_EQ(landing->tau, 1.0);
    EXPECT_EQ(landing->u, 1.0);
    // wherever the end lies within rounding, the crossing is found by one step or, at its start, by the next
    std::uint64_t state = 3;
    for (int trial = 0; trial < 2000; ++trial) {
        const double a = uniform(state, 0.1, 1.5), v = uniform(state, 0.5, 2.0), w = uniform(state, -1.0, 1.0);
        const double h = uniform(state, 0.1, 3.0);
        const double x = std::cos(a), y = std::sin(a);
        // goes out through the circle at about h
        const double ux = v * x - w * y, uy = v * y + w * x;
        const double end = h * (1.0 + 2.2e-16 * std::floor(uniform(state, -4.0, 5.0)));
        const Path before{{x - ux * h, ux}, {y - uy * h, uy}, end};
        if (std::hypot(before.x[0], before.y[0]) >= 0.99) continue;
        const auto here = land(unit_circle, before, 1, a);
        const Path after{{static_cast<double>(before.x_at(end)), ux}, {static_cast<double>(before.y_at(end)), uy}, h};
        if (here) {
            EXPECT_NEAR(here->tau, h, 4e-15 * h + 1e-15 / v);
        } else {
            const auto there = land(unit_circle, after, 1, a);
            ASSERT_TRUE(there) << trial;
            EXPECT_LE(there->tau, 4e-15);
        }
    }
}

TEST(Crossing, a_closed_curve_counts_on_in_the_turn_the_bead_was_in) {
    const Path out{{0.0, 0.0}, {0.0, -2.0}};
    const double turn = 2.0 * std::numbers::pi;
    for (const double last : {0.5, turn - 0.1, turn + 0.5, -0.5, 100.0 * turn + 1.0}) {
        const auto landing = land(unit_circle, out, 1, last);
        ASSERT_TRUE(landing);
        EXPECT_EQ(landing->tau, 0.5);
        EXPECT_NEAR(landing->u, std::floor(last / turn) * turn + 0.75 * turn, 1e-15 * (turn + std::abs(last)));
    }
    // just left at the seam, on either side of it
    for (const double last : {0.0, 1e-9, turn - 1e-9, turn}) {
        const Path path{{std::cos(last), -std::sin(last), -2.0}, {std::sin(last), std::cos(last), 0.0}};
        const auto landing = land(unit_circle, path, 1, last, true);
        const auto expected =
            first_fall([&](Real t) { return 1.0L - path.x_at(t) * path.x_at(t) - path.y_at(t) * path.y_at(t); }, 1e-2L,
                       1.0L, 1000);
        ASSERT_EQ(landing.has_value(), expected.has_value()) << last;
    }
}

TEST(Crossing, far_out_on_curves_without_end_landings_are_as_exact_as_places_are) {
    for (const double far : {1e3, -1e6, 1e9}) {
        const Path path{{far, 0.5, 0.0}, {1.0, 0.0, -2.0}};
        const auto landing = land(x_axis, path, 1);
        ASSERT_TRUE(landing) << far;
        EXPECT_NEAR(landing->tau, std::sqrt(0.5), 2e-16);
        EXPECT_NEAR(landing->u, far + 0.5 * std::sqrt(0.5), 2e-16 * std::abs(far));
        // one cover that began near the origin
        LandingFinder finder{Curve(graph_of({0.0, 0.0, 0.25}))};
        const Path near{{0.0, 1.0, 0.0}, {1.0, 0.0, -2.0}};
        EXPECT_TRUE(finder.first_landing(near.flight(), 1, 0.0, false));
        const double height = 0.25 * far * far;
        const Path there{{far, 0.0, 0.0}, {1.5 * height, 0.0, -height}};
        const auto down = finder.first_landing(there.flight(), 1, 0.0, false);
        ASSERT_TRUE(down) << far;
        EXPECT_NEAR(down->tau, std::sqrt(0.5), 4e-16);
        EXPECT_NEAR(down->u, far, 4e-16 * std::abs(far));
    }
}

TEST(Crossing, units_and_where_the_curve_lies_in_the_world_change_no_bit) {
    const Path path{{0.1, 0.7, -0.3, 0.2}, {0.05, -0.2, 0.9, 0.8}, 1.5};
    const auto here = land(unit_circle, path, 1);
    ASSERT_TRUE(here);
    const Circle tilted{.radius = 1.0, .start = {1, 2, 3}, .toward = {0, 1, 0}, .center = {5, -6, 7}};
    const auto there = land(tilted, path, 1);
    ASSERT_TRUE(there);
    EXPECT_EQ(there->tau, here->tau);
    EXPECT_EQ(there->u, here->u);
    for (const int power : {-60, -7, 3, 40}) {
        const double unit = std::ldexp(1.0, power);
        Path scaled = path;
        for (auto* c : {&scaled.x, &scaled.y})
            for (double& value : *c) value *= unit;
        const Circle circle{.radius = unit, .start = {1, 0, 0}, .toward = {0, 1, 0}};
        const auto landing = land(circle, scaled, 1);
        ASSERT_TRUE(landing);
        EXPECT_EQ(landing->tau, here->tau);
        EXPECT_EQ(landing->u, here->u);
        // a line by its length, whose parameter changes with the unit, and the unit of time
        Path fall{{-2.0, 4.0, 0.0}, {1.0, 3.0, -5.0}, 2.0};
        const auto flat = land(x_axis, fall, 1);
        for (auto* c : {&fall.x, &fall.y})
            for (std::size_t k = 0; k < 3; ++k) (*c)[k] *= unit * std::ldexp(1.0, -5 * static_cast<int>(k));
        fall.length *= 32.0;
        const auto scaled_flat = land(x_axis, fall, 1);
        ASSERT_TRUE(flat && scaled_flat);
        EXPECT_EQ(scaled_flat->tau, 32.0 * flat->tau);
        EXPECT_EQ(scaled_flat->u, unit * flat->u);
    }
}

TEST(Crossing, near_a_cusp_both_branches_are_seen) {
    // (u^2, u^3): the outside, y^2 > x^3, lies to the left
    const Curve cusp = Polynomial{.coefficients = {{0, 0, 0}, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}}};
    std::uint64_t state = 11;
    int landings = 0;
    for (int trial = 0; trial < 1000; ++trial) {
        // aimed past the cusp at a distance of any size
        const double miss = std::pow(10.0, uniform(state, -9.0, 0.0)) * (trial % 2 == 0 ? 1.0 : -1.0);
        const double a = uniform(state, 0.0, 2.0 * std::numbers::pi), c = std::cos(a), s = std::sin(a);
        const Path path{{-c - s * miss, 2.0 * c}, {-s + c * miss, 2.0 * s}};
        const auto gap = [&](Real t) {
            const Real x = path.x_at(t), y = path.y_at(t);
            return y * y - x * x * x;
        };
        // denser towards where it passes the cusp, with y = 0 there: inside if x > 0
        const Real passes = -Real(path.y[0]) / path.y[1];
        std::optional<Real> expected;
        Real from = 0.0L;
        for (int k = 1; k <= 160 && !expected; ++k) {
            const Real off = (2.0L + std::abs(passes)) * std::pow(0.7L, k <= 80 ? k : 160 - k),
                       to = passes + (k < 80    ? -off
                                      : k == 80 ? 0.0L
                                                : off);
            if (!(to > from)) continue;
            expected = first_fall(gap, from, std::min(to, 1.0L), 20);
            from = to;
        }
        const auto landing = land(cusp, path, 1);
        ASSERT_EQ(landing.has_value(), expected.has_value()) << trial << " " << a << " " << miss;
        if (!landing) continue;
        ++landings;
        const Real x = path.x_at(landing->tau), y = path.y_at(landing->tau);
        EXPECT_NEAR(landing->tau, static_cast<double>(*expected), 1e-12) << trial << " " << a << " " << miss;
        EXPECT_NEAR(static_cast<double>(x), landing->u * landing->u, 1e-14);
        EXPECT_NEAR(static_cast<double>(y), landing->u * landing->u * landing->u, 1e-14);
    }
    EXPECT_GT(landings, 200);
}

TEST(Crossing, random_flights_at_circles_and_lines_land_where_closed_forms_say) {
    std::uint64_t state = 2024;
    int landings = 0;
    LandingFinder on_circle(unit_circle, 2.0 * std::numbers::pi), on_line{Curve(x_axis)};
    for (int trial = 0; trial < 10000; ++trial) {
        Path path{{0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}, uniform(state, 0.2, 2.0)};
        const double spread = trial % 3 == 0 ? 1.0 : 3.0;
        for (auto* c : {&path.x, &path.y})
            for (double& value : *c) value = uniform(state, -spread, spread);
        const int side = trial % 2 == 0 ? 1 : -1;
        // the quartic 1 - |P|^2, by its own monotone stretches: roots of polynomials are tested by themselves
        std::vector<double> q(5, 0.0);
        for (std::size_t i = 0; i < 3; ++i)
            for (std::size_t k = 0; k < 3; ++k) q[i + k] -= path.x[i] * path.x[k] + path.y[i] * path.y[k];
        q[0] += 1.0;
        for (const bool circle : {true, false}) {
            std::vector<double> g = circle ? q : path.y;
            const double size = std::abs(g[0]);
            double power = 1.0;
            for (double& c : g) {
                c *= side * power;
                power *= path.length;
            }
            std::vector<double> roots;
            series::RootFinder().find(g.data(), static_cast<int>(g.size()) - 1, roots);
            std::optional<double> expected;
            bool above = g[0] > 0.0;
            for (double r : roots) {
                if (above && !expected) expected = r * path.length;
                above = !above;
            }
            auto& finder = circle ? on_circle : on_line;
            const auto landing = finder.first_landing(path.flight(), side, 0.0, false);
            ASSERT_TRUE(finder.complete());
            ASSERT_EQ(landing.has_value(), expected.has_value()) << trial << " " << circle << " " << size;
            if (!landing) continue;
            ++landings;
            const Real x = path.x_at(*expected), y = path.y_at(*expected);
            const Real slope = circle ? std::abs(2.0L * (x * Path::value({path.x[1], 2.0 * path.x[2]}, *expected) +
                                                         y * Path::value({path.y[1], 2.0 * path.y[2]}, *expected)))
                                      : std::abs(Path::value({path.y[1], 2.0 * path.y[2]}, *expected));
            EXPECT_NEAR(landing->tau, *expected, 1e-14 / std::min(1.0L, slope) + 1e-15) << trial << " " << circle;
            const CurvePoint<double> r = finder.cover().curve().own(landing->u);
            EXPECT_NEAR(static_cast<double>(path.x_at(landing->tau)), r.position[0], 4e-15) << trial;
            EXPECT_NEAR(static_cast<double>(path.y_at(landing->tau)), r.position[1], 4e-15) << trial;
        }
    }
    EXPECT_GT(landings, 3000);
}

TEST(Crossing, random_flights_over_random_ground_land_where_a_dense_search_says) {
    std::uint64_t state = 99;
    int landings = 0, close = 0;
    for (int ground_number = 0; ground_number < 60; ++ground_number) {
        std::vector<double> ground{0.0};
        for (int k = 0; k < 2 + ground_number % 6; ++k) ground.push_back(uniform(state, -1.0, 1.0));
        LandingFinder finder{Curve(graph_of(ground))};
        for (int trial = 0; trial < 50; ++trial) {
            const auto degree = static_cast<std::size_t>(uniform(state, 2.0, 24.99));
            Path path{std::vector<double>(degree + 1), std::vector<double>(degree + 1), uniform(state, 0.3, 1.0)};
            for (std::size_t k = 0; k <= degree; ++k) {
                path.x[k] = uniform(state, -1.0, 1.0);
                path.y[k] = uniform(state, -1.0, 1.0);
            }
            const int side = trial % 2 == 0 ? 1 : -1;
            const auto gap = [&](Real t) { return side * (path.y_at(t) - Path::value(ground, path.x_at(t))); };
            const auto expected = first_fall(gap, 0.0L, path.length, 1000);
            const auto landing = finder.first_landing(path.flight(), side, 0.0, false);
            ASSERT_TRUE(finder.complete());
            // what a dense search steps over is looked at by itself
            if (landing && (!expected || landing->tau < *expected - 1e-9L)) {
                ++close;
                EXPECT_LT(std::abs(gap(landing->tau)), 1e-13L);
                EXPECT_GT(gap(landing->tau - 1e-6L), 0.0L);
                EXPECT_LT(gap(landing->tau + 1e-6L), 0.0L);
                continue;
            }
            ASSERT_EQ(landing.has_value(), expected.has_value()) << ground_number << " " << trial;
            if (!landing) continue;
            ++landings;
            const Real slope = std::abs(gap(*expected + 1e-7L) - gap(*expected - 1e-7L)) / 2e-7L;
            EXPECT_NEAR(landing->tau, static_cast<double>(*expected), 2e-14 / std::min(1.0L, slope));
            EXPECT_NEAR(static_cast<double>(path.x_at(landing->tau)), landing->u, 1e-14);
        }
    }
    EXPECT_GT(landings, 300);
    EXPECT_LT(close, 10);
}

TEST(Crossing, a_flight_cut_into_steps_lands_where_the_whole_does) {
    std::uint64_t state = 17;
    int landings = 0;
    LandingFinder circle(unit_circle, 2.0 * std::numbers::pi), hill(graph_of({0.0, 0.0, -0.5, 0.0, 0.03125}));
    for (int trial = 0; trial < 5000; ++trial) {
        auto& finder = trial % 2 == 0 ? circle : hill;
        const int side = trial % 4 < 2 ? 1 : -1;
        Path path{{0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}};
        for (auto* c : {&path.x, &path.y})
            for (double& value : *c) value = uniform(state, -1.5, 1.5);
        const auto whole = finder.first_landing(path.flight(), side, 0.0, false);
        // cuts anywhere, and at the landing but for rounding
        std::vector<double> cuts{1.0};
        for (int k = 0; k < trial % 5; ++k) cuts.push_back(uniform(state));
        if (whole && trial % 3 == 0)
            cuts.push_back(std::min(1.0, whole->tau * (1.0 + 1.1e-16 * std::floor(uniform(state, -3.0, 4.0)))));
        std::sort(cuts.begin(), cuts.end());
        std::optional<double> landed;
        double from = 0.0;
        for (const double to : cuts) {
            if (!(to > from) || landed) continue;
            Path step = path;
            for (auto* c : {&step.x, &step.y}) {
                (*c)[0] = static_cast<double>(Path::value(*c, from));
                (*c)[1] += 2.0 * (*c)[2] * from;
            }
            step.length = to - from;
            const auto landing = finder.first_landing(step.flight(), side, 0.0, false);
            if (landing) landed = from + landing->tau;
            from = to;
        }
        ASSERT_EQ(landed.has_value(), whole.has_value()) << trial;
        if (!whole) continue;
        ++landings;
        EXPECT_NEAR(*landed, whole->tau, 1e-11) << trial;
    }
    EXPECT_GT(landings, 800);
}

TEST(Crossing, curves_that_cross_themselves_are_met_at_the_first_branch) {
    // x = u^2 - 1, y = u (u^2 - 1): a loop, y^2 = x^2 (x + 1);
    const Curve loop = Polynomial{.coefficients = {{0, 0, 0}, {0, -1, 0}, {1, 0, 0}, {0, 1, 0}}};
    // own origin at u = 0, (-1, 0) of the loop: branches at x = 1/2 there are u = -+ sqrt(1/2), y = +- sqrt(1/8)
    const double high = std::sqrt(0.125);
    const Path down{{0.5, 0.0}, {1.0, -2.0}};
    // the upper branch has u < 0 and x shrinking: its left is below; the lower one's left, x growing, is above
    const auto first = land(loop, down, -1), second = land(loop, down, 1);
    ASSERT_TRUE(first && second);
    EXPECT_NEAR(first->tau, 0.5 * (1.0 - high), 2e-16);
    EXPECT_NEAR(first->u, -std::sqrt(0.5), 4e-16);
    EXPECT_NEAR(second->tau, 0.5 * (1.0 + high), 2e-16);
    EXPECT_NEAR(second->u, std::sqrt(0.5), 4e-16);
}

TEST(Crossing, a_closed_curve_without_its_period_an_open_one_with_one_and_too_many_coefficients_are_refused) {
    EXPECT_THROW(LandingFinder{Curve(unit_circle)}, InvalidInput);
    EXPECT_THROW(LandingFinder(unit_circle, -1.0), InvalidInput);
    EXPECT_THROW(LandingFinder(x_axis, 1.0), InvalidInput);
    EXPECT_THROW(land(x_axis, {std::vector<double>(26, 1.0), std::vector<double>(26, 1.0)}, 1), InvalidInput);
}

TEST(Crossing, paths_along_the_curve_and_numbers_that_are_not_finite_end_without_a_landing) {
    EXPECT_FALSE(land(x_axis, {{0.0, 1.0}, {0.0, 0.0}}, 1, 0.0, true));
    EXPECT_FALSE(land(x_axis, {{0.0, 1.0}, {0.0, 0.0}}, 1));
    EXPECT_FALSE(land(x_axis, {{0.0, 0.0}, {1.0, 0.0}}, 1));
    // along a tilted slope, and along a circle as far as 24 coefficients follow it
    EXPECT_FALSE(land(graph_of({0.1, 0.3}), {{0.0, 1.0}, {0.1, 0.3}}, 1, 0.0, true));
    Path round{std::vector<double>(25), std::vector<double>(25), 1.0};
    double term = 1.0;
    for (std::size_t k = 0; k < 25; ++k) {
        (k % 2 == 0 ? round.x : round.y)[k] = (k / 2) % 2 == 0 ? term : -term;
        term /= static_cast<double>(k + 1);
    }
    for (const int side : {1, -1}) EXPECT_FALSE(land(unit_circle, round, side, 0.0, true));
    const double nan = std::numeric_limits<double>::quiet_NaN();
    for (const double bad : {nan, infinity}) {
        EXPECT_FALSE(land(unit_circle, {{0.0, bad}, {0.0, 1.0}}, 1));
        EXPECT_FALSE(land(unit_circle, {{bad, 1.0}, {0.0, 1.0}}, 1));
    }
}

}  // namespace
}  // namespace rbdyn::curves::test_crossing
