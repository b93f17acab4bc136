// Events of a run: what happened, as Python has it.
#include <set>

#include "data.hpp"
#include "run.hpp"

namespace binding {

using rbdyn::Event, rbdyn::Events;

namespace {

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

}  // namespace

py::object events_object(const rbdyn::Events& events, const std::vector<std::string>& watches) {
    Handles names;
    for (const std::string& name : watches)
        names.watches.push_back({{Handle::Of::watch, static_cast<int>(names.watches.size()), 0, name}});
    return py::cast(BoundEvents(events, std::move(names)));
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
}

}  // namespace binding
