// Closed loops against reference motions known to 25 digits: four bars, a slider and its crank, Andrews' mechanism,
// rows of four bars through their singular positions, Bricard's rods with a constraint too many, a governor, shafts
// joined by a cross.
//
// RBDYN_TEST_TABLE=1 prints true and estimated errors.
#include <gtest/gtest.h>

#include <cstdlib>
#include <iomanip>
#include <iostream>

#include "mechanics/figures.hpp"

namespace rbdyn::test::test_loop_references {
namespace {

using figures::Case;
using figures::Comparison;
using figures::json;
using figures::number;

bool table() { return std::getenv("RBDYN_TEST_TABLE") != nullptr; }

/// How far a run opens its loops: at the ends of its pieces, where it is held closed, and between.
struct Gaps {
    double held = 0.0, between = 0.0;
    double angle = 0.0;  // the largest there is [rad]: what is closed is a state that is rounded

    Gaps(const Trajectory& run, const std::vector<ConstraintHandle>& loops) {
        for (const ConstraintHandle loop : loops) {
            for (const double t : run.t()) held = std::max(held, run[loop].gap(t));
            for (int i = 0; i < static_cast<int>(run.scene().bodies().size()); ++i)
                if (std::holds_alternative<Revolute>(run.scene().bodies()[static_cast<std::size_t>(i)].joint))
                    for (const double t : run.t()) angle = std::max(angle, std::abs(run[BodyHandle{i}].angle(t)));
            for (int k = 0; k <= 997; ++k) between = std::max(between, run[loop].gap(run.end() * k / 997));
        }
    }
    /// Rounding of sums of a few lengths up to 2 m, and of three angles, each by half a unit of its last place, at arms
    /// of up to 2 m; one step of Newton's method squares what a step leaves.
    double allowed(double error) const { return epsilon * (20.0 + 3.0 * angle) + 10.0 * error * error; }
};

void print(const std::string& id, double error, const Trajectory& run, double actual, const Gaps& gap) {
    if (table())
        std::cout << std::setprecision(2) << std::setw(24) << id << "  asked " << error << "  estimate " << *run.error()
                  << "  true " << actual << "  ratio " << actual / *run.error() << "  gap " << gap.held << " "
                  << gap.between << "  steps " << run.statistics().steps << "  " << run.engine() << '\n';
}

// --- planar mechanisms, told by their files ---

const char* const planar[] = {"m_four_bar_gravity", "m_four_bar_torque", "m_slider_crank", "m_andrews"};

class PlanarLoops : public testing::TestWithParam<std::tuple<const char*, double>> {};

TEST_P(PlanarLoops, reach_the_error_asked_for_and_stay_closed) {
    const auto [id, error] = GetParam();
    const Case reference(id);
    // the start was printed to rounding, on its branch
    EXPECT_LE(reference.moved, 4e-16);
    for (const json& b : reference.file["parameters"]["bodies"]) {
        const auto& body = reference.scene.bodies()[static_cast<std::size_t>(reference.body.at(b["name"]).index)];
        const json& start = b["initial"];
        EXPECT_NEAR(body.parameter, number(start[start.contains("angle") ? "angle" : "displacement"]), 4e-16);
        EXPECT_NEAR(body.speed, number(start["rate"]), 1e-14);
    }
    std::optional<Trajectory> run;
    try {
        run = simulate(reference.scene, {.until = reference.until, .error = error});
    } catch (const AccuracyError& e) {
        if (table()) std::cout << std::setw(24) << id << "  asked " << error << "  " << e.what() << '\n';
        ASSERT_GT(figures::roundings(reference, reference.samples().size() - 1), error) << e.what();
        EXPECT_LE(Comparison(reference, e.run).worst(), 10.0 * *e.run.error());
        return;
    }
    const Comparison compared(reference, *run);
    const Gaps gap(*run, reference.loops);
    print(id, error, *run, compared.worst(), gap);
    for (std::size_t k = 0; k < compared.count(); ++k) {
        EXPECT_LE(compared.at(k), std::max(error, figures::roundings(reference, k)))
            << compared.where(k) << " at sample " << k;
    }
    EXPECT_LE(compared.worst(), 10.0 * *run->error());
    EXPECT_LE(*run->error(), error);
    EXPECT_LE(gap.held, gap.allowed(error));
    EXPECT_LE(gap.between, std::max(error, gap.allowed(0.0)));
    double size = 0.0;
    for (int k = 0; k <= 400; ++k) size = std::max(size, run->kinetic_energy(run->end() * k / 400));
    for (std::size_t k = 0; k < reference.samples().size(); ++k) {
        const json& s = reference.samples()[k];
        const double t = number(s["t"]), allowed = std::max(error, figures::roundings(reference, k)) * 10.0;
        EXPECT_NEAR(run->kinetic_energy(t), number(s["KE"]), allowed * size);
        EXPECT_NEAR(run->potential_energy(t), number(s["V"]), allowed * size);
    }
}

std::string name_of_case(const testing::TestParamInfo<PlanarLoops::ParamType>& info) {
    return std::string(std::get<0>(info.param)) + "_1e" +
           std::to_string(-static_cast<int>(std::lround(std::log10(std::get<1>(info.param)))));
}

INSTANTIATE_TEST_SUITE_P(of_bars, PlanarLoops,
                         testing::Combine(testing::ValuesIn(planar), testing::Values(1e-6, 1e-9, 1e-12)), name_of_case);

// --- others ---

RigidBody rod(double mass, const Vector3& along) {
    const Matrix3 inertia = mass / 12.0 * (along.squaredNorm() * Matrix3::Identity() - along * along.transpose());
    return {mass, inertia, {.com = 0.5 * along}};
}

class Loops : public testing::TestWithParam<double> {
protected:
    double error() const { return GetParam(); }
    /// Checks a run against what was measured of it.
    void expect(const std::string& id, const Trajectory& run, double actual, const Gaps& gap, double allowed) const {
        print(id, error(), run, actual, gap);
        EXPECT_LE(actual, std::max(error(), allowed));
        EXPECT_LE(actual, 10.0 * *run.error());
        EXPECT_LE(*run.error(), error());
        EXPECT_LE(gap.held, gap.allowed(error()));
        EXPECT_LE(gap.between, std::max(error(), gap.allowed(0.0)));
    }
};

TEST_P(Loops, shafts_joined_by_a_cross_turn_as_cardan_says) {
    const Case reference("m_cardan_shafts");
    Scene scene;
    const Vector3 first = figures::vector(reference.given("axis1")),
                  second = figures::vector(reference.given("axis2_direction")), up{0, 0, 1};
    const double one = reference.parameter("inertia1_about_axis"), other = reference.parameter("inertia2_about_axis");
    const BodyHandle a = scene.add(RigidBody(1.0, {one, one, one}), Revolute{.axis = first},
                                   {.rate = reference.parameter("rate1_at_start")}, "driving"),
                     b = scene.add(RigidBody(1.0, {other, other, other}), Revolute{.axis = second}, {.rate = 1.0},
                                   "driven");
    const ConstraintHandle cross =
        scene.constrain(Universal{.first = up, .second = up.cross(second)}, a.point({0, 0, 0}), b.point({0, 0, 0}));
    scene.apply(Torque(Vector3(first * reference.parameter("torque_on_shaft_1")), Frame::world), a);
    scene.assemble({a});
    const Trajectory run = simulate(scene, {.until = reference.until, .error = error()});
    double rate = 0.0, torque = 0.0;
    const auto held = [&](double t) { return -run[cross].torque(t).dot(second.normalized()); };
    for (int k = 0; k <= 400; ++k) {
        rate = std::max(rate, run[b].rate(run.end() * k / 400));
        torque = std::max(torque, std::abs(held(run.end() * k / 400)));
    }
    double actual = 0.0;
    for (const json& s : reference.samples()) {
        const double t = number(s["t"]);
        for (const double e :
             {run[a].angle(t) - number(s["angle1"]), run[b].angle(t) - number(s["angle2"]),
              (run[a].rate(t) - number(s["rate1"])) / rate, (run[b].rate(t) - number(s["rate2"])) / rate,
              (held(t) - number(s["torque_on_shaft_2_about_its_axis"])) / torque})
            actual = std::max(actual, std::abs(e));
    }
    expect("m_cardan_shafts", run, actual, Gaps(run, {cross}), 1e-13);
}

TEST_P(Loops, rods_of_bricards_move_though_a_constraint_is_too_many) {
    const Case reference("m_bricard");
    Scene scene(figures::vector(reference.given("gravity")));
    const Vector3 points[] = {{0, 0, 0}, {1, 0, 0}, {1, -1, 0}, {1, -1, 1}, {0, -1, 1}, {0, 0, 1}};
    std::vector<BodyHandle> rods;
    for (std::size_t k = 1; k < 6; ++k)
        rods.push_back(scene.add(rod(1.0, points[k] - points[k - 1]),
                                 Revolute{.axis = figures::vector(reference.given("hinge_axes_at_start")[k - 1]),
                                          .at = k == 1 ? points[0] : Vector3(points[k - 1] - points[k - 2])},
                                 RevoluteStart{.parent = k == 1 ? BodyHandle{} : rods.back()}));
    const ConstraintHandle loop = scene.constrain(Hinge{figures::vector(reference.given("hinge_axes_at_start")[5])},
                                                  rods.back().point(points[5] - points[4]), points[5]);
    const Trajectory run = simulate(scene, {.until = reference.until, .error = error()});
    EXPECT_EQ(run.plan().freedom(), 1);
    double rate = 0.0;
    for (int k = 0; k <= 400; ++k) rate = std::max(rate, std::abs(run[rods[0]].rate(run.end() * k / 400)));
    double actual = 0.0;
    for (const json& s : reference.samples()) {
        const double t = number(s["t"]);
        for (std::size_t k = 0; k < 5; ++k) {
            actual = std::max(actual, 0.5 * std::abs(run[rods[k]].angle(t) - number(s["angles"][k])));
            actual = std::max(actual, 0.5 * std::abs(run[rods[k]].rate(t) - number(s["rates"][k])) / rate);
            actual = std::max(actual, (run[rods[k]].center_of_mass(t) - figures::vector(s["com"][k])).norm());
        }
        EXPECT_NEAR(run.kinetic_energy(t), number(s["KE"]), 30.0 * std::max(error(), 1e-13));
    }
    expect("m_bricard", run, actual, Gaps(run, {loop}), 1e-13);
}

/// A row of windows: rods that stand on the ground, joined at their tops.
struct Windows {
    explicit Windows(const Case& reference) : scene({0, -reference.parameter("g"), 0}) {
        const int n = static_cast<int>(reference.parameter("N"));
        const double rate = reference.parameter("B0_speed");
        for (int i = 0; i <= n; ++i)
            rods.push_back(
                scene.add(rod(1.0, {0, 1, 0}), Revolute{.axis = {0, 0, -1}, .at = Vector3(i, 0, 0)}, {.rate = rate}));
        for (int i = 0; i < n; ++i) {
            const auto k = static_cast<std::size_t>(i);
            couplers.push_back(scene.add(rod(1.0, {1, 0, 0}), Revolute{.axis = {0, 0, 1}, .at = {0, 1, 0}},
                                         {.rate = rate, .parent = rods[k]}));
            loops.push_back(scene.constrain(Ball{}, couplers[k].point({1, 0, 0}), rods[k + 1].point({0, 1, 0})));
        }
    }
    Scene scene;
    std::vector<BodyHandle> rods, couplers;
    std::vector<ConstraintHandle> loops;
};

TEST_P(Loops, windows_of_four_bars_go_on_through_the_positions_where_they_lie_in_one_line) {
    const Case reference("m_n_four_bar");
    const Windows windows(reference);
    const Trajectory run = simulate(windows.scene, {.until = reference.until, .error = error()});
    double actual = 0.0;
    for (const json& s : reference.samples()) {
        const double t = number(s["t"]);
        const auto see = [&](const Vector3& value, const json& right) {
            actual = std::max(actual, (value - figures::vector(right)).norm() / 40.0);
        };
        for (std::size_t k = 0; k < 3; ++k) {
            actual = std::max(actual, std::abs(run[windows.rods[k]].angle(t) - number(s["theta"])));
            actual = std::max(actual, std::abs(run[windows.rods[k]].rate(t) - number(s["theta_rate"])) / 6.0);
            see(run[windows.rods[k]].reaction(t), s["reactions_on_rods_at_ground"][k]);
            if (k == 2) break;
            see(run[windows.couplers[k]].reaction(t), s["reactions_on_couplers_at_left_end"][k]);
            see(run[windows.loops[k]].force(t), s["closure_force_on_couplers_at_right_end"][k]);
        }
    }
    // both rows of windows lie in one line at the same times
    std::size_t flat = 0;
    for (int k = 0; k < 1000; ++k) {
        const auto height = [&](int i) { return std::cos(run[windows.rods[0]].angle(run.end() * i / 1000)); };
        flat += height(k) * height(k + 1) < 0.0 ? 1 : 0;
    }
    EXPECT_GE(flat, 10u);
    EXPECT_EQ(run.events().times("singular").size(), 2 * flat);
    expect("m_n_four_bar", run, actual, Gaps(run, windows.loops), 1e-13);
}

TEST_P(Loops, a_stiff_governor_swings_as_it_should) {
    const Case reference("m_flyball_governor");
    Scene scene({0, 0, -reference.parameter("g")});
    const double thin = reference.parameter("cross_section"), mass = reference.parameter("rod_and_shaft_mass"),
                 ball = reference.parameter("point_mass"), out = reference.parameter("hinge_offset"),
                 beta = reference.parameter("beta0"), heavy = reference.parameter("slider_mass"),
                 edge = reference.parameter("cube_edge");
    const double along = mass * thin * thin / 6.0, across = mass * (1.0 + thin * thin) / 12.0,
                 cube = heavy * edge * edge / 6.0;
    const BodyHandle shaft =
                         scene.add(RigidBody(mass, {across, across, along}, {.com = {0, 0, 0.5}}),
                                   Revolute{.axis = {0, 0, 1}}, {.rate = reference.parameter("shaft_rate0")}, "shaft"),
                     slider = scene.add(RigidBody(heavy, {cube, cube, cube}), Prismatic{.axis = {0, 0, 1}},
                                        {.displacement = reference.parameter("slider_position0"), .parent = shaft},
                                        "slider");
    std::vector<BodyHandle> rods;
    std::vector<CouplingHandle> springs;
    for (const double side : {1.0, -1.0}) {
        const double about = across + 0.25 * mass + ball;
        const RigidBody arm(
            mass + ball, {along, about, about},
            {.com = {side * (0.5 * mass + ball) / (mass + ball), 0, 0}, .inertia_about = InertiaAbout::origin});
        rods.push_back(
            scene.add(arm, Revolute{.axis = {0, side, 0}, .at = {side * out, 0, 1}}, {.angle = beta, .parent = shaft}));
        springs.push_back(scene.connect(Spring{.stiffness = reference.parameter("spring_stiffness"),
                                               .rest_length = reference.parameter("spring_rest_length"),
                                               .damping = reference.parameter("spring_damping")},
                                        slider.point({side * out, 0, 0}), rods.back().point({side * 0.5, 0, 0})));
    }
    const double until = setting("RBDYN_TEST_GOVERNOR", 0) > 0 ? reference.until : 1.0;
    // torques of a hundredth of a newton metre beside springs of 8e5 N/m: positions in doubles leave them 10 digits
    constexpr double told = 1e-9;
    std::optional<Trajectory> reached;
    try {
        reached = simulate(scene, {.until = until, .error = error()});
    } catch (const AccuracyError& e) {
        ASSERT_LT(error(), told) << e.what();
        reached = e.run;
    }
    const Trajectory& run = *reached;
    double actual = 0.0, force = 0.0, force_size = 0.0;
    for (const json& s : reference.samples()) {
        const double t = number(s["t"]);
        if (t > run.end()) continue;
        const auto see = [&](double value, const char* key, double scale) {
            actual = std::max(actual, std::abs(value - number(s[key])) / scale);
        };
        see(run[slider].displacement(t), "s", 0.25);
        see(run[slider].rate(t), "s_rate", 0.9);
        see(run[shaft].rate(t), "shaft_rate", 6.3);
        for (std::size_t k = 0; k < 2; ++k) {
            see(run[rods[k]].angle(t), "beta", 2.0);
            see(run[rods[k]].rate(t), "beta_rate", 6.3);
            force = std::max(force, std::abs(run[springs[k]].force(t).norm() - number(s["spring_force"])));
            force_size = std::max(force_size, run[rods[k]].reaction(t).norm());
        }
    }
    if (table()) std::cout << "   spring force " << force << " of " << force_size << '\n';
    actual = std::max(actual, force / force_size);
    if (error() >= told) return expect("m_flyball_governor", run, actual, Gaps(run, {}), 1e-11);
    print("m_flyball_governor", error(), run, actual, Gaps(run, {}));
    EXPECT_LE(*run.error(), told);
    EXPECT_LE(actual, 1e-11);
}

INSTANTIATE_TEST_SUITE_P(of_rods, Loops, testing::Values(1e-6, 1e-9, 1e-12),
                         [](const testing::TestParamInfo<double>& given) {
                             return "error_1e" +
                                    std::to_string(-static_cast<int>(std::lround(std::log10(given.param))));
                         });

}  // namespace
}  // namespace rbdyn::test::test_loop_references
