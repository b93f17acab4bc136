// A model, forces, a potential and a watched function of the user's own, from C++: functors over the number type,
// recorded once and then run, differentiated and expanded in Taylor series at native speed.
#include <cmath>
#include <iostream>
#include <rbdyn/rbdyn.hpp>

namespace {

// Van der Pol's oscillator: x' = f(t, x) of any kind is a model. Its extremes of x are noted.
struct VanDerPol {
    double stiffness = 2.0;

    int variables() const { return 2; }
    int positions() const { return 1; }
    template <class S>
    void operator()(const S& /*t*/, std::span<const S> x, std::span<S> rate) const {
        rate[0] = x[1];
        rate[1] = stiffness * (1.0 - x[0] * x[0]) * x[1] - x[0];
    }
    template <class S>
    std::vector<std::pair<std::string, S>> watched(const S& /*t*/, std::span<const S> x) const {
        return {{"extreme", x[1]}};
    }
};

bool good = true;
void expect(const char* what, double value, double exact, double tolerance) {
    const bool agrees = std::abs(value - exact) <= tolerance * std::abs(exact);
    std::cout << what << ": " << rbdyn::text(value) << (agrees ? "" : ", wrong: " + rbdyn::text(exact)) << '\n';
    good = good && agrees;
}

// the period and the amplitude of its limit cycle
void own_model() {
    const rbdyn::StateRun run = rbdyn::simulate(VanDerPol{}, {2.0, 0.0}, {.until = 100.0, .error = 1e-10});
    const auto& events = run.events();
    const std::size_t last = events.size() - 1;
    expect("period of the limit cycle", events[last].time - events[last - 2].time, 7.6298744797, 1e-9);
    expect("its amplitude", std::abs(run.state(events[last].time)[0]), 2.01989138, 1e-8);
}

// A planet: the force by its potential, or by its components; and where it is nearest.
void own_loads() {
    const auto period = [](const auto& load) {
        rbdyn::Scene scene;
        const auto planet =
            scene.add(rbdyn::Particle{.mass = 1.0}, {.position = {1.0, 0.0, 0.0}, .velocity = {0.0, 1.2, 0.0}});
        scene.apply(load, planet);
        // r.v rises through zero where the distance is least
        scene.watch("nearest",
                    [=](const rbdyn::Now& now) { return rbdyn::dot(now[planet].position(), now[planet].velocity()); },
                    {.direction = rbdyn::Direction::rising});
        const rbdyn::Trajectory run = rbdyn::simulate(scene, {.until = 40.0, .error = 1e-11});
        const auto times = run.events().times("nearest");
        return times[times.size() - 1] - times[times.size() - 2];
    };
    // Kepler's third law: v^2/2 - 1/r = -1/(2 a)
    const double pi = std::acos(-1.0), axis = 1.0 / (2.0 - 1.2 * 1.2), kepler = 2.0 * pi * std::pow(axis, 1.5);
    const rbdyn::Potential potential([](const auto& r) { return 1.0 / rbdyn::length(r); });
    const rbdyn::Force force([](const auto&, auto r, const auto&) {
        const auto distance = rbdyn::length(r);
        for (auto& component : r) component = -component / (distance * distance * distance);
        return r;
    });
    expect("period of a planet by its potential", period(potential), kepler, 1e-10);
    expect("and by its force", period(force), kepler, 1e-10);
}

}  // namespace

int main() {
    own_model();
    own_loads();
    return good ? 0 : 1;
}
