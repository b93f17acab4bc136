// Rough and smooth rails against reference motions known to 25 digits: every event, positions, speeds, reactions.
//
// The figures come from files of tests/reference, made with closed forms and independent integrations in extended
// precision; each file states its conventions. RBDYN_TEST_TABLE=1 prints true and estimated errors.
#include <gtest/gtest.h>

#include <fstream>
#include <iomanip>
#include <iostream>
#include <map>
#include <nlohmann/json.hpp>
#include <numbers>

#include "rbdyn/integrate.hpp"
#include "support.hpp"

namespace rbdyn::test::test_reference {
namespace {

using nlohmann::json;
using Real = long double;
using Vector = Eigen::Matrix<Real, 3, 1>;

const char* const cases[] = {"g_circle_above_horizontal",
                             "g_circle_from_rest",
                             "g_circle_turns",
                             "g_helix_stops",
                             "g_helix_terminal",
                             "g_incline_slips",
                             "g_incline_sticks",
                             "g_incline_up_then_back",
                             "g_incline_up_then_sticks",
                             "h_belt_no_stick",
                             "h_belt_overspeed",
                             "h_belt_stick_slip",
                             "f_line",
                             "f_circle_libration",
                             "f_helix",
                             "f_twisted_cubic",
                             "f_parabola",
                             "f_cycloid",
                             "f_helix_swirl"};

/// How the curve of a case is written, and its forces.
enum class Written { by_kind, as_function };
enum class Given { built_in, recorded, called_back };

json load(const std::string& id) {
    std::ifstream file(std::string(RBDYN_TEST_REFERENCE) + "/" + id + ".json");
    if (!file) throw std::runtime_error("no reference file " + id);
    return json::parse(file);
}

/// All digits a long double holds of a decimal string.
Real digits(const json& text) { return std::strtold(text.get_ref<const std::string&>().c_str(), nullptr); }
Vector digits3(const json& list) { return {digits(list[0]), digits(list[1]), digits(list[2])}; }

struct ExpectedEvent {
    Real time;
    std::string kind;
    json data;
};

/// A reference motion as a scene of this library, with its figures as vectors of the world.
class Reference {
public:
    explicit Reference(const std::string& name, Written written = Written::by_kind, Given forces = Given::built_in)
        : id(name), file_(load(name)), written_(written) {
        read_events();
        until = 0.0;
        for (const json& s : values()["samples"]) until = std::max(until, static_cast<double>(digits(s["t"])));
        // a little beyond the last event, far from the next one
        if (!events.empty()) until = std::max(until, static_cast<double>(events.back().time) + 0.1);
        if (forces == Given::built_in) scene.set_gravity({0.0, 0.0, -p("g")});
        if (id.starts_with("g_circle"))
            add(vertical_circle(p("R")), friction(), p("theta0"));
        else if (id.starts_with("g_helix"))
            add(Helix{.radius = p("R"),
                      .pitch = 2.0 * std::numbers::pi * p("h"),
                      .start = {1, 0, 0},
                      .toward = {0, -1, 0}},
                friction(), 0.0);
        else if (id.starts_with("g_incline"))
            add(incline(p("tan_slope")), friction(), 0.0);
        else if (id.starts_with("h_belt")) {
            add(along_x, friction(), p("x0"), "xdot0", p("V_belt"));
            scene.connect(Spring{.stiffness = p("k")}, bead, Vector3(Vector3::Zero()));
        } else {
            add_smooth();
        }
        if (forces != Given::built_in || id == "f_helix_swirl") scene.apply(force(forces), bead);
    }

    const json& values() const { return file_["values"]; }
    double p(const char* name) const { return static_cast<double>(digits(file_["parameters"][name]["value"])); }

    Vector position(const json& s) const {
        if (s.contains("position")) return digits3(s["position"]);
        if (id.starts_with("g_circle")) return Real(p("R")) * Vector(std::sin(angle(s)), 0, -std::cos(angle(s)));
        if (id.starts_with("g_helix"))
            return {Real(p("R")) * std::cos(angle(s)), -Real(p("R")) * std::sin(angle(s)), -Real(p("h")) * angle(s)};
        if (id.starts_with("g_incline")) return tangent(s) * digits(s["s"]);
        return {digits(s["x"]), 0, 0};
    }
    Vector velocity(const json& s) const {
        if (s.contains("velocity")) return digits3(s["velocity"]);
        return tangent(s) * digits(s.contains("x_dot") ? s["x_dot"] : s["s_dot"]);
    }
    /// The rail's reaction at a sample.
    Vector reaction(const json& s) const {
        if (s.contains("Phi_world")) return digits3(s["Phi_world"]);
        const Vector weight(0, 0, -Real(p("m")) * p("g"));
        const Vector t = tangent(s);
        if (id.starts_with("h_belt")) {
            const Real slip = digits(s["x_dot"]) - p("V_belt"), load = Real(p("m")) * p("g");
            const Real along = slip == 0 ? Real(p("k")) * digits(s["x"]) : (slip < 0 ? 1 : -1) * Real(p("f_d")) * load;
            return {along, 0, load};
        }
        const Real v = digits(s["s_dot"]);
        Vector across;
        if (id.starts_with("g_incline")) {
            across = t * weight.dot(t) - weight;
        } else if (id.starts_with("g_circle")) {
            across = digits(s["Phi_n"]) * Vector(-std::sin(angle(s)), 0, std::cos(angle(s)));
        } else {
            const Vector n(-std::cos(angle(s)), std::sin(angle(s)), 0), b = t.cross(n);
            across = digits(s["Phi_n"]) * n - b * weight.dot(b);
            return across + t * digits(s["Phi_t"]);
        }
        const Real along = v == 0 ? -weight.dot(t) : (v < 0 ? 1 : -1) * Real(p("f_d")) * across.norm();
        return across + t * along;
    }

    std::string id;
    Scene scene;
    BodyHandle bead;
    std::vector<ExpectedEvent> events;
    double until;

private:
    Real angle(const json& s) const {
        if (s.contains("theta")) return digits(s["theta"]);
        return s.contains("u_angle") ? digits(s["u_angle"]) : digits(s["s"]) / std::hypot(Real(p("R")), Real(p("h")));
    }
    Vector tangent(const json& s) const {
        if (id.starts_with("g_circle")) return {std::cos(angle(s)), 0, std::sin(angle(s))};
        if (id.starts_with("g_helix")) {
            const Real R = p("R"), h = p("h");
            return Vector(-R * std::sin(angle(s)), -R * std::cos(angle(s)), -h) / std::sqrt(R * R + h * h);
        }
        if (id.starts_with("g_incline")) return Vector(1, 0, -Real(p("tan_slope"))).normalized();
        return {1, 0, 0};
    }
    /// The curve of a smooth case: of its own kind, or as any function of the parameter.
    void add_smooth() {
        const double turn = 2.0 * std::numbers::pi;
        if (id == "f_line") {
            add_curve(Line{.direction = {p("a"), p("b"), p("c")}},
                      [a = p("a"), b = p("b"), c = p("c")](const auto& u) { return three(a * u, b * u, c * u); });
        } else if (id == "f_circle_libration") {
            add_curve(vertical_circle(p("R")),
                      [R = p("R")](const auto& u) { return three(R * sin(u), 0.0 * u, -R * cos(u)); });
        } else if (id == "f_parabola") {
            add_curve(Parabola{.a = p("a"), .x = {1, 0, 0}, .y = {0, 0, 1}},
                      [a = p("a")](const auto& u) { return three(u, 0.0 * u, a * u * u); });
        } else if (id == "f_cycloid") {
            add_curve(Cycloid{.radius = p("R"), .x = {1, 0, 0}, .y = {0, 0, 1}},
                      [R = p("R")](const auto& u) { return three(R * (u + sin(u)), 0.0 * u, R * (1.0 - cos(u))); });
        } else if (id.starts_with("f_helix")) {
            add_curve(Helix{.radius = p("R"), .pitch = turn * p("h"), .start = {1, 0, 0}, .toward = {0, 1, 0}},
                      [R = p("R"), h = p("h")](const auto& u) { return three(R * cos(u), R * sin(u), h * u); });
        } else {
            add_curve(
                Polynomial{.coefficients = {{0, 0, 0}, {p("a"), 0, 0}, {0, p("b"), 0}, {0, 0, p("c")}}},
                [a = p("a"), b = p("b"), c = p("c")](const auto& u) { return three(a * u, b * u * u, c * u * u * u); });
        }
    }
    template <class S>
    static Vector3Of<S> three(const S& x, const S& y, const S& z) {
        return {x, y, z};
    }
    template <class F>
    void add_curve(const Curve& curve, F&& function) {
        add(written_ == Written::by_kind ? curve : Curve(function), std::nullopt, p("u0"));
    }
    /// Weight and swirl; the swirl alone if the scene has the weight.
    Force force(Given given) const {
        const double weight = given == Given::built_in ? 0.0 : p("m") * p("g");
        const double swirl = id == "f_helix_swirl" ? p("swirl_c") : 0.0;
        if (given != Given::called_back)
            return Force([=](const auto&, const auto& r, const auto&) {
                using S = std::decay_t<decltype(r[0])>;
                return Vector3Of<S>{-swirl * r[1], swirl * r[0], S(-weight)};
            });
        auto callback = std::make_shared<Callback>();
        callback->name = "weight and swirl";
        callback->reason = "a test";
        callback->inputs = 7;
        callback->outputs = 3;
        callback->function = [=](const double* x, double* y) {
            y[0] = -swirl * x[2];
            y[1] = swirl * x[1];
            y[2] = -weight;
        };
        return Force(std::shared_ptr<const Callback>(std::move(callback)));
    }
    Coulomb friction() const { return {.mu_static = p("f_s"), .mu_dynamic = p("f_d")}; }
    void add(const Curve& curve, std::optional<Coulomb> rough, double u, const char* speed = "sdot0",
             double drive = 0.0) {
        bead = scene.add(Particle{p("m")}, Rail(curve, rough, {.drive = drive}), {.parameter = u, .speed = p(speed)});
    }

    /// The file's events in the library's words: what begins stuck or sliding does so silently.
    void read_events() {
        if (!values().contains("events")) return;
        const json& list = values()["events"];
        for (std::size_t k = 0; k < list.size(); ++k) {
            const Real time = digits(list[k]["t"]);
            std::string kind = list[k]["event"];
            if (time == 0) continue;
            if (kind == "stop") {
                const std::string next = list.at(k + 1)["event"];
                kind = next == "final_stick" || next == "stick_forever" ? "stick" : "reverse";
                events.push_back({time, kind, list[k]});
                ++k;
                continue;
            }
            if (kind == "start_of_slip") kind = "slip";
            if (kind == "Phi_n_changes_sign") kind = "normal-zero";
            if (kind == "crosses_belt_speed") kind = "reverse";
            events.push_back({time, kind, list[k]});
        }
    }

    json file_;
    Written written_;
};

/// What came of a reference motion.
struct Outcome {
    std::string found, expected;  // kinds of events
    double events = 0.0, motion = 0.0, reactions = 0.0;
    std::optional<double> estimate;
    double error() const { return std::max({events, motion, reactions}); }
};

Outcome measure(const std::string& id, const SimulateOptions& accuracy, Written written = Written::by_kind,
                Given forces = Given::built_in) {
    const Reference reference(id, written, forces);
    SimulateOptions options = accuracy;
    options.until = reference.until;
    const Trajectory run = simulate(reference.scene, options);
    Outcome result;
    result.estimate = run.error();
    result.found = kinds(run);
    for (const ExpectedEvent& e : reference.events) result.expected += (result.expected.empty() ? "" : " ") + e.kind;
    if (result.found != result.expected) return result;

    const Scales scale = scales(run, reference.bead);
    const auto compare_position = [&](const PointReport& r, const json& s) {
        const Real distance = (r.position.cast<Real>() - reference.position(s)).norm();
        result.motion = std::max(result.motion, relative(static_cast<double>(distance), scale.extent));
    };
    for (std::size_t k = 0; k < reference.events.size(); ++k) {
        const ExpectedEvent& e = reference.events[k];
        const double time = run.events()[k].time;
        result.events = std::max(result.events, static_cast<double>(std::abs(time - e.time) / e.time));
        compare_position(run[reference.bead].report(time), e.data);
    }
    for (const json& s : reference.values()["samples"]) {
        const PointReport r = run[reference.bead].report(static_cast<double>(digits(s["t"])));
        compare_position(r, s);
        const Real velocity = (r.velocity.cast<Real>() - reference.velocity(s)).norm();
        result.motion = std::max(result.motion, relative(static_cast<double>(velocity), scale.speed));
        const Real reaction = (r.reaction.cast<Real>() - reference.reaction(s)).norm();
        result.reactions = std::max(result.reactions, relative(static_cast<double>(reaction), scale.reaction));
    }
    if (std::getenv("RBDYN_TEST_TABLE") != nullptr)
        std::cout << std::setprecision(2) << std::scientific << std::left << std::setw(28) << id << std::setw(6)
                  << (accuracy.rtol ? "rtol" : "error") << std::setw(10) << accuracy.rtol.value_or(accuracy.error)
                  << " events " << result.events << "  motion " << result.motion << "  reactions " << result.reactions
                  << "  estimate " << result.estimate.value_or(0.0) << "  steps " << run.statistics().steps << '\n';
    return result;
}

class ReferenceMotion : public testing::TestWithParam<std::tuple<const char*, double>> {
protected:
    std::string id() const { return std::get<0>(GetParam()); }
    double asked() const { return std::get<1>(GetParam()); }
};

TEST_P(ReferenceMotion, has_every_event_once_and_is_within_the_error_asked_for) {
    const Outcome outcome = measure(id(), {.error = asked()});
    ASSERT_EQ(outcome.found, outcome.expected);
    EXPECT_LE(outcome.events, asked());
    EXPECT_LE(outcome.motion, asked());
    EXPECT_LE(outcome.reactions, asked());
    // the estimate keeps the promise, and is honest: never ten times too small
    ASSERT_TRUE(outcome.estimate.has_value());
    EXPECT_LE(*outcome.estimate, asked());
    EXPECT_LE(outcome.error(), 10.0 * *outcome.estimate);
}

INSTANTIATE_TEST_SUITE_P(To, ReferenceMotion,
                         testing::Combine(testing::ValuesIn(cases), testing::Values(1e-6, 1e-9, 1e-12)),
                         [](const auto& test) {
                             const int places = static_cast<int>(std::lround(-std::log10(std::get<1>(test.param))));
                             return std::string(std::get<0>(test.param)) + "_to_" + std::to_string(places) + "_places";
                         });

class WrittenOtherwise : public testing::TestWithParam<std::tuple<const char*, Written, Given>> {};

TEST_P(WrittenOtherwise, has_the_reference_motion_within_the_error_asked_for) {
    const auto [id, written, forces] = GetParam();
    for (double asked : {1e-6, 1e-9, 1e-12}) {
        const Outcome outcome = measure(id, {.error = asked}, written, forces);
        ASSERT_EQ(outcome.found, outcome.expected);
        EXPECT_LE(outcome.error(), asked);
        ASSERT_TRUE(outcome.estimate.has_value());
        EXPECT_LE(*outcome.estimate, asked);
        // also where dop853 crosses a helix in one step at every tolerance, and the error is rounding
        EXPECT_LE(outcome.error(), 10.0 * *outcome.estimate) << asked;
    }
}

INSTANTIATE_TEST_SUITE_P(As, WrittenOtherwise,
                         testing::Combine(testing::Values("f_line", "f_circle_libration", "f_helix", "f_twisted_cubic",
                                                          "f_parabola", "f_cycloid", "f_helix_swirl"),
                                          testing::Values(Written::by_kind, Written::as_function),
                                          testing::Values(Given::built_in, Given::recorded, Given::called_back)),
                         [](const auto& test) {
                             // no structured binding: the macro would take its commas for arguments
                             const Written written = std::get<1>(test.param);
                             const Given forces = std::get<2>(test.param);
                             return std::string(std::get<0>(test.param)) +
                                    (written == Written::by_kind ? "" : "_as_a_function") +
                                    (forces == Given::built_in   ? ""
                                     : forces == Given::recorded ? "_by_forces_recorded"
                                                                 : "_by_forces_called_back");
                         });

TEST(ReferenceMotions, median_estimate_is_at_most_thirty_times_the_true_error) {
    std::vector<double> ratios;
    for (const char* id : cases)
        for (double asked : {1e-6, 1e-9, 1e-12}) {
            const Outcome outcome = measure(id, {.error = asked});
            // below this both are rounding
            if (outcome.error() > 1e-15) ratios.push_back(*outcome.estimate / outcome.error());
        }
    ASSERT_GE(ratios.size(), 10u);
    std::sort(ratios.begin(), ratios.end());
    const double median = ratios[ratios.size() / 2];
    RecordProperty("median", std::to_string(median));
    if (std::getenv("RBDYN_TEST_TABLE") != nullptr)
        std::cout << "estimate/true error: least " << ratios.front() << ", median " << median << ", largest "
                  << ratios.back() << ", of " << ratios.size() << '\n';
    EXPECT_LE(median, 30.0);
}

TEST(ReferenceMotions, a_local_tolerance_gives_all_events_and_no_estimate) {
    for (const char* id : cases)
        for (double rtol : {1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10, 1e-11, 1e-12, 1e-13, 1e-14}) {
            const Outcome outcome = measure(id, {.rtol = rtol, .engine = "taylor"});
            EXPECT_EQ(outcome.found, outcome.expected) << id << " with " << rtol;
            EXPECT_FALSE(outcome.estimate.has_value());
            // global error of runs of at most some hundred steps
            EXPECT_LE(outcome.error(), 1e3 * rtol) << id << " with " << rtol;
        }
}

/// The least error, by tens, that an engine reaches on a case by its own estimate; checks that one on the way.
double floor_of(const char* id, const std::string& engine) {
    double reached = 1.0;
    for (double asked : {1e-6, 1e-7, 1e-8, 1e-9, 1e-10, 1e-11, 1e-12, 1e-13}) {
        try {
            const Outcome outcome = measure(id, {.error = asked, .engine = engine});
            EXPECT_EQ(outcome.found, outcome.expected) << id << ' ' << engine << ' ' << asked;
            EXPECT_LE(outcome.error(), asked) << id << ' ' << engine;
            EXPECT_LE(outcome.error(), 10.0 * *outcome.estimate) << id << ' ' << engine << ' ' << asked;
            reached = asked;
        } catch (const AccuracyError& e) {
            EXPECT_EQ(e.run.status(), Status::accuracy_not_reached);
            break;
        }
    }
    return reached;
}

TEST(ReferenceMotions, other_engines_keep_the_same_promise_down_to_their_floors_and_say_where_those_are) {
    // stated in docs/accuracy.md
    const std::map<std::string, double> floors{{"dop853", 1e-13}, {"cvode-adams", 1e-11}, {"cvode-bdf", 1e-10}};
    for (const std::string& engine : simulating::engines()) {
        if (engine == "taylor") continue;
        for (const char* id : cases) {
            const double floor = floor_of(id, engine);
            if (std::getenv("RBDYN_TEST_TABLE") != nullptr)
                std::cout << engine << ' ' << id << " reaches " << floor << '\n';
            // CVODE on the parabola loses a digit
            const bool is_parabola = engine.starts_with("cvode") && id == std::string("f_parabola");
            EXPECT_LE(floor, (is_parabola ? 10.001 : 1.001) * floors.at(engine)) << engine << ' ' << id;
        }
    }
}

TEST(ReferenceMotions, belt_has_the_period_of_the_limit_cycle) {
    for (const char* id : {"h_belt_stick_slip", "h_belt_overspeed"}) {
        const Reference reference(id);
        const double period = static_cast<double>(digits(reference.values()["limit_cycle_period"]));
        const double stick = static_cast<double>(digits(reference.values()["limit_cycle_stick_time"]));
        const Trajectory run = simulate(reference.scene, {.until = 40.0, .error = 1e-12});
        const auto slips = run.events().times("slip"), sticks = run.events().times("stick");
        ASSERT_GE(slips.size(), 15u);
        for (std::size_t k = 1; k < slips.size(); ++k) {
            EXPECT_NEAR(slips[k] - slips[k - 1], period, 2.0 * 1e-12 * slips[k]) << id;
            // the stick before a slip
            const double before = *(std::lower_bound(sticks.begin(), sticks.end(), slips[k]) - 1);
            EXPECT_NEAR(slips[k] - before, stick, 2.0 * 1e-12 * slips[k]) << id;
        }
    }
}

}  // namespace
}  // namespace rbdyn::test::test_reference
