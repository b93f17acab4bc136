// Trees of bodies against reference motions known to 25 digits: pendulums of two, three and five links in the plane and
// in space, a cart, branches, a gyroscope on a pendulum, a pair that floats.
//
// RBDYN_TEST_TABLE=1 prints true and estimated errors.
#include <gtest/gtest.h>

#include <cstdlib>
#include <iomanip>
#include <iostream>

#include "mechanics/figures.hpp"

namespace rbdyn::test::test_tree_references {
namespace {

using figures::Case;
using figures::Comparison;

const char* const cases[] = {"l_branched",         "l_cardan_drive",         "l_cart_pendulum",
                             "l_chain5",           "l_double_pendulum",      "l_free_pair",
                             "l_gyro_on_pendulum", "l_skew_double_pendulum", "l_triple_rods"};

class Trees : public testing::TestWithParam<std::tuple<const char*, double>> {};

TEST_P(Trees, reach_the_error_asked_for_and_say_so) {
    const auto [id, error] = GetParam();
    const Case reference(id);
    const bool table = std::getenv("RBDYN_TEST_TABLE") != nullptr;
    std::optional<Trajectory> run;
    try {
        run = simulate(reference.scene, {.until = reference.until, .error = error});
    } catch (const AccuracyError& e) {
        if (table) std::cout << std::setw(24) << id << "  asked " << error << "  " << e.what() << '\n';
        // only where rounding of the start alone comes near
        const std::size_t last = reference.samples().size() - 1;
        ASSERT_GT(figures::roundings(reference, last), error) << e.what();
        const Comparison compared(reference, e.run);
        EXPECT_LE(compared.worst(), 10.0 * *e.run.error());
        return;
    }
    const Comparison compared(reference, *run);
    if (table)
        std::cout << std::setprecision(2) << std::setw(24) << id << "  asked " << error << "  estimate "
                  << *run->error() << "  true " << compared.worst() << "  ratio " << compared.worst() / *run->error()
                  << "  steps " << run->statistics().steps << '\n';
    for (std::size_t k = 0; k < compared.count(); ++k) {
        EXPECT_LE(compared.at(k), std::max(error, figures::roundings(reference, k)))
            << compared.where(k) << " at sample " << k;
    }
    EXPECT_LE(compared.worst(), 10.0 * *run->error());
    EXPECT_LE(*run->error(), error);
    EXPECT_LE(compared.start(), 1e-14);

    // energies, over the largest there is of kinetic energy
    double size = 0.0;
    for (int k = 0; k <= 400; ++k) size = std::max(size, run->kinetic_energy(run->end() * k / 400));
    for (std::size_t k = 0; k < reference.samples().size(); ++k) {
        const auto& s = reference.samples()[k];
        const double t = figures::number(s["t"]), allowed = std::max(error, figures::roundings(reference, k)) * 10.0;
        EXPECT_NEAR(run->kinetic_energy(t), figures::number(s["KE"]), allowed * size);
        EXPECT_NEAR(run->potential_energy(t), figures::number(s["V"]), allowed * size);
    }
}

std::string name_of_case(const testing::TestParamInfo<Trees::ParamType>& info) {
    return std::string(std::get<0>(info.param)) + "_1e" +
           std::to_string(-static_cast<int>(std::lround(std::log10(std::get<1>(info.param)))));
}

INSTANTIATE_TEST_SUITE_P(of_bodies, Trees,
                         testing::Combine(testing::ValuesIn(cases), testing::Values(1e-6, 1e-9, 1e-12)), name_of_case);

}  // namespace
}  // namespace rbdyn::test::test_tree_references
