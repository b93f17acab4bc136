// Conditions on expressions, asked about; and what functions print of their cases.
#include <gtest/gtest.h>

#include <rbdyn/expression/condition.hpp>
#include <rbdyn/expression/function.hpp>
#include <vector>

namespace rbdyn::test::test_conditions {

namespace {

TEST(Conditions, are_asked_about_in_order_and_no_further_than_needed) {
    Recorder recorder(Recorder::Purpose::function);
    const Expression x = recorder.input(0), y = recorder.input(1);
    std::vector<std::int32_t> asked;
    const auto answers = [&](bool first, bool second) {
        return [&asked, first, second, x](const Expression& margin) {
            asked.push_back(margin.node());
            return margin.node() == x.node() ? first : second;
        };
    };
    const Condition both = (x > 0.0) & (y > 0.0), either = (x > 0.0) | (y > 0.0);
    for (const bool first : {false, true})
        for (const bool second : {false, true}) {
            asked.clear();
            EXPECT_EQ(both.holds(answers(first, second)), first && second);
            EXPECT_EQ(asked.size(), first ? 2u : 1u);
            asked.clear();
            EXPECT_EQ(either.holds(answers(first, second)), first || second);
            EXPECT_EQ(asked.size(), first ? 1u : 2u);
            EXPECT_EQ((!both).holds(answers(first, second)), !(first && second));
        }
    asked.clear();
    EXPECT_TRUE((Condition(true) | (x > 0.0)).holds(answers(false, false)));
    EXPECT_FALSE((Condition(false) & (x > 0.0)).holds(answers(true, true)));
    EXPECT_TRUE(asked.empty());
}

TEST(Functions, print_what_their_cases_are_called) {
    const Function f = Function::record(1, [](const std::vector<Expression>& x) {
        return std::vector<Expression>{select(
                                           x[0], [&] { return x[0]; }, [&] { return abs(x[0]); }, "spring"),
                                       floor(x[0])};
    });
    const std::string text = f.text();
    for (const char* name : {"(spring)", "(abs)", "(floor)"}) EXPECT_NE(text.find(name), std::string::npos) << text;
}

}  // namespace

}  // namespace rbdyn::test::test_conditions
