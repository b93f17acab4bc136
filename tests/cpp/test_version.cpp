#include <gtest/gtest.h>

#include <rbdyn/rbdyn.hpp>

namespace rbdyn::test::test_version {

TEST(version, is_that_of_the_project) { EXPECT_STREQ(rbdyn::version, RBDYN_TEST_VERSION); }

}  // namespace rbdyn::test::test_version
