// Sweeps: one scene, many starts and numbers. What python/rbdyn/sweep.py runs them by.
#include <algorithm>
#include <rbdyn/simulate_many.hpp>
#include <rbdyn/trajectory/run_bytes.hpp>

#include "running.hpp"
#include "starts.hpp"

namespace binding {

namespace {

using rbdyn::Variation;

/// What one member has of its own, from arrays over the members.
class Varied {
public:
    Varied(const BoundScene& scene, const py::dict& vary) : scene_(scene.scene), tried_(scene.scene) {
        for (const auto& [key, values] : vary) {
            if (py::isinstance<rbdyn::Parameter>(key)) {
                numbers_.emplace_back(key.cast<const rbdyn::Parameter&>(), py::reinterpret_borrow<py::object>(values));
                continue;
            }
            const auto [body, word] = word_of(scene.handles, key, "simulate_many");
            auto place = std::find_if(words_.begin(), words_.end(),
                                      [index = body.index](const Words& w) { return w.body.index == index; });
            if (place == words_.end()) place = words_.insert(words_.end(), {body, {}});
            place->of.emplace_back(word, py::reinterpret_borrow<py::object>(values));
        }
    }

    Variation member(py::ssize_t i) {
        Variation v;
        const py::int_ index(i);
        try {
            for (const Words& w : words_) {
                const rbdyn::Scene::Body& kept = scene_.bodies()[static_cast<std::size_t>(w.body.index)];
                StartWords words{{}, kept.name, "simulate_many", false};
                for (const auto& [word, values] : w.of) words.given[py::str(word)] = values[index];
                tried_.replace(w.body, rbdyn::Started(kept));
                restart(tried_, w.body, words);
                v.starts.emplace_back(w.body, rbdyn::Started(tried_.bodies()[static_cast<std::size_t>(w.body.index)]));
            }
            for (const auto& [parameter, values] : numbers_)
                v.numbers.emplace_back(parameter, number(values[index], "simulate_many", parameter.description()));
            const rbdyn::BoundParameters accepted(v.numbers);
        } catch (const InvalidInput& e) {
            throw InvalidInput("simulate_many, member " + std::to_string(i) + ": " + e.what());
        }
        return v;
    }

private:
    struct Words {
        rbdyn::BodyHandle body;
        std::vector<std::pair<std::string, py::object>> of;
    };
    const rbdyn::Scene& scene_;
    rbdyn::Scene tried_;
    std::vector<Words> words_;
    std::vector<std::pair<rbdyn::Parameter, py::object>> numbers_;
};

std::vector<Variation> variations(const BoundScene& scene, const py::dict& vary, py::ssize_t count) {
    Varied varied(scene, vary);
    std::vector<Variation> all;
    // more than there is memory for is refused at once
    all.reserve(static_cast<std::size_t>(count));
    for (py::ssize_t i = 0; i < count; ++i) {
        if (i % 1024 == 0 && PyErr_CheckSignals() != 0) throw py::error_already_set();
        all.push_back(varied.member(i));
    }
    return all;
}

/// Whether anything in Python is called while a scene runs: several threads would wait for its lock.
bool needs_lock(const rbdyn::Scene& scene) {
    const auto is_python = [](const auto& one) {
        if constexpr (requires { one.callback()->is_python; })
            return one.callback() != nullptr && one.callback()->is_python;
        else
            return false;
    };
    for (const auto& l : scene.loads())
        if (std::visit(is_python, l.load)) return true;
    for (const auto& c : scene.connections())
        if (const rbdyn::OwnFunction* own = own_function(c.coupling);
            own != nullptr && own->callback() && own->callback()->is_python)
            return true;
    for (const auto& w : scene.watches())
        if (!w.function.is_recorded() || w.options.action.change) return true;
    return false;
}

/// Why a member was refused, as a Python exception.
py::object refusal_of(const std::exception_ptr& refused) {
    const py::module_ errors = py::module_::import("rbdyn.errors");
    try {
        std::rethrow_exception(refused);
    } catch (py::error_already_set& e) {
        return e.value();
    } catch (const InvalidInput& e) {
        return errors.attr("InvalidInput")(e.what());
    } catch (const std::exception& e) {
        return errors.attr("Error")(e.what());
    }
}

py::tuple sweep(const BoundScene& scene, const py::dict& vary, py::ssize_t count, double until, double start,
                std::optional<double> error, std::optional<double> rtol, const std::string& engine,
                const KeepLike& keep, std::int64_t max_steps, const std::string& events, const py::object& progress,
                int threads, bool lanes) {
    // copies, since other threads may change the scene while this one runs without the lock
    const rbdyn::Scene copy = scene.scene;
    const auto handles = std::make_shared<const Handles>(scene.handles);
    const std::vector<Variation> members = variations(scene, vary, count);
    Watch watch(progress);
    rbdyn::ManyOptions options;
    options.run = options_of(until, start, error, rtol, engine, keep, max_steps);
    options.run.events = events_of(py::str(events), handles);
    options.threads = needs_lock(copy) ? 1 : threads;
    options.lanes = lanes;
    options.monitor = [&](double fraction) { return watch.goes_on(fraction); };
    std::vector<rbdyn::Member> done;
    {
        std::optional<py::gil_scoped_release> free;
        if (!calls_python(copy)) free.emplace();
        done = rbdyn::simulate_many(copy, members, options);
    }
    py::list runs, errors;
    for (rbdyn::Member& member : done) {
        if (!member.attempt) {
            runs.append(py::none());
            errors.append(member.refused ? refusal_of(member.refused) : py::none());
            continue;
        }
        const BoundTrajectory run{member.attempt->run, handles};
        runs.append(run);
        errors.append(failure_of(*member.attempt, run));
        member = {};
    }
    // an interruption meanwhile does not lose what is done
    watch.look(1.0);
    return py::make_tuple(runs, errors, watch.raised() ? py::object(watch.raised()->value()) : py::none());
}

/// Throws what sweep() would throw before anything runs.
void check(const BoundScene& scene, const py::dict& vary, py::ssize_t count, double until, double start,
           std::optional<double> error, std::optional<double> rtol, const std::string& engine, const KeepLike& keep,
           std::int64_t max_steps, const std::string& events) {
    rbdyn::simulating::validate(options_of(until, start, error, rtol, engine, keep, max_steps));
    (void)events_of(py::str(events), nullptr);
    (void)variations(scene, vary, count);
}

/// Runs from their data and what their members had of their own; None where there is no run.
py::list runs_from(const BoundScene& scene, const py::dict& vary, const py::list& data) {
    const auto handles = std::make_shared<const Handles>(scene.handles);
    Varied varied(scene, vary);
    py::list runs;
    for (std::size_t i = 0; i < data.size(); ++i) {
        if (data[i].is_none()) {
            runs.append(py::none());
            continue;
        }
        const Variation own = varied.member(static_cast<py::ssize_t>(i));
        const rbdyn::BoundParameters bound(own.numbers);
        rbdyn::Scene member = scene.scene;
        for (const auto& [body, start] : own.starts) member.replace(body, start);
        // with the numbers it ran with
        member = member.frozen();
        runs.append(BoundTrajectory{rbdyn::Trajectory(rbdyn::run_from(member, std::string(data[i].cast<py::bytes>()))),
                                    handles});
    }
    return runs;
}

}  // namespace

void bind_many(py::module_& m) {
    const rbdyn::SimulateOptions defaults;
    m.def("_sweep", &sweep, py::arg("scene"), py::arg("vary"), py::arg("count"), py::arg("until"), py::kw_only(),
          py::arg("start"), py::arg("error"), py::arg("rtol"), py::arg("engine"), py::arg("keep"), py::arg("max_steps"),
          py::arg("events"), py::arg("progress"), py::arg("threads"), py::arg("lanes"),
          "The runs of a sweep, what went wrong with each, and what interrupted it.");
    m.def("_check_sweep", &check, py::arg("scene"), py::arg("vary"), py::arg("count"), py::arg("until"), py::kw_only(),
          py::arg("start"), py::arg("error"), py::arg("rtol"), py::arg("engine"), py::arg("keep"), py::arg("max_steps"),
          py::arg("events"), "Raises what a sweep would raise before anything runs.");
    m.def(
        "_bytes_of", [](const BoundTrajectory& run) { return py::bytes(rbdyn::bytes_of(*run.run.data())); },
        py::arg("run"), "A run as data, without its scene.");
    m.def("_runs_from", &runs_from, py::arg("scene"), py::arg("vary"), py::arg("data"),
          "The runs of members of a sweep from their data.");
}

}  // namespace binding
