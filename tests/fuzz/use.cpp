#include "use.hpp"

#include <cmath>
#include <exception>
#include <string>

#include "target.hpp"

namespace rbdyn::fuzz {

namespace {

bool is_finite(const Vector3& v) { return std::isfinite(v[0]) && std::isfinite(v[1]) && std::isfinite(v[2]); }

}  // namespace

void ask(const Trajectory& run) {
    const double start = run.start(), end = run.end();
    require(start <= end, "a run ends before it starts");
    double last = start;
    for (const Event& e : run.events()) {
        require(e.time >= last && e.time <= end, "an event is out of order: " + text(e.time) + " s of " + text(end));
        last = e.time;
        require(!e.name.empty() || e.subject >= -1, "an event is of nothing");
    }
    for (const double t : {start, 0.5 * (start + end), end})
        for (int i = 0; i < static_cast<int>(run.scene().bodies().size()); ++i) try {
                const BodyHandle body{i};
                const Vector3 r = run[body].position(t), v = run[body].velocity(t);
                require(is_finite(r) && is_finite(v), "a place is not finite at " + text(t) + " s");
                run[body].force(t);
                run[body].reaction(t);
            } catch (const Error&) {
                // what this body or time has not
            }
    try {
        run.energy(end);
        run.momentum(0.5 * (start + end));
    } catch (const Error&) {
        // not of every scene
    }
}

void use(const Scene& scene) {
    make_plan(scene);
    const Attempt made = attempt(scene, {.until = 0.3, .rtol = 1e-4, .max_steps = 40});
    if (made.thrown) std::rethrow_exception(made.thrown);
    require(made.outcome == simulating::Outcome::good || !made.message.empty(), "a run fails without a word");
    ask(made.run);
}

}  // namespace rbdyn::fuzz
