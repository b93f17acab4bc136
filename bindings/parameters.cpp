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

// numbers of the user's in lists of at most so many levels are seen
constexpr int deepest = 4;

bool holds_parameter(py::handle value, int depth) {
    if (py::isinstance<Parameter>(value)) return true;
    if (py::isinstance<py::list>(value) || py::isinstance<py::tuple>(value)) {
        for (const py::handle item : value)
            if (depth < deepest && holds_parameter(item, depth + 1)) return true;
        return false;
    }
    if (!py::isinstance<py::array>(value)) return false;
    const auto array = py::reinterpret_borrow<py::array>(value);
    if (array.dtype().kind() != 'O') return false;
    for (const py::handle item : array.attr("flat"))
        if (py::isinstance<Parameter>(item)) return true;
    return false;
}

py::object made(const py::object& value, const std::optional<std::string>& name) {
    return objects().add(Parameter(number(value, "parameter", "value"), name.value_or("")));
}

}  // namespace

bool has_parameters(py::handle value) { return holds_parameter(value, 0); }

void refuse_parameter(py::handle value) {
    throw InvalidInput(py::module_::import("rbdyn.reasons").attr("plain")(shown(value)).cast<std::string>());
}

rbdyn::Given given(py::handle value, const std::string& object, const std::string& what) {
    if (py::isinstance<Parameter>(value)) return rbdyn::Given(value.cast<const Parameter&>());
    return number(value, object, what);
}

NumberOrParameter to_python(const rbdyn::Given& number) {
    const py::object value =
        number.varies() ? parameter_object(number.parameter(), number.now()) : py::float_(number.now());
    return py::reinterpret_borrow<NumberOrParameter>(value);
}

std::string text(const rbdyn::Given& number) {
    return number.varies() ? std::string(py::repr(parameter_object(number.parameter()))) : rbdyn::text(number.now());
}

rbdyn::Function function_of_numbers(py::handle value, int inputs, int results, const std::string& object,
                                    const std::string& what) {
    py::list numbers;
    if (py::isinstance<Parameter>(value))
        numbers.append(value);
    else
        for (const py::handle item : py::iter(value)) numbers.append(item);
    if (static_cast<int>(numbers.size()) != results)
        throw InvalidInput(object + ": " + what + " has " + std::to_string(numbers.size()) + " numbers; it has " +
                           std::to_string(results));
    std::vector<rbdyn::Given> given_numbers;
    for (const py::handle item : numbers) given_numbers.push_back(given(item, object, what));
    const auto f = rbdyn::Function::record(inputs, [&](const std::vector<Expression>&) {
        std::vector<Expression> y;
        for (const rbdyn::Given& g : given_numbers)
            y.push_back(g.varies() ? static_cast<Expression>(g.parameter()) : Expression(g.now()));
        return y;
    });
    // as from data, so that it is equal to what it is unpickled from
    std::vector<rbdyn::Node> nodes;
    for (std::int32_t i = 0; i < f.size(); ++i) nodes.push_back(f.node(i));
    return rbdyn::Function::from_data(inputs, nodes, f.output_nodes(), f.names(), f.parameters());
}

py::object parameter_object(const Parameter& p, double value) {
    return p.value() == value ? parameter_object(p) : objects().add(Parameter(value, p.name()));
}

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
        .def_property_readonly("name", &Parameter::name, "As it was given; empty if it was not.")
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
    const py::module_ math = py::module_::import("math"), builtins = py::module_::import("builtins");
    for (const char* name : {"floor", "ceil", "trunc"}) {
        const py::object f = math.attr(name);
        parameter.def(("__" + std::string(name) + "__").c_str(),
                      [f](const Parameter& p) -> py::object { return f(meaning(p)); });
    }
    parameter
        .def(
            "__round__",
            [f = py::object(builtins.attr("round"))](const Parameter& p, const py::object& digits) -> py::object {
                return f(meaning(p), digits);
            },
            py::arg("ndigits") = py::none())
        .def("__divmod__",
             [f = py::object(builtins.attr("divmod"))](const Parameter& p, const py::object& y) -> py::object {
                 return f(meaning(p), y);
             })
        .def("__rdivmod__",
             [f = py::object(builtins.attr("divmod"))](const Parameter& p, const py::object& y) -> py::object {
                 return f(y, meaning(p));
             })
        .def("__bool__", [](const Parameter& p) { return py::bool_(meaning(p)); })
        // in functions numbers are compared; elsewhere a parameter is equal to itself
        .def("__eq__",
             [](const py::object& self, const py::object& y) -> py::object {
                 if (Recording::current() == nullptr && CallingBack::depth() == 0)
                     return self.is(y) ? py::object(py::bool_(true))
                                       : py::reinterpret_borrow<py::object>(Py_NotImplemented);
                 if (self.is(y)) return py::bool_(true);
                 return meaning(self.cast<const Parameter&>()).attr("__eq__")(y);
             })
        .def("__hash__", [](const py::object& self) { return reinterpret_cast<std::uintptr_t>(self.ptr()) >> 4; });
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
