// Runs: the whole system and its parts, by time.
#include <rbdyn/trajectory/run_bytes.hpp>

#include "data.hpp"
#include "recording.hpp"
#include "run.hpp"

namespace binding {

using rbdyn::Side, rbdyn::Trajectory;

namespace {

using Of = std::optional<std::variant<Handle, std::vector<Handle>>>;

void require_some(const std::vector<Handle>& handles) {
    if (handles.empty()) throw InvalidInput("Trajectory: of has 0 handles; give at least one, or leave it out for all");
}

Trajectory::Bodies bodies_of(const BoundTrajectory& self, const Of& of) {
    Trajectory::Bodies bodies;
    if (!of) return bodies;
    if (const Handle* one = std::get_if<Handle>(&*of)) return {self.handles->body(*one, "Trajectory")};
    const auto& several = std::get<std::vector<Handle>>(*of);
    require_some(several);
    for (const Handle& h : several) bodies.push_back(self.handles->body(h, "Trajectory"));
    return bodies;
}

/// What power and work are asked of: bodies (empty: all), loads, couplings.
struct Parts {
    bool bodies_count = false;
    Trajectory::Bodies bodies;
    std::vector<rbdyn::LoadHandle> loads;
    std::vector<rbdyn::CouplingHandle> couplings;

    /// The sum of f over them.
    template <class F>
    double sum(F&& f) const {
        double result = bodies_count ? f(bodies) : 0.0;
        for (const auto load : loads) result += f(load);
        for (const auto coupling : couplings) result += f(coupling);
        return result;
    }
};

Parts parts_of(const BoundTrajectory& self, const Of& of) {
    Parts parts;
    parts.bodies_count = !of;
    if (!of) return parts;
    const auto take = [&](const Handle& h) {
        self.handles->require(h, "Trajectory");
        switch (h.of) {
            case Handle::Of::contact:
                throw InvalidInput("Trajectory: \"" + h.name +
                                   "\" is a contact, and those have no power of their own here");
            case Handle::Of::constraint:
                throw InvalidInput("Trajectory: \"" + h.name +
                                   "\" is a constraint, and those do no work on what they join");
            case Handle::Of::body: parts.bodies.push_back({h.index}); break;
            case Handle::Of::load: parts.loads.push_back({h.index}); break;
            case Handle::Of::coupling: parts.couplings.push_back({h.index}); break;
            case Handle::Of::watch:
                throw InvalidInput("Trajectory: \"" + h.name + "\" is a watched function, which has no power");
        }
    };
    if (const Handle* one = std::get_if<Handle>(&*of)) {
        take(*one);
    } else {
        const auto& several = std::get<std::vector<Handle>>(*of);
        require_some(several);
        for (const Handle& h : several) take(h);
    }
    parts.bodies_count = !parts.bodies.empty();
    return parts;
}

/// A run is its scene, with the numbers it ran with, and what was computed.
py::tuple data_of(const BoundTrajectory& r) {
    try {
        const std::string bytes = unlocked([&] { return rbdyn::bytes_of(*r.run.data()); });
        return py::make_tuple(BoundScene{r.run.scene(), *r.handles}, py::bytes(bytes));
    } catch (const InvalidInput& e) {
        // as everything that cannot be pickled
        throw py::type_error(e.what());
    }
}
BoundTrajectory trajectory_from(const py::tuple& d) {
    const auto& scene = d[0].cast<const BoundScene&>();
    const rbdyn::Scene own = scene.scene;
    const std::string bytes = d[1].cast<py::bytes>();
    return {Trajectory(unlocked([&] { return rbdyn::run_from(own, bytes); })),
            std::make_shared<const Handles>(scene.handles)};
}

template <class R>
auto of_bodies(R (Trajectory::*quantity)(double, const Trajectory::Bodies&, Side) const) {
    return [quantity](const BoundTrajectory& self, const ArrayLike& t, const Of& of, const SideName& name) {
        const Side side = side_of(name);
        const Trajectory::Bodies bodies = bodies_of(self, of);
        return over(t, "Trajectory", "time", [&](double x) { return (self.run.*quantity)(x, bodies, side); });
    };
}

/// Poles of moments at times: one for all of them, or a place for each.
class Poles {
public:
    Poles(const BoundTrajectory& self, const MovingPole& given, const ArrayLike& t) {
        if (py::isinstance<Handle>(given)) {
            poles_.emplace_back(self.handles->body(given.cast<const Handle&>(), "Trajectory"));
        } else if (py::isinstance<BodyPoint>(given)) {
            const auto& p = given.cast<const BodyPoint&>();
            poles_.emplace_back(self.handles->body(p.body, "Trajectory").point(p.point));
        } else if (PyCallable_Check(given.ptr()) != 0) {
            const UserFunction path = user_pole(given, "Trajectory: pole");
            if (path.function)
                poles_.emplace_back(path.function);
            else
                call(*path.callback, t);
        } else {
            read(doubles(given, "Trajectory", "pole"), t);
        }
    }
    /// That of the next time, in order.
    const rbdyn::Pole& next() { return is_one_a_time_ ? poles_[next_++] : poles_.front(); }
    /// Throws InvalidInput where it is not known how the pole moves.
    void require_velocity() const {
        if (is_one_a_time_)
            throw InvalidInput("Trajectory: the velocity of the pole is not known, for " + why_ +
                               "; give a point, a function of time that can be recorded, or a handle");
    }

private:
    void call(const rbdyn::Callback& path, const ArrayLike& t) {
        is_one_a_time_ = true;
        why_ = "its function is called back (" + path.reason + ")";
        const Array times = doubles(t, "Trajectory", "time");
        for (py::ssize_t i = 0; i < times.size(); ++i) {
            double place[3];
            path(times.data() + i, place);
            poles_.emplace_back(Vector3(place[0], place[1], place[2]));
        }
    }
    void read(const Array& places, const ArrayLike& t) {
        const Array times = doubles(t, "Trajectory", "time");
        std::vector<py::ssize_t> wanted(times.shape(), times.shape() + times.ndim()),
            shape(places.shape(), places.shape() + places.ndim());
        wanted.push_back(3);
        is_one_a_time_ = shape != std::vector<py::ssize_t>{3};
        if (is_one_a_time_ && shape != wanted)
            throw InvalidInput("Trajectory: pole has shape " + shape_of(places) +
                               "; it is a point (3,), or one for each time, in m");
        why_ = "it is given by places";
        for (const double* x = places.data(); x < places.data() + places.size(); x += 3)
            poles_.emplace_back(Vector3(x[0], x[1], x[2]));
    }

    std::vector<rbdyn::Pole> poles_;
    std::size_t next_ = 0;
    bool is_one_a_time_ = false;
    std::string why_;
};

/// The axes that a kinetic energy is seen from: none for those of the world.
double kinetic_energy(const BoundTrajectory& self, double t, bool of_center, Poles* poles,
                      const Trajectory::Bodies& bodies, Side side) {
    if (of_center) return self.run.relative_kinetic_energy(t, std::nullopt, bodies, side);
    if (poles != nullptr) return self.run.relative_kinetic_energy(t, poles->next(), bodies, side);
    return self.run.kinetic_energy(t, bodies, side);
}

}  // namespace

Side side_of(const SideName& side) {
    const std::string name = plain(side);
    if (name == "after") return Side::after;
    if (name == "before") return Side::before;
    throw InvalidInput("Trajectory: side is \"" + name + "\"; it is \"after\" or \"before\"");
}

SideName after() { return py::reinterpret_steal<SideName>(PyUnicode_FromString("after")); }

void bind_trajectory(py::module_& m) {
    bind_events(m);
    bind_statistics(m);
    bind_motions(m);
    py::class_<BoundTrajectory> run(m, "Trajectory", R"(The result of simulate(): motion, events, error estimate, price.

run[handle] is the motion of a body or a coupling, also by its name: run["ball"]. Quantities of the whole system are
methods of time: t [s] is a number or an array; scalars come back as float or (n,), vectors as (3,) or (n, 3), world axes;
of: a handle or several, all bodies by default; side: at a jump the value "after" it, or "before". A run owns all it needs
and outlives its scene.)");
    run.def_property_readonly(
           "status", [](const BoundTrajectory& r) { return name_of(r.run.status()); },
           "reached end, stopped by event, stopped by user, step limit, not finite, accuracy not reached or "
           "inconsistent.")
        .def_property_readonly(
            "advice", [](const BoundTrajectory& r) { return advice(r.run.status()); }, "What to do about the status.")
        .def_property_readonly(
            "start", [](const BoundTrajectory& r) { return r.run.start(); }, "[s]")
        .def_property_readonly(
            "end", [](const BoundTrajectory& r) { return r.run.end(); }, "[s]")
        .def_property_readonly(
            "certain_until", [](const BoundTrajectory& r) { return r.run.certain_until(); },
            "The time up to which the motion is as accurate as asked for [s].")
        .def_property_readonly(
            "engine", [](const BoundTrajectory& r) { return r.run.engine(); },
            "What computed it; of several parts those of all.")
        .def_property_readonly(
            "error", [](const BoundTrajectory& r) { return r.run.error(); },
            "Estimated global error, each quantity relative to its own scale in this motion; None with rtol.")
        .def_property_readonly(
            "drift", [](const BoundTrajectory& r) { return unlocked([&] { return r.run.drift(); }); },
            R"(For each first integral of the scene its largest departure from the value at the start, relative to the largest
size of its terms.)")
        .def_property_readonly(
            "statistics", [](const BoundTrajectory& r) { return r.run.statistics(); }, "What it cost.")
        .def_property_readonly(
            "events", [](const BoundTrajectory& r) { return BoundEvents(r); }, "What happened, in order of time.")
        .def_property_readonly(
            "plan", [](const BoundTrajectory& r) { return r.run.plan(); }, "What was simulated and what was left out.")
        .def_property_readonly(
            "bodies", [](const BoundTrajectory& r) { return r.handles->bodies; }, "Handles of the bodies.")
        .def_property_readonly(
            "couplings", [](const BoundTrajectory& r) { return r.handles->couplings; }, "Handles of the couplings.")
        .def_property_readonly(
            "t",
            [](const BoundTrajectory& r) {
                const std::vector<double> t = r.run.t();
                return py::array_t<double>(static_cast<py::ssize_t>(t.size()), t.data());
            },
            "The ends of the integrator's pieces (n,) [s].");
    bind_motion_of(run);
    run.def(
        "__getitem__",
        [](const py::object& self, const std::string& name) {
            return py::object(self[self.cast<const BoundTrajectory&>().handles->find(name, "Trajectory")]);
        },
        py::arg("name"));

    const auto of_time_and_bodies = [&](const char* name, auto quantity, const char* doc) {
        run.def(name, of_bodies(quantity), py::arg("t"), py::arg("of") = py::none(), py::arg("side") = after(), doc);
    };
    run.def(
        "kinetic_energy",
        [](const BoundTrajectory& self, const ArrayLike& t, const Of& of, const SideName& name,
           const std::optional<std::string>& frame, const std::optional<MovingPole>& pole) {
            const Side side = side_of(name);
            const Trajectory::Bodies bodies = bodies_of(self, of);
            if (frame && pole)
                throw InvalidInput(
                    "Trajectory: frame and pole are given; both say what moves with the axes that T is "
                    "seen from, give one");
            const bool of_center = frame && *frame == "center of mass";
            if (frame && !of_center && *frame != "world")
                throw InvalidInput("Trajectory: frame is \"" + *frame + "\"; it is \"world\" or \"center of mass\"");
            std::optional<Poles> poles;
            if (pole) {
                poles.emplace(self, *pole, t);
                poles->require_velocity();
            }
            return over(t, "Trajectory", "time", [&](double x) {
                return kinetic_energy(self, x, of_center, poles ? &*poles : nullptr, bodies, side);
            });
        },
        py::arg("t"), py::arg("of") = py::none(), py::arg("side") = after(), py::kw_only(),
        py::arg("frame") = py::none(), py::arg("pole") = py::none(),
        R"([J]

frame: "center of mass" for that of the motion relative to axes which do not turn and move with the centre of mass of the
bodies asked for (Koenig, 7.37); "world" by default. pole: the same with axes that move with a pole, a function of time,
a handle or a point of a body.)");
    of_time_and_bodies("momentum", &Trajectory::momentum, "[kg m/s]");
    of_time_and_bodies("center_of_mass", &Trajectory::center_of_mass, "[m]");
    of_time_and_bodies("center_of_mass_velocity", &Trajectory::center_of_mass_velocity, "[m/s]");
    of_time_and_bodies("center_of_mass_acceleration", &Trajectory::center_of_mass_acceleration, "[m/s^2]");

    using OfBodies = double (Trajectory::*)(double, const Trajectory::Bodies&, Side) const;
    of_time_and_bodies("potential_energy", static_cast<OfBodies>(&Trajectory::potential_energy),
                       R"(V = -U of gravity, constant forces, potentials and couplings [J].

Zero at the origin, at rest length, at infinity for gravitation, at the distance of the start for a central force. Of some
bodies: with the couplings among them and to the world.)");
    of_time_and_bodies("potential", static_cast<OfBodies>(&Trajectory::potential),
                       "U, with F = +grad U (the chapter's sign) [J].");
    of_time_and_bodies("energy", static_cast<OfBodies>(&Trajectory::energy), "T + V = T - U [J].");
    of_time_and_bodies("external_force", &Trajectory::external_force,
                       R"(Resultant of what acts on the bodies from outside them [N].

Loads, gravity, rails and joints, and couplings to the world and to other bodies.)");

    run.def(
           "work",
           [](const BoundTrajectory& self, double t0, double t1, const Of& of) {
               const Parts parts = parts_of(self, of);
               return unlocked(
                   [&] { return parts.sum([&](const auto& part) { return self.run.work(t0, t1, part); }); });
           },
           py::arg("t0"), py::arg("t1"), py::arg("of") = py::none(),
           R"(Work of all forces on the bodies from t0 to t1, reactions included (Thm 7.9) [J].

of: bodies, or loads and couplings for theirs alone. What jumps of the state (a landing, an action) make of the energy does
not count. Raises InvalidInput for times outside the run, and where it takes a motion that was not kept (keep=).)")
        .def(
            "power",
            [](const BoundTrajectory& self, const ArrayLike& t, const Of& of, const SideName& name) {
                const Side side = side_of(name);
                const Parts parts = parts_of(self, of);
                return over(t, "Trajectory", "time", [&](double x) {
                    return parts.sum([&](const auto& part) { return self.run.power(x, part, side); });
                });
            },
            py::arg("t"), py::arg("of") = py::none(), py::arg("side") = after(),
            R"(Power of all forces on the bodies, reactions included: dT/dt (Thm 7.6) [W].

of: bodies, or loads and couplings for theirs alone; a coupling's is that on both its ends.)")
        .def(
            "angular_momentum",
            [](const BoundTrajectory& self, const ArrayLike& t, const MovingPole& pole, const Of& of,
               const SideName& name) {
                const Side side = side_of(name);
                const Trajectory::Bodies bodies = bodies_of(self, of);
                Poles poles(self, pole, t);
                return over(t, "Trajectory", "time",
                            [&](double x) { return self.run.angular_momentum(x, poles.next(), bodies, side); });
            },
            py::arg("t"), py::arg("pole") = std::vector<double>{0.0, 0.0, 0.0}, py::arg("of") = py::none(),
            py::arg("side") = after(),
            R"(About a pole [kg m^2/s] (7.31).

pole: a point of the world (3,), or one for each time (n, 3) [m]; a function of time; the handle of a body, for its centre
of mass, or a point of a body.)")
        .def(
            "external_moment",
            [](const BoundTrajectory& self, const ArrayLike& t, const MovingPole& pole, const Of& of,
               const SideName& name) {
                const Side side = side_of(name);
                const Trajectory::Bodies bodies = bodies_of(self, of);
                Poles poles(self, pole, t);
                return over(t, "Trajectory", "time",
                            [&](double x) { return self.run.external_moment(x, poles.next(), bodies, side); });
            },
            py::arg("t"), py::arg("pole") = std::vector<double>{0.0, 0.0, 0.0}, py::arg("of") = py::none(),
            py::arg("side") = after(),
            "Moment about a pole, as of angular_momentum, of what acts on the bodies from outside them [N m].")
        .def(
            "cardinal_residuals",
            [](const BoundTrajectory& self, const ArrayLike& t, const MovingPole& pole, const Of& of,
               const SideName& name) {
                const Side side = side_of(name);
                const Trajectory::Bodies bodies = bodies_of(self, of);
                Poles poles(self, pole, t);
                poles.require_velocity();
                return pair_over<py::typing::Tuple<Vectors, Vectors>>(
                    t, [&](double x) { return self.run.cardinal_residuals(x, poles.next(), bodies, side); });
            },
            py::arg("t"), py::arg("pole") = std::vector<double>{0.0, 0.0, 0.0}, py::arg("of") = py::none(),
            py::arg("side") = after(),
            R"((R - dQ/dt, M - dK/dt - v x Q), v the velocity of the pole [N, N m] (7.38, 7.39).

Rounding, but for the moment of forces between the bodies that are not along their lines. Rates are from accelerations of
the model, never from differences. pole: as of angular_momentum, but how it moves must be known: a point, a function of
time that can be recorded, or a handle.)")
        .def(
            "sample",
            [](const py::object& self, const std::optional<ArrayLike>& times) {
                return SampleObject(py::module_::import("rbdyn.sample").attr("Sample")(self, times));
            },
            py::arg("times") = py::none(),
            "All quantities of all bodies and couplings at times (n,) [s], by default the ends of the pieces, run.t: a "
            "rbdyn.sample.Sample.")
        .def(
            "save",
            [](const py::object& self, const py::object& path) {
                py::module_::import("rbdyn.files").attr("save")(self, path);
            },
            py::arg("path"),
            R"(Writes the run with its scene to a file, by its suffix .npz, or .h5, which needs h5py; load() reads it.

Raises InvalidInput if a function of its scene is called back, and where the system refuses.)")
        .def(py::pickle([](const BoundTrajectory& r) { return data_of(r); }, &trajectory_from))
        .def("__str__", [](const BoundTrajectory& r) { return printed(r.run); })
        .def("__repr__", [](const BoundTrajectory& r) {
            return "<Trajectory: " + std::string(name_of(r.run.status())) + " at t = " + rbdyn::text(r.run.end()) +
                   " s, " + std::to_string(r.run.events().size()) + " events, engine " + r.run.engine() + ">";
        });
}

}  // namespace binding
