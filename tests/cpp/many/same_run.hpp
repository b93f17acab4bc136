// Whether two runs are the same, bit for bit.
#pragma once

#include <gtest/gtest.h>

#include <sstream>
#include <string>

#include "rbdyn/rbdyn.hpp"

namespace rbdyn::test {

/// The same scene, which nobody has planned.
inline Scene unplanned(const Scene& scene) {
    Scene copy = scene;
    copy.set_gravity(scene.gravity());
    return copy;
}

inline std::string printed(const Plan& plan) {
    std::ostringstream out;
    out << plan;
    return out.str();
}

inline void expect_same_run(const Attempt& a, const Attempt& b) {
    EXPECT_EQ(a.outcome, b.outcome);
    EXPECT_EQ(a.message, b.message);
    if (a.outcome == simulating::Outcome::thrown) return;  // as the motion begins: there is none
    EXPECT_EQ(a.run.status(), b.run.status());
    EXPECT_EQ(a.run.end(), b.run.end());
    EXPECT_EQ(a.run.certain_until(), b.run.certain_until());
    EXPECT_EQ(a.run.error(), b.run.error());
    EXPECT_EQ(a.run.engine(), b.run.engine());
    EXPECT_EQ(a.run.statistics().steps, b.run.statistics().steps);
    EXPECT_EQ(a.run.statistics().size, b.run.statistics().size);
    EXPECT_EQ(printed(a.run.plan()), printed(b.run.plan()));
    EXPECT_EQ(a.run.t(), b.run.t());
    ASSERT_EQ(a.run.events().size(), b.run.events().size());
    for (std::size_t i = 0; i < a.run.events().size(); ++i) {
        EXPECT_EQ(a.run.events()[i].time, b.run.events()[i].time);
        EXPECT_EQ(a.run.events()[i].name, b.run.events()[i].name);
    }
    for (std::size_t i = 0; i < a.run.scene().bodies().size(); ++i)
        for (const double part : {0.0, 0.3, 0.7, 1.0}) {
            const BodyHandle body{static_cast<int>(i)};
            const double t = a.run.start() + part * (a.run.end() - a.run.start());
            EXPECT_EQ(a.run[body].position(t), b.run[body].position(t));
            EXPECT_EQ(a.run[body].velocity(t), b.run[body].velocity(t));
            EXPECT_EQ(a.run[body].acceleration(t), b.run[body].acceleration(t));
        }
}

}  // namespace rbdyn::test
