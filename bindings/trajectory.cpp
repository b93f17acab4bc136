// Runs: motion, events, price.
#include <algorithm>
#include <rbdyn/trajectory/run_bytes.hpp>
#include <set>

#include "data.hpp"
#include "recording.hpp"
#include "run.hpp"

namespace binding {

using rbdyn::BodyMotion, rbdyn::Event, rbdyn::Events, rbdyn::Side, rbdyn::CouplingMotion, rbdyn::Statistics,
    rbdyn::Trajectory;

namespace {

struct BoundEvents {
    std::shared_ptr<const Events> events;  // of a run, which they keep
    std::shared_ptr<const Handles> handles;

    BoundEvents(const BoundTrajectory& r) : events(r.run.data(), &r.run.events()), handles(r.handles) {}
    BoundEvents(Events all, Handles known)
        : events(std::make_shared<const Events>(std::move(all))),
          handles(std::make_shared<Handles>(std::move(known))) {}

    const Events& list() const { return *events; }
    BoundEvent at(std::size_t i) const { return bound(list()[i], *handles); }
};

struct BoundMotion {
    BodyMotion motion;
    const rbdyn::Scene::Body* body;  // of the run's scene, which the motion keeps
    std::string name;
};
struct BoundPoint {
    rbdyn::BodyPointMotion motion;
    std::string name;
};
struct BoundCoupling {
    CouplingMotion motion;
    std::string name;
};

struct BoundConstraint {
    rbdyn::ConstraintMotion motion;
    std::string name;
};

/// quantity(motion, t, side) as a method of time.
template <class Owner, class R>
auto of_time(R (decltype(Owner::motion)::*quantity)(double, Side) const) {
    return [quantity](const Owner& self, const ArrayLike& t, const SideName& name) {
        const Side side = side_of(name);
        return over(t, "Trajectory", "time", [&](double x) { return (self.motion.*quantity)(x, side); });
    };
}

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

std::vector<double> times_of(const BoundEvents& self, const std::string& kind_or_name,
                             const std::optional<Handle>& subject) {
    std::set<std::string> known;
    std::string kinds;
    for (int i = 0; i <= static_cast<int>(rbdyn::EventKind::singular); ++i) {
        const std::string kind(name_of(static_cast<rbdyn::EventKind>(i)));
        known.insert(kind);
        kinds += (kinds.empty() ? "" : ", ") + kind;
    }
    for (const Event& e : self.list()) known.insert(e.name);
    for (const Handle& h : self.handles->bodies) known.insert(h.name);
    for (const Handle& h : self.handles->watches) known.insert(h.name);
    for (const Handle& h : self.handles->contacts) known.insert(h.name);
    if (known.count(kind_or_name) == 0)
        throw InvalidInput("Events: \"" + kind_or_name +
                           "\" is no name in this run and no kind of event; the kinds are " + kinds);
    if (!subject) return self.list().times(kind_or_name);
    if (subject->of == Handle::Of::contact) {
        self.handles->require(*subject, "Events");
        return self.list().times(kind_or_name, rbdyn::ContactHandle{subject->index});
    }
    return self.list().times(kind_or_name, self.handles->body(*subject, "Events"));
}

// --- as data ---

py::tuple data_of(const Event& e) {
    return py::make_tuple(e.time, static_cast<int>(e.kind), e.subject, e.name, static_cast<int>(e.direction), e.impulse,
                          e.instant.hi, e.instant.lo, e.contact, tuple_of(e.push), e.note, e.count);
}
Event event_from(const py::handle& data) {
    const auto d = data.cast<py::tuple>();
    Event e;
    e.time = d[0].cast<double>();
    e.kind = member(d[1].cast<int>(), rbdyn::EventKind::singular, "Event", "kind");
    e.subject = d[2].cast<int>();
    e.name = d[3].cast<std::string>();
    e.direction = member(d[4].cast<int>(), rbdyn::Direction::falling, "Event", "direction");
    e.impulse = d[5].cast<double>();
    e.instant = {d[6].cast<double>(), d[7].cast<double>()};
    if (d.size() > 8) e.contact = d[8].cast<int>();
    if (d.size() > 9) e.push = vector_from(d[9]);
    if (d.size() > 10) e.note = d[10].cast<std::string>();
    if (d.size() > 11) e.count = d[11].cast<std::int64_t>();
    return e;
}
bool same(const BoundEvent& a, const BoundEvent& b) {
    return a.subject == b.subject && data_of(a.event).equal(data_of(b.event));
}

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
    const auto bytes = d[1].cast<std::string>();
    return {Trajectory(unlocked([&] { return rbdyn::run_from(own, bytes); })),
            std::make_shared<const Handles>(scene.handles)};
}

void bind_events(py::module_& m) {
    py::class_<BoundEvent>(m, "Event",
                           "Something that happened at a time, located to rounding error. print() shows it.")
        .def_property_readonly(
            "time", [](const BoundEvent& e) { return e.event.time; }, "[s]")
        .def_property_readonly(
            "kind", [](const BoundEvent& e) { return name_of(e.event.kind); },
            "watch, reverse, stick, slip, normal-zero, rail-end, detach, land, impact, rest, accumulation or switch.")
        .def_property_readonly(
            "name", [](const BoundEvent& e) { return e.event.name; }, "Of the watch or of the subject.")
        .def_property_readonly(
            "subject", [](const BoundEvent& e) { return e.subject; }, "Handle of the body or the contact, or None.")
        .def_property_readonly(
            "direction", [](const BoundEvent& e) { return name_of(e.event.direction); },
            "In which the watched quantity passed zero: rising, falling or either.")
        .def_property_readonly(
            "impulse",
            [](const BoundEvent& e) {
                return py::reinterpret_borrow<Values>(e.event.contact >= 0 ? to_python(e.event.push)
                                                                           : to_python(e.event.impulse));
            },
            "Of an impact [N s]: of a contact a vector (3,) on its first side, world axes, else its size.")
        .def_property_readonly(
            "note", [](const BoundEvent& e) { return e.event.note; },
            "What else is to be said of it (that restitution was lowered, lest friction gain energy); empty if "
            "nothing.")
        .def_property_readonly(
            "count", [](const BoundEvent& e) { return e.event.count; },
            "With events=\"last\": how many of its kind, name and subject there were.")
        .def("__eq__",
             [](const BoundEvent& a, const py::object& b) {
                 return py::isinstance<BoundEvent>(b) && same(a, b.cast<const BoundEvent&>());
             })
        .def("__hash__", [](const BoundEvent& e) { return py::hash(data_of(e.event)); })
        .def(py::pickle([](const BoundEvent& e) { return py::make_tuple(data_of(e.event), e.subject); },
                        [](const py::tuple& d) {
                            return BoundEvent{event_from(d[0]),
                                              d[1].cast<std::optional<std::variant<BodyHandle, ContactHandle>>>()};
                        }))
        .def("__str__", [](const BoundEvent& e) { return printed(e.event); })
        .def("__repr__", [](const BoundEvent& e) { return "<Event: " + printed(e.event) + ">"; });

    py::class_<BoundEvents>(m, "Events", "The events of a run, a sequence in order of time.")
        .def("__len__", [](const BoundEvents& e) { return e.list().size(); })
        .def(
            "__getitem__",
            [](const BoundEvents& e, py::ssize_t i) {
                const auto n = static_cast<py::ssize_t>(e.list().size());
                if (i < 0) i += n;
                if (i < 0 || i >= n) throw py::index_error("Events: there are " + std::to_string(n) + " events");
                return e.at(static_cast<std::size_t>(i));
            },
            py::arg("index"))
        .def(
            "__getitem__",
            [](const BoundEvents& e, const py::slice& slice) {
                std::size_t start = 0, stop = 0, step = 0, length = 0;
                if (!slice.compute(e.list().size(), &start, &stop, &step, &length)) throw py::error_already_set();
                std::vector<BoundEvent> result;
                for (std::size_t i = 0; i < length; ++i, start += step) result.push_back(e.at(start));
                return result;
            },
            py::arg("slice"))
        .def("__iter__",
             [](const BoundEvents& e) {
                 py::list all;
                 for (std::size_t i = 0; i < e.list().size(); ++i) all.append(e.at(i));
                 return py::reinterpret_borrow<py::typing::Iterator<BoundEvent>>(py::iter(all));
             })
        .def(
            "times",
            [](const BoundEvents& e, const std::string& kind_or_name, const std::optional<Handle>& subject) {
                const std::vector<double> times = times_of(e, kind_or_name, subject);
                return py::array_t<double>(static_cast<py::ssize_t>(times.size()), times.data());
            },
            py::arg("kind_or_name"), py::arg("subject") = py::none(),
            R"(Times (n,) [s] of the events of a kind, a watch or a body, of one subject if given.

Raises InvalidInput for what is neither a kind of event nor a name in this run.)")
        .def("__str__",
             [](const BoundEvents& e) {
                 std::string text;
                 for (const Event& event : e.list()) text += (text.empty() ? "" : "\n") + printed(event);
                 return text;
             })
        .def("__eq__",
             [](const BoundEvents& a, const py::object& other) {
                 if (!py::isinstance<BoundEvents>(other)) return false;
                 const auto& b = other.cast<const BoundEvents&>();
                 bool all = a.list().size() == b.list().size();
                 for (std::size_t i = 0; all && i < a.list().size(); ++i) all = same(a.at(i), b.at(i));
                 return all;
             })
        .def(py::pickle(
            [](const BoundEvents& e) {
                py::list all;
                for (const Event& event : e.list()) all.append(data_of(event));
                return py::make_tuple(all, e.handles->bodies, e.handles->watches, e.handles->contacts);
            },
            [](const py::tuple& d) {
                Events all;
                for (const py::handle event : d[0]) all.push_back(event_from(event));
                Handles known;
                known.bodies = d[1].cast<std::vector<BodyHandle>>();
                known.watches = d[2].cast<std::vector<WatchHandle>>();
                if (d.size() > 3) known.contacts = d[3].cast<std::vector<ContactHandle>>();
                for (const Event& e : all)
                    if (e.subject < -1 || e.subject >= static_cast<int>(known.bodies.size()) || e.contact < -1 ||
                        e.contact >= static_cast<int>(known.contacts.size()))
                        throw InvalidInput("Events: in its data subject " + std::to_string(e.subject) + " or contact " +
                                           std::to_string(e.contact) + " is none of its handles");
                return BoundEvents(std::move(all), std::move(known));
            }))
        .def("__repr__", [](const BoundEvents& e) { return "<Events: " + std::to_string(e.list().size()) + ">"; });

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

/// Names of the quantities a body has.
std::vector<std::string> quantities_of(const rbdyn::Scene::Body& body) {
    std::vector<std::string> names = {"position", "velocity", "acceleration", "force"};
    const auto also = [&](std::initializer_list<const char*> more) {
        names.insert(names.end(), more.begin(), more.end());
    };
    if (body.rail() != nullptr)
        also({"parameter", "arc_length", "speed", "tangential_force", "reaction", "reaction_frenet"});
    if (body.rigid() == nullptr) return names;
    also({"center_of_mass", "center_of_mass_velocity", "center_of_mass_acceleration", "quaternion", "rotation_matrix",
          "euler_angles", "euler_rates", "angular_velocity", "angular_velocity_world", "angular_acceleration",
          "poisson_vector", "instantaneous_axis"});
    if (!std::holds_alternative<rbdyn::Free>(body.joint)) also({"reaction", "reaction_torque"});
    const auto is_on = [&]<class J>(const J*) { return std::holds_alternative<J>(body.joint); };
    if (is_on(static_cast<rbdyn::Revolute*>(nullptr)) || is_on(static_cast<rbdyn::Planar*>(nullptr)))
        also({"angle", "rate"});
    if (is_on(static_cast<rbdyn::Cylindrical*>(nullptr))) also({"angle", "rate", "displacement", "displacement_rate"});
    if (is_on(static_cast<rbdyn::Universal*>(nullptr))) also({"angles", "rates"});
    if (std::holds_alternative<rbdyn::Prismatic>(body.joint)) also({"displacement", "rate"});
    return names;
}

/// A pair of vectors at each time, as a named tuple of python/rbdyn/frames.py.
template <class Pair, class F>
Pair pair_over(const ArrayLike& t, F&& f) {
    std::vector<std::pair<Vector3, Vector3>> kept;
    const auto first = over(t, "Trajectory", "time", [&](double x) { return kept.emplace_back(f(x)).first; });
    auto next = kept.cbegin();
    const auto second = over(t, "Trajectory", "time", [&](double) { return (next++)->second; });
    return Pair(py::make_tuple(first, second));
}
template <class Named, class F>
Named pair_over(const char* name, const ArrayLike& t, F&& f) {
    return Named(py::module_::import("rbdyn.frames").attr(name)(*pair_over<py::tuple>(t, f)));
}

void bind_motions(py::module_& m) {
    using M = BodyMotion;
    py::class_<BoundMotion> body(m, "BodyMotion", R"(Motion of one body of a run. Each quantity is a method of time.

t: [s], a number or an array; scalars come back as float or (n,), vectors as (3,) or (n, 3), matrices as (3, 3) or
(n, 3, 3); world axes, but where body axes are named. side: at a jump the value "after" it, or "before". Raises
InvalidInput for a time outside the run, and for what the body or its joint does not have.)");
    const auto define = [&](const char* name, auto quantity, const char* doc) {
        body.def(name, of_time<BoundMotion>(quantity), py::arg("t"), py::arg("side") = after(), doc);
    };
    define("position", &M::position, "Of a particle, or of the origin of a rigid body's axes [m].");
    define("velocity", &M::velocity, "Of the same [m/s].");
    define("acceleration", &M::acceleration, "Of the same, from the model at the state [m/s^2].");
    define("force", &M::force, "Resultant of the active forces [N].");
    define("parameter", &M::parameter, "The curve's parameter. On a rail.");
    define("arc_length", &M::arc_length,
           "From the beginning of the curve, or from u = 0 where it has none [m]. On a rail.");
    define("speed", &M::speed, "ds/dt along the curve as placed [m/s], zero after a release. On a rail.");
    define("tangential_force", &M::tangential_force,
           "Q_s = F.t, the active force along the curve (eq. 7.15) [N]. On a rail.");
    define("reaction", &M::reaction, "Reaction of the rail or the joint on the body [N].");
    define("reaction_frenet", &M::reaction_frenet,
           "That of a rail along tangent, normal, binormal, which turn with it (eqs. 7.12-7.14) [N].");
    define("center_of_mass", &M::center_of_mass, "[m]");
    define("center_of_mass_velocity", &M::center_of_mass_velocity, "[m/s]");
    define("center_of_mass_acceleration", &M::center_of_mass_acceleration, "[m/s^2]");
    define("quaternion", &M::quaternion, "(w, x, y, z), body axes to the world's: (4,) or (n, 4). Of a rigid body.");
    define("rotation_matrix", &M::rotation_matrix,
           "Body axes to the world's, its columns the body's axes. Of a rigid body.");
    define("euler_angles", &M::euler_angles,
           R"(theta, psi, phi, continuous in time from the start of the run [rad]. Of a rigid body.

R = Rz(psi) Rx(theta) Rz(phi). An integrated run that keeps its end alone does not know their whole turns.)");
    define("euler_rates", &M::euler_rates,
           "Their rates [rad/s] (eq. 7.49); not finite where sin theta = 0. Of a rigid body.");
    define("angular_velocity", &M::angular_velocity, "In body axes [rad/s]. Of a rigid body.");
    define("angular_velocity_world", &M::angular_velocity_world, "In world axes [rad/s]. Of a rigid body.");
    define("angular_acceleration", &M::angular_acceleration, "In body axes [rad/s^2]. Of a rigid body.");
    define("poisson_vector", &M::poisson_vector, "The world's third axis in body axes (7.59). Of a rigid body.");
    define("reaction_torque", &M::reaction_torque,
           "Moment that the joint exerts on a rigid body, about the point it holds [N m].");
    define("angle", &M::angle, "Of a hinge, also one that slides, or in a plane [rad].");
    define("displacement", &M::displacement, "Of a slide, also of a hinge that slides [m].");
    define("rate", &M::rate, "Of the angle [rad/s], or of the displacement of a slide [m/s].");
    define("displacement_rate", &M::displacement_rate, "Of a hinge that slides [m/s].");
    define("angles", &M::angles, "Of a universal joint, about its first axis and its second [rad]: (2,) or (n, 2).");
    define("rates", &M::rates, "Of these angles [rad/s]: (2,) or (n, 2).");
    body.def(
            "instantaneous_axis",
            [](const BoundMotion& self, const ArrayLike& t, const SideName& name) {
                const Side side = side_of(name);
                return pair_over<AxisObject>("Axis", t,
                                             [&](double x) { return self.motion.instantaneous_axis(x, side); });
            },
            py::arg("t"), py::arg("side") = after(),
            R"(The instantaneous axis of rotation: (point, direction), of a rigid body.

point: that of the axis nearest to the centre of mass [m]; direction: of unit length, zero while the body does not turn.)")
        .def(
            "point",
            [](const BoundMotion& self, const ArrayLike& place, const ArrayLike& t, const SideName& name) {
                const Side side = side_of(name);
                const Vector3 p = vector3(place, self.name, "place");
                return pair_over<PointObject>("PointMotion", t,
                                              [&](double x) { return self.motion.point(p, x, side); });
            },
            py::arg("place"), py::arg("t"), py::arg("side") = after(),
            "(position, velocity) of the point of a rigid body at a place in body axes (3,) [m, m/s].")
        .def_property_readonly(
            "quantities", [](const BoundMotion& b) { return quantities_of(*b.body); },
            "Names of the quantities this body has.")
        .def("__repr__", [](const BoundMotion& b) { return "<BodyMotion: " + b.name + ">"; });

    using P = rbdyn::BodyPointMotion;
    py::class_<BoundPoint> point(
        m, "BodyPointMotion",
        "A point fixed in a rigid body of a run, run[handle.point([x, y, z])]; each a method of "
        "time [s].");
    point
        .def("position", of_time<BoundPoint>(&P::position), py::arg("t"), py::arg("side") = after(), "[m], world axes.")
        .def("velocity", of_time<BoundPoint>(&P::velocity), py::arg("t"), py::arg("side") = after(),
             "[m/s], world axes.")
        .def("acceleration", of_time<BoundPoint>(&P::acceleration), py::arg("t"), py::arg("side") = after(),
             "[m/s^2], world axes.")
        .def("__repr__", [](const BoundPoint& p) { return "<BodyPointMotion: " + p.name + ">"; });

    py::class_<BoundCoupling> spring(m, "CouplingMotion",
                                     "Length and force of a coupling of a run, each a method of time [s].");
    spring
        .def("length", of_time<BoundCoupling>(&CouplingMotion::length), py::arg("t"), py::arg("side") = after(),
             "Between its ends [m].")
        .def("force", of_time<BoundCoupling>(&CouplingMotion::force), py::arg("t"), py::arg("side") = after(),
             "On the first end [N], world axes.")
        .def_property_readonly(
            "quantities",
            [](const BoundCoupling&) {
                return std::vector<std::string>{"length", "force"};
            },
            "Names of the quantities a coupling has.")
        .def("__repr__", [](const BoundCoupling& s) { return "<CouplingMotion: " + s.name + ">"; });
}

void bind_constraint_motion(py::module_& m) {
    using M = rbdyn::ConstraintMotion;
    py::class_<BoundConstraint> constraint(m, "ConstraintMotion",
                                           "What a constraint of a run does, each a method of time [s].");
    constraint
        .def("force", of_time<BoundConstraint>(&M::force), py::arg("t"), py::arg("side") = after(),
             "On its first end [N], world axes.")
        .def("torque", of_time<BoundConstraint>(&M::torque), py::arg("t"), py::arg("side") = after(),
             "On its first end, about the point it holds [N m], world axes.")
        .def("gap", of_time<BoundConstraint>(&M::gap), py::arg("t"), py::arg("side") = after(),
             "How far its points are from where they should be [m], angles of its axes [rad] taken for metres.")
        .def("__repr__", [](const BoundConstraint& c) { return "<ConstraintMotion: " + c.name + ">"; });
}

struct BoundContact {
    rbdyn::ContactMotion motion;
    std::string name;
};

void bind_contact_motion(py::module_& m) {
    using M = rbdyn::ContactMotion;
    py::class_<BoundContact> contact(m, "ContactMotion", "What a contact of a run does, each a method of time [s].");
    contact
        .def("gap", of_time<BoundContact>(&M::gap), py::arg("t"), py::arg("side") = after(),
             "The distance between the part and the surface [m], negative inside.")
        .def("force", of_time<BoundContact>(&M::force), py::arg("t"), py::arg("side") = after(),
             "On its first side, normal force and friction together [N], world axes.")
        .def("slip", of_time<BoundContact>(&M::slip), py::arg("t"), py::arg("side") = after(),
             "The velocity of the first side's point of contact relative to the second's, along the surface [m/s].")
        .def(
            "state",
            [](const BoundContact& self, const ArrayLike& t, const SideName& name) -> py::object {
                const Side side = side_of(name);
                const py::array times = py::array::ensure(t);
                if (times.ndim() == 0) return py::cast(self.motion.state(t.cast<double>(), side));
                py::list all;
                for (const double x : list_of_doubles(t, "Trajectory", "time")) all.append(self.motion.state(x, side));
                return py::object(all);
            },
            py::arg("t"), py::arg("side") = after(),
            R"("open", "sticks" or "slides"; a list of them for several times.)")
        .def("__repr__", [](const BoundContact& c) { return "<ContactMotion: " + c.name + ">"; });
}

BoundContact motion_of_contact(const BoundTrajectory& self, const ContactHandle& handle) {
    self.handles->require(handle, "Trajectory");
    return {self.run[rbdyn::ContactHandle{handle.index}], handle.name};
}

BoundConstraint motion_of_constraint(const BoundTrajectory& self, const ConstraintHandle& handle) {
    self.handles->require(handle, "Trajectory");
    return {self.run[rbdyn::ConstraintHandle{handle.index}], handle.name};
}

BoundMotion motion_of_body(const BoundTrajectory& self, const BodyHandle& handle) {
    self.handles->require(handle, "Trajectory");
    const auto& body = self.run.scene().bodies()[static_cast<std::size_t>(handle.index)];
    return {self.run[rbdyn::BodyHandle{handle.index}], &body, handle.name};
}

BoundPoint motion_of_point(const BoundTrajectory& self, const BodyPoint& point) {
    self.handles->require(point.body, "Trajectory");
    return {self.run[rbdyn::BodyPoint{point.body.index, point.point}],
            point.body.name + " at " + list_text(point.point)};
}

BoundCoupling motion_of_coupling(const BoundTrajectory& self, const CouplingHandle& handle) {
    self.handles->require(handle, "Trajectory");
    return {self.run[rbdyn::CouplingHandle{handle.index}], handle.name};
}

/// A watched function of a run, a function of time.
struct BoundWatched {
    Trajectory run;
    rbdyn::WatchHandle watch;
    std::string name;
};

BoundWatched motion_of_watch(const BoundTrajectory& self, const WatchHandle& handle) {
    self.handles->require(handle, "Trajectory");
    return {self.run, {handle.index}, handle.name};
}

py::typing::Never motion_of_load(const BoundTrajectory& self, const LoadHandle& handle) {
    self.handles->require(handle, "Trajectory");
    throw InvalidInput("Trajectory: \"" + handle.name + "\" is a load, which has no motion; ask for its body's force");
}

/// quantity(run, t, of, side) as a method of time.
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

py::object events_object(const rbdyn::Events& events, const std::vector<std::string>& watches) {
    Handles names;
    for (const std::string& name : watches)
        names.watches.push_back({{Handle::Of::watch, static_cast<int>(names.watches.size()), 0, name}});
    return py::cast(BoundEvents(events, std::move(names)));
}

SideName after() { return py::reinterpret_steal<SideName>(PyUnicode_FromString("after")); }

void bind_trajectory(py::module_& m) {
    bind_events(m);
    bind_motions(m);
    bind_constraint_motion(m);
    bind_contact_motion(m);
    py::class_<BoundWatched>(m, "Watched", "A watched function of a run: its value at a time.")
        .def(
            "value",
            [](const BoundWatched& w, const ArrayLike& t, const SideName& name) {
                const Side side = side_of(name);
                return over(t, "Trajectory", "time", [&](double x) { return w.run.watched(w.watch, x, side); });
            },
            py::arg("t"), py::arg("side") = after(), "At a time [s], a number or an array.")
        .def_property_readonly(
            "quantities", [](const BoundWatched&) { return std::vector<std::string>{"value"}; },
            "Names of the quantities it has.")
        .def("__repr__", [](const BoundWatched& w) { return "<Watched: " + w.name + ">"; });

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
            "The ends of the integrator's pieces (n,) [s].")
        .def("__getitem__", &motion_of_body, py::arg("handle"))
        .def("__getitem__", &motion_of_point, py::arg("handle"))
        .def("__getitem__", &motion_of_coupling, py::arg("handle"))
        .def("__getitem__", &motion_of_constraint, py::arg("handle"))
        .def("__getitem__", &motion_of_contact, py::arg("handle"))
        .def("__getitem__", &motion_of_watch, py::arg("handle"))
        .def("__getitem__", &motion_of_load, py::arg("handle"))
        .def(
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
