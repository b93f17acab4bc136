// What verbs that run scenes share.
#include "running.hpp"

#include <algorithm>

namespace binding {

namespace {

int& nested() {
    static thread_local int value = 0;
    return value;
}

}  // namespace

Watch::Watch(const py::object& progress) {
    if (nested() >= most_nested)
        throw InvalidInput("simulate: it is called within itself " + std::to_string(nested()) +
                           " deep, by functions that it calls back; simulate beforehand what they need");
    if (PyBool_Check(progress.ptr())) {
        if (progress.is(py::bool_(true))) show_ = py::module_::import("rbdyn.progress").attr("Bar")();
    } else if (PyCallable_Check(progress.ptr()) != 0) {
        show_ = progress;
    } else {
        throw InvalidInput("simulate: progress is " + shown(progress) +
                           "; it is True, False, or a function of the fraction done");
    }
    ++nested();
}

Watch::~Watch() {
    --nested();
    if (!show_ || !py::hasattr(show_, "close")) return;
    try {
        show_.attr("close")();
    } catch (py::error_already_set& e) {
        e.discard_as_unraisable("progress");
    }
}

bool Watch::goes_on(double fraction) {
    if (raised_) return false;
    const Clock::time_point now = Clock::now();
    if (now - last_ < interval) return true;
    const py::gil_scoped_acquire lock;
    look(fraction);
    last_ = Clock::now();
    return !raised_;
}

void Watch::look(double fraction) {
    if (raised_) return;
    try {
        if (PyErr_CheckSignals() != 0) throw py::error_already_set();
        if (show_) show_(fraction);
    } catch (py::error_already_set& e) {
        raised_.emplace(e);
    }
}

void Watch::say(const std::string& sentence) {
    const py::gil_scoped_acquire lock;
    if (raised_) return;
    // of the line that called the verb, which is a function of Python's (python/rbdyn/signatures.py)
    constexpr int caller = 2;
    if (PyErr_WarnEx(PyExc_RuntimeWarning, sentence.c_str(), caller) != 0) raised_.emplace();
}

rbdyn::KeepEvents events_of(const py::object& events, const std::shared_ptr<const Handles>& handles) {
    using What = rbdyn::KeepEvents::What;
    if (py::isinstance<py::str>(events))
        return {one_of<What>(plain(events), {{"all", What::all}, {"last", What::last}}, "simulate", "events"), {}};
    if (PyCallable_Check(events.ptr()) == 0)
        throw InvalidInput("simulate: events is " + shown(events) +
                           "; it is \"all\", \"last\", or a function of an Event");
    // any thread may drop it
    const std::shared_ptr<const py::object> f(new py::object(events), [](const py::object* one) {
        if (Py_IsInitialized() == 0) return;
        const py::gil_scoped_acquire lock;
        delete one;
    });
    return {What::all, [f, handles](const rbdyn::Event& e) {
                const py::gil_scoped_acquire lock;
                (*f)(bound(e, *handles));
            }};
}

rbdyn::Keep keep_of(const KeepLike& keep) {
    using What = rbdyn::Keep::What;
    if (const auto* times = std::get_if<ArrayLike>(&keep)) {
        rbdyn::Keep result{What::times, list_of_doubles(*times, "simulate", "keep")};
        std::sort(result.times.begin(), result.times.end());
        return result;
    }
    const auto& name = std::get<std::string>(keep);
    if (name == "all") return {What::all, {}};
    if (name == "end") return {What::end, {}};
    throw InvalidInput("simulate: keep is \"" + name + "\"; it is \"all\", \"end\", or a list of times");
}

rbdyn::SimulateOptions options_of(double until, double start, std::optional<double> error, std::optional<double> rtol,
                                  const std::string& engine, const KeepLike& keep, std::int64_t max_steps) {
    if (error && rtol)
        throw InvalidInput("simulate: both error " + rbdyn::text(*error) + " and rtol " + rbdyn::text(*rtol) +
                           " are given; error is global and estimated, rtol local and without an estimate: give one");
    rbdyn::SimulateOptions options;
    options.until = until;
    options.start = start;
    options.error = error.value_or(options.error);
    options.rtol = rtol;
    options.engine = engine;
    options.keep = keep_of(keep);
    options.max_steps = max_steps;
    return options;
}

bool calls_python(const rbdyn::Scene& scene) {
    const auto is_python = [](const auto& l) {
        const auto* force = std::get_if<rbdyn::Force>(&l.load);
        return force != nullptr && force->callback() && force->callback()->is_python;
    };
    const auto is_called = [](const auto& w) { return !w.function.is_recorded(); };
    return std::any_of(scene.loads().begin(), scene.loads().end(), is_python) ||
           std::any_of(scene.watches().begin(), scene.watches().end(), is_called);
}

py::object failure_of(const std::exception_ptr& thrown, const py::object& run) {
    const auto with_run = [&](const char* type, const char* what) {
        const py::object raised = py::module_::import("rbdyn.errors").attr(type)(what);
        raised.attr("run") = run;
        return raised;
    };
    try {
        std::rethrow_exception(thrown);
    } catch (py::error_already_set& e) {
        if (PyObject_SetAttrString(e.value().ptr(), "run", run.ptr()) != 0) PyErr_Clear();
        // the frames of the user's function: whoever raises the value again would lose them
        if (e.trace()) PyException_SetTraceback(e.value().ptr(), e.trace().ptr());
        return e.value();
    } catch (const InvalidInput& e) {
        return with_run("InvalidInput", e.what());
    } catch (const rbdyn::Error& e) {
        return with_run("Error", e.what());
    }
}

void raise(const py::object& error) {
    PyErr_SetObject(py::type::handle_of(error).ptr(), error.ptr());
    throw py::error_already_set();
}

}  // namespace binding
