// Functions of the user's, written in plain Python and NumPy: recorded by calling them with expressions, or called back
// where that is not possible; and recorded functions as data.
#include <algorithm>
#include <cmath>
#include <utility>

#include "recording.hpp"

namespace binding {

using rbdyn::GivenNumbers, rbdyn::Function;
using rbdyn::Node;
using rbdyn::Operation;
using rbdyn::Parameter;

namespace {

/// One result of a function.
Expression result(py::handle value, const std::string& user, const std::string& name) {
    const auto y = operand(value);
    if (!y) throw InvalidInput(user + ": function " + name + " returns " + shown(value) + "; it returns numbers");
    if (y->is_constant())
        rbdyn::require(std::isfinite(y->value()), user, "what function " + name + " returns", y->value(),
                       "it returns finite numbers");
    return *y;
}

std::vector<Expression> results_of(const py::object& returned, const Signature& signature, const std::string& user,
                                   const std::string& name) {
    std::vector<Expression> y;
    if (signature.is_motion) {
        for (const py::handle item : py::module_::import("rbdyn.tracing").attr("rigid_motion")(returned, user, name))
            y.push_back(result(item, user, name));
        return y;
    }
    const bool is_list = PyTuple_CheckExact(returned.ptr()) != 0 || PyList_CheckExact(returned.ptr()) != 0;
    if (signature.results == 1 && !is_list && !py::isinstance<py::array>(returned))
        return {result(returned, user, name)};
    const py::array array = py::module_::import("numpy").attr("asarray")(returned, py::arg("dtype") = "object");
    if (!signature.fits(array))
        throw InvalidInput(user + ": function " + name + " returns " + form_of(returned, array) + "; " +
                           signature.rule);
    for (const py::handle item : array.attr("ravel")().cast<py::array>()) y.push_back(result(item, user, name));
    return y;
}

py::tuple arguments_of(Recording& recording, const Signature& signature, bool spread) {
    py::list given;
    int first = 0;
    for (std::size_t k = 0; k < signature.arguments.size(); ++k) {
        const int size = signature.arguments[k];
        const std::vector<py::ssize_t> shape = signature.shape(k);
        if (shape.empty() || spread)
            for (int i = 0; i < size; ++i) given.append(recording.input(first + i));
        else
            given.append(recording.inputs(first, shape));
        first += size;
    }
    return given;
}

[[noreturn]] void refuse(const py::object& cause, const std::string& message) {
    const py::object type = py::module_::import("rbdyn.errors").attr("InvalidInput");
    const py::object error = type(message);
    if (cause) error.attr("__cause__") = cause;
    PyErr_SetObject(type.ptr(), error.ptr());
    throw py::error_already_set();
}

// --- functions as data ---

const char* const operation_names[] = {"constant", "input", "time",  "parameter", "cell",  "add",     "multiply",
                                       "divide",   "sqrt",  "norm",  "sin",       "cos",   "sinh",    "cosh",
                                       "tanh",     "exp",   "log",   "expm1",     "log1p", "arcsinh", "arctanh",
                                       "power",    "raise", "angle", "call",      "sign",  "where",   "floor"};

/// (inputs, nodes, outputs, names, parameters), from plain Python values.
py::tuple data(const Function& f) {
    py::list nodes, parameters;
    for (std::int32_t i = 0; i < f.size(); ++i) {
        const Node& n = f.node(i);
        nodes.append(py::make_tuple(operation_names[static_cast<int>(n.operation)], n.a, n.b, n.c, n.d, n.value));
    }
    // of a run each number is what it was when that started
    rbdyn::GivenNumbers given;
    f.give(given);
    for (std::size_t i = 0; i < given.cells.size(); ++i)
        parameters.append(parameter_object(given.cells[i], given.values[i]));
    return py::make_tuple(f.inputs(), nodes, f.output_nodes(), f.names(), parameters);
}

Function from_data(int inputs, const std::vector<std::tuple<std::string, int, int, int, int, double>>& nodes,
                   const std::vector<std::int32_t>& outputs, const std::vector<std::string>& names,
                   const std::vector<Parameter>& parameters) {
    std::vector<Node> made;
    for (const auto& [operation, a, b, c, d, value] : nodes) {
        const auto* const found = std::find(std::begin(operation_names), std::end(operation_names), operation);
        if (found == std::end(operation_names))
            throw InvalidInput("Function: an operation in its data is \"" + operation +
                               "\"; there is none of that name");
        made.push_back({static_cast<Operation>(found - std::begin(operation_names)), a, b, c, d, value});
    }
    return Function::from_data(inputs, made, outputs, names, parameters);
}

/// From any function of numbers that returns numbers, in whatever arrangement.
Function recorded_by_hand(const py::object& f, const std::optional<int>& inputs) {
    if (py::isinstance<Function>(f)) return f.cast<Function>();
    if (PyCallable_Check(f.ptr()) == 0) throw InvalidInput("Function: f is " + shown(f) + "; it is a function");
    const int count = inputs ? *inputs : py::module_::import("rbdyn.reasons").attr("parameters")(f).cast<int>();
    // 300 MB while it is recorded
    constexpr int most = 1'000'000;
    rbdyn::require(count >= 0 && count <= most, "Function", "inputs", count,
                   "it takes from 0 to " + std::to_string(most) + " numbers; give fewer");
    const std::string name = name_of(f);
    const Attempt a = attempt(
        f,
        [&](Recording& recording) {
            py::list given;
            for (int i = 0; i < count; ++i) given.append(recording.input(i));
            return py::tuple(given);
        },
        [&](const py::object& returned) {
            const py::array array = py::module_::import("numpy").attr("asarray")(returned, py::arg("dtype") = "object");
            std::vector<Expression> y;
            for (const py::handle item : array.attr("ravel")().cast<py::array>())
                y.push_back(result(item, "Function", name));
            return y;
        });
    if (!a.function) refuse(a.cause, "Function: function " + name + " cannot be recorded: " + a.reason);
    return with_inputs(a.function, count);
}

py::object number_or_tuple(const std::vector<double>& y) {
    if (y.size() == 1) return py::float_(y[0]);
    return py::tuple(py::cast(y));
}

/// f as a part of another function that is being recorded.
std::vector<Expression> composed(const Function& f, const std::vector<Expression>& x, rbdyn::Recorder& recorder) {
    std::vector<std::int32_t> moved;
    const auto at = [&](std::int32_t i) { return moved[static_cast<std::size_t>(i)]; };
    for (std::int32_t i = 0; i < f.size(); ++i) {
        Node node = f.node(i);
        if (node.operation == Operation::input) {
            moved.push_back(recorder.node_of(x[static_cast<std::size_t>(node.a)]));
            continue;
        }
        if (node.operation == Operation::cell) {
            moved.push_back(recorder.cell(f.parameters()[static_cast<std::size_t>(node.a)]).node());
            continue;
        }
        const auto operands = node.operands();
        if (operands[0] >= 0) node.a = at(operands[0]);
        if (operands[1] >= 0) node.b = at(operands[1]);
        if (operands[2] >= 0) node.c = at(operands[2]);
        if (node.operation == Operation::sign || node.operation == Operation::select ||
            node.operation == Operation::whole)
            node.d = recorder.name_index(f.names()[static_cast<std::size_t>(node.d)]);
        moved.push_back(recorder.record(node).node());
    }
    std::vector<Expression> y;
    for (const std::int32_t out : f.output_nodes()) {
        const Node& node = recorder.node(at(out));
        y.push_back(node.operation == Operation::constant ? Expression(node.value) : Expression(&recorder, at(out)));
    }
    return y;
}

py::object applied(const Function& f, const py::args& arguments) {
    if (static_cast<int>(arguments.size()) != f.inputs())
        throw InvalidInput("Function: it is called with " + std::to_string(arguments.size()) + " numbers; it takes " +
                           std::to_string(f.inputs()));
    Recording* const recording = Recording::current();
    if (recording != nullptr && CallingBack::depth() == 0) {
        std::vector<Expression> x;
        for (const py::handle a : arguments) {
            const auto value = operand(a);
            if (!value) throw InvalidInput("Function: an input is " + shown(a) + "; its inputs are numbers");
            x.push_back(*value);
        }
        py::list y;
        for (const Expression& out : composed(f, x, recording->recorder()))
            y.append(recorded_number(out, recording->shared_from_this()));
        return y.size() == 1 ? py::object(y[0]) : py::object(py::tuple(y));
    }
    std::vector<double> x;
    for (const py::handle a : arguments) x.push_back(number(a, "Function", "an input"));
    return number_or_tuple(f(std::span<const double>(x)));
}

}  // namespace

Function with_inputs(const Function& f, int inputs) {
    if (f.inputs() == inputs) return f;
    std::vector<Node> nodes;
    for (std::int32_t i = 0; i < f.size(); ++i) nodes.push_back(f.node(i));
    return Function::from_data(inputs, nodes, f.output_nodes(), f.names(), f.parameters());
}

std::vector<py::ssize_t> Signature::shape(std::size_t argument) const {
    const int size = arguments[argument];
    if (is_state && argument + 1 == arguments.size()) return {size};
    if (size == 9) return {3, 3};
    return size == 1 ? std::vector<py::ssize_t>{} : std::vector<py::ssize_t>{size};
}

bool Signature::fits(const py::array& array) const {
    const bool is_list = array.ndim() == 1, is_number = array.ndim() == 0;
    return array.size() == results && (results > 1 ? is_list : is_number || (is_list && is_state));
}

int Signature::inputs() const {
    int sum = 0;
    for (const int size : arguments) sum += size;
    return sum;
}

std::string form_of(const py::object& returned, const py::array& array) {
    return array.ndim() == 0 ? shown(returned) : "shape " + shape_of(array);
}

std::string name_of(const py::object& f) {
    const py::object name = py::getattr(f, "__name__", py::none());
    return name.is_none() ? shown(f) : "\"" + std::string(py::str(name)) + "\"";
}

bool takes_numbers(const py::object& f, const Signature& signature, const std::string& user, const std::string& name) {
    const auto few = static_cast<int>(signature.arguments.size()), many = signature.inputs();
    const py::tuple range = py::module_::import("rbdyn.reasons").attr("positional")(f);
    if (range.empty()) return false;
    const int least = range[0].cast<int>(), most = range[1].cast<int>();
    if (least <= few && few <= most) return false;
    const bool stays_whole =
        signature.is_state || std::count(signature.arguments.begin(), signature.arguments.end(), 9) > 0;
    if (!stays_whole && least <= many && many <= most) return true;
    const auto plural = [](int n) { return std::to_string(n) + (n == 1 ? " argument" : " arguments"); };
    throw InvalidInput(
        user + ": function " + name + " takes " + plural(least) + "; it is called with " + std::to_string(few) +
        (many != few && !stays_whole ? ", or with each of the " + std::to_string(many) + " numbers" : ""));
}

UserFunction user_function(const py::object& f, std::optional<bool> trace, const std::string& user,
                           const Signature& signature) {
    UserFunction result;
    const py::object plain = py::getattr(f, "__name__", py::none());
    result.name = plain.is_none() ? shown(f) : std::string(py::str(plain));
    if (py::isinstance<Function>(f)) {
        result.function = f.cast<Function>();
        const bool fits =
            result.function.inputs() == signature.inputs() && result.function.outputs() == signature.results;
        if (!fits)
            throw InvalidInput(user + ": Function has " + std::to_string(result.function.inputs()) + " inputs and " +
                               std::to_string(result.function.outputs()) + " results; here it has " +
                               std::to_string(signature.inputs()) + " and " + std::to_string(signature.results));
        return result;
    }
    result.callback = native_callback(f, signature, user);
    if (result.callback) {
        if (trace.value_or(false))
            throw InvalidInput(user + ": function " + result.name +
                               " is compiled, and cannot be recorded; leave trace out, or give it in Python");
        return result;
    }
    if (PyCallable_Check(f.ptr()) == 0) throw InvalidInput(user + ": " + shown(f) + " is no function; give one");
    const std::string name = name_of(f);
    const bool spread = takes_numbers(f, signature, user, name);
    if (!trace.value_or(true)) {
        result.callback = python_callback(f, signature, spread, user, "trace=False");
        return result;
    }
    // what numba compiles on demand has its Python source with it
    const py::object source = py::getattr(f, "py_func", f);
    const Attempt a = attempt(
        source, [&](Recording& recording) { return arguments_of(recording, signature, spread); },
        [&](const py::object& returned) { return results_of(returned, signature, user, name); });
    if (a.function) {
        result.function = with_inputs(a.function, signature.inputs());
    } else if (trace.value_or(false)) {
        refuse(a.cause, user + ": function " + name + " cannot be recorded: " + a.reason);
    } else {
        result.callback = python_callback(f, signature, spread, user, a.reason);
    }
    return result;
}

UserFunction user_force(const py::object& f, std::optional<bool> trace, const std::string& user) {
    return user_function(f, trace, user, {{1, 3, 3}, 3, "a force has three components, in N"});
}
UserFunction user_torque(const py::object& f, std::optional<bool> trace, const std::string& user) {
    return user_function(f, trace, user, {{1, 9, 3}, 3, "a torque has three components, in N m"});
}
UserFunction user_potential(const py::object& f, std::optional<bool> trace, const std::string& user) {
    return user_function(f, trace, user, {{3}, 1, "it returns one number, in J"});
}
UserFunction user_joint_load(const py::object& f, std::optional<bool> trace, const std::string& user) {
    return user_function(f, trace, user, {{1, 1, 1}, 1, "it returns one number"});
}
UserFunction user_central(const py::object& f, std::optional<bool> trace, const std::string& user) {
    return user_function(f, trace, user, {{1}, 1, "it returns one number, in N"});
}
UserFunction user_pair_force(const py::object& f, std::optional<bool> trace, const std::string& user) {
    return user_function(f, trace, user, {{1, 3, 3, 3, 3}, 3, "a force has three components, in N"});
}
UserFunction user_pole(const py::object& f, const std::string& user) {
    return user_function(f, std::nullopt, user, {{1}, 3, "a pole has three coordinates, in m"});
}
UserFunction user_time_function(const py::object& f, std::optional<bool> trace, const std::string& user) {
    return user_function(f, trace, user, {{1}, 1, "it returns one number"});
}
UserFunction user_curve(const py::object& f, std::optional<bool> trace, const std::string& user) {
    return user_function(f, trace, user, {{1}, 3, "a point has three coordinates, in m"});
}
UserFunction user_motion(const py::object& f, std::optional<bool> trace, const std::string& user) {
    return user_function(f, trace, user, {{1}, 12, "a motion is a displacement, a rotation matrix, or both", true});
}

UserFunction user_rates(const py::object& f, int variables, std::optional<bool> trace, const std::string& user) {
    const std::string rule = "it returns the rates of " + std::to_string(variables) +
                             (variables == 1 ? " variable" : " variables") + ", as many as x0 has";
    return user_function(f, trace, user, {{1, variables}, variables, rule, false, true});
}

rbdyn::TimeFunction recorded_time_function(const py::object& f, const std::string& user) {
    return user_time_function(f, true, user).function;
}
Function recorded_force(const py::object& f, const std::string& user) { return user_force(f, true, user).function; }

void bind_functions(py::module_& m) {
    py::class_<Function> function(m, "Function",
                                  R"(A recorded function: numbers in, numbers out, kept as a list of operations.

    f = rb.Function(lambda x, y: np.hypot(x, y))
    f(3.0, 4.0)  # 5.0

Recorded by calling f once, or once for each side of an `if`. Data: it can be printed, compared, copied and pickled, and
given wherever a function with its inputs is taken. Raises InvalidInput if f cannot be recorded.)");
    function
        .def(py::init(&recorded_by_hand), py::arg("f"), py::arg("inputs") = py::none(),
             "f: of `inputs` numbers, by default as many as it has parameters, a million at most; returns a number, or "
             "an array of them.")
        .def_property_readonly("inputs", &Function::inputs, "How many numbers it takes.")
        .def_property_readonly("outputs", &Function::outputs, "How many numbers it gives.")
        .def_property_readonly(
            "parameters",
            [](const Function& f) {
                std::vector<py::object> parameters;
                for (const Parameter& p : f.parameters()) parameters.push_back(parameter_object(p));
                return parameters;
            },
            "The parameters it uses by reference.")
        .def("__call__", &applied, R"(One number for one result, a tuple for several.

Inside a function that is being recorded it becomes part of that one.)")
        .def("__str__",
             [](const Function& f) {
                 std::string text = f.text();
                 while (!text.empty() && text.back() == '\n') text.pop_back();
                 return text;
             })
        .def("__repr__",
             [](const Function& f) {
                 return "Function(" + std::to_string(f.inputs()) + " inputs, " + std::to_string(f.outputs()) +
                        " results, " + std::to_string(f.size()) + " operations)";
             })
        .def("__eq__",
             [](const Function& f, const py::object& other) -> py::object {
                 if (!py::isinstance<Function>(other)) return py::reinterpret_borrow<py::object>(Py_NotImplemented);
                 return py::bool_(f == other.cast<const Function&>());
             })
        .def("__hash__",
             [](const Function& f) {
                 const py::tuple d = data(f);
                 return py::hash(py::make_tuple(d[0], py::tuple(d[1]), py::tuple(d[2]), py::tuple(d[3])));
             })
        .def("__reduce__", [](const py::object& self) {
            return py::make_tuple(py::object(py::module_::import("rbdyn._core").attr("_function")),
                                  data(self.cast<const Function&>()));
        });

    py::class_<UserFunction>(m, "UserFunction",
                             "How a function of the user's is run: recorded, or called back, and why.")
        .def_readonly("name", &UserFunction::name, "Of the function.")
        .def_property_readonly(
            "recorded", [](const UserFunction& f) { return f.callback ? std::nullopt : std::optional(f.function); },
            "The recorded function; None if it is called back.")
        .def_property_readonly(
            "reason", [](const UserFunction& f) { return f.callback ? f.callback->reason : std::string(); },
            "Why it is called back; empty if it is not.")
        .def_property_readonly(
            "is_python", [](const UserFunction& f) { return f.callback != nullptr && f.callback->is_python; },
            "Whether Python runs it.")
        .def_property_readonly(
            "calls", [](const UserFunction& f) { return f.callback ? f.callback->calls.load() : 0; },
            "How often it was called back.")
        .def(
            "__call__",
            [](const UserFunction& f, const py::args& arguments) -> py::object {
                if (!f.callback) return applied(f.function, arguments);
                std::vector<double> x, y(static_cast<std::size_t>(f.callback->outputs));
                for (const py::handle a : arguments) x.push_back(number(a, "UserFunction", "an input"));
                rbdyn::require(static_cast<int>(x.size()) == f.callback->inputs, "UserFunction", "count of numbers",
                               static_cast<double>(x.size()), "it takes " + std::to_string(f.callback->inputs));
                (*f.callback)(x.data(), y.data());
                return number_or_tuple(y);
            },
            "Its results for numbers.")
        .def("__repr__", [](const UserFunction& f) {
            return "UserFunction(" + f.name + ", " +
                   (f.callback ? "called back: " + f.callback->reason : std::string("recorded")) + ")";
        });
    m.def(
        "_user_function",
        [](const std::string& kind, const py::object& f, std::optional<bool> trace) {
            if (kind == "force") return user_force(f, trace, "Force");
            if (kind == "potential") return user_potential(f, trace, "Potential");
            if (kind == "curve") return user_curve(f, trace, "Curve");
            if (kind == "motion") return user_motion(f, trace, "Motion");
            return user_time_function(f, trace, "TimeFunction");
        },
        py::arg("kind"), py::arg("f"), py::arg("trace") = py::none());
    m.def("_function", &from_data, py::arg("inputs"), py::arg("nodes"), py::arg("outputs"), py::arg("names"),
          py::arg("parameters"));
}

}  // namespace binding
