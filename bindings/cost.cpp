// cost(): its list of prices. It runs without Python's lock, looks for Ctrl-C and shows progress.
#include <optional>
#include <rbdyn/cost.hpp>
#include <rbdyn/simulate.hpp>

#include "rows.hpp"
#include "running.hpp"
#include "system.hpp"

namespace binding {

using rbdyn::CostRow, rbdyn::MissingEngine, rbdyn::Prediction, rbdyn::Price;

namespace {

rbdyn::CostOptions options_of(double until, double start, const std::optional<ArrayLike>& errors,
                              const std::optional<std::vector<std::string>>& engines, double budget, Watch& watch) {
    rbdyn::CostOptions options;
    options.until = until;
    options.start = start;
    if (errors) options.errors = list_of_doubles(*errors, "cost", "errors");
    if (engines) options.engines = *engines;
    if (engines && engines->empty())
        throw InvalidInput("cost: engines is empty; name those to price, or leave it out for all");
    options.budget = budget;
    options.monitor = watch.monitor(0.0, budget);
    return options;
}

Price cost(const BoundScene& scene, double until, double start, const std::optional<ArrayLike>& errors,
           const std::optional<std::vector<std::string>>& engines, double budget, const py::object& progress) {
    const rbdyn::Scene copy = scene.scene;
    Watch watch(progress);
    const rbdyn::CostOptions options = options_of(until, start, errors, engines, budget, watch);
    return tabulated(copy, scene.handles, watch, [&] { return rbdyn::cost(copy, options); });
}

Price cost_of_system(const BoundSystem& system, double until, double start, const std::optional<ArrayLike>& errors,
                     const std::optional<std::vector<std::string>>& engines, double budget,
                     const py::object& progress) {
    const rbdyn::System copy = system.system;
    Watch watch(progress);
    const rbdyn::CostOptions options = options_of(until, start, errors, engines, budget, watch);
    std::optional<Price> price;
    try {
        const Unlocked free(!copy.calls_python());
        price = rbdyn::cost(copy, options);
    } catch (const rbdyn::SystemError& e) {
        const bool is_inaccurate = e.run.status() == rbdyn::Status::accuracy_not_reached;
        raise(error_with(e.run, is_inaccurate ? "AccuracyError" : "IntegrationError", e.what()));
    }
    watch.look(1.0);
    watch.raise_if_raised<rbdyn::SystemRun>(std::nullopt);
    return *std::move(price);
}

py::tuple data_of(const CostRow& r) {
    return py::make_tuple(r.engine, r.tolerance, r.motion_error, r.event_error, r.events, r.events_expected,
                          r.has_all_events, r.seconds, r.spread, r.total, r.steps, r.right_hand_sides, r.error);
}

CostRow row_from(const py::tuple& d) {
    CostRow r{.engine = d[0].cast<std::string>(), .tolerance = d[1].cast<double>()};
    r.motion_error = d[2].cast<double>();
    r.event_error = d[3].cast<double>();
    r.events = d[4].cast<int>();
    r.events_expected = d[5].cast<int>();
    r.has_all_events = d[6].cast<bool>();
    r.seconds = d[7].cast<double>();
    r.spread = d[8].cast<double>();
    r.total = d[9].cast<double>();
    r.steps = d[10].cast<std::int64_t>();
    r.right_hand_sides = d[11].cast<std::int64_t>();
    r.error = d[12].cast<double>();
    return r;
}

void bind_row(py::module_& m) {
    py::class_<CostRow>(m, "CostRow", "One engine at one tolerance: a row of cost().")
        .def_readonly("engine", &CostRow::engine, "What computed it.")
        .def_readonly("tolerance", &CostRow::tolerance, "Local, the rtol= of simulate(); 0 of a closed form.")
        .def_readonly("error", &CostRow::error,
                      "Global, relative: the larger of those of the motion and of the events.")
        .def_readonly("motion_error", &CostRow::motion_error,
                      "Of the motion, measured against the reference, in the scales of the motion; after an event that "
                      "differs of places alone. Of a closed form the estimate of its rounding.")
        .def_readonly("event_error", &CostRow::event_error,
                      "Of the times of events, over the time since the start, up to one that differs.")
        .def_readonly("events", &CostRow::events, "How many were found.")
        .def_readonly("events_expected", &CostRow::events_expected, "How many the reference has.")
        .def_readonly("has_all_events", &CostRow::has_all_events, "Whether those found are those expected.")
        .def_readonly("seconds", &CostRow::seconds,
                      "Of the integration alone, processor time, least of the repeats; of a closed form its set-up and "
                      "one state [s].")
        .def_readonly("spread", &CostRow::spread,
                      "Median of the repeats over the least, less 1; nan if there was time for one only.")
        .def_readonly("total", &CostRow::total,
                      "Of the whole call, simulate() with error= what this row reaches and its engine, planned before, "
                      "processor time; nan if that was not reached or not in time [s].")
        .def_readonly("steps", &CostRow::steps, "Of the integration.")
        .def_readonly("right_hand_sides", &CostRow::right_hand_sides, "For Taylor series: orders computed.")
        .def(py::pickle([](const CostRow& r) { return data_of(r); }, &row_from))
        .def("__repr__", [](const CostRow& r) {
            return "<CostRow: " + r.engine + ", tolerance " + rbdyn::text(r.tolerance) + ", error " +
                   rbdyn::text(r.error) + ", " + rbdyn::text(r.seconds) + " s>";
        });

    py::class_<MissingEngine>(m, "MissingEngine", "An engine that is missing from a list of prices, or from its end.")
        .def_readonly("engine", &MissingEngine::engine, "Its name.")
        .def_readonly(
            "tolerance", &MissingEngine::tolerance,
            "The first that there was no time for, or the last before its floor; 0 if it cannot do the scene.")
        .def_readonly("reason", &MissingEngine::reason,
                      "Why: begins with \"cannot\", \"floor reached\", \"no time left\" or \"stiff\".")
        .def_readonly("seconds", &MissingEngine::seconds, "What it would have taken; nan if that is not known [s].")
        .def(py::pickle(
            [](const MissingEngine& e) { return py::make_tuple(e.engine, e.tolerance, e.reason, e.seconds); },
            [](const py::tuple& d) {
                return MissingEngine{d[0].cast<std::string>(), d[1].cast<double>(), d[2].cast<std::string>(),
                                     d[3].cast<double>()};
            }))
        .def("__repr__", [](const MissingEngine& e) { return "<MissingEngine: " + e.engine + ", " + e.reason + ">"; });

    py::class_<Prediction>(m, "Prediction", "What an accuracy will cost that no row has. print() shows it.")
        .def_readonly("engine", &Prediction::engine, "The quickest there.")
        .def_readonly("tolerance", &Prediction::tolerance, "The rtol= that leads to the error; 0 of a closed form.")
        .def_readonly("seconds", &Prediction::seconds, "Of the integration alone [s].")
        .def_readonly("total", &Prediction::total, "Of simulate() with this error=; nan if that is not known [s].")
        .def_readonly("basis", &Prediction::basis, "The rows it is read from.")
        .def(py::pickle(
            [](const Prediction& p) { return py::make_tuple(p.engine, p.tolerance, p.seconds, p.total, p.basis); },
            [](const py::tuple& d) {
                return Prediction{d[0].cast<std::string>(), d[1].cast<double>(), d[2].cast<double>(),
                                  d[3].cast<double>(), d[4].cast<std::string>()};
            }))
        .def("__str__", &printed<Prediction>)
        .def("__repr__", [](const Prediction& p) { return "<Prediction: " + printed(p) + ">"; });
}

void bind_price(py::module_& m) {
    py::class_<Price> price(m, "Price",
                            "What accuracy costs: a sequence of CostRow, engines over tolerances. print() shows it.");
    as_sequence<Price, CostRow>(price, "Price");
    const auto in_python = [](const char* module, const char* name) { return py::module_::import(module).attr(name); };
    price.def_readonly("missing", &Price::missing, "Engines without a row, or without one as tight as asked for.")
        .def_readonly("automatic", &Price::automatic,
                      "What simulate() takes by itself; \"auto\" where it changes the engine on the way.")
        .def_readonly("reference", &Price::reference, "What errors are measured against, and how sure that is.")
        .def_readonly("seconds", &Price::seconds, "Spent on the list, by the clock [s].")
        .def(
            "cheapest", [](const Price& p, double error) { return p.cheapest(error); }, py::arg("error"),
            "The quickest row that reaches an error and has all events. Raises InvalidInput if none does.")
        .def("predict", &Price::predict, py::arg("error"),
             R"(What an error will cost that no row has, with the engine that is quickest there.

Between two rows of an engine, errors, times and tolerances are interpolated in their logarithms; an error looser than an
engine's loosest row costs what that row does. Raises InvalidInput where no engine has a row as accurate.)")
        .def("front", &Price::front, "The rows than which none is as accurate and quicker, from loose to tight.")
        .def(
            "plot",
            [in_python](const py::object& self, const py::object& path) {
                return in_python("rbdyn.plots", "plot_price")(self, path);
            },
            py::arg("path") = py::none(),
            R"(The work-precision diagram: time over achieved error, written to `path` if given.

A line an engine, dashed for the whole call; the errors of the events' times apart; the front of what is cheapest, and
what simulate() takes by itself, are marked. Returns the matplotlib figure. Raises ImportError if matplotlib is missing.)")
        .def(
            "to_pandas", [in_python](const py::object& self) { return in_python("rbdyn.tables", "price_frame")(self); },
            R"(A pandas.DataFrame: a row a row, with `on_front` and `is_automatic`; what is missing is in its attrs.

Raises ImportError if pandas is missing.)")
        .def("_repr_html_",
             [in_python](const py::object& self) { return in_python("rbdyn.tables", "price_html")(self); })
        .def(py::pickle(
            [](const Price& p) { return py::make_tuple(p.rows, p.missing, p.automatic, p.reference, p.seconds); },
            [](const py::tuple& d) {
                return Price{d[0].cast<std::vector<CostRow>>(), d[1].cast<std::vector<MissingEngine>>(),
                             d[2].cast<std::string>(), d[3].cast<std::string>(), d[4].cast<double>()};
            }))
        .def("__str__", &printed<Price>)
        .def("__repr__", [](const Price& p) { return "<Price: " + std::to_string(p.rows.size()) + " rows>"; });
}

}  // namespace

void bind_cost(py::module_& m) {
    bind_row(m);
    bind_price(m);
    const rbdyn::CostOptions defaults;
    m.def("cost", &cost, py::arg("scene"), py::arg("until"), py::kw_only(), py::arg("start") = defaults.start,
          py::arg("errors") = py::none(), py::arg("engines") = py::none(), py::arg("budget") = defaults.budget,
          py::arg("progress") = false,
          R"(What accuracy costs in time, for a scene: every engine over its tolerances, from loose to tight.

until, start: times [s]. errors: global; an engine begins with the loosest as its tolerance, and is tightened until it
reaches the tightest, or its floor; 1e-3 to 1e-12 by default. engines: all by default, "auto" among them. budget: time to
spend by the clock, the reference included [s]. progress: True for a bar, or a function of the share of the budget that is
spent. What could not be had within it stands in `missing`, with the time it would have taken.

Raises InvalidInput for what breaks a rule, and what simulate() raises of a scene that has no motion up to `until`.)");
    m.def("cost", &cost_of_system, py::arg("system"), py::arg("until"), py::kw_only(),
          py::arg("start") = defaults.start, py::arg("errors") = py::none(), py::arg("engines") = py::none(),
          py::arg("budget") = defaults.budget, py::arg("progress") = false,
          R"(The same for first-order equations of one's own: a System.)");
}

}  // namespace binding
