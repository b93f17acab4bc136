// The plan: what a scene calls for.
#include <rbdyn/plan/kept_plan.hpp>

#include "handles.hpp"

namespace binding {

namespace {

using rbdyn::Plan;

/// What a plan says; its equations stay behind.
py::tuple plan_data(const Plan& p) {
    return py::make_tuple(p.coordinates, p.effects, p.guards, p.functions, p.engine, p.reason, p.integrator,
                          p.omissions, p.integrals, p.parts, p.size(), p.variables(), p.freedom(), p.not_unique);
}
Plan plan_from(const py::tuple& d) {
    using Lines = std::vector<std::string>;
    Plan p;
    p.coordinates = d[0].cast<Lines>();
    p.effects = d[1].cast<Lines>();
    p.guards = d[2].cast<Lines>();
    p.functions = d[3].cast<Lines>();
    p.engine = d[4].cast<std::string>();
    p.reason = d[5].cast<std::string>();
    p.integrator = d[6].cast<std::string>();
    p.omissions = d[7].cast<std::vector<Plan::Omission>>();
    p.integrals = d[8].cast<Lines>();
    p.parts = d[9].cast<std::vector<Plan>>();
    p.told =
        Plan::Told{d[10].cast<rbdyn::Size>(), d[11].cast<std::pair<int, int>>(), d.size() > 12 ? d[12].cast<int>() : 0};
    if (d.size() > 13) p.not_unique = d[13].cast<Lines>();
    return p;
}

}  // namespace

void bind_plan(py::module_& m) {
    using rbdyn::Size;
    py::class_<Size>(m, "Size", "How much is integrated: the equations that a motion begins with.")
        .def_readonly("variables", &Size::variables, "Of the state.")
        .def_readonly("guards", &Size::guards, "Functions whose zeros are looked for.")
        .def_readonly("instructions", &Size::instructions, "Of the right-hand side and its guards.")
        .def("__eq__",
             [](const Size& a, const py::object& b) { return py::isinstance<Size>(b) && a == b.cast<Size>(); })
        .def(py::pickle([](const Size& s) { return py::make_tuple(s.variables, s.guards, s.instructions); },
                        [](const py::tuple& d) {
                            Size s;
                            s.variables = d[0].cast<int>();
                            s.guards = d[1].cast<int>();
                            s.instructions = d[2].cast<int>();
                            return s;
                        }))
        .def("__repr__", [](const Size& s) { return "<Size: " + printed(s) + ">"; });

    py::class_<Plan::Omission>(m, "Omission", "Something a scene does not call for, and why.")
        .def_readonly("what", &Plan::Omission::what, "What is left out.")
        .def_readonly("why", &Plan::Omission::why, "Why, or what would bring it in.")
        .def("__eq__",
             [](const Plan::Omission& a, const py::object& other) {
                 if (!py::isinstance<Plan::Omission>(other)) return false;
                 const auto& b = other.cast<const Plan::Omission&>();
                 return a.what == b.what && a.why == b.why;
             })
        .def(py::pickle([](const Plan::Omission& o) { return py::make_tuple(o.what, o.why); },
                        [](const py::tuple& d) {
                            return Plan::Omission{d[0].cast<std::string>(), d[1].cast<std::string>()};
                        }))
        .def("__repr__", [](const Plan::Omission& o) { return "<Omission: " + o.what + ": " + o.why + ">"; });

    py::class_<Plan>(m, "Plan", "The decisions made from a scene before anything is computed. print() shows them.")
        .def_readonly("coordinates", &Plan::coordinates, "One line for each body.")
        .def_readonly("effects", &Plan::effects, "Effects the scene has, such as \"gravity\" or \"static friction\".")
        .def_readonly("guards", &Plan::guards, "What is watched for.")
        .def_property_readonly("size", &Plan::size,
                               "Of the equations that a motion from time 0 begins with; of several parts the sum.")
        .def_readonly("functions", &Plan::functions, "The user's own functions: traced, or called back and why.")
        .def_property_readonly("freedom", &Plan::freedom,
                               "Degrees of freedom: those that joints and constraints leave.")
        .def_readonly(
            "not_unique", &Plan::not_unique,
            "Constraints whose forces are not determined by the motion: those told have the least norm. And contacts "
            "that are closed as it starts and whose forces are not determined by it: those told are one choice.")
        .def_readonly("engine", &Plan::engine,
                      "The automatic choice; of several parts those of all, such as \"closed form, taylor\".")
        .def_readonly("reason", &Plan::reason, "Why that engine.")
        .def_readonly("omissions", &Plan::omissions, "What is left out, and why.")
        .def_readonly("integrals", &Plan::integrals, "First integrals of the scene.")
        .def_readonly(
            "parts", &Plan::parts,
            "Plans of the parts, bodies that nothing joins, which are solved apart; none if there is one part only.")
        .def(py::pickle(&plan_data, &plan_from))
        .def("__str__", &printed<Plan>)
        .def("__repr__", [](const Plan& p) {
            return "<Plan: " + std::to_string(p.effects.size()) + " effects, engine " + p.engine + ">";
        });

    m.def(
        "plan",
        [](const BoundScene& scene) {
            const rbdyn::Scene copy = scene.scene;
            return unlocked([&] { return rbdyn::make_plan(copy); });
        },
        py::arg("scene"),
        R"(What a scene calls for and what it does not: coordinates, effects, guards, engine, first integrals.

Raises InvalidInput for a scene without bodies.)");
}

}  // namespace binding
