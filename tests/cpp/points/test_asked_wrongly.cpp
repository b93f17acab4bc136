// What watched functions and actions ask for and the scene does not have, and functions that are none, are refused in
// a sentence.
#include <gtest/gtest.h>

#include <functional>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "rbdyn/expression/callback.hpp"
#include "rbdyn/rbdyn.hpp"
#include "refusal.hpp"
#include "support.hpp"

namespace rbdyn::test::test_asked_wrongly {
namespace {

/// A particle that passes x = 3 after 0.5 s.
Scene passing() {
    Scene scene;
    scene.add(Particle{2.0}, {.position = {1, 2, 3}, .velocity = {4, 5, 6}}, "stone");
    return scene;
}

/// A rod on a hinge with another one on it: a tree.
Scene chain() {
    Scene scene({0, 0, -9.81});
    const Revolute hinge{.axis = {0, 1, 0}, .point = {0, 0, 0.5}};
    const BodyHandle upper = scene.add(shapes::rod(1.0, 1.0, {0, 0, 1}), hinge, {.angle = 1.0}, "stone");
    scene.add(shapes::rod(1.0, 1.0, {0, 0, 1}), hinge, {.angle = 0.5, .parent = upper}, "lower");
    return scene;
}

/// What a run of a scene is refused with, whose action asks for something.
std::string asking(Scene scene, const Observable& what) {
    const auto ask = [=](const Observe& now) {
        now(what);
        return std::vector<StateChange>{};
    };
    scene.watch("late", [](const Now& now) { return now.time() - 0.1; }, {.action = {WatchAction::Kind::change, ask}});
    return refusal([&] { simulate(scene, {.until = 0.2}); });
}

/// The same of a function that is called back.
std::string watching(Scene scene, const Observable& what) {
    const auto ask = [=](const Observe& now) { return now(what); };
    scene.watch("own", WatchFunction::called_back(ask, "a test"));
    return refusal([&] { simulate(scene, {.until = 0.2, .engine = "dop853"}); });
}

bool says(const std::string& message, const std::string& words) {
    EXPECT_NE(message.find(words), std::string::npos) << message;
    return message.find(words) != std::string::npos;
}

TEST(AskedWrongly, is_refused_where_an_action_or_a_callback_asks) {
    for (const Scene& scene : {passing(), chain()})
        for (const auto& refused : {asking, watching}) {
            EXPECT_EQ(refused(scene, {Quantity::velocity, 0, 2}), "accepted");
            EXPECT_TRUE(says(refused(scene, {Quantity::position, 9, 0}), "handle is 9"));
            EXPECT_TRUE(says(refused(scene, {Quantity::position, -1, 0}), "handle is -1"));
            for (const int component : {3, -1, 1000})
                EXPECT_TRUE(says(
                    refused(scene, {Quantity::velocity, 0, component}),
                    "component is " + std::to_string(component) + "; what it asks for of stone has components 0 to 2"));
            EXPECT_TRUE(says(refused(scene, {Quantity::kinetic_energy, 0, 1}), "is one number, component 0"));
            EXPECT_TRUE(says(refused(scene, {Quantity::length, 0, 0}), "handle is 0"));
            EXPECT_TRUE(says(refused(scene, {static_cast<Quantity>(99), 0, 0}), "quantity is 99"));
        }
}

TEST(AskedWrongly, is_refused_of_an_integral_that_is_called_back) {
    for (Scene scene : {passing(), chain()}) {
        const auto ask = [](const Observe& now) { return now({Quantity::position, 0, 3}); };
        scene.integral("own", WatchFunction::called_back(ask, "a test"));
        const Trajectory run = simulate(scene, {.until = 0.1});
        EXPECT_TRUE(says(refusal([&] { run.drift(); }), "integral own: component is 3"));
    }
}

TEST(AskedWrongly, is_refused_when_a_recorded_function_is_given) {
    for (const int component : {3, 7, -1}) {
        Scene scene = passing();
        EXPECT_TRUE(says(refusal([&] {
                             scene.watch("beyond", [=](const Now& now) {
                                 return now.value({Quantity::position, 0, component});
                             });
                         }),
                         "watch beyond: component is " + std::to_string(component)));
    }
}

TEST(AskedWrongly, functions_that_are_none_are_refused_where_they_are_given) {
    Scene scene = passing();
    const WatchFunction late = [](const Now& now) { return now.time() - 0.1; };
    EXPECT_TRUE(says(refusal([&] { scene.watch("none", WatchFunction()); }), "watch none: its function is empty"));
    EXPECT_TRUE(says(refusal([&] { scene.integral("none", WatchFunction()); }), "its function is empty"));
    EXPECT_TRUE(says(refusal([] { WatchFunction::called_back(nullptr, "a test"); }), "is empty; give a function"));
    const WatchAction empty{WatchAction::Kind::change, {}};
    EXPECT_TRUE(says(refusal([&] { scene.watch("late", late, {.action = empty}); }), "has no function"));
    const WatchHandle watch = scene.watch("late", late);
    EXPECT_TRUE(says(refusal([&] { scene.act(watch, empty); }), "watch late: its action changes states"));
    System system([](const auto&, auto x, auto rate) { rate[0] = -x[0]; }, {1.0});
    EXPECT_TRUE(says(refusal([&] {
                         system.watch("half", [](const auto&, auto x) { return x[0] - 0.5; },
                                      {.action = {WatchAction::Kind::change, {}}});
                     }),
                     "watch \"half\": its action"));

    const std::shared_ptr<const Callback> nothing;
    const auto hollow = std::make_shared<Callback>();
    for (const std::shared_ptr<const Callback>& callback : {nothing, std::shared_ptr<const Callback>(hollow)}) {
        const std::string rule = callback ? "its callback has no function" : "there is no callback";
        EXPECT_TRUE(says(refusal([&] { Force{callback}; }), "Force: " + rule));
        EXPECT_TRUE(says(refusal([&] { Torque{callback}; }), "Torque: " + rule));
        EXPECT_TRUE(says(refusal([&] { JointTorque{callback}; }), "JointForce: " + rule));
        EXPECT_TRUE(says(refusal([&] { Central{callback}; }), rule));
        EXPECT_TRUE(says(refusal([&] { PairForce{callback}; }), rule));
        EXPECT_TRUE(says(refusal([&] { OwnFunction{callback}; }), rule));
    }
    const double one = 1.0;
    EXPECT_TRUE(says(refusal([&] { Function()(std::span<const double>(&one, 1)); }), "Function: it is empty"));
}

TEST(AskedWrongly, times_of_a_name_that_nothing_has_are_refused) {
    Scene scene = passing();
    const WatchHandle late = scene.watch("late", [](const Now& now) { return now.time() - 2.0; });
    const Trajectory run = simulate(scene, {.until = 1.0});
    // what did not happen, and what is a typing error
    for (const char* word : {"late", "stone", "detach", "watch"}) EXPECT_TRUE(run.events().times(word).empty()) << word;
    EXPECT_TRUE(says(refusal([&] { run.events().times("bogus"); }), "\"bogus\" is no name in this run"));
    EXPECT_TRUE(says(refusal([&] { run.events().times("bogus", BodyHandle{0}); }), "the kinds are"));
    EXPECT_EQ(run.watched(late, 1.0), -1.0);
    System system([](const auto&, auto x, auto rate) { rate[0] = -x[0]; }, {1.0});
    system.watch("half", [](const auto&, auto x) { return x[0] - 0.5; });
    const SystemRun decay = simulate(system, {.until = 1.0});
    EXPECT_EQ(decay.events().times("half").size(), 1U);
    EXPECT_TRUE(says(refusal([&] { decay.events().times("hlaf"); }), "\"hlaf\" is no name in this run"));
}

TEST(MovedFrom, things_stay_what_they_were_or_are_refused) {
    Scene scene = passing();
    const BodyHandle stone{0};
    Force force([](const auto&, const auto& r, const auto&) { return -1.0 * r; });
    const Force elsewhere = std::move(force);
    scene.apply(force, stone);  // NOLINT: what it is after the move
    Trajectory run = simulate(scene, {.until = 1.0});
    const Trajectory same = std::move(run);
    EXPECT_EQ(run[stone].position(1.0), same[stone].position(1.0));  // NOLINT
    Curve circle = Circle{.radius = 1.0, .start = {1, 0, 0}, .toward = {0, 1, 0}};
    const Curve other = std::move(circle);
    EXPECT_TRUE(circle == other);  // NOLINT
    Parameter k(1.5, "k");
    const Parameter l = std::move(k);
    EXPECT_EQ(k.value(), 1.5);  // NOLINT
    System system([](const auto&, auto x, auto rate) { rate[0] = -x[0]; }, {1.0});
    const System more = std::move(system);
    SystemRun decay = simulate(system, {.until = 1.0});  // NOLINT
    const SystemRun kept = std::move(decay);
    EXPECT_EQ(decay.x(1.0), kept.x(1.0));  // NOLINT

    const auto pull = std::make_shared<Callback>();
    pull->inputs = 7;
    pull->outputs = 3;
    pull->function = [](const double* x, double* f) {
        for (int i = 0; i < 3; ++i) f[i] = -x[1 + i];
    };
    Force called{std::shared_ptr<const Callback>(pull)};
    const Force gone = std::move(called);
    Scene pulled = passing();
    pulled.apply(called, stone);  // NOLINT
    EXPECT_TRUE(says(refusal([&] { simulate(pulled, {.until = 1.0}); }), "moved from"));
    // a scene can be filled anew
    const Scene whole = std::move(pulled);
    pulled = passing();
    EXPECT_EQ(simulate(pulled, {.until = 1.0}).end(), 1.0);
    Scene emptied = passing();
    const Scene full = std::move(emptied);
    emptied.add(Particle{1.0});  // NOLINT
    EXPECT_EQ(simulate(emptied, {.until = 1.0}).end(), 1.0);
}

}  // namespace
}  // namespace rbdyn::test::test_asked_wrongly
