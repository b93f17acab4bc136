// First-order systems of one's own: what they are made of, and their runs. simulate() of them is in verbs.cpp.
#include "system.hpp"

#include <rbdyn/system/system_plan.hpp>

#include "recording.hpp"
#include "run.hpp"
#include "watch.hpp"

namespace binding {

using rbdyn::OwnFunction, rbdyn::StateAction, rbdyn::System, rbdyn::SystemPlan, rbdyn::SystemRun;

namespace {

/// The present moment of a motion, in expressions or in numbers.
struct SystemNow {
    py::object time, x;
    System system;
    std::shared_ptr<std::string> lack;  // what it was asked for and does not have
};

int place_of(const System& system, const py::object& which, const std::string& user) {
    if (py::isinstance<py::str>(which)) return system.place(plain(which));
    const auto n = static_cast<py::ssize_t>(system.variables());
    const py::ssize_t i = PyNumber_AsSsize_t(which.ptr(), PyExc_IndexError);
    if (i == -1 && PyErr_Occurred() != nullptr) {
        PyErr_Clear();
        throw InvalidInput(user + ": a variable is " + shown(which) + "; it is a name or a place, from 0");
    }
    if (i < -n || i >= n)
        throw py::index_error(user + ": there is no variable " + std::to_string(i) + "; there are " +
                              std::to_string(n));
    return static_cast<int>(i < 0 ? i + n : i);
}

py::array_t<double> array_of(std::span<const double> x) {
    return py::array_t<double>(static_cast<py::ssize_t>(x.size()), x.data());
}

py::object now_in_numbers(const System& system, double t, std::span<const double> x) {
    return py::cast(SystemNow{py::float_(t), array_of(x), system, std::make_shared<std::string>()});
}

/// A function of the user's that is called with numbers; any thread may copy and drop it.
struct StateFunction {
    py::object f;
    System system;
    std::string user;
};
std::shared_ptr<const StateFunction> state_function(const py::object& f, const System& system,
                                                    const std::string& user) {
    return {new StateFunction{f, system, user}, [](const StateFunction* c) {
                if (Py_IsInitialized() == 0) return;
                const py::gil_scoped_acquire lock;
                delete c;
            }};
}

/// Recorded if it can be and `trace` is not false, else called back.
OwnFunction watched_state(const py::object& f, const System& system, std::optional<bool> trace,
                          const std::string& user) {
    if (PyCallable_Check(f.ptr()) == 0)
        throw InvalidInput(user + ": " + shown(f) + " is no function; give function(now)");
    const int n = system.variables();
    std::string reason = "trace=False";
    if (trace.value_or(true)) {
        const auto lack = std::make_shared<std::string>();
        const Attempt a = attempt(
            f,
            [&](Recording& recording) {
                return py::make_tuple(SystemNow{recording.input(0), recording.inputs(1, {n}), system, lack});
            },
            [&](const py::object& returned) { return std::vector<Expression>{one_expression(returned, user)}; });
        if (a.function) return OwnFunction(with_inputs(a.function, 1 + n), user);
        if (!lack->empty()) throw InvalidInput(user + ": " + *lack);
        if (trace.value_or(false)) throw InvalidInput(user + ": its function cannot be recorded: " + a.reason);
        reason = a.reason;
    }
    auto callback = std::make_shared<rbdyn::Callback>();
    callback->name = name_of(f);
    callback->reason = reason;
    callback->inputs = 1 + n;
    callback->outputs = 1;
    callback->is_python = true;
    callback->function = [c = state_function(f, system, user), n](const double* x, double* y) {
        const py::gil_scoped_acquire lock;
        const CallingBack here;
        *y = one_number(c->f(now_in_numbers(c->system, *x, {x + 1, static_cast<std::size_t>(n)})), c->user);
    };
    return OwnFunction(std::move(callback));
}

/// The place of a variable that a state is given for, which is no subscript.
int changed_place(const System& system, const py::object& which, const std::string& user, const std::string& what) {
    try {
        return place_of(system, which, user);
    } catch (const py::index_error&) {
        throw InvalidInput(user + ": " + what + " is for a variable " + shown(which) +
                           "; variables are named, or have a place from 0 to " +
                           std::to_string(system.variables() - 1));
    }
}

/// The state that is meant by what a user gives for it: all of it, or some of its numbers by name or place.
std::vector<double> state_from(const py::object& given, const System& system, std::vector<double> x,
                               const std::string& user, const std::string& what) {
    if (given.is_none()) return x;
    if (PyDict_Check(given.ptr()) == 0) {
        x = list_of_doubles(given, user, what);
        rbdyn::require(static_cast<int>(x.size()) == system.variables(), user, "count of numbers of " + what,
                       static_cast<double>(x.size()),
                       "the state has " + std::to_string(system.variables()) +
                           " variables; some of them are given as {name or place: number}");
        return x;
    }
    for (const auto& [which, value] : given.cast<py::dict>()) {
        const int place = changed_place(system, py::reinterpret_borrow<py::object>(which), user, what);
        x[static_cast<std::size_t>(place)] = number(value, user, system.name(place) + " of " + what);
    }
    return x;
}

StateAction action_of(const py::object& action, const System& system, const std::string& user) {
    using Kind = rbdyn::WatchAction::Kind;
    if (py::isinstance<py::str>(action))
        return {one_of<Kind>(plain(action), {{"record", Kind::record}, {"stop", Kind::stop}}, user, "action"), {}};
    if (PyCallable_Check(action.ptr()) == 0)
        throw InvalidInput(user + ": action is " + shown(action) +
                           "; it is \"record\", \"stop\", or a function of now");
    return {Kind::change, [c = state_function(action, system, user)](double t, std::span<const double> x) {
                const py::gil_scoped_acquire lock;
                const CallingBack here;
                const py::object returned = c->f(now_in_numbers(c->system, t, x));
                return state_from(returned, c->system, {x.begin(), x.end()}, c->user, "what its action returns");
            }};
}

BoundSystem make_system(const py::object& f, const ArrayLike& x0, const std::vector<std::string>& names,
                        std::optional<bool> trace) {
    const std::vector<double> start = list_of_doubles(x0, "System", "x0");
    if (start.empty())
        throw InvalidInput("System: x0 has 0 numbers; it is the state to start in, one for each variable");
    UserFunction rates = user_rates(f, static_cast<int>(start.size()), trace, "System");
    OwnFunction own = rates.callback ? OwnFunction(rates.callback) : OwnFunction(rates.function, rates.name);
    return {System(std::move(own), start, names), std::move(rates)};
}

void watch_state(BoundSystem& self, const std::string& name, const py::object& function, const std::string& direction,
                 const ActionName& action, std::optional<bool> trace) {
    const std::string user = "watch \"" + name + "\"";
    self.system.watch(name, watched_state(function, self.system, trace, user),
                      {one_of(direction, directions, user, "direction"), action_of(action, self.system, user)});
}

// --- as data ---

const rbdyn::Function& traced(const OwnFunction& f, const std::string& user) {
    if (f.callback()) throw py::type_error(user + " is called back, and only what is traced can be pickled");
    return f.function();
}

py::tuple data_of(const BoundSystem& s) {
    py::list watches;
    for (const System::Watch& w : s.system.watches()) {
        const std::string user = "System: watch \"" + w.name + "\"";
        if (w.options.action.change)
            throw py::type_error(user + " has an action in Python, and only what is traced can be pickled");
        watches.append(py::make_tuple(w.name, traced(w.function, user), word_for(w.options.direction, directions),
                                      w.options.action.kind == rbdyn::WatchAction::Kind::stop ? "stop" : "record"));
    }
    return py::make_tuple(traced(s.system.function(), "System: f"), s.system.start(), s.system.names(), watches);
}

BoundSystem system_from(const py::tuple& d) {
    const auto f = d[0].cast<rbdyn::Function>();
    BoundSystem result{
        System(OwnFunction(f, "f"), d[1].cast<std::vector<double>>(), d[2].cast<std::vector<std::string>>()),
        {f, nullptr, "f"}};
    for (const py::handle item : d[3]) {
        const auto w = item.cast<py::tuple>();
        const auto name = w[0].cast<std::string>();
        result.system.watch(name, OwnFunction(w[1].cast<rbdyn::Function>(), name),
                            {one_of(w[2].cast<std::string>(), directions, "System", "direction"),
                             action_of(w[3], result.system, "System")});
    }
    return result;
}

/// One variable of a run.
struct RunVariable {
    SystemRun run;
    int place;
};

void bind_system_run(py::module_& m) {
    const auto at = [](const SystemRun& run, const ArrayLike& times, const SideName& name) {
        const rbdyn::Side side = side_of(name);
        return states_over(times, run.system().variables(), "SystemRun", [&](double t) { return run.x(t, side); });
    };
    const auto rate_at = [](const SystemRun& run, const ArrayLike& times, const SideName& name) {
        const rbdyn::Side side = side_of(name);
        return states_over(times, run.system().variables(), "SystemRun", [&](double t) { return run.rate(t, side); });
    };
    py::class_<RunVariable>(m, "SystemVariable", "A variable of a run of a System, each quantity a method of time.")
        .def_property_readonly(
            "name", [](const RunVariable& v) { return v.run.system().name(v.place); }, "Its name, or \"x[2]\".")
        .def(
            "value",
            [](const RunVariable& v, const ArrayLike& t, const SideName& name) {
                const rbdyn::Side side = side_of(name);
                const auto i = static_cast<std::size_t>(v.place);
                return over(t, "SystemRun", "time", [&](double s) { return v.run.x(s, side)[i]; });
            },
            py::arg("t"), py::arg("side") = after(), "At a time, a number or an array.")
        .def(
            "rate",
            [](const RunVariable& v, const ArrayLike& t, const SideName& name) {
                const rbdyn::Side side = side_of(name);
                const auto i = static_cast<std::size_t>(v.place);
                return over(t, "SystemRun", "time", [&](double s) { return v.run.rate(s, side)[i]; });
            },
            py::arg("t"), py::arg("side") = after(), "Its derivative in time there.")
        .def("__repr__", [](const RunVariable& v) { return "<SystemVariable: " + v.run.system().name(v.place) + ">"; });

    py::class_<SystemRun>(m, "SystemRun", R"(The motion of a System: its state at any time. print() shows it.

run.x(t) is the state, run["theta"] or run[0] one variable. It owns all it needs and outlives its system.)")
        .def_property_readonly(
            "status", [](const SystemRun& r) { return name_of(r.status()); },
            "reached end, stopped by event, stopped by user, step limit, not finite, accuracy not reached or "
            "inconsistent.")
        .def_property_readonly(
            "advice", [](const SystemRun& r) { return advice(r.status()); }, "What to do about the status.")
        .def_property_readonly("start", &SystemRun::start, "Its first time.")
        .def_property_readonly("end", &SystemRun::end, "Its last time.")
        .def_property_readonly("certain_until", &SystemRun::certain_until,
                               "The time up to which the motion is as accurate as asked for.")
        .def_property_readonly("engine", &SystemRun::engine, "What computed it.")
        .def_property_readonly(
            "error", &SystemRun::error,
            "Estimated global error, each variable relative to its largest size in this motion; None "
            "with rtol.")
        .def_property_readonly("statistics", &SystemRun::statistics, "What it cost.")
        .def_property_readonly(
            "events",
            [](const SystemRun& r) {
                std::vector<std::string> watches;
                for (const System::Watch& w : r.system().watches()) watches.push_back(w.name);
                return events_object(r.events(), watches);
            },
            "What happened, in order of time: Events.")
        .def_property_readonly(
            "names", [](const SystemRun& r) { return r.system().names(); },
            "Of the variables; empty if they have none.")
        .def_property_readonly(
            "t", [](const SystemRun& r) { return array_of(r.times()); }, "The ends of the integrator's pieces (k,).")
        .def("x", at, py::arg("t"), py::arg("side") = after(),
             R"(The state at a time (n,), or at an array of k times (k, n).

side: at a jump the state "after" it, or "before". Raises InvalidInput for a time the run does not hold.)")
        .def("rate", rate_at, py::arg("t"), py::arg("side") = after(),
             R"(Its derivative in time, (n,) or (k, n): f on the side of each case distinction that the motion is on.)")
        .def(
            "__getitem__",
            [](const SystemRun& r, const py::object& variable) {
                return RunVariable{r, place_of(r.system(), variable, "SystemRun")};
            },
            py::arg("variable"))
        .def(
            "sample",
            [](const py::object& self, const py::object& times) {
                return py::module_::import("rbdyn.system_sample").attr("SystemSample")(self, times);
            },
            py::arg("times") = py::none(),
            "A SystemSample: all variables at times (k,), by default at run.t; with tables of them.")
        .def(py::pickle(
            [](const SystemRun& r) {
                const System& s = r.system();
                return py::make_tuple(BoundSystem{s, {s.function().function(), s.function().callback(), "f"}},
                                      py::bytes(rbdyn::bytes_of(r)));
            },
            [](const py::tuple& d) {
                return rbdyn::system_run_from(d[0].cast<const BoundSystem&>().system,
                                              std::string(d[1].cast<py::bytes>()));
            }))
        .def("__str__", &printed<SystemRun>)
        .def("__repr__", [](const SystemRun& r) {
            return "<SystemRun: " + std::string(name_of(r.status())) + " at t = " + rbdyn::text(r.end()) + ">";
        });
}

void bind_system_plan(py::module_& m) {
    py::class_<SystemPlan>(m, "SystemPlan",
                           "The decisions made from a System before anything is computed. print() shows them.")
        .def_readonly("variables", &SystemPlan::variables, "Their names.")
        .def_readonly("guards", &SystemPlan::guards, "What is watched for where the motion begins.")
        .def_readonly("functions", &SystemPlan::functions, "The user's own: traced, or called back and why.")
        .def_readonly("engine", &SystemPlan::engine, "The automatic choice.")
        .def_readonly("reason", &SystemPlan::reason, "Why that engine.")
        .def_readonly("size", &SystemPlan::size, "Of the equations that a motion from time 0 begins with.")
        .def("__str__", &printed<SystemPlan>)
        .def("__repr__", [](const SystemPlan& p) {
            return "<SystemPlan: " + std::to_string(p.variables.size()) + " variables, engine " + p.engine + ">";
        });
    m.def(
        "plan", [](const BoundSystem& system) { return make_plan(system.system); }, py::arg("system"),
        "The same of a System: variables, guards, functions, engine.");
}

}  // namespace

System started(const System& system, const py::object& initial, const std::string& user) {
    return initial.is_none() ? system : system.from(state_from(initial, system, system.start(), user, "initial"));
}

void bind_system(py::module_& m) {
    py::class_<SystemNow> now(m, "SystemNow",
                              "The present moment of a System: what its watched functions are called with.");
    now.def_property_readonly(
           "time", [](const SystemNow& n) { return n.time; }, "The time.")
        .def_property_readonly(
            "x", [](const SystemNow& n) { return n.x; }, "The state (n,).")
        .def(
            "__getitem__",
            [](const SystemNow& n, const py::object& variable) {
                try {
                    return py::object(n.x[py::int_(place_of(n.system, variable, "SystemNow"))]);
                } catch (const std::exception& e) {
                    *n.lack = e.what();
                    throw;
                }
            },
            py::arg("variable"), "A variable by its name or place.");
    // no part of its signature: type checkers know what there is
    now.attr("__getattr__") = py::cpp_function(
        [](const SystemNow& n, const std::string& name) -> py::object {
            *n.lack = "SystemNow has no " + name + "; it has time, x, and variables by name or place: now[\"theta\"]";
            throw py::attribute_error(*n.lack);
        },
        py::is_method(now), py::name("__getattr__"));

    py::class_<BoundSystem>(m, "System", R"(First-order equations of one's own, x' = f(t, x), simulated like a scene.

    pendulum = rb.System(lambda t, x: [x[1], -9.81 * np.sin(x[0])], [1.0, 0.0], names=["angle", "rate"])
    pendulum.watch("lowest point", lambda now: now["angle"])
    run = rb.simulate(pendulum, until=10.0)
    run.x(5.0), run["angle"].value(5.0), run.events.times("lowest point")

Units are the user's; errors are relative to the largest size of each variable in the motion.)")
        .def(
            py::init(&make_system), py::arg("f"), py::arg("x0"), py::kw_only(),
            py::arg("names") = std::vector<std::string>{}, py::arg("trace") = py::none(),
            R"(f: f(t, x) -> the rates (n,) of the variables x (n,), an array or a list; x0: the state to start in (n,).

names: of the variables. f is recorded, with the cases it distinguishes, and runs at native speed; what cannot be recorded
is called back (trace as for Force), and so is a compiled function, void (double t, double *x, double *rates). Raises
InvalidInput for what is no state, and for rates that are not as many.)")
        .def_property_readonly(
            "x0", [](const BoundSystem& s) { return array_of(s.system.start()); }, "The state it starts in (n,).")
        .def_property_readonly(
            "names", [](const BoundSystem& s) { return s.system.names(); },
            "Of the variables; empty if they have none.")
        .def_property_readonly(
            "f", [](const BoundSystem& s) { return s.f; }, "f as it is run: recorded, or called back and why.")
        .def_property_readonly(
            "parameters",
            [](const BoundSystem& s) {
                std::vector<py::object> parameters;
                for (const rbdyn::Parameter& p : s.system.numbers().cells) parameters.push_back(parameter_object(p));
                return parameters;
            },
            "The numbers by reference that it uses: each Parameter once.")
        .def("watch", &watch_state, py::arg("name"), py::arg("function"), py::kw_only(),
             py::arg("direction") = "either", py::arg("action") = "record", py::arg("trace") = py::none(),
             R"(Watches a function of the motion: where it passes zero is an event of kind "watch".

function: function(now) -> number, with now.time, now.x (n,) and now["angle"] or now[0]. direction: "rising", "falling" or
"either". action: "record" it, "stop" the run there, or a function of now (numbers) that returns the state after it: all of
it (n,), or {name or place: number}. trace as for Force. Raises InvalidInput for a name that is taken.)")
        .def(py::pickle([](const BoundSystem& s) { return data_of(s); }, &system_from))
        .def("__copy__", [](const BoundSystem& s) { return BoundSystem(s); })
        .def(
            "__deepcopy__", [](const BoundSystem& s, const py::dict&) { return BoundSystem(s); }, py::arg("memo"))
        .def("__repr__", [](const BoundSystem& s) {
            const int n = s.system.variables();
            return "<System: " + std::to_string(n) + (n == 1 ? " variable" : " variables") + ", f " +
                   (s.system.calls_back() ? "called back" : "recorded") + ">";
        });
    bind_system_plan(m);
    bind_system_run(m);
}

}  // namespace binding
