// Sentences about what goes wrong: the numbers in them.
#include "rbdyn/basics/error.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <limits>

namespace rbdyn::test::test_error {
namespace {

TEST(Numbers, in_sentences_read_back_as_they_were) {
    for (const double x : {0.0, -0.0, 0.1, 1e-3, 1.0 / 3.0, 123456.0, 1234567.0, -1e100, 4e-15, 5e-324, 0x1p-1022})
        EXPECT_EQ(std::strtod(text(x).c_str(), nullptr), x) << text(x);
    EXPECT_EQ(text(0.1), "0.1");
    EXPECT_EQ(text(1e-15), "1e-15");
    EXPECT_EQ(text(1234567.0), "1234567");
    EXPECT_EQ(text(-std::numeric_limits<double>::infinity()), "-inf");
}

}  // namespace
}  // namespace rbdyn::test::test_error
