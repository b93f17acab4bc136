// Numbers of the user's that recorded functions use by reference.
#include <rbdyn/expression/expression.hpp>

#include "recording.hpp"

namespace binding {

using rbdyn::Parameter;

namespace {

/// What a parameter stands for where it is used: an expression, or its value where a function is called back.
py::object meaning(const Parameter& p) {
    if (CallingBack::depth() > 0) return py::float_(p.value());
    if (Recording* r = Recording::current()) return recorded_number(r->recorder().cell(p), r->shared_from_this());
    throw InvalidInput("parameter" + (p.name().empty() ? std::string() : " " + p.name()) +
                       ": it is part of a function while that is recorded; elsewhere write .value for its number");
}

// the Python objects of the parameters there are, so that each has one
struct Objects {
    std::vector<std::pair<Parameter, py::weakref>> known;
    std::size_t enough = 64;

    py::object add(const Parameter& p) {
        if (known.size() >= enough) {
            std::erase_if(known, [](const auto& k) { return k.second().is_none(); });
            enough = 2 * known.size() + 64;
        }
        const py::object object = py::cast(p);
        known.emplace_back(p, py::weakref(object));
        return object;
    }
};
Objects& objects() {
    // never destroyed: Python may be gone by then
    static auto* all = new Objects;
    return *all;
}

py::object made(const py::object& value, const std::optional<std::string>& name) {
    return objects().add(Parameter(number(value, "parameter", "value"), name.value_or("")));
}

}  // namespace

py::object parameter_object(const Parameter& p) {
    for (const auto& [other, weak] : objects().known) {
        if (!other.is(p)) continue;
        const py::object object = weak();
        if (!object.is_none()) return object;
    }
    return objects().add(p);
}

void bind_parameters(py::module_& m) {
    py::class_<Parameter> parameter(m, "Parameter", R"(A number that functions use by reference.

    k = rb.parameter(2.0, "k")
    force = rb.Force(lambda t, position, velocity: -k * position)
    k.value = 3.0  # from here on, in runs that start later

In a function it stands for its value in arithmetic and NumPy's functions; a function that is recorded is not recorded
again when it changes. Elsewhere ask for .value.)");
    parameter
        .def_property(
            "value",
            [](const Parameter& p) -> py::object {
                // inside a function that is recorded its number would be fixed for good
                if (Recording::current() != nullptr && CallingBack::depth() == 0) return meaning(p);
                return py::float_(p.value());
            },
            [](Parameter& p, const py::object& value) { p.set(number(value, "parameter", "value")); },
            "Its number; finite. Inside a function that is being recorded, the parameter itself.")
        .def_property_readonly("name", &Parameter::name)
        .def("__float__",
             [](const Parameter& p) {
                 Recording* r = Recording::current();
                 if (r != nullptr && CallingBack::depth() == 0) r->refuse("value");
                 return p.value();
             })
        .def("__repr__",
             [](const Parameter& p) {
                 const std::string name = p.name().empty() ? "" : ", " + std::string(py::repr(py::str(p.name())));
                 return "parameter(" + rbdyn::text(p.value()) + name + ")";
             })
        .def("__reduce__", [](const py::object& self) {
            const Parameter& p = self.cast<const Parameter&>();
            return py::make_tuple(py::object(py::module_::import("rbdyn._core").attr("parameter")),
                                  py::make_tuple(p.value(), p.name()));
        });

    m.def("parameter", &made, py::arg("value"), py::arg("name") = py::none(),
          "A number that functions use by reference: changing its .value changes what they do from the next run on.");

    const py::module_ operators = py::module_::import("operator");
    for (const char* name : {"add", "sub", "mul", "truediv", "pow", "mod", "floordiv"}) {
        const py::object f = operators.attr(name);
        parameter
            .def(("__" + std::string(name) + "__").c_str(),
                 [f](const Parameter& p, const py::object& y) -> py::object { return f(meaning(p), y); })
            .def(("__r" + std::string(name) + "__").c_str(),
                 [f](const Parameter& p, const py::object& y) -> py::object { return f(y, meaning(p)); });
    }
    for (const char* name : {"lt", "le", "gt", "ge"}) {
        const py::object f = operators.attr(name);
        parameter.def(("__" + std::string(name) + "__").c_str(),
                      [f](const Parameter& p, const py::object& y) -> py::object { return f(meaning(p), y); });
    }
    for (const char* name : {"neg", "pos", "abs"}) {
        const py::object f = operators.attr(name);
        parameter.def(("__" + std::string(name) + "__").c_str(),
                      [f](const Parameter& p) -> py::object { return f(meaning(p)); });
    }
    m.def("_meaning", &meaning, py::arg("parameter"));
    const auto hook = [&](const char* method, const char* name) {
        parameter.attr(method) = py::cpp_function(
            [name = std::string(name)](const py::object&, const py::args& args, const py::kwargs& kwargs) {
                return py::module_::import("rbdyn.tracing").attr(name.c_str())(*args, **kwargs);
            },
            py::is_method(parameter), py::name(method));
    };
    hook("__array_ufunc__", "array_ufunc");
    hook("__array_function__", "array_function");
}

}  // namespace binding
