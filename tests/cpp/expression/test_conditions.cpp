// Conditions on expressions, asked about; and what functions print of their cases.
#include <gtest/gtest.h>

#include <random>
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

/// Joined at random, and the same said by values.
struct Joined {
    Condition condition;
    std::vector<bool> values;  // for each of the 16 answers to four comparisons
};

TEST(Conditions, joined_at_random_say_what_logic_says) {
    std::mt19937 random(7);
    Recorder recorder(Recorder::Purpose::function);
    for (int turn = 0; turn < 200; ++turn) {
        std::vector<Expression> x;
        std::vector<Joined> all;
        for (int i = 0; i < 4; ++i) {
            x.push_back(recorder.input(i));
            all.push_back({x.back() > 0.0, {}});
            for (int answers = 0; answers < 16; ++answers) all.back().values.push_back((answers >> i & 1) != 0);
        }
        for (int k = 0; k < 30; ++k) {
            const Joined a = all[random() % all.size()], b = all[random() % all.size()];
            const auto by_values = [&](const auto& join) {
                std::vector<bool> values;
                for (std::size_t i = 0; i < 16; ++i) values.push_back(join(a.values[i], b.values[i]));
                return values;
            };
            switch (random() % 4) {
                case 0:
                    all.push_back({a.condition & b.condition, by_values([](bool p, bool q) { return p && q; })});
                    break;
                case 1:
                    all.push_back({a.condition | b.condition, by_values([](bool p, bool q) { return p || q; })});
                    break;
                case 2:
                    all.push_back({a.condition ^ b.condition, by_values([](bool p, bool q) { return p != q; })});
                    break;
                default: all.push_back({!a.condition, by_values([](bool p, bool) { return !p; })});
            }
        }
        const Joined& last = all.back();
        for (std::size_t answers = 0; answers < 16; ++answers) {
            const auto positive = [&](const Expression& margin) {
                for (std::size_t i = 0; i < 4; ++i)
                    if (margin.node() == x[i].node()) return (answers >> i & 1) != 0;
                return false;
            };
            EXPECT_EQ(last.condition.holds(positive), last.values[answers]) << turn << " " << answers;
        }
    }
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
