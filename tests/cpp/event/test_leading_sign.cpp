// The sign that a function which begins at zero takes, told by values: neither that of rounding nor that of steps.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "rbdyn/expression/program.hpp"
#include "rbdyn/expression/recorder.hpp"
#include "rbdyn/model/leading_sign.hpp"

namespace rbdyn::test::test_leading_sign {
namespace {

/// Equations of one's own and a mode of them.
struct Watched {
    Equations equations;
    Mode mode;
    Watched(Recorder& r, const std::vector<Expression>& outputs, int variables) {
        equations.program = Program(r, outputs, variables);
        mode.equations = &equations;
    }
    int by_values(const std::vector<double>& x, bool is_zero) const {
        return leading::by_values(mode, 0.0, x, static_cast<int>(x.size()), is_zero);
    }
};
TEST(LeadingSign, by_values_is_not_that_of_rounding) {
    // zero on the way, whatever rounding makes of it
    Recorder r;
    const Expression x = r.input(0), v = r.input(1);
    const Watched none(r, {v, 0.0 * x, x * x - 2.0 * x * 0.7 + 0.7 * 0.7 - (x - 0.7) * (x - 0.7)}, 2);
    for (const double place : {0.3, 1.1, 123.4, -7.7})
        for (const double speed : {0.3, -1.7}) {
            EXPECT_EQ(none.by_values({place, speed}, false), 0) << place << ' ' << speed;
            EXPECT_EQ(none.by_values({place, speed}, true), 0) << place << ' ' << speed;
        }
}
TEST(LeadingSign, by_values_is_not_that_of_the_error_of_its_steps) {
    // round a circle nothing leaves it
    Recorder r;
    const Expression x = r.input(0), y = r.input(1);
    const Watched circle(r, {-y, x, x * x + y * y - 1.0}, 2);
    for (const double angle : {0.1, 0.7, 2.0, 4.0}) {
        EXPECT_EQ(circle.by_values({std::cos(angle), std::sin(angle)}, true), 0) << angle;
    }
    Recorder other;
    const Expression u = other.input(0), w = other.input(1);
    const Watched spiral(other, {-w + 0.01 * u, u + 0.01 * w, u * u + w * w - 1.0}, 2);
    EXPECT_EQ(spiral.by_values({0.6, 0.8}, true), 1);
}

}  // namespace
}  // namespace rbdyn::test::test_leading_sign
