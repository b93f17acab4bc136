// Whether a run gets on: steps that get shorter without end are told from steps that are short.
#include <gtest/gtest.h>

#include <cstdint>

#include "rbdyn/event/progress.hpp"

namespace rbdyn::test::test_progress {
namespace {

TEST(Progress, ends_what_gets_ever_slower_and_only_that) {
    const auto verdict = [](double slower, std::int64_t max_steps) {
        Progress progress(1e-9);
        double t = 0.0, step = 1e-3;
        const Mode mode;
        // to and fro by half the extent: steps that get on
        const double up[] = {0.0, 1.0}, back[] = {1.0, -1.0};
        for (int k = 0; k < 100'000; ++k) {
            const Piece piece{{t, 0.0}, step, 1.0, 1, 1, k % 2 == 0 ? up : back, 2};
            if (progress.after(mode, piece, 1.0, 1e3, max_steps) != Progress::Verdict::gets_on) return k;
            t += step;
            if (k % 10'000 == 9'999) step *= slower;
        }
        return 0;
    };
    EXPECT_EQ(verdict(1.0, 1'000'000), 0);
    EXPECT_EQ(verdict(0.95, 1'000'000), 0);
    // 1e3 s in steps of 1/8 ms are 8 million
    EXPECT_EQ(verdict(0.5, 1'000'000'000), 0);
    EXPECT_EQ(verdict(0.5, 1'000'000), 39'999);
}

}  // namespace
}  // namespace rbdyn::test::test_progress
