// Bodies that turn one after the other about the same axis: recorded by the sum of their angles.
#include <gtest/gtest.h>

#include <algorithm>

#include "rbdyn/body/shapes.hpp"
#include "rbdyn/expression/program.hpp"
#include "rbdyn/model/scene_model.hpp"
#include "rbdyn/plan/plan.hpp"
#include "rbdyn/scene/scene.hpp"
#include "rbdyn/simulate.hpp"
#include "rbdyn/trajectory/trajectory.hpp"

namespace rbdyn::test_parallel_axes {
namespace {

constexpr double until = 3.0;

/// Rods that hang one from the other; the axes of some point the other way, and their angles count the other way.
struct Chain {
    Scene scene{{0.0, 0.0, -9.81}};
    std::vector<BodyHandle> rods;

    explicit Chain(const std::vector<double>& signs) {
        constexpr double angles[] = {1.0, 0.5, -0.75};
        for (std::size_t i = 0; i < signs.size(); ++i) {
            const Revolute hinge{.axis = {0, signs[i], 0}, .at = {0, 0, i == 0 ? 0.0 : -0.5}, .point = {0, 0, 0.5}};
            const RevoluteStart start = i == 0 ? RevoluteStart{.angle = signs[i] * angles[i]}
                                               : RevoluteStart{.angle = signs[i] * angles[i], .parent = rods.back()};
            rods.push_back(scene.add(shapes::rod(1.0, 1.0, {0, 0, 1}), hinge, start));
        }
    }
};

TEST(ParallelAxes, that_point_the_other_way_are_the_same_axes) {
    const Chain one({1.0, 1.0, 1.0}), other({1.0, -1.0, 1.0});
    const SimulateOptions options{.until = until, .error = 1e-10};
    const Trajectory a = simulate(one.scene, options), b = simulate(other.scene, options);
    for (std::size_t i = 0; i < one.rods.size(); ++i)
        for (const double t : {0.5, until}) {
            EXPECT_LT((a[one.rods[i]].position(t) - b[other.rods[i]].position(t)).norm(), 1e-9);
            EXPECT_LT((a[one.rods[i]].reaction(t) - b[other.rods[i]].reaction(t)).norm(), 1e-6);
        }
}

TEST(ParallelAxes, make_no_products_of_angles_and_nothing_of_what_is_constant) {
    const Chain two({1.0, -1.0});
    const Plan plan = make_plan(two.scene.frozen());
    std::vector<double> x = plan.model->start();
    const Program& program = plan.model->begin(0.0, x).equations->program;
    int products = 0, divisions = 0;
    for (const Instruction& i : program.instructions()) {
        products += i.products;
        divisions += i.code == Code::divide ? 1 : 0;
    }
    // of two rods by hand 15; through articulated bodies in world axes without any of this 53, and two divisions
    EXPECT_LE(products, 28) << program.text();
    EXPECT_EQ(divisions, 1) << program.text();
}

}  // namespace
}  // namespace rbdyn::test_parallel_axes
