// Shapes: closed forms against each other, welded parts against wholes, and quadrature of their densities.
#include <gtest/gtest.h>

#include <limits>
#include <numbers>
#include <string>

#include "random.hpp"
#include "rbdyn/basics/double_double_functions.hpp"
#include "rbdyn/body/momentum.hpp"
#include "rbdyn/body/shapes.hpp"
#include "rbdyn/body/solid.hpp"
#include "refusal.hpp"

namespace rbdyn::test::test_shapes {

namespace {

using rbdyn::test::refusal;

using rbdyn::Quaternion, rbdyn::RigidBody, rbdyn::Vector3, rbdyn::test::Random;
using rbdyn::shapes::Range, rbdyn::shapes::SolidBounds;
namespace shapes = rbdyn::shapes;

constexpr double epsilon = std::numeric_limits<double>::epsilon();
constexpr double pi = std::numbers::pi;

double largest(const Matrix3Of<DoubleDouble>& m) { return rounded(m).cwiseAbs().maxCoeff(); }

/// Equal in mass, centre of mass and inertia to a relative error.
void expect_same(const RigidBody& a, const RigidBody& b, double error) {
    const double size = std::sqrt(b.inertia().trace() / b.mass()) + b.com().norm();
    EXPECT_NEAR(a.mass(), b.mass(), error * b.mass());
    EXPECT_LE((a.com() - b.com()).norm(), error * size);
    EXPECT_LE(largest(a.inertia_exact() - b.inertia_exact()), error * largest(b.inertia_exact()))
        << a.inertia() << "\n\n"
        << b.inertia();
}

TEST(Shapes, moments_are_those_of_the_textbooks) {
    const auto moments = [](const RigidBody& body) { return Vector3(body.inertia().diagonal()); };
    const Vector3 z(0, 0, 2);
    EXPECT_EQ(moments(shapes::rod(3.0, 2.0, z)), Vector3(1, 1, 0));
    EXPECT_EQ(moments(shapes::box(12.0, {1, 2, 3})), Vector3(13, 10, 5));
    EXPECT_EQ(moments(shapes::disc(4.0, 3.0, z)), Vector3(9, 9, 18));
    EXPECT_EQ(moments(shapes::ring(4.0, 3.0, z)), Vector3(18, 18, 36));
    EXPECT_EQ(moments(shapes::cylinder(12.0, 1.0, 2.0, z)), Vector3(7, 7, 6));
    EXPECT_EQ(moments(shapes::sphere(5.0, 2.0)), Vector3(8, 8, 8));
    EXPECT_EQ(moments(shapes::shell(3.0, 2.0)), Vector3(8, 8, 8));
    EXPECT_EQ(moments(shapes::ellipsoid(5.0, {1, 2, 3})), Vector3(13, 10, 5));
    const RigidBody cone = shapes::cone(80.0, 1.0, 2.0, z);
    EXPECT_EQ(moments(cone), Vector3(24, 24, 24));
    EXPECT_EQ(cone.com(), Vector3(0, 0, 1.5));
    // about its apex: 3/20 m (r^2 + 4 h^2)
    EXPECT_EQ(cone.inertia(InertiaAbout::origin)(0, 0), 204.0);
}

TEST(Shapes, the_axis_may_point_anywhere_and_have_any_length) {
    Random random(1);
    for (int k = 0; k < 30; ++k) {
        const Quaternion q = rbdyn::turn(random.direction(), random.uniform(-7, 7));
        const Vector3 axis = random.logarithmic(1e-200, 1e200) * Vector3(rotation_matrix(q).col(2));
        const Vector3 z(0, 0, 1);
        expect_same(shapes::cylinder(2.0, 0.3, 1.0, axis), shapes::cylinder(2.0, 0.3, 1.0, z).rotated(q), 4 * epsilon);
        expect_same(shapes::cone(2.0, 0.3, 1.0, axis), shapes::cone(2.0, 0.3, 1.0, z).rotated(q), 4 * epsilon);
        EXPECT_TRUE(shapes::rod(1.0, 0.7, axis).is_rod());
        EXPECT_TRUE(shapes::disc(1.0, 0.7, axis).is_gyroscope(0.0));
        const auto p = shapes::rod(1.0, 0.7, axis).principal_exact();
        EXPECT_EQ(p.moments[0] == p.moments[1] || p.moments[1] == p.moments[2] || p.moments[2] == p.moments[0], true);
    }
}

TEST(Shapes, wholes_are_the_parts_they_are_cut_into_to_32_digits) {
    const double wide_rounding = 0x1p-98;
    const Vector3 z(0, 0, 1);
    // lengths and masses whose halves and thirds of inertia are no doubles
    const RigidBody half = shapes::rod(0.35, 0.15, z);
    expect_same(half.shifted({0, 0, 0.075}) + half.shifted({0, 0, -0.075}), shapes::rod(0.7, 0.3, z), wide_rounding);
    const RigidBody slab = shapes::box(0.7, {0.1, 0.2, 0.15});
    expect_same(slab.shifted({0, 0, -0.075}) + slab.shifted({0, 0, 0.075}), shapes::box(1.4, {0.1, 0.2, 0.3}),
                wide_rounding);
    const RigidBody coin = shapes::cylinder(0.7, 0.3, 0.05, z);
    expect_same(coin.shifted({0, 0, -0.025}) + coin.shifted({0, 0, 0.025}), shapes::cylinder(1.4, 0.3, 0.1, z),
                wide_rounding);
    // a cone of height 2 is one of height 1 and a frustum: seven parts of eight, taken as eight less one
    const RigidBody whole = shapes::cone(0.8, 0.3, 2.0, z), tip = shapes::cone(0.1, 0.15, 1.0, z);
    EXPECT_NEAR(whole.inertia(InertiaAbout::origin)(2, 2), 32.0 * tip.inertia(InertiaAbout::origin)(2, 2), 1e-15);
    // welded bodies agree in doubles to the last place or the one before
    const RigidBody both = half.shifted({0, 0, 0.075}) + half.shifted({0, 0, -0.075});
    EXPECT_LE(std::abs(both.inertia()(0, 0) - shapes::rod(0.7, 0.3, z).inertia()(0, 0)),
              epsilon * both.inertia()(0, 0));
}

TEST(Shapes, a_ball_is_an_ellipsoid_a_thin_cylinder_a_disc_and_a_thin_box_a_rod) {
    expect_same(shapes::ellipsoid(0.7, {0.3, 0.3, 0.3}), shapes::sphere(0.7, 0.3), 1e-30);
    expect_same(shapes::cylinder(0.7, 0.3, 1e-12, {0, 1, 0}), shapes::disc(0.7, 0.3, {0, 1, 0}), 1e-22);
    expect_same(shapes::box(0.7, {1e-12, 0.3, 1e-12}), shapes::rod(0.7, 0.3, {0, 1, 0}), 1e-22);
}

TEST(Shapes, points_of_mass_are_the_same_body_in_any_order) {
    Random random(2);
    std::vector<double> masses;
    std::vector<Vector3> at;
    for (int k = 0; k < 20; ++k) {
        masses.push_back(random.uniform(0.1, 2.0));
        at.push_back(random.direction() + Vector3(1e3, 0, 0));
    }
    const RigidBody body = shapes::points(masses, at);
    RigidBody welded = shapes::points({masses[19]}, {at[19]});
    for (std::size_t k = 19; k-- > 0;) welded = welded + shapes::points({masses[k]}, {at[k]});
    expect_same(welded, body, 1e-26);  // of what is a thousandth of its distance: 32 digits less six
    EXPECT_TRUE(shapes::points({1.0}, {{1, 2, 3}}).is_point());
    EXPECT_TRUE(shapes::points({1.0, 0.7}, {{1, 2, 3}, {0.1, 0.2, 0.7}}).is_rod());
}

TEST(Shapes, numbers_that_make_no_shape_are_refused_by_name) {
    const Vector3 z(0, 0, 1), none(0, 0, 0);
    const struct {
        std::string message, words;
    } cases[] = {
        {refusal([&] { shapes::rod(1.0, -2.0, z); }), "rod: length is -2; it is positive"},
        {refusal([&] { shapes::rod(1.0, 2.0, none); }), "rod: length of along is 0;"},
        {refusal([&] {
             shapes::box(1.0, {1, 0, 1});
         }),
         "box: size[1] is 0;"},
        {refusal([&] {
             shapes::ellipsoid(1.0, {1, 1, std::nan("")});
         }),
         "ellipsoid: semi_axes[2] is nan;"},
        {refusal([&] { shapes::disc(0.0, 1.0, z); }), "disc: mass is 0; it is positive and finite; give it in kg"},
        {refusal([&] { shapes::cone(1.0, 1.0, 0.0, z); }), "cone: height is 0;"},
        {refusal([&] { shapes::points({1.0}, {}); }), "points: masses has 1 numbers and positions 0;"},
        {refusal([&] {
             shapes::points({1.0, -1.0}, {z, none});
         }),
         "points: masses[1] is -1;"},
    };
    for (const auto& c : cases) EXPECT_NE(c.message.find(c.words), std::string::npos) << c.message;
}

// --- quadrature ---

/// A ball about the origin, as bounds.
SolidBounds ball(double r) {
    const auto half = [](double square) { return std::sqrt(std::max(square, 0.0)); };
    return {Range{-r, r},
            [=](double x) {
                const double y = half(r * r - x * x);
                return Range{-y, y};
            },
            [=](double x, double y) {
                const double z = half(r * r - x * x - y * y);
                return Range{-z, z};
            }};
}

TEST(Solid, uniform_density_gives_the_closed_forms) {
    const auto uniform = [](double density) { return [=](double, double, double) { return density; }; };
    const RigidBody block = shapes::solid(uniform(2.0), {{-0.1, 0.1}, {-0.2, 0.2}, {0.0, 3.0}});
    expect_same(block, shapes::box(2.0 * 0.2 * 0.4 * 3.0, {0.2, 0.4, 3.0}).shifted({0, 0, 1.5}), 1e-13);
    const RigidBody round = shapes::solid(uniform(3.0), ball(0.5));
    expect_same(round, shapes::sphere(3.0 * 4.0 / 3.0 * pi * 0.125, 0.5), 1e-13);
    // a cone by its sections
    const double r = 0.3, h = 2.0;
    const RigidBody cone =
        shapes::solid(uniform(1.0), {Range{0.0, h},
                                     [=](double x) {
                                         return Range{-r * x / h, r * x / h};
                                     },
                                     [=](double x, double y) {
                                         const double z = std::sqrt(std::max(0.0, r * r * x * x / (h * h) - y * y));
                                         return Range{-z, z};
                                     }});
    expect_same(cone, shapes::cone(pi * r * r * h / 3.0, r, h, {1, 0, 0}), 1e-13);
}

TEST(Solid, a_density_that_varies_has_its_integrals) {
    // exp(-x) sin(pi y) on the unit cube, its integrals by hand
    const RigidBody body = shapes::solid([](double x, double y, double) { return std::exp(-x) * std::sin(pi * y); },
                                         {{0, 1}, {0, 1}, {0, 1}});
    const double e = std::exp(-1.0), mass = (1.0 - e) * 2.0 / pi;
    EXPECT_NEAR(body.mass(), mass, 1e-13);
    const double x1 = (1.0 - 2.0 * e) / (1.0 - e), x2 = (2.0 - 5.0 * e) / (1.0 - e);
    EXPECT_NEAR(body.com()[0], x1, 1e-13);
    EXPECT_NEAR(body.com()[1], 0.5, 1e-13);
    const double y2 = 0.5 - 2.0 / (pi * pi);
    EXPECT_NEAR(body.inertia()(2, 2), mass * (x2 - x1 * x1 + y2 - 0.25), 1e-13);
    EXPECT_NEAR(body.inertia()(0, 1), 0.0, 1e-14);
}

TEST(Solid, a_narrow_peak_is_found_and_a_far_place_costs_no_digits) {
    // a Gaussian a fortieth of the box wide: mass and moments to the tails, exp(-200)
    const double s = 0.05, far = 1e4;
    const RigidBody body = shapes::solid(
        [=](double x, double y, double z) {
            const double r2 = (x - far) * (x - far) + (y - 0.25) * (y - 0.25) + z * z;
            return std::exp(-0.5 * r2 / (s * s));
        },
        {{far - 1.0, far + 1.0}, {-1, 1}, {-1, 1}});
    const double mass = std::pow(2.0 * pi * s * s, 1.5);
    EXPECT_NEAR(body.mass(), mass, 1e-11 * mass);
    EXPECT_LE((body.com() - Vector3(far, 0.25, 0)).norm(), 1e-11);
    EXPECT_LE((body.inertia() - 2.0 * mass * s * s * Matrix3::Identity()).norm(), 1e-10 * mass * s * s);
}

TEST(Solid, a_density_that_jumps_is_refused_unless_a_larger_error_is_asked_for) {
    const auto jumps = [](double x, double y, double z) { return x * x + y * y + z * z <= 1.0 ? 1.0 : 0.0; };
    const SolidBounds box{{-1, 1}, {-1, 1}, {-1, 1}};
    EXPECT_NE(refusal([&] { shapes::solid(jumps, box); }).find("solid: relative accuracy reached is"),
              std::string::npos);
    expect_same(shapes::solid(jumps, box, 3e-2), shapes::sphere(4.0 / 3.0 * pi, 1.0), 3e-2);
}

TEST(Solid, what_is_narrow_is_found_or_refused_never_passed_over) {
    const SolidBounds cube{{0, 1}, {0, 1}, {0, 1}};
    const double root = std::sqrt(pi);
    for (const double w : {0.1, 0.01}) {
        const auto peak = [w](double x, double at) { return std::exp(-(x - at) * (x - at) / (w * w)); };
        const auto check = [&](const auto& density, double mass, const char* what) {
            try {
                EXPECT_NEAR(shapes::solid(density, cube).mass() / mass, 1.0, 1e-11) << what << w;
            } catch (const InvalidInput& refusal) {
                EXPECT_LT(w, 0.025) << what << refusal.what();
            }
        };
        // its integral from 0 to 1
        const auto all = [&](double at) { return 0.5 * w * root * (std::erf((1.0 - at) / w) + std::erf(at / w)); };
        check([&](double x, double, double) { return 1.0 + 10.0 * peak(x, 0.3137); }, 1.0 + 10.0 * all(0.3137),
              "plate ");
        check([&](double x, double y, double) { return 1.0 + 100.0 * peak(x, 0.3137) * peak(y, 0.7113); },
              1.0 + 100.0 * all(0.3137) * all(0.7113), "needle ");
        check([&](double x, double y,
                  double z) { return 1.0 + 100.0 * peak(x, 0.3137) * peak(y, 0.7113) * peak(z, 0.4321); },
              1.0 + 100.0 * all(0.3137) * all(0.7113) * all(0.4321), "grain ");
    }
    // thinner still: the plate is found on lines
    const auto thin = [](double x, double, double) { return 1.0 + 50.0 * std::exp(-std::pow((x - 0.3137) / 5e-4, 2)); };
    EXPECT_NEAR(shapes::solid(thin, cube).mass() / (1.0 + 50.0 * 5e-4 * root), 1.0, 1e-11);
    // a grain with edges
    const auto grain = [](double x, double y, double z) {
        return std::abs(x - 0.3) < 0.01 && std::abs(y - 0.6) < 0.01 && std::abs(z - 0.45) < 0.01 ? 50.0 : 1.0;
    };
    EXPECT_NE(refusal([&] { shapes::solid(grain, cube); }).find("solid: "), std::string::npos);
}

TEST(Solid, thin_plates_with_sharp_edges_are_found_wherever_they_are) {
    const SolidBounds cube{{0, 1}, {0, 1}, {0, 1}};
    // of a ten-thousandth of the range and more, along each axis, on a background a thousandth as dense or on none
    Random random(11);
    for (int trial = 0; trial < 6; ++trial) {
        const int axis = trial % 3;
        const double half = 0.5 * std::pow(10.0, random.uniform(-4.0, -2.5)), at = random.uniform(0.01, 0.99);
        const double background = trial < 3 ? 1e-3 : 0.0;
        const auto plate = [=](double x, double y, double z) {
            const double place[] = {x, y, z};
            return background + (std::abs(place[axis] - at) < half ? 1.0 : 0.0);
        };
        // edges are closed in on by halving, or that takes too many cells
        try {
            EXPECT_NEAR(shapes::solid(plate, cube).mass(), background + 2.0 * half, 1e-11) << half << " at " << at;
        } catch (const InvalidInput& refusal) {
            EXPECT_EQ(std::string(refusal.what()).find("mass is 0"), std::string::npos) << half << " at " << at;
        }
    }
    const auto two = [](double x, double, double) {
        return std::abs(x - 0.5123) < 0.001 || std::abs(x - 0.77) < 0.001 ? 1.0 : 0.0;
    };
    EXPECT_NEAR(shapes::solid(two, cube, 0.05).mass(), 0.004, 0.05 * 0.004);
}

TEST(Solid, bounds_and_densities_that_are_none_are_refused) {
    const auto one = [](double, double, double) { return 1.0; };
    const auto solid = [](const auto& density, const SolidBounds& bounds) {
        return refusal([&] { shapes::solid(density, bounds); });
    };
    const SolidBounds cube{{0, 1}, {0, 1}, {0, 1}};
    EXPECT_NE(solid(one, {{1, 0}, {0, 1}, {0, 1}}).find("the upper bound of x is 0; it is not below the lower one"),
              std::string::npos);
    EXPECT_NE(solid(one, {{0, 1}, {0, std::nan("")}, {0, 1}}).find("a bound of y is nan;"), std::string::npos);
    EXPECT_NE(solid(one, {{0, 1}, {0, 1}, {2, 2}}).find("solid: mass is 0;"), std::string::npos);
    EXPECT_NE(solid([](double x, double, double) { return x - 0.5; }, cube).find("a density is zero or positive"),
              std::string::npos);
    EXPECT_NE(solid([](double, double, double) { return std::nan(""); }, cube).find(" is nan;"), std::string::npos);
}

TEST(Solid, momentum_of_a_continuous_body_is_that_of_its_mass_properties) {
    // Int rho v dtau, Int (P - Q) x rho v dtau, Int rho v^2/2 dtau: the velocities of a rigid motion over points of
    // equal cells, exact for a density linear in x once their own inertia is counted in
    const Vector3 pole(0.3, -0.2, 0.7), v_pole(1.0, 2.0, -0.5), omega(0.3, -1.1, 0.8);
    const auto density = [](double x, double, double) { return 1.0 + 2.0 * x; };
    const RigidBody body = shapes::solid(density, {{0, 1}, {0, 2}, {0, 0.5}});
    // Gauss's two points a cell are exact up to cubes: rho v^2 has the degree 3 in x and 2 in y and z
    const double node[2] = {0.5 - 0.5 / std::sqrt(3.0), 0.5 + 0.5 / std::sqrt(3.0)};
    Vector3 q = Vector3::Zero(), k = Vector3::Zero();
    double t = 0.0;
    for (const double x : node)
        for (const double y : node)
            for (const double z : node) {
                const Vector3 p(x, 2.0 * y, 0.5 * z), v = v_pole + omega.cross(p - pole);
                const double dm = density(p[0], p[1], p[2]) * (1.0 / 8.0);
                q += dm * v;
                k += dm * (p - pole).cross(v);
                t += 0.5 * dm * v.squaredNorm();
            }
    EXPECT_LE((momentum(body, pole, v_pole, omega) - q).norm(), 1e-13);          // 7.28, 7.29
    EXPECT_LE((angular_momentum(body, pole, v_pole, omega) - k).norm(), 1e-13);  // 7.30b, 7.33
    EXPECT_NEAR(kinetic_energy(body, pole, v_pole, omega), t, 1e-13);            // 7.36
}

}  // namespace

}  // namespace rbdyn::test::test_shapes
