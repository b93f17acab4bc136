// Mass properties: other points, sums, shifts and turns against direct sums over points of mass; bodies refused.
#include <gtest/gtest.h>

#include <cstdint>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "random.hpp"
#include "rbdyn/basics/double_double_functions.hpp"
#include "rbdyn/body/momentum.hpp"
#include "refusal.hpp"

namespace rbdyn::test::test_rigid_body {

namespace {

using rbdyn::test::Random;
using rbdyn::test::refusal;

constexpr double epsilon = std::numeric_limits<double>::epsilon();
// of numbers of 32 digits: 2^-106, some tens of operations
constexpr double wide_rounding = 0x1p-100;

/// Points of mass whose sums are exact in whole numbers.
struct Cloud {
    std::vector<std::int64_t> mass;
    std::vector<Eigen::Matrix<std::int64_t, 3, 1>> at;
};

Cloud cloud(Random& random, int points) {
    Cloud c;
    for (int k = 0; k < points; ++k) {
        c.mass.push_back(random.whole(1, 1000));
        c.at.push_back({random.whole(-999, 999), random.whole(-999, 999), random.whole(-999, 999)});
    }
    return c;
}

RigidBody body_of(const Cloud& c, std::size_t begin, std::size_t end) {
    const auto point = [&](std::size_t k) {
        return RigidBody(static_cast<double>(c.mass[k]), {0, 0, 0}, {.com = c.at[k].cast<double>()});
    };
    RigidBody body = point(begin);
    for (std::size_t k = begin + 1; k < end; ++k) body = body + point(k);
    return body;
}

double largest(const Matrix3Of<DoubleDouble>& m) { return rounded(m).cwiseAbs().maxCoeff(); }

/// m I_G exactly: m times the direct sum about the origin, less that of the whole mass at G.
Eigen::Matrix<std::int64_t, 3, 3> mass_times_central_inertia(const Cloud& c) {
    using Whole = Eigen::Matrix<std::int64_t, 3, 1>;
    const auto second = [](const Whole& x) {
        return Eigen::Matrix<std::int64_t, 3, 3>(x.dot(x) * Eigen::Matrix<std::int64_t, 3, 3>::Identity() -
                                                 x * x.transpose());
    };
    std::int64_t mass = 0;
    Whole first = Whole::Zero();
    Eigen::Matrix<std::int64_t, 3, 3> about_origin = Eigen::Matrix<std::int64_t, 3, 3>::Zero();
    for (std::size_t k = 0; k < c.mass.size(); ++k) {
        mass += c.mass[k];
        first += c.mass[k] * c.at[k];
        about_origin += c.mass[k] * second(c.at[k]);
    }
    return mass * about_origin - second(first);
}

TEST(RigidBody, points_of_mass_welded_have_the_inertia_of_the_direct_sum_to_32_digits) {
    Random random(1);
    for (int k = 0; k < 50; ++k) {
        const Cloud c = cloud(random, random.whole(2, 12));
        const RigidBody body = body_of(c, 0, c.mass.size());
        const auto expected = mass_times_central_inertia(c);
        const double size = expected.cast<double>().cwiseAbs().maxCoeff();
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j) {
                const DoubleDouble off =
                    body.exact().mass * body.inertia_exact()(i, j) - static_cast<double>(expected(i, j));
                EXPECT_LE(std::abs(off.hi), wide_rounding * size);
                EXPECT_EQ(body.inertia_exact()(i, j), body.inertia_exact()(j, i));
            }
    }
}

TEST(RigidBody, the_order_and_grouping_of_welding_do_not_matter) {
    Random random(2);
    for (int k = 0; k < 50; ++k) {
        Cloud c = cloud(random, 9);
        const RigidBody whole = body_of(c, 0, 9);
        const auto cut = static_cast<std::size_t>(random.whole(1, 8));
        const RigidBody parts = body_of(c, cut, 9) + body_of(c, 0, cut);
        EXPECT_EQ(parts.mass(), whole.mass());
        EXPECT_LE((parts.com() - whole.com()).norm(), 2.0 * epsilon * whole.com().norm());
        EXPECT_LE((parts.inertia() - whole.inertia()).norm(), 2.0 * epsilon * whole.inertia().norm());
        EXPECT_LE(largest(parts.inertia_exact() - whole.inertia_exact()),
                  wide_rounding * largest(whole.inertia_exact()));
    }
}

/// Any body, its products of inertia and centre of mass not zero.
RigidBody any_body(Random& random) {
    const Cloud c = cloud(random, 5);
    const RigidBody body = body_of(c, 0, 5);
    return RigidBody(body.mass(), body.inertia(), {.com = body.com()});
}

TEST(RigidBody, an_inertia_about_the_origin_is_that_about_the_centre_of_mass_moved) {
    Random random(3);
    for (int k = 0; k < 50; ++k) {
        const RigidBody body = any_body(random);
        const RigidBody again(body.mass(), body.inertia(InertiaAbout::origin),
                              {.com = body.com(), .inertia_about = InertiaAbout::origin});
        EXPECT_LE((again.inertia() - body.inertia()).cwiseAbs().maxCoeff(),
                  epsilon * again.given_inertia().cwiseAbs().maxCoeff());
        EXPECT_EQ(again.inertia(InertiaAbout::origin), body.inertia(Vector3(0, 0, 0)));
        EXPECT_EQ(body.inertia(body.com()), body.inertia());
        EXPECT_EQ(again.inertia(Vector3(0, 0, 0)), again.given_inertia());
    }
}

TEST(RigidBody, there_and_back_leaves_a_body_as_it_was) {
    Random random(4);
    for (int k = 0; k < 50; ++k) {
        const RigidBody body = any_body(random);
        const Vector3 r = 1000.0 * random.direction();
        EXPECT_EQ(body.shifted(r).shifted(-r), body);
        EXPECT_EQ(body.shifted(r).inertia(r), body.inertia(InertiaAbout::origin));
        const Attitude turn = rbdyn::turn(random.direction(), random.uniform(-7, 7));
        const RigidBody back = body.rotated(turn).rotated(conjugate(turn.quaternion()));
        EXPECT_LE(largest(back.inertia_exact() - body.inertia_exact()), wide_rounding * body.inertia().norm());
        EXPECT_EQ(back.com(), body.com());
    }
}

TEST(RigidBody, a_quarter_turn_permutes_axes) {
    const RigidBody body(2.0, {1.0, 2.0, 2.5}, {.com = {1, 2, 3}});
    // one half is not the square of a double: the turn is exact only because its matrix divides by |q|^2
    const double half = std::sqrt(0.5);
    const RigidBody turned = body.rotated(Quaternion{half, 0, 0, half});
    EXPECT_EQ(turned.com(), Vector3(-2, 1, 3));
    EXPECT_EQ(turned.inertia(), Matrix3(Vector3(2.0, 1.0, 2.5).asDiagonal()));
    EXPECT_EQ(body.rotated(Quaternion{0.5, 0.5, 0.5, 0.5}).inertia(), Matrix3(Vector3(2.5, 1.0, 2.0).asDiagonal()));
}

TEST(RigidBody, turning_pieces_turns_the_whole) {
    Random random(5);
    for (int k = 0; k < 50; ++k) {
        const RigidBody a = any_body(random), b = any_body(random);
        const Attitude turn = rbdyn::turn(random.direction(), random.uniform(-7, 7));
        const RigidBody first = (a + b).rotated(turn), second = a.rotated(turn) + b.rotated(turn);
        EXPECT_LE(largest(first.inertia_exact() - second.inertia_exact()), wide_rounding * first.inertia().norm());
        EXPECT_LE((first.com() - second.com()).norm(), epsilon * first.com().norm());
    }
}

TEST(PrincipalAxes, they_are_orthonormal_right_handed_and_make_the_tensor_again_to_30_digits) {
    Random random(6);
    for (int k = 0; k < 100; ++k) {
        const RigidBody body = any_body(random);
        const auto p = body.principal_exact();
        Matrix3Of<DoubleDouble> scaled_axes = p.axes;
        for (int j = 0; j < 3; ++j) scaled_axes.col(j) = rbdyn::scaled(p.axes.col(j), p.moments[j]);
        const Matrix3Of<DoubleDouble> transposed = p.axes.transpose();
        EXPECT_LE(largest(product(scaled_axes, transposed) - body.inertia_exact()),
                  1e-30 * largest(body.inertia_exact()));
        EXPECT_LE(largest(product(p.axes, transposed) - rbdyn::widened(Matrix3(Matrix3::Identity()))), 1e-30);
        EXPECT_GT(rounded(p.axes).determinant(), 0.0);
    }
}

TEST(PrincipalAxes, a_diagonal_tensor_stays_as_it_is) {
    const auto p = RigidBody(1.0, {3.0, 1.0, 2.5}).principal();
    EXPECT_EQ(p.moments, Vector3(3.0, 1.0, 2.5));
    EXPECT_EQ(p.axes, Matrix3::Identity());
}

TEST(PrincipalAxes, equal_moments_stay_equal_in_any_attitude) {
    Random random(7);
    const RigidBody top(1.0, {0.3, 0.3, 0.1}), ball(1.0, {0.7, 0.7, 0.7}), rod(1.0, {0.3, 0.3, 0.0});
    for (int k = 0; k < 100; ++k) {
        const Quaternion turn = rbdyn::turn(random.direction(), random.uniform(-7, 7));
        auto m = top.rotated(turn).principal_exact().moments;
        EXPECT_EQ((m[0] == m[1]) + (m[1] == m[2]) + (m[2] == m[0]), 1);
        m = ball.rotated(turn).principal_exact().moments;
        EXPECT_TRUE(m[0] == m[1] && m[1] == m[2]);
        EXPECT_EQ(rod.rotated(turn).principal().moments.minCoeff(), 0.0);
        const Vector3 along = rotation_matrix(turn).col(2);
        EXPECT_NEAR(std::abs(top.rotated(turn).gyroscope_axis()->dot(along)), 1.0, 4.0 * epsilon);
        EXPECT_NEAR(std::abs(rod.rotated(turn).rod_axis()->dot(along)), 1.0, 4.0 * epsilon);
    }
}

TEST(PrincipalAxes, a_tiny_moment_keeps_its_digits_in_any_attitude) {
    Random random(8);
    const RigidBody needle(1.0, {1.0, 1.0, 1e-12});
    for (int k = 0; k < 50; ++k) {
        const RigidBody turned = needle.rotated(rbdyn::turn(random.direction(), random.uniform(-7, 7)));
        EXPECT_NEAR(turned.principal().moments.minCoeff(), 1e-12, 1e-28);
        EXPECT_FALSE(turned.is_rod());
    }
}

TEST(RigidBody, a_gyroscope_has_two_equal_moments_about_its_centre_of_mass) {
    EXPECT_EQ(*RigidBody(1.0, {1.0, 2.0, 2.0}).gyroscope_axis(), Vector3(1, 0, 0));
    EXPECT_EQ(*RigidBody(1.0, {2.0, 2.0, 2.0}).gyroscope_axis(), Vector3(0, 0, 1));
    EXPECT_TRUE(RigidBody(1.0, {1.0, 1.0 + 1e-10, 0.5}).is_gyroscope());
    EXPECT_FALSE(RigidBody(1.0, {1.0, 1.0 + 1e-10, 0.5}).is_gyroscope(1e-11));
    EXPECT_FALSE(RigidBody(1.0, {1.0, 2.0, 3.0}).is_gyroscope());
    // equal about G, not about the origin; and the reverse
    EXPECT_TRUE(RigidBody(1.0, {1.0, 1.0, 1.5}, {.com = {1, 0, 0}}).is_gyroscope());
    EXPECT_FALSE(
        RigidBody(0.5, {3.0, 3.0, 1.5}, {.com = {1, 0, 0}, .inertia_about = InertiaAbout::origin}).is_gyroscope());
    EXPECT_THROW(RigidBody(1.0, {1, 1, 1}).is_gyroscope(-1.0), InvalidInput);
}

TEST(RigidBody, is_balanced_about_its_principal_central_axes_alone) {
    Random random(11);
    for (int trial = 0; trial < 20; ++trial) {
        const RigidBody body = RigidBody(2.0, {1.0, 1.5, 2.0})
                                   .rotated(rbdyn::turn(random.direction(), random.uniform(-7, 7)))
                                   .shifted(random.direction());
        const Matrix3 axes = body.principal().axes;
        for (int k = 0; k < 3; ++k) {
            const Vector3 axis = random.uniform(0.1, 10.0) * rbdyn::column(axes, k);
            EXPECT_TRUE(body.is_balanced(axis, body.com() + 3.0 * axis));
            EXPECT_FALSE(body.is_balanced(axis, body.com() + 1e-6 * rbdyn::column(axes, (k + 1) % 3)));
            EXPECT_FALSE(body.is_balanced(axis + 1e-6 * axis.norm() * rbdyn::column(axes, (k + 1) % 3), body.com()));
        }
        // a principal axis about a point off it asks for a force, and for no couple
        const Vector3 point = body.com() + 0.5 * rbdyn::column(axes, 1), e = rbdyn::column(axes, 0);
        const rbdyn::Imbalance off = body.imbalance(e, point);
        EXPECT_LE((off.offset + rbdyn::column(axes, 1)).norm(), 1e-15);
        EXPECT_LE(off.couple.norm(), 1e-15);
    }
    // chapter's I_13 and I_23, matrix elements
    Matrix3 tensor;
    tensor << 2.0, 0.125, -0.25, 0.125, 2.5, 0.5, -0.25, 0.5, 3.0;
    const rbdyn::Imbalance i = RigidBody(2.0, tensor).imbalance({0, 0, 4});
    EXPECT_EQ(i.couple, Vector3(-0.5, -0.25, 0.0)) << "-I_23, I_13";
    EXPECT_EQ(i.offset, Vector3(0, 0, 0));
    EXPECT_NE(refusal([] {
                  (void)RigidBody(1.0, {1, 1, 1}).imbalance({0, 0, 0});
              }).find("length of axis is 0"),
              std::string::npos);
}

TEST(RigidBody, discs_laminae_rods_and_points_are_bodies) {
    Random random(9);
    for (const Vector3& moments : {Vector3(1, 1, 2), Vector3(0.1, 0.2, 0.1 + 0.2), Vector3(0.2, 0.1, 0.3),
                                   Vector3(1, 1, 0), Vector3(0, 0, 0), Vector3(1, 1, 1e-12)}) {
        const RigidBody body(1.0, moments);
        EXPECT_EQ(body.is_rod(), moments.minCoeff() == 0.0);
        EXPECT_EQ(body.is_point(), moments.maxCoeff() == 0.0);
        for (int k = 0; k < 20; ++k) {
            // turned and moved by the user, in doubles
            const Matrix3 r = rotation_matrix(rbdyn::turn(random.direction(), random.uniform(-7, 7)));
            const Matrix3 turned = r * moments.asDiagonal() * r.transpose();
            if (moments[2] == 1e-12) continue;  // its digits are lost in doubles
            EXPECT_EQ(RigidBody(1.0, turned).is_rod(), body.is_rod());
            const Vector3 g = random.direction();
            const Matrix3 moved = turned + g.squaredNorm() * Matrix3::Identity() - g * g.transpose();
            const RigidBody about_origin(1.0, moved, {.com = g, .inertia_about = InertiaAbout::origin});
            EXPECT_EQ(about_origin.is_rod(), body.is_rod());
        }
    }
}

TEST(RigidBody, numbers_no_body_has_are_refused_with_the_condition_and_the_numbers) {
    const double nan = std::nan(""), infinity = std::numeric_limits<double>::infinity();
    const auto of = [](double mass, const rbdyn::Inertia& inertia, const rbdyn::RigidBodyOptions& options = {}) {
        return refusal([&] { RigidBody(mass, inertia, options); });
    };
    Matrix3 skew = Matrix3::Identity(), products = Matrix3::Identity();
    skew(0, 1) = 0.25;
    products(0, 2) = products(2, 0) = 1.5;
    const struct {
        std::string message, words;
    } cases[] = {
        {of(-1.5, {1, 1, 1}), "RigidBody: mass is -1.5; a mass is positive"},
        {of(0.0, {1, 1, 1}), "mass is 0;"},
        {of(nan, {1, 1, 1}), "mass is nan;"},
        {of(1.0, {1, infinity, 1}), "inertia[1][1] is inf; an inertia is finite"},
        {of(1.0, {1, 1, 1}, {.com = {0, nan, 0}}), "com[1] is nan;"},
        {of(1.0, skew), "inertia[1][0] is 0; it is equal to inertia[0][1], which is 0.25: an inertia is symmetric"},
        {of(1.0, {1, 1, 3}),
         "(1, 1, 3) kg m^2, one is 3; each is at most the sum of the other two (triangle "
         "inequality), here 2: check"},
        {of(1.0, {1, 2, 3.0 + 1e-7}), "one is 3.0000001;"},
        {of(1.0, {1, -0.5, 1}), "(1, -0.5, 1) kg m^2, one is -0.5; a moment of inertia is zero or positive"},
        {of(1.0, {1, 1, -1e-14}), "one is -1e-14;"},
        {of(1.0, products), "one is -0.5; a moment of inertia is zero or positive"},
        {of(4.0, {1, 1, 1}, {.com = {1, 0, 0}, .inertia_about = InertiaAbout::origin}),
         "(1, -3, -3) kg m^2 (what was given about the origin less m d^2), one is -3;"},
    };
    for (const auto& c : cases) EXPECT_NE(c.message.find(c.words), std::string::npos) << c.message;
    // a lamina whose moments were written with eleven digits
    EXPECT_EQ(of(1.0, {1, 1, 2.0 * (1.0 + 1e-11)}), "accepted");
}

TEST(RigidBody, a_body_of_any_unit_is_judged_alike) {
    for (const double unit : {0x1p-60, 1.0, 0x1p60}) {
        EXPECT_NO_THROW(RigidBody(unit, unit * Vector3(0.1, 0.2, 0.1 + 0.2)));
        EXPECT_THROW(RigidBody(unit, unit * Vector3(1, 1, 2.0 + 1e-7)), InvalidInput);
        EXPECT_EQ(RigidBody(unit, unit * Vector3(1, 1, 2)).is_gyroscope(), true);
        EXPECT_EQ(RigidBody(unit, unit * Vector3(1, 1, 1e-12)).is_rod(), false);
    }
}

TEST(RigidBody, bodies_are_equal_if_the_same_was_given) {
    const RigidBody a(1.0, {1, 2, 3}), b(1.0, Matrix3(Vector3(1, 2, 3).asDiagonal()));
    EXPECT_EQ(a, b);
    EXPECT_FALSE(a == RigidBody(1.0, {1, 2, 2.5}));
    EXPECT_FALSE(a == RigidBody(1.0, {1, 2, 3}, {.com = {0, 0, 1e-300}}));
    EXPECT_FALSE(a == RigidBody(1.0, {1, 2, 3}, {.inertia_about = InertiaAbout::origin}));
}

/// Points with velocities of a rigid motion, and the body they make.
TEST(Momentum, that_of_a_moving_body_is_the_sum_over_its_points_about_any_pole) {
    Random random(10);
    for (int k = 0; k < 50; ++k) {
        const Cloud c = cloud(random, 6);
        const RigidBody body = body_of(c, 0, 6);
        const Vector3 pole = 500.0 * random.direction(), v_pole = random.direction(), omega = random.direction();
        Vector3 q = Vector3::Zero(), k_pole = Vector3::Zero(), q_g = Vector3::Zero(), k_g = Vector3::Zero();
        double t = 0.0, t_g = 0.0, size = 0.0;
        const Vector3 v_g = rbdyn::velocity_of(body.com(), pole, v_pole, omega);
        for (std::size_t i = 0; i < c.mass.size(); ++i) {
            const double m = static_cast<double>(c.mass[i]);
            const Vector3 p = c.at[i].cast<double>(), v = v_pole + omega.cross(p - pole);
            q += m * v;
            q_g += m * (v - v_g);
            k_pole += m * (p - pole).cross(v);
            k_g += m * (p - pole).cross(v - v_g);
            t += 0.5 * m * v.squaredNorm();
            t_g += 0.5 * m * (v - v_g).squaredNorm();
            size += m * (p - pole).squaredNorm();
        }
        const double rounding = 32.0 * epsilon * size;
        EXPECT_LE((momentum(body, pole, v_pole, omega) - q).norm(), rounding);               // 7.29
        EXPECT_LE(q_g.norm(), rounding);                                                     // Thm 7.1
        EXPECT_LE((angular_momentum(body, pole, v_pole, omega) - k_pole).norm(), rounding);  // 7.33
        // 7.34, and Thm 7.2: the same about every pole
        EXPECT_LE((angular_momentum(body, body.com(), v_g, omega) - k_g).norm(), rounding);
        EXPECT_LE((body.inertia() * omega - k_g).norm(), rounding);
        // 7.31, 7.35
        EXPECT_LE(((body.com() - pole).cross(body.mass() * v_g) + k_g - k_pole).norm(), rounding);
        EXPECT_NEAR(kinetic_energy(body, pole, v_pole, omega), t, rounding);
        EXPECT_NEAR(kinetic_energy(body, body.com(), v_g, omega), t, rounding);
        EXPECT_NEAR(0.5 * body.mass() * v_g.squaredNorm() + t_g, t, rounding);  // 7.37
    }
}

TEST(Momentum, about_a_point_at_rest_it_is_the_inertia_there_times_omega) {
    // a disc rolls along x with its plane upright: the point of contact C is at rest
    const double radius = 0.5;
    const RigidBody disc(2.0, {0.125, 0.25, 0.125});
    const Vector3 contact(0, 0, -radius), omega(0, 3.0, 0);
    const Vector3 v_g = rbdyn::velocity_of({0, 0, 0}, contact, {0, 0, 0}, omega);
    EXPECT_EQ(v_g, Vector3(1.5, 0, 0));
    const Vector3 k_c = disc.inertia(contact) * omega;
    EXPECT_EQ(angular_momentum(disc, contact, Vector3(0, 0, 0), omega), k_c);
    EXPECT_EQ(Vector3(-contact.cross(2.0 * v_g) + disc.inertia() * omega), k_c);
    // v_C along G - C will do as well
    EXPECT_EQ(angular_momentum(disc, contact, Vector3(0, 0, 7.0), omega), k_c);
}

}  // namespace

}  // namespace rbdyn::test::test_rigid_body
