// simulate() and effects(): they run without Python's lock, look for Ctrl-C and show progress. The engines are built
// here.
#include <cmath>
#include <optional>
#include <rbdyn/rbdyn.hpp>
#include <variant>

#include "rows.hpp"
#include "running.hpp"
#include "starts.hpp"
#include "system.hpp"

namespace binding {

using rbdyn::EffectRow, rbdyn::EffectTable, rbdyn::Trajectory;

namespace {

/// The fraction of a run that is done; of one without an end of its own all.
double done_of(double end, double start, double until) {
    return std::isfinite(until) ? (end - start) / (until - start) : 1.0;
}

/// What an attempt came to, or the error that it did.
BoundTrajectory finished(const rbdyn::Attempt& result, const std::shared_ptr<const Handles>& handles, Watch& watch,
                         double start, double until) {
    const std::optional<BoundTrajectory> run = BoundTrajectory{result.run, handles};
    // also what came since the last look
    watch.look(done_of(run->run.end(), start, until));
    watch.raise_if_raised(run);
    if (result.outcome != rbdyn::simulating::Outcome::good) raise(failure_of(result, *run));
    return *run;
}

BoundTrajectory simulate(const BoundScene& scene, double until, double start, std::optional<double> error,
                         std::optional<double> rtol, const std::string& engine, const KeepLike& keep,
                         std::int64_t max_steps, const py::object& progress, const py::object& initial,
                         const py::object& events) {
    // copies, since other threads may change the scene while this one runs without the lock
    rbdyn::Scene copy = scene.scene;
    if (!initial.is_none()) {
        // lists, too, are mappings to PyMapping_Check
        if (!py::hasattr(initial, "keys"))
            throw InvalidInput("simulate: initial is " + shown(initial) +
                               "; it is a mapping of (handle, word), as in {(wheel, \"rate\"): 3.0}");
        restart(copy, scene.handles, py::dict(initial), "simulate");
    }
    const auto handles = std::make_shared<const Handles>(scene.handles);
    Watch watch(progress);
    rbdyn::SimulateOptions options = options_of(until, start, error, rtol, engine, keep, max_steps);
    options.events = events_of(events, handles);
    options.monitor = watch.monitor(start, until);
    options.warn = watch.warn();

    std::optional<rbdyn::Attempt> result;
    {
        const Unlocked free(!calls_python(copy));
        result = rbdyn::attempt(copy, options);
    }
    return finished(*result, handles, watch, start, until);
}

BoundTrajectory simulate_on(const BoundTrajectory& before, double until, std::optional<double> error,
                            std::optional<double> rtol, const std::optional<std::string>& engine,
                            const std::optional<KeepLike>& keep, std::optional<std::int64_t> max_steps,
                            const py::object& progress, const py::object& events) {
    const double start = before.run.end();
    Watch watch(progress);
    rbdyn::ContinueOptions options{.until = until, .error = error, .rtol = rtol, .engine = engine};
    if (keep) options.keep = keep_of(*keep);
    options.events = events_of(events, before.handles);
    options.max_steps = max_steps;
    options.monitor = watch.monitor(start, until);
    options.warn = watch.warn();
    std::optional<rbdyn::Attempt> result;
    {
        const Unlocked free(!calls_python(before.run.scene()));
        result = rbdyn::attempt(before.run, options);
    }
    return finished(*result, before.handles, watch, start, until);
}

rbdyn::StateRun simulate_top(const rbdyn::EulerTop& model, const ArrayLike& state, double until, double start,
                             std::optional<double> error, std::optional<double> rtol, const std::string& engine,
                             const KeepLike& keep, std::int64_t max_steps, const py::object& progress) {
    const std::vector<double> x = list_of_doubles(state, "simulate", "state");
    Watch watch(progress);
    rbdyn::SimulateOptions options = options_of(until, start, error, rtol, engine, keep, max_steps);
    options.monitor = watch.monitor(start, until);
    std::optional<rbdyn::StateRun> run;
    std::string failure;
    {
        const Unlocked free;
        try {
            run = rbdyn::simulate(model, x, options);
        } catch (const rbdyn::ModelError& e) {
            run = e.run;
            failure = e.what();
        }
    }
    watch.look(done_of(run->end(), start, until));
    watch.raise_if_raised(run);
    if (failure.empty()) return *run;
    const bool inaccurate = run->status() == rbdyn::Status::accuracy_not_reached;
    raise(error_with(*run, inaccurate ? "AccuracyError" : "IntegrationError", failure));
}

rbdyn::SystemRun simulate_system(const BoundSystem& system, double until, double start, std::optional<double> error,
                                 std::optional<double> rtol, const std::string& engine, const KeepLike& keep,
                                 std::int64_t max_steps, const py::object& progress, const py::object& initial,
                                 const py::object& events) {
    const rbdyn::System copy = started(system.system, initial, "simulate");
    Watch watch(progress);
    rbdyn::SimulateOptions options = options_of(until, start, error, rtol, engine, keep, max_steps);
    options.monitor = watch.monitor(start, until);
    options.warn = watch.warn();
    options.events = events_of(events, std::make_shared<const Handles>());
    std::optional<rbdyn::SystemAttempt> result;
    {
        const Unlocked free(!copy.calls_python());
        result = rbdyn::attempt(copy, options);
    }
    watch.look(done_of(result->run.end(), start, until));
    watch.raise_if_raised(std::optional(result->run));
    if (result->outcome != rbdyn::simulating::Outcome::good) raise(failure_of(*result, result->run));
    return result->run;
}

EffectTable effects(const BoundScene& scene, double until, double start, std::optional<double> error,
                    std::optional<double> rtol, const std::string& engine, std::int64_t max_steps) {
    const rbdyn::Scene copy = scene.scene;
    Watch watch(py::bool_(false));
    rbdyn::SimulateOptions options = options_of(until, start, error, rtol, engine, std::string("all"), max_steps);
    options.monitor = watch.monitor(start, until);
    return tabulated(copy, scene.handles, watch, [&] { return rbdyn::effects(copy, options); });
}

void bind_effects(py::module_& m) {
    py::class_<EffectRow>(m, "EffectRow", "What one effect does: a row of effects().")
        .def_readonly("effect", &EffectRow::effect, "Its name.")
        .def_readonly("difference", &EffectRow::difference,
                      "Of the states with and without it at the end, in the motion's scales; nan if there is none.")
        .def_readonly("time", &EffectRow::time, "Where they are compared: the earlier end of the two [s].")
        .def_readonly("gained", &EffectRow::gained, "Events that it brings.")
        .def_readonly("lost", &EffectRow::lost, "Events that it prevents.")
        .def_readonly("seconds", &EffectRow::seconds, "Of simulate() without it, least of the repeats [s].")
        .def_readonly("steps", &EffectRow::steps, "Without it.")
        .def_readonly("note", &EffectRow::note, "Why there are no numbers, or not all; else empty.")
        .def(py::pickle(
            [](const EffectRow& r) {
                return py::make_tuple(r.effect, r.difference, r.time, r.gained, r.lost, r.seconds, r.steps, r.note);
            },
            [](const py::tuple& d) {
                return EffectRow{d[0].cast<std::string>(),  d[1].cast<double>(),     d[2].cast<double>(),
                                 d[3].cast<int>(),          d[4].cast<int>(),        d[5].cast<double>(),
                                 d[6].cast<std::int64_t>(), d[7].cast<std::string>()};
            }))
        .def("__repr__", [](const EffectRow& r) {
            return "<EffectRow: " + r.effect + ", difference " + rbdyn::text(r.difference) +
                   (r.note.empty() ? "" : ", " + r.note) + ">";
        });

    py::class_<EffectTable> table(
        m, "EffectTable",
        "What each effect does to motion and price: a sequence of EffectRow, also by name. print() shows it.");
    as_sequence<EffectTable, EffectRow>(table, "EffectTable");
    table
        .def(
            "__getitem__", [](const EffectTable& t, const std::string& effect) { return t[effect]; }, py::arg("effect"))
        .def_readonly("seconds", &EffectTable::seconds, "Of simulate() with all of them, least of the repeats [s].")
        .def_readonly("steps", &EffectTable::steps, "With all of them.")
        .def_readonly("events", &EffectTable::events, "With all of them.")
        .def(py::pickle([](const EffectTable& t) { return py::make_tuple(t.rows, t.seconds, t.steps, t.events); },
                        [](const py::tuple& d) {
                            return EffectTable{d[0].cast<std::vector<EffectRow>>(), d[1].cast<double>(),
                                               d[2].cast<std::int64_t>(), d[3].cast<int>()};
                        }))
        .def("__str__", &printed<EffectTable>)
        .def("__repr__",
             [](const EffectTable& t) { return "<EffectTable: " + std::to_string(t.rows.size()) + " rows>"; });
}

}  // namespace

void bind_verbs(py::module_& m) {
    m.attr("__version__") = rbdyn::version;
    m.def(
        "engines", [] { return rbdyn::engines(); },
        R"(The names of the engines that this build has, as engine= takes them beside "auto".

"closed form", "taylor" and "dop853"; with SUNDIALS "cvode-adams" and "cvode-bdf".)");
    bind_effects(m);
    const rbdyn::SimulateOptions defaults;
    m.def("simulate", &simulate, py::arg("scene"), py::arg("until"), py::kw_only(), py::arg("start") = defaults.start,
          py::arg("error") = py::none(), py::arg("rtol") = py::none(), py::arg("engine") = defaults.engine,
          py::arg("keep") = "all", py::arg("max_steps") = defaults.max_steps, py::arg("progress") = false,
          py::arg("initial") = py::none(), py::arg("events") = "all",
          R"(Runs a scene, as accurately as asked for.

until, start: times [s]. until may be inf where something can stop the run: a watched function with action "stop", or the
end of a rail.
error: global, of each quantity relative to its own scale in the motion, 1e-9 by default; the scene is run again more
accurately until the two agree. rtol, instead of it: local tolerance only, no estimate: the cheap way.
engine: "auto", "closed form", "taylor", "dop853", "cvode-adams" or "cvode-bdf" (engines() tells what this build has).
keep: "all" of the motion, its "end", or times [s]. A RuntimeWarning tells, with figures, of a run that would need more
than half of the memory there is. max_steps: of each integration.
progress: True for a bar, or a function of the fraction done; it starts again with each integration.
initial: where this run starts, by handle and word of add(), as in {(wheel, "rate"): 3.0}; the rest as the scene has it,
and the scene stays as it is.
events: "all" are kept; the "last" of each kind, name and subject with its count; or a function that is called with each
Event of the run that is returned, once and in order, of which only those that end the run are kept then: with rtol while it
runs, so that long runs with keep="end" take no more memory, else when it is judged.
Bodies that nothing joins are solved apart (plan(scene).parts), and the run is one.

Raises InvalidInput for what breaks a rule, AccuracyError if the error is out of reach, IntegrationError if the motion
cannot be continued; the last two, KeyboardInterrupt and what `progress` raises carry the partial run as `.run`.
Other threads run meanwhile.)");
    m.def("simulate", &simulate_on, py::arg("run"), py::arg("until"), py::kw_only(), py::arg("error") = py::none(),
          py::arg("rtol") = py::none(), py::arg("engine") = py::none(), py::arg("keep") = py::none(),
          py::arg("max_steps") = py::none(), py::arg("progress") = false, py::arg("events") = "all",
          R"(Goes on with a run: from its end, or from run.certain_until if the error asked for was not reached.

The options are those of the run where none are given; its scene and its numbers are as it had them. The motion, what
sticks and touches, and the estimate of the error are those of a run that was not interrupted; the events at the time
where it starts are of the run before.

Raises what simulate() of a scene does, and InvalidInput where there is nothing to go on with: at the end of a rail.)");
    m.def("simulate", &simulate_top, py::arg("model"), py::arg("state"), py::arg("until"), py::kw_only(),
          py::arg("start") = defaults.start, py::arg("error") = py::none(), py::arg("rtol") = py::none(),
          py::arg("engine") = defaults.engine, py::arg("keep") = "all", py::arg("max_steps") = defaults.max_steps,
          py::arg("progress") = false,
          R"(Runs a model of its own from a state, as accurately as asked for: an EulerTop, and its six variables.

The options are those of a scene; "auto" is "taylor". error: of each variable relative to its own scale.)");
    m.def("simulate", &simulate_system, py::arg("system"), py::arg("until"), py::kw_only(),
          py::arg("start") = defaults.start, py::arg("error") = py::none(), py::arg("rtol") = py::none(),
          py::arg("engine") = defaults.engine, py::arg("keep") = "all", py::arg("max_steps") = defaults.max_steps,
          py::arg("progress") = false, py::arg("initial") = py::none(), py::arg("events") = "all",
          R"(Runs first-order equations of one's own, as accurately as asked for: a System.

The options are those of a scene; "auto" is "taylor", or "dop853" where f is called back. error: of each variable relative
to its largest size. initial: the state this run starts in, (n,) or {name or place: number}.

Raises what simulate() of a scene does; the errors carry the partial run as `.run`.)");
    m.def(
        "effects", &effects, py::arg("scene"), py::arg("until"), py::kw_only(), py::arg("start") = defaults.start,
        py::arg("error") = py::none(), py::arg("rtol") = py::none(), py::arg("engine") = defaults.engine,
        py::arg("max_steps") = defaults.max_steps,
        R"(What each effect of a scene does to its motion and its price: the scene is run as it is, and without each of them.

Arguments as for simulate(). The difference is that of the states at the end, in the scales of the motion: of each body
the place of its centre of mass to the extent of the motion, velocity and angular velocity to their largest size (of
whichever run has more), the attitude in radians; the largest of these. Events are gained or lost by kind, name and
subject.

Raises what simulate() raises for the scene as it is; what goes wrong without an effect is the note of its row.)");
}

}  // namespace binding
