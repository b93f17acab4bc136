// What a run cost, as Python has it.
#include "data.hpp"
#include "run.hpp"

namespace binding {

using rbdyn::Statistics;

namespace {

std::vector<std::pair<double, std::string>> changes_of(const Statistics& s) {
    std::vector<std::pair<double, std::string>> changes;
    for (const rbdyn::EngineChange& c : s.changes) changes.emplace_back(c.time, c.engine);
    return changes;
}
py::tuple data_of(const Statistics& s) {
    return py::make_tuple(s.seconds, s.planning_seconds, s.integration_seconds, s.judging_seconds, s.steps, s.rejected,
                          s.right_hand_sides, s.jacobians, s.guard_evaluations, s.events, s.python_calls, s.runs,
                          s.size, s.planned, changes_of(s));
}
Statistics statistics_from(const py::tuple& d) {
    Statistics s;
    s.seconds = d[0].cast<double>();
    s.planning_seconds = d[1].cast<double>();
    s.integration_seconds = d[2].cast<double>();
    s.judging_seconds = d[3].cast<double>();
    std::int64_t* counts[] = {&s.steps,  &s.rejected,    &s.right_hand_sides, &s.jacobians, &s.guard_evaluations,
                              &s.events, &s.python_calls};
    for (std::size_t i = 0; i < std::size(counts); ++i) *counts[i] = d[i + 4].cast<std::int64_t>();
    s.runs = d[11].cast<int>();
    s.size = d[12].cast<rbdyn::Size>();
    s.planned = d[13].cast<bool>();
    if (d.size() > 14)
        for (auto& [time, engine] : d[14].cast<std::vector<std::pair<double, std::string>>>())
            s.changes.push_back({time, std::move(engine)});
    return s;
}

}  // namespace

void bind_statistics(py::module_& m) {
    py::class_<Statistics>(m, "Statistics", "The price of a run. print() shows it.")
        .def_readonly("seconds", &Statistics::seconds, "The whole call, by the clock [s].")
        .def_readonly("planning_seconds", &Statistics::planning_seconds,
                      "Of it: reading the scene, or finding that its plan holds [s].")
        .def_readonly("integration_seconds", &Statistics::integration_seconds, "Of it: the returned motion alone [s].")
        .def_readonly("judging_seconds", &Statistics::judging_seconds,
                      "Of it: all that tells the error, so the runs it is compared with; 0 with rtol= [s].")
        .def_readonly("steps", &Statistics::steps, "Of the returned motion.")
        .def_readonly("rejected", &Statistics::rejected, "Steps tried in vain.")
        .def_readonly("right_hand_sides", &Statistics::right_hand_sides, "For Taylor series: orders computed.")
        .def_readonly("jacobians", &Statistics::jacobians, "Of the right-hand side, computed for stiff engines.")
        .def_readonly("guard_evaluations", &Statistics::guard_evaluations,
                      "Of functions whose zeros are looked for, where they were called for numbers.")
        .def_readonly("events", &Statistics::events, "How many there are.")
        .def_readonly("python_calls", &Statistics::python_calls, "Calls of functions that could not be recorded.")
        .def_readonly("runs", &Statistics::runs, "Integrations, those for the estimate counted.")
        .def_readonly("planned", &Statistics::planned, "Whether it was planned anew, and not as an earlier run was.")
        .def_property_readonly(
            "changes", &changes_of,
            "Where \"auto\" changed the engine in the returned motion, for it was stiff or was so no "
            "longer: (time [s], engine), in order.")
        .def_readonly("size", &Statistics::size, "Of the equations the motion began with; of several parts the sum.")
        .def("__eq__",
             [](const Statistics& a, const py::object& b) {
                 return py::isinstance<Statistics>(b) && data_of(a).equal(data_of(b.cast<const Statistics&>()));
             })
        .def(py::pickle([](const Statistics& s) { return data_of(s); }, &statistics_from))
        .def("__str__", &printed<Statistics>)
        .def("__repr__", [](const Statistics& s) { return "<Statistics: " + printed(s) + ">"; });
}

}  // namespace binding
