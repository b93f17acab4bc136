#include <gtest/gtest.h>

#include <rbdyn/rbdyn.hpp>

TEST(version, is_that_of_the_project) { EXPECT_STREQ(rbdyn::version, RBDYN_TEST_VERSION); }
