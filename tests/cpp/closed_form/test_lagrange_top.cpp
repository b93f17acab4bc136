// Lagrange's top against reference digits, its conservation laws and its special motions.
#include <gtest/gtest.h>

#include <numbers>
#include <vector>

#include "rbdyn/closed_form/lagrange_top.hpp"
#include "reference.hpp"

namespace rbdyn::test::test_lagrange_top {
namespace {

constexpr double limit = 2e-15;  // what the closed forms promise
const Vector3 up{0.0, 0.0, 1.0};

double angle_apart(const Quaternion& p, const Quaternion& q) {
    const Quaternion d = conjugate(p) * q;
    return 2.0 * std::atan2(std::sqrt(d.x * d.x + d.y * d.y + d.z * d.z), std::abs(d.w));
}

/// True errors of attitude and angular velocity, to be held against the estimates.
struct Errors {
    std::vector<double> truth, estimate;

    void take(const LagrangeTop& top, double t, const nlohmann::json& attitude, const nlohmann::json& omega) {
        const LagrangeTop::State s = top.at({t, 0.0});
        double error = angle_between(s.attitude, attitude), difference = 0.0, size = top.at({}).angular_velocity.norm();
        if (!omega.is_null()) {
            Vector3 d;
            for (int i = 0; i < 3; ++i)
                d[i] = static_cast<double>(s.angular_velocity[i] - digits(omega[static_cast<std::size_t>(i)]));
            difference = d.norm();
            size = std::max(size, s.angular_velocity.norm());
        }
        if (difference > 0.0) error = std::max(error, difference / size);
        EXPECT_LE(error, limit) << "t = " << t;
        EXPECT_LE(error, 10.0 * top.error(t)) << "t = " << t;
        truth.push_back(error);
        estimate.push_back(top.error(t));
    }
};

TEST(LagrangeTop, moves_as_the_reference_cases_do) {
    for (const char* name : {"d_lagrange_cusps", "d_lagrange_fast", "d_lagrange_near_sleeping",
                             "d_lagrange_near_theta0", "d_planar_through_0_and_pi"}) {
        SCOPED_TRACE(name);
        const nlohmann::json r = reference(name);
        const auto p = [&](const char* of) { return parameter(r, of); };
        const LagrangeTop top(p("I1"), p("I3"), DoubleDouble(p("m")) * p("g") * p("x3_G_body"), up,
                              from_euler(p("theta0"), p("psi0"), p("phi0")),
                              {p("omega0_1"), p("omega0_2"), p("omega0_3")});
        Errors errors;
        for (const auto& s : r["values"]["samples"])
            errors.take(top, static_cast<double>(digits(s["t"])), s["quaternion_body_to_world"], s["omega_body"]);
        EXPECT_GE(errors.truth.size(), 3u);
    }
}

TEST(LagrangeTop, moves_as_random_tops_do_until_a_million_seconds) {
    Errors errors;
    const nlohmann::json table = reference("lagrange_top_random");
    for (const auto& c : table["cases"]) {
        SCOPED_TRACE(c["kind"]);
        const auto vector = [&](const char* of) { return Vector3(c[of][0], c[of][1], c[of][2]); };
        const auto& q = c["attitude"];
        const LagrangeTop top(c["across"].get<double>(), c["along"].get<double>(), c["weight_moment"].get<double>(),
                              vector("up"), Quaternion{q[0], q[1], q[2], q[3]}, vector("angular_velocity"));
        for (std::size_t i = 0; i < c["times"].size(); ++i) {
            const auto& s = c["states"][i];
            const bool all = s.size() == 7;
            errors.take(top, c["times"][i], s, all ? nlohmann::json{s[4], s[5], s[6]} : nlohmann::json());
        }
    }
    // the estimates are honest the other way too
    const auto median = [](std::vector<double> v) {
        std::sort(v.begin(), v.end());
        return v[v.size() / 2];
    };
    EXPECT_LE(median(errors.estimate), 30.0 * median(errors.truth));
}

TEST(LagrangeTop, with_cusps_has_the_period_of_its_chapter) {
    // A = 1, C = 1.5, m g l = 1, spin 3, released from rest at 60 degrees
    const double theta = std::numbers::pi / 3.0;
    const LagrangeTop top(1.0, 1.5, 1.0, up, turn(Vector3::UnitX(), theta), {0.0, 0.0, 3.0});
    EXPECT_NEAR(top.nutation_period(), 1.4610376297378547, 1e-15);
    const auto axis = [&](double t) { return to_world(top.at({t, 0.0}).attitude, Vector3(Vector3::UnitZ())); };
    EXPECT_NEAR(std::acos(axis(0.5 * top.nutation_period())[2]) * 180.0 / std::numbers::pi, 65.257837854397279, 1e-13);
    const Vector3 start = axis(0.0), later = axis(top.nutation_period());
    EXPECT_NEAR(std::atan2(later[1], later[0]) - std::atan2(start[1], start[0]), 0.33168586628482653, 1e-14);
    // at rest across its axis at each cusp
    EXPECT_NEAR(top.at({7.0 * top.nutation_period(), 0.0}).angular_velocity.head<2>().norm(), 0.0, 1e-13);
}

TEST(LagrangeTop, returns_the_start_exactly) {
    const Quaternion q{0.8, 0.6, 1e-3, -2.0};
    const Vector3 omega(0.1, -0.3, 7.0);
    const LagrangeTop::State s = LagrangeTop(0.5, 0.25, 4.0, {0.1, 0.2, -0.9}, q, omega).at({});
    EXPECT_EQ(s.attitude, q);
    EXPECT_EQ(s.angular_velocity, omega);
}

TEST(LagrangeTop, asleep_stays_asleep) {
    // below the critical spin too, where any push would grow
    for (double weight : {4.0, -4.0})
        for (double spin : {40.0, 5.0, 0.0}) {
            const LagrangeTop top(0.5, 0.25, weight, up, Quaternion{0.5, 0.0, 0.0, 0.7}, {0.0, 0.0, spin});
            const LagrangeTop::State s = top.at({1e6, 0.0});
            EXPECT_NEAR(squared_norm(s.attitude), 1.0, limit);
            EXPECT_EQ(s.attitude.x, 0.0);
            EXPECT_EQ(s.attitude.y, 0.0);
            EXPECT_EQ(s.angular_velocity, Vector3(0.0, 0.0, spin));
        }
}

TEST(LagrangeTop, asleep_along_any_vertical_stays_asleep) {
    for (const double side : {1.0, -1.0}) {
        const LagrangeTop top(0.5, 0.25, 4.0, side * Vector3::UnitX(), Quaternion{0.5, 0.5, 0.5, 0.5}, {0.0, 0.0, 5.0});
        const LagrangeTop::State s = top.at({1e4, 0.0});
        EXPECT_NEAR(to_world(s.attitude, up)[0], 1.0, limit);
        EXPECT_EQ(s.angular_velocity, Vector3(0.0, 0.0, 5.0));
    }
}

/// 1 - u = y1 / cosh^2 on the way to sleep: K_3 is K about the vertical, and the energy that of the sleeping top, so
/// that u'^2 = (1 - u)^2 (b (1 + u) - a^2) with b = 2 m g l/A and a = C omega_3/A, u1 = a^2/b - 1 the lowest place.
struct FallingAsleep {
    double sine, spin;        // of half the tilt at the start
    DoubleDouble more = 1.0;  // factor of the angular velocity with which it rises
    static constexpr double across = 1.0, along = 0.75, weight_moment = 0.875;
    static constexpr double b = 2.0 * weight_moment / across;

    DoubleDouble axial() const { return DoubleDouble(along) * spin / across; }
    LagrangeTop top() const {
        const DoubleDouble x = sine, w = sqrt(1.0 - x * x), a = axial();
        const DoubleDouble second = a * x / w, first = sqrt(x * x * (2.0 * b) - second * second);
        return {across, along, weight_moment, up, {w, x, 0.0, 0.0}, {-first * more, second, spin}};
    }
    double below(double t) const {
        const double y1 = 2.0 - (axial() * axial()).hi / b, y = 2.0 * sine * sine;
        const double c = std::cosh(0.5 * std::sqrt(b * y1) * t + std::acosh(std::sqrt(y1 / y)));
        return y1 / (c * c);
    }
};

TEST(LagrangeTop, that_spins_falls_asleep_however_its_numbers_are_rounded) {
    for (const double sine : {0.3, 0.4, 0.45, 0.55, 0.65})
        for (const double spin : {0.9, 1.1, -1.3}) {
            const FallingAsleep s{sine, spin};
            const LagrangeTop top = s.top();
            EXPECT_EQ(top.nutation_period(), INFINITY) << sine << ' ' << spin;
            for (const double t : {0.0, 0.5, 3.0, 10.0, 30.0, 300.0}) {
                const Quaternion q = top.at({t, 0.0}).attitude;
                EXPECT_NEAR(2.0 * (q.x * q.x + q.y * q.y), s.below(t), 2.0 * limit) << sine << ' ' << spin << ' ' << t;
            }
        }
}

// whether it stays asleep is for the next digits of its start to say: the estimate knows
TEST(LagrangeTop, that_falls_asleep_is_known_until_the_last_of_its_digits_has_grown) {
    for (const double sine : {0.3, 0.55}) {
        FallingAsleep s{sine, 1.1};
        const LagrangeTop top = s.top();
        s.more = DoubleDouble(1.0) - 1e-29;
        const LagrangeTop beside = s.top();
        EXPECT_LT(top.error(5.0), 2e-15);
        double most = 0.0;
        for (double t = 0.0; t < 150.0; t += 0.5) {
            const double apart = angle_apart(top.at({t, 0.0}).attitude, beside.at({t, 0.0}).attitude);
            EXPECT_LE(apart, 1e3 * top.error(t)) << sine << ' ' << t;
            most = std::max(most, apart);
        }
        EXPECT_GT(most, 0.1);
    }
}

TEST(LagrangeTop, asleep_along_a_vertical_of_any_direction_stays_asleep) {
    for (const Vector3& vertical : {Vector3(0.6, -0.3, 0.7), Vector3(0.1, 0.2, -0.9), Vector3(1e-3, 0.3, 0.1)}) {
        // the turn from z to it, then one about it
        const DoubleDouble x = vertical[0], y = vertical[1], z = vertical[2];
        const DoubleDouble length = sqrt(x * x + y * y + z * z);
        const QuaternionOf<DoubleDouble> upright{length + z, -y, x, 0.0}, spun{0.8, 0.0, 0.0, 0.35};
        const LagrangeTop top(0.5, 0.25, 4.0, vertical, upright * spun, {0.0, 0.0, 5.0});
        for (const double t : {10.0, 30.0, 100.0, 1e4}) {
            const LagrangeTop::State s = top.at({t, 0.0});
            EXPECT_LT((to_world(s.attitude, up) - vertical.normalized()).norm(), limit) << vertical.transpose() << t;
            EXPECT_EQ(s.angular_velocity, Vector3(0.0, 0.0, 5.0));
        }
    }
}

TEST(LagrangeTop, falls_asleep_on_the_separatrix) {
    // planar: the start at the bottom with just the speed that reaches the top
    const LagrangeTop top(1.0, 1.0, 1.0, up, Quaternion{0.0, 1.0, 0.0, 0.0}, {2.0, 0.0, 0.0});
    EXPECT_EQ(top.nutation_period(), INFINITY);
    for (double t : {1.0, 5.0, 20.0, 1e3}) {
        const LagrangeTop::State s = top.at({t, 0.0});
        EXPECT_NEAR(to_world(s.attitude, Vector3(Vector3::UnitZ()))[2], 2.0 * std::pow(std::tanh(t), 2.0) - 1.0, limit);
        EXPECT_NEAR(s.angular_velocity[0], 2.0 / std::cosh(t), limit);
    }
}

TEST(LagrangeTop, keeps_energy_and_momenta_and_its_attitude_follows_its_angular_velocity) {
    const double a = 0.5, c = 0.25, weight = 4.90625;
    const Quaternion q = normalized({0.8, 0.5, -0.1, 0.3});
    for (const Vector3& omega : {Vector3(1.0, 2.0, 8.0), Vector3(0.0, 0.0, 30.0), Vector3(3.0, -1.0, 0.0)})
        for (const Vector3& vertical : {Vector3(0.0, 0.0, 1.0), Vector3(0.6, 0.0, -0.8)}) {
            const LagrangeTop top(a, c, weight, vertical, q, omega);
            const auto energy = [&](const LagrangeTop::State& s) {
                const Vector3& w = s.angular_velocity;
                return 0.5 * (a * w.head<2>().squaredNorm() + c * w[2] * w[2]) +
                       weight * to_body(s.attitude, vertical)[2];
            };
            const auto momentum = [&](const LagrangeTop::State& s) {
                const Vector3& w = s.angular_velocity;
                return to_body(s.attitude, vertical).dot(Vector3(a * w[0], a * w[1], c * w[2]));
            };
            const LagrangeTop::State start = top.at({});
            for (double t : {-3.0, 0.25, 10.0, 1e5}) {
                const LagrangeTop::State s = top.at({t, 0.0});
                EXPECT_NEAR(energy(s), energy(start), 30 * 2.2e-16 * (std::abs(energy(start)) + weight));
                EXPECT_NEAR(momentum(s), momentum(start), 30 * 2.2e-16 * (a + c) * omega.norm());
                // q' = 1/2 q (0, omega), by a central difference whose own error is h^2
                const double h = 1e-5;
                const Quaternion before = top.at({t, -h}).attitude, after = top.at({t, h}).attitude;
                const Quaternion slope = conjugate(s.attitude) * Quaternion{after.w - before.w, after.x - before.x,
                                                                            after.y - before.y, after.z - before.z};
                EXPECT_NEAR((Vector3(slope.x, slope.y, slope.z) / h - s.angular_velocity).norm(), 0.0, 1e-6);
            }
        }
}

TEST(LagrangeTop, goes_over_into_the_free_body_as_gravity_fades) {
    const Quaternion q = normalized({0.8, 0.5, -0.1, 0.3});
    const Vector3 omega(1.0, 2.0, 3.0);
    const LagrangeTop free(0.5, 0.25, 0.0, up, q, omega);
    for (double weight : {1e-18, 1e-30, 1e-45}) {
        const LagrangeTop top(0.5, 0.25, weight, up, q, omega);
        for (double t : {1.0, 100.0})
            EXPECT_LE(angle_apart(top.at({t, 0.0}).attitude, free.at({t, 0.0}).attitude), limit) << weight;
    }
}

TEST(LagrangeTop, is_the_same_motion_in_other_units_and_a_turned_world) {
    const Quaternion q = normalized({0.8, 0.5, -0.1, 0.3}), turned{0.5, -0.5, 0.5, 0.5};
    // the turned start in all digits: rounded, it would be another motion
    const QuaternionOf<DoubleDouble> start =
        QuaternionOf<DoubleDouble>{0.5, -0.5, 0.5, 0.5} * QuaternionOf<DoubleDouble>{q.w, q.x, q.y, q.z};
    const Vector3 omega(1.0, 2.0, 8.0);
    const LagrangeTop top(0.5, 0.25, 4.0, up, q, omega), large(0x1p31, 0x1p30, 0x1p34, up, q, omega),
        quick(0.5, 0.25, 4.0 * 0x1p20, up, q, omega * 0x1p10),
        other(0.5, 0.25, 4.0, to_world(turned, up), start, {1.0, 2.0, 8.0});
    for (double t : {0.5, 70.0}) {
        const LagrangeTop::State s = top.at({t, 0.0});
        EXPECT_EQ(large.at({t, 0.0}).attitude, s.attitude);
        EXPECT_EQ(quick.at({t * 0x1p-10, 0.0}).attitude, s.attitude);
        EXPECT_LE(angle_apart(other.at({t, 0.0}).attitude, turned * s.attitude), limit);
    }
}

}  // namespace
}  // namespace rbdyn::test::test_lagrange_top
