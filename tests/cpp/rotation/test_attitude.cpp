// Attitudes: the axioms of the group of rotations, forms taken and refused.
#include <gtest/gtest.h>

#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "random.hpp"
#include "rbdyn/basics/double_double_functions.hpp"
#include "rbdyn/basics/error.hpp"
#include "rbdyn/rotation/attitude.hpp"

namespace rbdyn::test::test_attitude {

namespace {

using rbdyn::test::Random;

constexpr double epsilon = std::numeric_limits<double>::epsilon();
// a few roundings of numbers up to 1
constexpr double rounding = 8.0 * epsilon;

/// The angle of the turn from one attitude to another.
double angle_between(const Quaternion& a, const Quaternion& b) {
    const Quaternion d = conjugate(a) * b;
    return 2.0 * std::atan2(std::hypot(d.x, d.y, d.z), std::abs(d.w));
}

/// Turns about random axes, by the angles at which formulas for rotations fail and by others.
std::vector<Quaternion> turns() {
    Random random(7);
    std::vector<Quaternion> result;
    for (int k = 0; k < 20; ++k) {
        for (const double angle : {0.0, 1e-11, 1e-5, std::numbers::pi - 1e-8, std::numbers::pi})
            result.push_back(rbdyn::turn(random.direction(), angle));
        result.push_back(rbdyn::turn(random.direction(), random.uniform(-6.0, 6.0)));
    }
    for (const double angle : {0.0, 1e-11, 1e-5, std::numbers::pi - 1e-8, std::numbers::pi})
        for (int k = 0; k < 3; ++k) result.push_back(rbdyn::turn(Vector3::Unit(k), angle));
    return result;
}

TEST(Attitude, rotations_are_a_group_that_its_matrices_represent) {
    const auto all = turns();
    for (std::size_t k = 0; k + 2 < all.size(); ++k) {
        const Quaternion &p = all[k], &q = all[k + 1], &r = all[k + 2];
        EXPECT_LE(angle_between((p * q) * r, p * (q * r)), rounding);
        EXPECT_LE(angle_between(p * conjugate(p), {}), rounding);
        EXPECT_LE((rotation_matrix(p * q) - rotation_matrix(p) * rotation_matrix(q)).cwiseAbs().maxCoeff(), rounding);
        EXPECT_LE((rotation_matrix(conjugate(p)) - rotation_matrix(p).transpose()).cwiseAbs().maxCoeff(), 0.0);
        EXPECT_NEAR(rotation_matrix(p).determinant(), 1.0, rounding);
    }
}

TEST(Attitude, a_rotation_matrix_gives_back_its_quaternion_at_every_angle) {
    for (const Quaternion& q : turns())
        EXPECT_LE(angle_between(q, Attitude(rotation_matrix(q)).quaternion()), rounding);
}

TEST(Attitude, a_small_turn_keeps_its_relative_digits_in_a_matrix) {
    const Quaternion q = rbdyn::turn({0, 1, 0}, 1e-11);
    EXPECT_NEAR(Attitude(rotation_matrix(q)).quaternion().y, 5e-12, 5e-12 * rounding);
}

TEST(Attitude, digits_of_a_unit_quaternion_are_kept) {
    for (const Quaternion& q : turns()) EXPECT_EQ(Attitude(q).quaternion(), q);
}

TEST(Attitude, has_32_digits_of_what_the_numbers_given_say) {
    using rbdyn::DoubleDouble;
    using Real = long double;
    const auto wide = [](const DoubleDouble& x) { return static_cast<Real>(x.hi) + static_cast<Real>(x.lo); };
    Random random(8);
    for (int k = 0; k < 50; ++k) {
        const EulerAngles a{random.uniform(-4, 4), random.uniform(-9, 9), random.uniform(-9, 9)};
        const Attitude from_angles = a;
        const auto& q = from_angles.exact();
        const Real half = static_cast<Real>(a.theta) / 2, sum = (static_cast<Real>(a.psi) + a.phi) / 2,
                   difference = (static_cast<Real>(a.psi) - a.phi) / 2;
        EXPECT_LE(std::abs(wide(q.w) - std::cos(half) * std::cos(sum)), 2e-19L);
        EXPECT_LE(std::abs(wide(q.x) - std::sin(half) * std::cos(difference)), 2e-19L);
        EXPECT_LE(std::abs(wide(q.y) - std::sin(half) * std::sin(difference)), 2e-19L);
        EXPECT_LE(std::abs(wide(q.z) - std::cos(half) * std::sin(sum)), 2e-19L);
        EXPECT_LE(std::abs((squared_norm(q) - 1.0).hi), 1e-30);

        // a quaternion keeps its direction
        const Quaternion given = rbdyn::turn(random.direction(), random.uniform(-6.0, 6.0));
        const auto turned = conjugate(Attitude(given).exact()) * rbdyn::widened(given);
        for (const DoubleDouble& c : {turned.x, turned.y, turned.z}) EXPECT_LE(std::abs(c.hi), 1e-30);
        EXPECT_LE(std::abs((squared_norm(Attitude(given).exact()) - 1.0).hi), 1e-30);

        // the rotation nearest to a matrix: what is left of it is symmetric
        const Matrix3 rough = rotation_matrix(given) + 1e-7 * Matrix3(Vector3(random.direction()).asDiagonal());
        const auto r = rotation_matrix(Attitude(rough).exact());
        const auto rest = product(r.transpose(), rbdyn::widened(rough));
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < i; ++j) EXPECT_LE(std::abs((rest(i, j) - rest(j, i)).hi), 1e-29);
    }
}

TEST(Attitude, what_is_nearly_a_rotation_becomes_the_nearest_one) {
    const Quaternion q = rbdyn::turn(Vector3(1, 2, 3).normalized(), 1.25);
    const double stretch = 1.0 + 9e-7;
    const Quaternion longer{q.w * stretch, q.x * stretch, q.y * stretch, q.z * stretch};
    EXPECT_LE(angle_between(Attitude(longer).quaternion(), q), rounding);
    EXPECT_NEAR(squared_norm(Attitude(longer).quaternion()), 1.0, 4.0 * epsilon);
    // R S with S symmetric: the polar factor of R S is R
    Matrix3 s;
    s << 1.0 + 3e-7, 2e-7, -1e-7, 2e-7, 1.0 - 4e-7, 1e-7, -1e-7, 1e-7, 1.0;
    EXPECT_LE(angle_between(Attitude(Matrix3(rotation_matrix(q) * s)).quaternion(), q), rounding);
}

TEST(Attitude, other_forms_are_taken) {
    const Eigen::Quaterniond turned(Eigen::AngleAxisd(0.5, Vector3::UnitZ()));
    EXPECT_LE(angle_between(Attitude(turned).quaternion(), rbdyn::turn({0, 0, 1}, 0.5)), rounding);
    const Attitude from_angles = EulerAngles{.theta = 0.0, .psi = 0.25, .phi = 0.25};
    EXPECT_LE(angle_between(from_angles.quaternion(), rbdyn::turn({0, 0, 1}, 0.5)), rounding);
    EXPECT_EQ(Attitude(), Attitude(Quaternion{}));
}

template <class Form>
std::string refusal(const Form& form) {
    try {
        Attitude{form};
    } catch (const InvalidInput& error) {
        return error.what();
    }
    return "accepted";
}

TEST(Attitude, what_is_no_rotation_is_refused_with_its_number) {
    const double nan = std::nan("");
    EXPECT_NE(refusal(Quaternion{2, 0, 0, 0}).find("norm of the quaternion is 2; a unit quaternion"),
              std::string::npos);
    EXPECT_NE(refusal(Quaternion{0, 0, 0, 0}).find("is 0;"), std::string::npos);
    EXPECT_NE(refusal(Quaternion{1.0 + 1.1e-6, 0, 0, 0}).find("is 1.0000011;"), std::string::npos);
    EXPECT_NE(refusal(Quaternion{nan, 0, 0, 0}).find("is nan;"), std::string::npos);
    EXPECT_NE(refusal(EulerAngles{0.0, nan, 0.0}).find("EulerAngles: psi is nan;"), std::string::npos);
    EXPECT_NE(refusal(EulerAngles{0.0, 0.0, 1e300}).find("EulerAngles: phi is 1e+300;"), std::string::npos);
    const Matrix3 mirror = Vector3(1, 1, -1).asDiagonal(), zero = Matrix3::Zero(), blown = 1.001 * Matrix3::Identity();
    EXPECT_NE(refusal(mirror).find("determinant of the matrix is -1; a rotation does not mirror"), std::string::npos);
    EXPECT_NE(refusal(zero).find("departure of the matrix from a rotation is 1;"), std::string::npos);
    EXPECT_NE(refusal(blown).find("departure of the matrix from a rotation is 0.002"), std::string::npos);
    EXPECT_NE(refusal(Matrix3(nan * blown)).find("is nan;"), std::string::npos);
}

}  // namespace

}  // namespace rbdyn::test::test_attitude
