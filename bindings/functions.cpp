// Functions of the user's, written in plain Python and NumPy: called once with expressions, which record what is done
// with them. The recorded function runs at native speed, and no Python with it.
//
// NumPy keeps expressions in arrays of objects and asks each for its method of a function's name (x.sin(), x.sqrt()),
// so that np.sin, np.dot, np.cross, np.linalg.norm and the like work on them as they are.
#include <memory>
#include <optional>
#include <rbdyn/expression/function.hpp>
#include <utility>

#include "binding.hpp"

namespace binding {

using rbdyn::Expression;
using rbdyn::Node;
using rbdyn::Operation;
using rbdyn::Recorder;

namespace {

/// An expression as Python holds it. It may outlive its recording, which nothing but `recording` then tells.
struct Recorded {
    Expression value;
    std::shared_ptr<const bool> recording;  // true while the function is being called
};

const Expression& live(const Recorded& x) {
    if (!*x.recording)
        throw InvalidInput(
            "Expression: the function it was recorded in has returned; a function may use only what it is called with");
    return x.value;
}

/// What a Python object means beside an expression; nothing if it is not a number.
std::optional<Expression> operand(py::handle x) {
    if (py::isinstance<Recorded>(x)) return live(x.cast<const Recorded&>());
    const PyNumberMethods* numeric = Py_TYPE(x.ptr())->tp_as_number;
    const bool is_number = numeric != nullptr && (numeric->nb_float != nullptr || numeric->nb_index != nullptr);
    if (!is_number || py::hasattr(x, "__len__")) return std::nullopt;
    return Expression(x.cast<double>());
}

[[noreturn]] void refuse(const std::string& what, const std::string& instead) {
    throw InvalidInput("Expression: " + what + " cannot be recorded: its value is not known while the function is; " +
                       instead);
}

/// Whether a node is a sum of at most three squares; of what goes to `roots`.
bool is_sum_of_squares(const Recorder& recorder, std::int32_t index, std::vector<std::int32_t>& roots) {
    const Node& node = recorder.node(index);
    if (node.operation == Operation::add)
        return is_sum_of_squares(recorder, node.a, roots) && is_sum_of_squares(recorder, node.b, roots);
    if (node.operation != Operation::multiply || node.a != node.b) return false;
    roots.push_back(node.a);
    return roots.size() <= 3;
}

/// The square root; of a sum of squares a length, whose zero is a switching point.
Expression root(const Expression& x) {
    std::vector<std::int32_t> parts;
    if (x.is_constant() || !is_sum_of_squares(*x.recorder(), x.node(), parts)) return sqrt(x);
    rbdyn::Vector3Of<Expression> v{0.0, 0.0, 0.0};
    for (std::size_t i = 0; i < parts.size(); ++i) {
        const bool is_constant = x.recorder()->node(parts[i]).operation == Operation::constant;
        const double value = x.recorder()->node(parts[i]).value;
        v[static_cast<Eigen::Index>(i)] = is_constant ? Expression(value) : Expression(x.recorder(), parts[i]);
    }
    return length(v);
}

Expression raised(const Expression& x, const Expression& n) {
    if (!n.is_constant() && x.is_constant() && !(x.value() > 0.0))
        throw InvalidInput("Expression: the base of a power is " + rbdyn::text(x.value()) +
                           "; with an exponent that varies it is positive");
    return pow(x, n);
}

template <class F>
auto unary(F f) {
    return [f](const Recorded& x) { return Recorded{f(live(x)), x.recording}; };
}

/// f(x, y) and, for numbers on the left, f(y, x); Python's NotImplemented for what is not a number.
template <class F>
auto binary(F f) {
    return [f](const Recorded& x, const py::object& y) -> py::object {
        const auto other = operand(y);
        if (!other) return py::reinterpret_borrow<py::object>(Py_NotImplemented);
        return py::cast(Recorded{f(live(x), *other), x.recording});
    };
}

std::string name_of_function(const py::object& f) {
    const py::object name = py::getattr(f, "__name__", py::none());
    if (name.is_none()) return shown(f);
    return "\"" + std::string(py::str(name)) + "\"";
}

/// One result of a function.
Expression result(py::handle value, const std::string& user, const std::string& name) {
    const auto y = operand(value);
    if (!y) throw InvalidInput(user + ": function " + name + " returns " + shown(value) + "; it returns numbers");
    if (y->is_constant())
        rbdyn::require(std::isfinite(y->value()), user, "what function " + name + " returns", y->value(),
                       "it returns finite numbers");
    return *y;
}

/// Calls f with what `arguments` makes of the inputs, and keeps what it does.
template <class Arguments, class Results>
rbdyn::Function recorded(const py::object& f, const std::string& user, int inputs, Arguments&& arguments,
                         Results&& results) {
    const auto recording = std::make_shared<bool>(true);
    struct End {
        bool& recording;
        ~End() { recording = false; }
    } end{*recording};
    const std::string name = name_of_function(f);
    try {
        return rbdyn::Function::record(inputs, [&](const std::vector<Expression>& x) {
            std::vector<Recorded> given;
            for (const Expression& e : x) given.push_back({e, recording});
            return results(f(*arguments(given)), name);
        });
    } catch (py::error_already_set& error) {
        const py::module_ errors = py::module_::import("rbdyn.errors");
        const bool is_ours = error.matches(errors.attr("Error"));
        if (!is_ours && !error.matches(PyExc_TypeError) && !error.matches(PyExc_AttributeError)) throw;
        const std::string reason = py::str(error.value());
        const std::string message =
            user + ": function " + name + " cannot be recorded: " + reason +
            ". It may use arithmetic, abs, and NumPy's sin, cos, tan, exp, log, sqrt, tanh, hypot, "
            "dot, cross and norm, without asking for values";
        py::raise_from(error, errors.attr("InvalidInput").ptr(), message.c_str());
        throw py::error_already_set();
    }
}

py::object array_of_objects(const py::list& items) {
    return py::module_::import("numpy").attr("array")(items, py::arg("dtype") = "object");
}

}  // namespace

rbdyn::TimeFunction recorded_time_function(const py::object& f, const std::string& user) {
    return recorded(
        f, user, 1, [](const std::vector<Recorded>& x) { return py::make_tuple(x[0]); },
        [&](const py::object& returned, const std::string& name) {
            py::object value = returned;
            if (py::isinstance<py::array>(value)) {
                const py::array array = value;
                if (array.ndim() != 0)
                    throw InvalidInput(user + ": function " + name + " returns shape " + shape_of(array) +
                                       "; it returns one number");
                value = array.attr("item")();
            }
            return std::vector<Expression>{result(value, user, name)};
        });
}

rbdyn::Function recorded_force(const py::object& f, const std::string& user) {
    return recorded(
        f, user, 7,
        [](const std::vector<Recorded>& x) {
            py::list position, velocity;
            for (std::size_t i = 0; i < 3; ++i) {
                position.append(x[1 + i]);
                velocity.append(x[4 + i]);
            }
            return py::make_tuple(x[0], array_of_objects(position), array_of_objects(velocity));
        },
        [&](const py::object& returned, const std::string& name) {
            const py::module_ numpy = py::module_::import("numpy");
            const py::array array = numpy.attr("asarray")(returned, py::arg("dtype") = "object");
            if (array.ndim() != 1 || array.size() != 3)
                throw InvalidInput(user + ": function " + name + " returns shape " + shape_of(array) +
                                   "; a force has three components, in N");
            std::vector<Expression> components;
            for (const py::handle item : array) components.push_back(result(item, user, name));
            return components;
        });
}

void bind_functions(py::module_& m) {
    py::class_<Recorded> expression(
        m, "Expression",
        R"(A number that is being recorded: what a function of the user's is called with, once.

Arithmetic, abs and NumPy's sin, cos, tan, exp, log, sqrt, tanh, hypot, dot, cross and linalg.norm are recorded; zeros
of absolute values and lengths become switching points, located like events. Its value is not known: comparing it or
asking for a float raises InvalidInput.)");
    const auto add = [](const Expression& a, const Expression& b) { return a + b; };
    const auto subtract = [](const Expression& a, const Expression& b) { return a - b; };
    const auto multiply = [](const Expression& a, const Expression& b) { return a * b; };
    const auto divide = [](const Expression& a, const Expression& b) { return a / b; };
    const auto reversed = [](auto f) { return [f](const Expression& a, const Expression& b) { return f(b, a); }; };
    expression.def("__add__", binary(add))
        .def("__radd__", binary(add))
        .def("__sub__", binary(subtract))
        .def("__rsub__", binary(reversed(subtract)))
        .def("__mul__", binary(multiply))
        .def("__rmul__", binary(multiply))
        .def("__truediv__", binary(divide))
        .def("__rtruediv__", binary(reversed(divide)))
        .def("__pow__", binary(raised))
        .def("__rpow__", binary(reversed(raised)))
        .def("__neg__", unary([](const Expression& x) { return -x; }))
        .def("__pos__", unary([](const Expression& x) { return x; }))
        .def("__abs__", unary([](const Expression& x) { return abs(x); }));
    // the names NumPy looks for
    expression.def("conjugate", unary([](const Expression& x) { return x; }))
        .def("fabs", unary([](const Expression& x) { return abs(x); }))
        .def("sqrt", unary(root))
        .def("sin", unary([](const Expression& x) { return sin(x); }))
        .def("cos", unary([](const Expression& x) { return cos(x); }))
        .def("tan", unary([](const Expression& x) { return tan(x); }))
        .def("exp", unary([](const Expression& x) { return exp(x); }))
        .def("log", unary([](const Expression& x) { return log(x); }))
        .def("tanh", unary([](const Expression& x) { return tanh(x); }))
        .def("hypot", binary([](const Expression& x, const Expression& y) {
                 return length(rbdyn::Vector3Of<Expression>{x, y, 0.0});
             }));
    for (const char* comparison : {"__eq__", "__ne__", "__lt__", "__le__", "__gt__", "__ge__"})
        expression.def(comparison, [](const Recorded&, const py::object&) -> bool {
            refuse("a comparison", "abs() and np.linalg.norm() may take the place of a case distinction");
        });
    expression.def("__bool__", [](const Recorded&) -> bool { refuse("an if", "the function has one formula"); });
    for (const char* conversion : {"__float__", "__complex__"})
        expression.def(conversion, [](const Recorded&) -> double {
            refuse("float()", "use NumPy's functions in place of those of math, and make arrays from lists");
        });
    for (const char* conversion : {"__int__", "__index__", "__round__", "__floor__", "__ceil__", "__trunc__"})
        expression.def(conversion, [](const Recorded&) -> int { refuse("rounding", "use smooth functions"); });
    expression.attr("__hash__") = py::none();
    expression.def("__repr__", [](const Recorded& x) {
        return x.value.is_constant() ? "Expression(" + rbdyn::text(x.value.value()) + ")" : std::string("Expression");
    });
}

}  // namespace binding
